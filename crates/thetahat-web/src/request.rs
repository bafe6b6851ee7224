use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use thetahat::{
    Method, OneOrEach,
    experiment::{ProposalFiles, ProposalRequest},
    recording::{Side, Unit},
};

/// A request for a robot and its recordings: the arguments of `thetahat init`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) robot: Option<PathBuf>,
    pub(crate) recordings: Vec<PathBuf>,
    position: Vec<String>,
    torque: Vec<String>,
    pub(crate) time: Option<String>,
    joints: Vec<String>,
    rate: Option<f64>,
    position_unit: Option<OneOrEach<Unit>>,
    torque_unit: Option<OneOrEach<Unit>>,
    side: Option<Side>,
    pub(crate) window_s: Option<[f64; 2]>,
    locked: BTreeMap<String, f64>,
    /// Torque for 1 A, 1 V or 100 %, one for all joints or one for each.
    gain: Vec<f64>,
    position_gain: Vec<f64>,
    velocity_gain: Vec<f64>,
    methods: Vec<Method>,
}

impl Request {
    /// The files in the session's folder, which also contains the experiment.
    pub(crate) fn files(&self, folder: &Path) -> ProposalFiles {
        ProposalFiles {
            robot: folder.join(self.robot.clone().unwrap_or_default()),
            recordings: self.recordings.iter().map(|file| folder.join(file)).collect(),
            folder: folder.to_owned(),
        }
    }

    /// The request without some recordings.
    pub(crate) fn without<'p>(&self, paths: impl Iterator<Item = &'p Path>) -> Self {
        let paths: Vec<&Path> = paths.collect();
        let recordings = self.recordings.iter().filter(|path| !paths.contains(&path.as_path())).cloned().collect();
        Self { recordings, ..self.clone() }
    }

    /// The request of the library.
    pub(crate) fn proposal(&self, files: &ProposalFiles) -> ProposalRequest {
        let request = self.clone();
        files.name_in(ProposalRequest {
            position: request.position,
            torque: request.torque,
            joints: request.joints,
            time: request.time,
            sample_rate_hz: request.rate,
            position_unit: request.position_unit,
            torque_unit: request.torque_unit,
            side: request.side,
            window_s: request.window_s.map_or([None; 2], |window| window.map(Some)),
            locked: request.locked,
            torque_gain: request.gain,
            position_gain: request.position_gain,
            velocity_gain: request.velocity_gain,
            methods: request.methods,
            ..ProposalRequest::default()
        })
    }
}
