//! What formats of drives write of a robot.

use serde::de::DeserializeOwned;

use crate::export::{error::ExportError, format::ActuatorFormat, pd_loop::PdLoop, represented::RepresentedRobot};
use thetahat_model::robot::{JointQuantity, Robot};

/// Step of the simulation for which a delay is counted where the controller has no sample time, s.
const USUAL_STEP_S: f64 = 0.0025;

/// What is written of a robot.
pub(in crate::export) struct Written<'a> {
    pub(in crate::export) format: ActuatorFormat,
    /// The robot, with its motors.
    pub(in crate::export) robot: &'a Robot,
    /// The same as the format has it.
    pub(in crate::export) represented: &'a RepresentedRobot,
    /// The controller, if it is known.
    pub(in crate::export) pd: Option<&'a PdLoop>,
    /// Where the values come from, a sentence each.
    pub(in crate::export) about: Vec<String>,
}

/// The numbers of a joint's drive, SI, at the joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drive {
    pub(super) joint: String,
    pub(super) armature: f64,
    pub(super) damping: f64,
    pub(super) friction: f64,
}

impl Written<'_> {
    /// That each joint has a drive of its own.
    pub(super) fn require_drives_of_joints(&self) -> Result<(), ExportError> {
        let (robot, format) = (self.robot, self.format.of_exports());
        if let Some(joint) = robot.joints.iter().find(|joint| joint.mimic.is_some() || !joint.also_follows.is_empty()) {
            return Err(ExportError::FollowerInActuators { joint: joint.name.clone(), format });
        }
        let coupled = robot.transmission.coupled_motors().first().map(|motor| motor + 1);
        coupled.map_or(Ok(()), |motor| Err(ExportError::CoupledActuators { motor, format }))
    }

    /// The joint positions at the zeros of the encoders, one for each coordinate, rad or m.
    pub(super) fn zeros(&self) -> &[f64] {
        self.robot.transmission.offset()
    }

    pub(super) fn drives(&self) -> Vec<Drive> {
        let of = |quantity, joint| self.represented.of_joint(quantity, joint);
        let joints = self.represented.robot.coordinate_joints();
        let drive = |&joint: &usize| Drive {
            joint: self.represented.robot.joints[joint].name.clone(),
            armature: of(JointQuantity::Ia, joint),
            damping: of(JointQuantity::Fv, joint),
            friction: of(JointQuantity::Fc, joint),
        };
        joints.iter().map(drive).collect()
    }

    /// The controller.
    pub(super) fn pd(&self) -> Result<&PdLoop, ExportError> {
        self.pd.ok_or_else(|| ExportError::NoController { format: self.format.of_exports() })
    }

    /// The step in which a delay is counted, s, and the delay in such steps.
    pub(super) fn steps_of_delay(&self) -> Steps {
        let step_s = self.pd.and_then(|pd| pd.sample_time_s).unwrap_or(USUAL_STEP_S);
        let delay_s = self.pd.map_or(0.0, |pd| pd.delay_s);
        Steps { step_s, delay_s, count: (delay_s / step_s).round().max(0.0) }
    }

    /// All that the file says of itself.
    pub(super) fn said(&self, notes: &[String]) -> Vec<String> {
        [&self.about, notes, &self.represented.not_represented].concat()
    }
}

/// A delay in steps of a simulation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    pub(super) step_s: f64,
    pub(super) delay_s: f64,
    pub(super) count: f64,
}

impl Steps {
    /// What the count loses.
    pub(super) fn note(self) -> String {
        format!(
            "delay {:.3} ms: {} steps of {:.3} ms; count it anew for another step",
            1e3 * self.delay_s,
            self.count,
            1e3 * self.step_s
        )
    }
}

/// A file of a format.
pub(super) fn parsed<T: DeserializeOwned>(text: &str) -> Result<T, ExportError> {
    serde_json::from_str(text).map_err(|error| ExportError::ReadBack { missing: format!("numbers: {error}") })
}
