//! Robots and the recordings of their simulated twins, to try the page on.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};
use thetahat::Experiment;
use thetahat_report::report;

use crate::session::Outcome;

const ARM: &str = include_str!("../../../../examples/arm/arm.urdf");
const ARM_TWIN: &str = include_str!("../../../../examples/arm/twin.toml");
const AXIS: &str = include_str!("../../../../robots/emps.toml");
const AXIS_TWIN: &str = include_str!("../../../../experiments/emps_twin.toml");

/// Files, with the request for them.
pub(crate) struct Sample {
    pub(crate) files: [(&'static str, Vec<u8>); 2],
    pub(crate) answer: SampleAnswer,
}

#[derive(Serialize)]
pub(crate) struct SampleAnswer {
    request: Value,
    /// Where it is not the proposal.
    experiment: Option<String>,
}

impl Sample {
    /// The sample of a name.
    pub(crate) fn named(name: &str) -> Outcome<Self> {
        match name {
            "demo" => Self::demo(),
            "arm" => Ok(Self::of(("arm.urdf", ARM), ("arm_log.csv", recorded(ARM, ARM_TWIN)?))),
            "axis" => Ok(Self::of(("axis.toml", AXIS), ("axis_log.csv", recorded(AXIS, AXIS_TWIN)?))),
            "exchanged" => {
                let log = with_exchanged_names(recorded(ARM, ARM_TWIN)?);
                Ok(Self::of(("arm.urdf", ARM), ("exchanged_log.csv", log)))
            }
            _ => Err(format!("there is no sample {name:?}: the samples are demo, arm, axis and exchanged").into()),
        }
    }

    fn of((robot_file, robot): (&'static str, &str), log: (&'static str, Vec<u8>)) -> Self {
        let request = json!({ "robot": robot_file, "recordings": [log.0] });
        Self { files: [(robot_file, robot.into()), log], answer: SampleAnswer { request, experiment: None } }
    }

    /// The demonstration of the command line, with its own experiment.
    fn demo() -> Outcome<Self> {
        const ROBOT: &str = "tx40.toml";
        let demo = Experiment::demo()?;
        let log = report::recording_csv(&demo.record_twin()?)?;
        let own = demo.file.robot.display().to_string();
        let sample = Self::of((ROBOT, &demo.robot_text), ("tx40_demo.csv", log));
        let experiment = Some(demo.text.replacen(&own, ROBOT, 1));
        Ok(Self { answer: SampleAnswer { experiment, ..sample.answer }, ..sample })
    }
}

/// The log of a twin, as `simulate` writes it.
fn recorded(robot: &str, twin: &str) -> Outcome<Vec<u8>> {
    let experiment = Experiment::from_texts(Path::new("twin.toml"), twin.to_owned(), robot.to_owned())?;
    Ok(report::recording_csv(&experiment.record_twin()?)?)
}

/// The log with the names of the first two torques exchanged, as by two cables in the wrong sockets.
fn with_exchanged_names(log: Vec<u8>) -> Vec<u8> {
    let end = log.iter().position(|byte| *byte == b'\n').unwrap_or(log.len());
    let head = String::from_utf8_lossy(&log[..end]).into_owned();
    let exchanged = head.replace("torque_1", "\0").replace("torque_2", "torque_1").replace('\0', "torque_2");
    [exchanged.as_bytes(), &log[end..]].concat()
}
