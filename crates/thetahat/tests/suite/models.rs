//! The library `models/`: files that `.ci/models` writes.

use std::fs;

use thetahat_testing::project;
use toml::{Table, Value};

const QUANTITIES: [&str; 4] = ["armature", "viscous_friction", "coulomb_friction", "constant_torque"];

fn number(value: &Value) -> f64 {
    value.as_float().or(value.as_integer().map(|whole| whole as f64)).unwrap()
}

/// Each file names its source, its files with their digests and its experiment, and has intervals about its values.
#[test]
fn models_have_sources_digests_and_intervals() {
    let folder = project("models");
    let files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let models: Vec<_> = files.iter().filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    assert_eq!(models.len(), 5, "{models:?}");
    for path in models {
        let model: Table = fs::read_to_string(path).unwrap().parse().unwrap();
        let text = |key: &str| model[key].as_str().unwrap();
        assert!(text("source").contains("commit"), "{}", path.display());
        assert!(folder.join(text("experiment")).is_file(), "{}", path.display());
        assert!(number(&model["held_back_mrad_rms"]) > 0.0);
        let digests = model["sha256"].as_table().unwrap();
        assert!(!digests.is_empty() && digests.values().all(|digest| digest.as_str().unwrap().len() == 64));
        for joint in model["joint"].as_array().unwrap() {
            for key in QUANTITIES {
                let [low, high] = joint[key]["interval_95"].as_array().unwrap().as_slice() else { panic!("{key}") };
                let value = number(&joint[key]["value"]);
                assert!(number(low) < value && value < number(high), "{}: {key} of {}", path.display(), joint["name"]);
            }
        }
    }
}
