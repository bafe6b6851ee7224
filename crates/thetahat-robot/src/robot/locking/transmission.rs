use super::error::LockError;
use crate::robot::{Robot, Transmission};
use thetahat_ground::linear_algebra::Matrix;

/// The motors that turn only with moving joints, and the transmission from them to the remaining coordinates.
pub(super) struct Remaining {
    /// Motors of the whole robot, from zero.
    pub(super) motors: Vec<usize>,
    pub(super) transmission: Transmission,
}

/// The transmission without the coordinates of `locked` joints and the motors that turn only with them.
pub(super) fn remaining(robot: &Robot, locked: &[Option<f64>]) -> Result<Remaining, LockError> {
    let joints = robot.coordinate_joints();
    let (matrix, n) = (robot.transmission.matrix(), joints.len());
    let is_locked = |coordinate: usize| locked[joints[coordinate]].is_some();
    let coordinates: Vec<usize> = (0..n).filter(|&c| !is_locked(c)).collect();
    let mut motors = Vec::with_capacity(coordinates.len());
    for motor in 0..n {
        let turns_with = |of_locked: bool| (0..n).find(|&c| matrix.at(motor, c) != 0.0 && is_locked(c) == of_locked);
        match (turns_with(true), turns_with(false)) {
            (Some(locked), Some(moving)) => {
                let name = |c: usize| robot.joints[joints[c]].name.clone();
                return Err(LockError::Coupled { motor: motor + 1, locked: name(locked), moving: name(moving) });
            }
            (None, Some(_)) => motors.push(motor),
            (_, None) => {}
        }
    }
    let pick = |of: &[f64], indices: &[usize]| indices.iter().map(|&i| of[i]).collect::<Vec<f64>>();
    let rest = Matrix::from_fn(motors.len(), coordinates.len(), |i, j| matrix.at(motors[i], coordinates[j]));
    let offset = pick(robot.transmission.offset(), &coordinates);
    let gains = pick(robot.transmission.drive_gain(), &motors);
    // A diagonal block of a block-diagonal matrix is as invertible as the whole.
    let direct = || Transmission::direct(coordinates.len());
    let transmission = Transmission::new(rest, offset, gains).unwrap_or_else(direct);
    Ok(Remaining { motors, transmission })
}
