//! The library `models/`: its experiments give its numbers again.

use std::fs;

use libtest_mimic::{Failed, Trial};
use thetahat::{Experiment, Method, results::RunResult};
use thetahat_testing::{data, each_night, ensure, project, trials_on_shared_data};
use toml::{Table, Value};

/// Difference of an estimate from that of the file, of its interval: digits are rounded, and processors differ.
const TOLERANCE: f64 = 0.02;
const QUANTITIES: [(&str, &str); 4] =
    [("ia", "armature"), ("fv", "viscous_friction"), ("fc", "coulomb_friction"), ("off", "constant_torque")];

fn number(value: &Value) -> f64 {
    value.as_float().or(value.as_integer().map(|whole| whole as f64)).unwrap_or(f64::NAN)
}

fn ensure_same(run: &RunResult, joint: usize, model: &Value) -> Result<(), Failed> {
    for (quantity, key) in QUANTITIES {
        let name = format!("{quantity}{}", joint + 1);
        let found = run.parameter(&name).ok_or_else(|| Failed::from(format!("no {name}")))?.estimate;
        let interval = model[key]["interval_95"].as_array().ok_or("no interval")?;
        let width = number(&interval[1]) - number(&interval[0]);
        let kept = number(&model[key]["value"]);
        ensure((found - kept).abs() <= TOLERANCE * width, format!("{name}: {found}, in the file {kept}"))?;
    }
    Ok(())
}

fn go2_is_identified_again() -> Result<(), Failed> {
    let folder = data().join("go2");
    let results = Experiment::read(&project("models/experiments/go2.toml"), &folder)?.run(&folder, &mut |_| {})?;
    let run = results.run("nominal", Method::CLOE).ok_or("no run by cloe")?;
    let model: Table = fs::read_to_string(project("models/go2.toml"))?.parse()?;
    let joints = model["joint"].as_array().ok_or("no joints")?;
    ensure(joints.len() == 12, format!("{} joints", joints.len()))?;
    joints.iter().enumerate().try_for_each(|(k, joint)| ensure_same(run, k, joint))
}

pub fn all_trials() -> Vec<Trial> {
    each_night(trials_on_shared_data(&["datasets/go2"], vec![("go2_is_identified_again", go2_is_identified_again)]))
}
