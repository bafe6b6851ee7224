//! The loop linearised in a state: with respect to the state, exactly, and to the sensitivity parameters.

use std::ops::Range;

use super::{
    columns::ColumnBlocks, linear_terms::LinearTerms, parameter_columns::ParameterColumns, sensitive_to::SensitiveTo,
    stages::StageMotion, torque_slopes::TorqueSlopes, transition_columns::TransitionColumns,
};
use crate::simulation::{closed_loop::Job, running::Running, system::Loop};
use thetahat_model::dynamics::Jacobian;

/// Upper bound of the number of stages of a step.
const MOST_STAGES: usize = 8;

/// The torques of the drives, or `M` times the accelerations, as linear functions of the sensitivities S of the state:
///
/// `d tau/dp = tau_p - K S_q - D S_dq`, and `M d ddq/dp = tau_p - phi_p - (K + d ID/dq) S_q - (D + d ID/d dq) S_dq`, with
/// `tau_p` the change of the torques in the same state, and K and D the stiffness and damping of a continuous controller.
pub(super) struct LoopSlopes {
    torques: TorqueSlopes,
    parameters: ParameterColumns,
    transition: Option<TransitionColumns>,
    /// One for each stage of a step.
    jacobians: Vec<Jacobian>,
    terms: LinearTerms,
    /// Scratch: the state of a stage.
    x: Vec<f64>,
}

impl LoopSlopes {
    /// `start` are the sensitivities of the initial state.
    pub(super) fn new(
        job: &Job<'_>,
        running: &mut Running<'_>,
        to: &[SensitiveTo],
        inertia_slopes: Option<&[Vec<f64>]>,
        start: &ColumnBlocks,
    ) -> Self {
        let setup = &job.closed_loop;
        let n = setup.model.coordinate_count();
        Self {
            torques: TorqueSlopes::new(job, running, to, inertia_slopes, start),
            parameters: ParameterColumns::new(setup, to),
            transition: TransitionColumns::new(setup, to),
            jacobians: vec![Jacobian::zeros(n); MOST_STAGES],
            terms: LinearTerms::zeros(n, to.len()),
            x: vec![0.0; 2 * n],
        }
    }

    /// Follows a sampled controller into the interval just begun, where the state has the sensitivities `state`.
    pub(super) fn follow_interval(&mut self, running: &mut Running<'_>, state: &ColumnBlocks) {
        self.torques.follow_interval(running, state);
    }

    /// The fall of the joint torques at the start of the interval, where the drive signals change; none for a continuous controller.
    pub(super) fn torque_drop(&self) -> Option<&[f64]> {
        self.torques.torque_drop()
    }

    /// The torques' derivatives at time `t` and state `x` with the sensitivities `state`.
    pub(super) fn torques(
        &mut self,
        system: &mut Loop<'_>,
        t: f64,
        x: &[f64],
        state: &ColumnBlocks,
        out: &mut ColumnBlocks,
    ) {
        self.torques.linearise(system, t, x, &mut self.terms);
        self.terms.evaluate(state, out);
    }

    /// Computes the robot's part of [`Self::accelerations`] in these stages.
    pub(super) fn evaluate_stages(&mut self, system: &Loop<'_>, motion: &StageMotion, stages: Range<usize>) {
        let (plant, series) = (&system.plant, motion.series());
        self.parameters.evaluate(plant, series, motion.channels());
        if let Some(transition) = &mut self.transition {
            transition.evaluate(plant, motion, stages.clone());
        }
        plant.model.inverse_dynamics_jacobians(
            &plant.parameters,
            series,
            motion.channels(),
            stages,
            plant.sign,
            &mut self.jacobians,
        );
    }

    /// The terms of `M d ddq/dp` in a stage at time `t`.
    pub(super) fn accelerations(
        &mut self,
        system: &mut Loop<'_>,
        t: f64,
        motion: &StageMotion,
        stage: usize,
    ) -> &LinearTerms {
        let Self { torques, parameters, transition, jacobians, terms, x } = self;
        motion.write_state(stage, x);
        torques.linearise(system, t, x, terms);
        let Jacobian { by_position, by_velocity } = &jacobians[stage];
        terms.by_position.iter_mut().zip(by_position).for_each(|(a, j)| *a += j);
        terms.by_velocity.iter_mut().zip(by_velocity).for_each(|(b, j)| *b += j);
        parameters.subtract(stage, &mut terms.explicit);
        if let Some(transition) = transition {
            transition.subtract(stage, &mut terms.explicit);
        }
        terms
    }
}
