//! The demonstration: a robot, and the recording of its simulated twin.

use serde::Serialize;
use serde_json::{Value, json};
use thetahat::Experiment;
use thetahat_report::report;

use crate::session::Outcome;

const ROBOT: &str = "tx40.toml";
const LOG: &str = "tx40_demo.csv";

/// Files, with the request for them.
pub(crate) struct Demo {
    pub(crate) files: [(&'static str, Vec<u8>); 2],
    pub(crate) answer: DemoAnswer,
}

#[derive(Serialize)]
pub(crate) struct DemoAnswer {
    request: Value,
    experiment: String,
}

impl Demo {
    pub(crate) fn new() -> Outcome<Self> {
        let demo = Experiment::demo()?;
        let log = report::recording_csv(&demo.record_twin()?)?;
        let own = demo.file.robot.display().to_string();
        Ok(Self {
            files: [(ROBOT, demo.robot_text.into_bytes()), (LOG, log)],
            answer: DemoAnswer {
                request: json!({ "robot": ROBOT, "recordings": [LOG] }),
                experiment: demo.text.replacen(&own, ROBOT, 1),
            },
        })
    }
}
