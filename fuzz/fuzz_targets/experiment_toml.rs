#![no_main]

use std::path::Path;

use thetahat::Experiment;

const ROBOT: &str = include_str!("../../robots/tx40.toml");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = Experiment::from_texts(Path::new("experiment.toml"), text.to_owned(), ROBOT.to_owned());
});
