//! A controller that acts in steps takes viscous friction away: where its steps are not described, intervals allow for them.

use super::identification::Identification;
use thetahat_estimation::control::{ControllerDescription, Law};
use thetahat_model::robot::{JointQuantity, Quantity};
use thetahat_report::results::RunResult;

/// Steps of a controller that is described as continuous. A choice, which the run's notes state: those of drives are 1 ms or shorter.
const STEP_S: f64 = 1e-3;

/// Widens the intervals of viscous friction by `kp T / 2`: a torque that is held for steps of T acts half of one late, and
/// `-kp q(t - T / 2)` is `-kp q + (kp T / 2) dq`.
pub(super) fn allow_for_steps(identification: &Identification, run: &mut RunResult) {
    let Some(stiffness) = continuous_stiffness(identification).filter(|_| run.is_of_positions()) else { return };
    run.notes.push(format!(
        "the intervals of viscous friction allow for a controller that acts in steps of {:.0} ms; sample_time_s in [controller] states its steps",
        1e3 * STEP_S
    ));
    let table = identification.setup().robot.parameter_table();
    let coordinates = identification.setup().robot.coordinate_joints();
    for p in table.iter().filter(|p| p.quantity == Quantity::Joint(JointQuantity::Fv)) {
        let Some(c) = coordinates.iter().position(|joint| joint + 1 == p.number) else { continue };
        let name = p.name();
        for found in run.parameters.iter_mut().filter(|found| found.name == name) {
            found.widen_interval(0.5 * STEP_S * stiffness[c]);
        }
    }
}

/// The stiffness that a continuous PD controller gives each coordinate, N m/rad or N/m; none of another one.
fn continuous_stiffness(identification: &Identification) -> Option<Vec<f64>> {
    let described =
        |c: &&ControllerDescription| c.law == Law::Pd && c.sample_time_s == 0.0 && !c.position_gain.is_empty();
    let controller = identification.controller().filter(described)?;
    let transmission = &identification.setup().robot.transmission;
    let (coupling, drive) = (transmission.motor_in_joint_units(), transmission.drive_to_joint_units());
    let gain = |motor: usize| controller.position_gain.get(motor).unwrap_or(&controller.position_gain[0]);
    let of_joint = |j: usize| (0..drive.len()).map(|i| coupling.at(i, j).powi(2) * (drive[i] * gain(i)).abs()).sum();
    Some((0..drive.len()).map(of_joint).collect())
}
