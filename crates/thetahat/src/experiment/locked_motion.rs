//! Joints that an identification locked, in the file of another motion.

use super::{description::RecordingDescription, error::ExperimentError, proposal::recorded_positions};
use thetahat_data::recording::{Side, Unit, inspect};
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_model::robot::{JointKind, LockedJoint, Robot};

/// Distance from its locked coordinate from which a joint changes the torques of the others noticeably, rad and m.
const MOVES: [f64; 2] = [0.1, 0.02];

/// That the file of a motion has no column of a locked joint that is elsewhere than where it was locked. `whole` is the robot without
/// locks, `locked` its joints that are.
pub(super) fn require_locked_at_rest(
    description: &RecordingDescription,
    whole: &Robot,
    locked: &[LockedJoint],
) -> Result<(), ExperimentError> {
    let position = &description.position;
    if locked.is_empty() || position.side == Side::Motor || position.gain.is_some() {
        return Ok(());
    }
    // A file that cannot be inspected is refused where it is read.
    let Ok(contents) = inspect(&position.file) else { return Ok(()) };
    let recorded = recorded_positions(&contents, whole);
    for (joint, found) in whole.coordinates().zip(recorded) {
        let Some((lock, (column, ends))) = locked.iter().find(|lock| lock.name == joint.name).zip(found) else {
            continue;
        };
        if position.columns.contains(&column) {
            continue;
        }
        let Some(unit) = unit_of(&position.unit, lock.kind) else { continue };
        let [least, most] = ends.map(|end| end * unit.to_si());
        let [angle, length] = MOVES;
        let (limit, si) = match lock.kind {
            JointKind::Revolute => (angle, "rad"),
            JointKind::Prismatic => (length, "m"),
        };
        if (most - lock.value).max(lock.value - least) > limit {
            return Err(ExperimentError::LockedMoves {
                file: position.file.clone(),
                joint: lock.name.clone(),
                value: lock.value,
                column,
                least,
                most,
                unit: si,
            });
        }
    }
    Ok(())
}

/// The unit of the positions of a kind of joint.
fn unit_of(units: &OneOrEach<Unit>, kind: JointKind) -> Option<Unit> {
    let turns = |unit: &Unit| unit.dimension() == thetahat_data::recording::Dimension::Angle;
    units.given().iter().copied().find(|unit| turns(unit) == (kind == JointKind::Revolute))
}
