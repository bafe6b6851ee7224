//! The curves of a recording.

use serde::Serialize;
use thetahat::{Recording, Robot, Series, results::JointResult};

/// Largest number of samples in the curves.
const MOST: usize = 2000;

/// Positions and torques of the joints, thinned: one row for each joint.
#[derive(Serialize)]
pub(super) struct SeriesAnswer {
    time_s: Vec<f64>,
    position: Vec<Vec<f64>>,
    torque: Vec<Vec<f64>>,
    joints: Vec<String>,
    position_unit: Vec<String>,
    torque_unit: Vec<String>,
    window_s: [f64; 2],
}

impl SeriesAnswer {
    pub(super) fn of(robot: &Robot, recording: &Recording, window_s: Option<[f64; 2]>) -> Self {
        let samples = recording.position.len();
        let kept = || (0..samples).step_by(samples.div_ceil(MOST).max(1));
        let time = |k: usize| k as f64 / recording.sample_rate_hz;
        let thinned =
            |series: &Series| (0..series.channels()).map(|c| kept().map(|k| series.sample(k)[c]).collect()).collect();
        let joints = JointResult::of_coordinates(robot);
        let each = |text: fn(&JointResult) -> &String| joints.iter().map(|joint| text(joint).clone()).collect();
        Self {
            time_s: kept().map(time).collect(),
            position: thinned(&recording.position),
            torque: recording.torque.as_ref().map(thinned).unwrap_or_default(),
            joints: each(|joint| &joint.name),
            position_unit: each(|joint| &joint.position_unit),
            torque_unit: each(|joint| &joint.torque_unit),
            window_s: window_s.unwrap_or([0.0, time(samples)]),
        }
    }
}
