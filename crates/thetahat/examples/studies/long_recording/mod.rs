//! A long recording of the TX40 twin: one motion of the demonstration repeated, with fresh noise in every repetition.
//!
//! `cargo run --release -p thetahat --example studies -- long_recording FOLDER SAMPLES` writes `record.csv`, `position.npy` and
//! `torque.npy` of SAMPLES samples at 5 kHz, with an experiment for each: `long_csv.toml` and `long_npy.toml`. One hour is
//! 18 million samples. A third argument, `csv` or `npy`, writes only that one.

pub mod twin;

use std::{error::Error, path::Path};

use self::twin::{Kind, Twin};

const USAGE: &str = "usage: long_recording FOLDER SAMPLES [csv|npy]";

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let (folder, samples, kinds) = match &arguments[..] {
        [folder, samples] => (Path::new(folder), samples.parse()?, vec![Kind::Csv, Kind::Npy]),
        [folder, samples, kind] => {
            let kind = [Kind::Csv, Kind::Npy].into_iter().find(|k| k.to_string() == *kind).ok_or(USAGE)?;
            (Path::new(folder), samples.parse()?, vec![kind])
        }
        _ => return Err(USAGE.into()),
    };
    let twin = Twin::new()?;
    kinds.into_iter().try_for_each(|kind| twin.write(kind, folder, samples).map(|_| ()))
}
