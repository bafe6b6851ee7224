//! Events in the words and units of the robot.

use super::{
    collision::Bump,
    drift::{Cause, FoundChange},
    layout::{OWN, PAYLOAD},
    subject::WatchedRobot,
};
use thetahat_estimation::statistics::t_quantile;
use thetahat_model::robot::JointKind;
use thetahat_report::results::{JointResult, WatchChange, WatchCollision, WatchDrift};

/// Probability that an interval of several misses its value.
const MISSED: f64 = 0.05;
/// Degrees of freedom of a normal distribution.
const NORMAL: f64 = 1e6;

/// Says events at a time.
pub(super) struct Words<'a> {
    pub(super) robot: &'a WatchedRobot,
    pub(super) joints: &'a [JointResult],
    pub(super) time_s: f64,
}

impl Words<'_> {
    pub(super) fn bump(&self, bump: &Bump) -> WatchCollision {
        let joint = &self.joints[bump.joint];
        WatchCollision {
            time_s: self.time_s,
            began_s: bump.began_s,
            joint: bump.joint + 1,
            torque: bump.torque,
            unit: joint.torque_unit.clone(),
            label: joint.label(bump.joint + 1),
        }
    }

    pub(super) fn drift(&self, found: &FoundChange) -> WatchDrift {
        let places = found.cause.parameters(self.joints.len());
        WatchDrift {
            time_s: self.time_s,
            began_s: found.began_s,
            cause: self.cause(found.cause),
            rivals: found.rivals.iter().map(|cause| self.cause(*cause)).collect(),
            changes: self.changes(&places, &found.ratio.changes, &found.ratio.deviations, places.len()),
            evidence: found.ratio.log,
        }
    }

    pub(super) fn cause(&self, cause: Cause) -> String {
        match cause {
            Cause::Friction(j) => format!("friction of {}", self.joints[j].label(j + 1)),
            Cause::Offset(j) => format!("offset of {}", self.joints[j].label(j + 1)),
            Cause::Payload => "payload".to_owned(),
        }
    }

    /// Changes at some places with intervals that hold all of so many.
    pub(super) fn changes(
        &self,
        places: &[usize],
        changes: &[f64],
        deviations: &[f64],
        together: usize,
    ) -> Vec<WatchChange> {
        let half = t_quantile(1.0 - 0.5 * MISSED / together as f64, NORMAL).unwrap_or(f64::INFINITY);
        let of = |((place, change), deviation): ((&usize, &f64), &f64)| {
            let (parameter, unit, identified) = self.named(*place);
            WatchChange {
                parameter,
                unit,
                change: *change,
                interval_95: [change - half * deviation, change + half * deviation],
                percent: identified.filter(|value| *value != 0.0).map(|value| 100.0 * change / value),
            }
        };
        places.iter().zip(changes).zip(deviations).map(of).collect()
    }

    /// Name, unit and identified value of a change.
    fn named(&self, place: usize) -> (String, String, Option<f64>) {
        let (joint, change) = (place / OWN, place % OWN);
        let Some(of_joint) = self.joints.get(joint) else {
            let payload = place - OWN * self.joints.len();
            let unit = ["kg", "kg m", "kg m^2"][payload.div_ceil(3).min(2)];
            return (PAYLOAD[payload].to_owned(), unit.to_owned(), None);
        };
        let friction = self.robot.friction(joint);
        let value = |of: Option<[f64; 2]>| of.map(|[value, _]| value);
        let (torque, number) = (&of_joint.torque_unit, joint + 1);
        match change {
            0 => {
                let per_speed = if of_joint.kind == JointKind::Revolute { "N m s/rad" } else { "N s/m" };
                (format!("fv{number}"), per_speed.to_owned(), value(friction.viscous))
            }
            1 => (format!("fc{number}"), torque.clone(), value(friction.coulomb)),
            _ => (format!("off{number}"), torque.clone(), None),
        }
    }
}
