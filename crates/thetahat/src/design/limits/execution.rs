//! What a controller makes of a motion: torques and velocities of the simulated loop, against their limits.

use crate::design::{
    error::DesignError,
    limits::{
        joint_limits::JointLimits,
        verification::{RATE_HZ, uses},
    },
    text::description::Design,
};
use crate::{preparation::Setup, scheduling::closed_loop};
use thetahat_estimation::{
    control::ControllerDescription,
    simulation::{OutputGrid, Reference, SampledReference, SimulatedMotion, SimulationError, SimulatorBias},
};
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Model;
use thetahat_report::results::{ExecutedMotion, Limited};

/// What the loop may exceed although the motion does not.
const OF_THE_LOOP: [Limited; 3] = [Limited::Velocity, Limited::Torque, Limited::Power];

/// Bandwidth of the controller of a rehearsal whose design describes none, Hz.
const USUAL_HZ: f64 = 10.0;

impl Design {
    /// The limits in the loop of a motion's positions `q` at `sample_rate_hz`, of the robot with its payload and with assumed drives where it has
    /// none.
    pub(in crate::design) fn executed(
        &self,
        model: &Model,
        limits: &[JointLimits],
        q: &Series,
    ) -> Result<ExecutedMotion, DesignError> {
        let controller = self.settings.controller.clone().unwrap_or_else(|| ControllerDescription::pd(USUAL_HZ));
        let is_stated = self.settings.controller.is_some();
        let robot = self.robot_of_loop(model)?;
        Ok(match self.followed(model, &controller, q, &robot, RATE_HZ) {
            Ok(SimulatedMotion { q, dq, ddq, tau, .. }) => {
                let jerk = Series::zeros(q.len(), q.channels());
                let mut uses = uses(limits, &[q, dq, ddq, jerk], &[tau]);
                uses.retain(|limit| OF_THE_LOOP.contains(&limit.quantity));
                ExecutedMotion { is_stated, uses, failure: None }
            }
            Err(error) => ExecutedMotion { is_stated, uses: Vec::new(), failure: Some(error.to_string()) },
        })
    }

    /// The motion of a robot in the closed loop, at `rate_hz`. The controller is made for the robot without payload.
    pub(in crate::design) fn followed(
        &self,
        model: &Model,
        controller: &ControllerDescription,
        q: &Series,
        theta: &[f64],
        rate_hz: f64,
    ) -> Result<SimulatedMotion, SimulationError> {
        let reference = Reference::Sampled(SampledReference::new(q.clone(), self.file.sample_rate_hz));
        let setup = Setup { robot: &self.robot, settings: &self.settings };
        let closed_loop = closed_loop(setup, model, controller, &reference, None, SimulatorBias::NONE);
        let inertia = closed_loop.motor_inertia(&self.robot.a_priori_parameters(), self.file.duration_s);
        let samples = (self.file.duration_s * rate_hz).round() as usize + 1;
        closed_loop.simulate(theta, &inertia, &OutputGrid { start_s: 0.0, sample_rate_hz: rate_hz, samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::text::experiment_text::USUAL_CONTROLLER;

    /// The controller of the rehearsal is the one of the verified loop.
    #[test]
    fn the_usual_controller_is_that_of_the_rehearsal() {
        let table: toml::Table = USUAL_CONTROLLER.parse().unwrap();
        let read: ControllerDescription = table["controller"].clone().try_into().unwrap();
        assert_eq!(read, ControllerDescription::pd(USUAL_HZ));
    }
}
