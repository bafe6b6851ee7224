//! The bias of an estimate by errors that its residual hardly shows and no interval holds: torques that are late, and friction
//! that grows near rest.
//!
//! The torque that the estimate predicts is simulated with such an error, and estimated from: the change says how far the error
//! moves the estimate (C. Gouriéroux, A. Monfort, E. Renault, "Indirect inference", Journal of Applied Econometrics 8, 1993), and
//! is linear in the size of the error. The same simulated errors as columns in addition to the parameters say which
//! sizes the recording leaves possible.

use std::iter::once;

use super::{identification::Identification, prepared::filtered};
use crate::{
    diagnosis::MethodEstimate,
    preparation::{FilteredRecording, Problem, torques},
};
use thetahat_estimation::{
    identification::{Divisor, EstimationError, Fit, Response, uncertainty},
    signal::SignalError,
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_report::results::{HiddenBias, HiddenError, MovedParameter, ParameterResult, RunResult};

/// Velocity at which friction that grows near rest has fallen to `1/e`, relative to the joint's largest one.
const STRIBECK_VELOCITY: f64 = 0.1;

/// An error, and the torque that one unit of it makes, in the rows of the regression.
#[derive(Clone)]
struct Direction {
    error: HiddenError,
    joint: Option<usize>,
    torque: Vec<f64>,
}

impl Identification {
    /// Adds to each run its bias by each error, the largest one that the recording leaves possible; none to a run without estimates
    /// or without intervals, and none if torques take another channel or none are fitted.
    pub(super) fn add_hidden_biases(&self, problem: &Problem, runs: &mut [RunResult], estimated: &[MethodEstimate]) {
        if !self.setup().robot.channels().is_empty() {
            return;
        }
        let Ok(friction) = self.friction_near_rest(problem) else { return };
        for (run, estimated) in runs.iter_mut().zip(estimated) {
            run.hidden_bias = self.hidden_biases(problem, run, estimated, &friction);
        }
    }

    fn hidden_biases(
        &self,
        problem: &Problem,
        run: &RunResult,
        estimated: &MethodEstimate,
        friction: &[Direction],
    ) -> Vec<HiddenBias> {
        let Some(fit) = &estimated.outcome.fit else { return Vec::new() };
        if run.method.response() != Response::Torque || estimated.outcome.offset.is_some() {
            return Vec::new();
        }
        let Ok(late) = self.late_torque(problem, fit) else { return Vec::new() };
        let errors = once(&late).chain(friction).filter(|d| d.torque.iter().any(|t| *t != 0.0));
        let divisor = self.setup().settings.estimation.variance;
        Bounded { estimated, run, divisor }.biases(errors.cloned().collect()).unwrap_or_default()
    }

    /// Torques that are late by one second.
    fn late_torque(&self, problem: &Problem, fit: &Fit) -> Result<Direction, SignalError> {
        let theta = problem.estimated.to_standard(&fit.theta);
        let predicted = |recording: &FilteredRecording| {
            let tau = torques(&problem.model, &theta, &recording.motion, None);
            of_one_second(&tau, recording)
        };
        let torque = self.rows_of(problem, predicted)?;
        Ok(Direction { error: HiddenError::LateTorque, joint: None, torque })
    }

    /// Friction of each joint that grows near rest.
    fn friction_near_rest(&self, problem: &Problem) -> Result<Vec<Direction>, SignalError> {
        let peaks = peak_velocities(&filtered(&self.main), problem.model.coordinate_count());
        let rows = self.rows_of(problem, |recording| near_rest(&recording.motion.dq, &peaks))?;
        let layout = &problem.regression.layout;
        let of_joint = |joint: usize| {
            let mut torque = vec![0.0; rows.len()];
            layout.rows_of_joint(joint).for_each(|row| torque[row] = rows[row]);
            Direction { error: HiddenError::FrictionNearRest, joint: Some(joint), torque }
        };
        Ok((0..layout.joints()).map(of_joint).collect())
    }

    /// The rows of the regression of torques over the samples of each recording.
    fn rows_of(
        &self,
        problem: &Problem,
        torque: impl Fn(&FilteredRecording) -> Series,
    ) -> Result<Vec<f64>, SignalError> {
        let recordings = filtered(&self.main).into_iter().enumerate();
        let of_each = recordings.map(|(k, recording)| problem.assembly(k).measurement_vector(&torque(recording)));
        Ok(problem.regression.layout.stack_vectors(of_each.collect::<Result<_, _>>()?))
    }
}

/// A run whose residual bounds the errors.
struct Bounded<'a> {
    estimated: &'a MethodEstimate,
    run: &'a RunResult,
    divisor: Divisor,
}

impl Bounded<'_> {
    fn biases(&self, mut directions: Vec<Direction>) -> Result<Vec<HiddenBias>, EstimationError> {
        let MethodEstimate { method, regression, outcome } = self.estimated;
        let sizes = loop {
            match self.sizes(&directions) {
                // What the parameters can imitate in full leaves no residual that would bound it.
                Err(EstimationError::NotIdentifiable { dependent, .. }) => {
                    let before = directions.len();
                    let mut column = regression.parameters()..;
                    directions.retain(|_| column.next().is_some_and(|c| !dependent.contains(&c)));
                    if directions.len() == before {
                        return Ok(Vec::new());
                    }
                }
                sizes => break sizes?,
            }
        };
        let influence = method.influence(regression, outcome.instruments.as_ref())?;
        let bias = |(direction, size): (&Direction, &[f64; 2])| {
            self.bias(direction, *size, &influence.transpose_times(&direction.torque))
        };
        Ok(directions.iter().zip(&sizes).filter_map(bias).collect())
    }

    /// 95 % intervals of the sizes of errors that are estimated together with the parameters.
    fn sizes(&self, directions: &[Direction]) -> Result<Vec<[f64; 2]>, EstimationError> {
        let MethodEstimate { method, regression, outcome } = self.estimated;
        let torques = directions.iter().flat_map(|d| d.torque.iter().copied()).collect();
        let errors = Matrix::from_columns(regression.x.rows(), torques);
        let with_errors = |matrix: &Matrix| Matrix::side_by_side(&[matrix, &errors]);
        let (regression, z) =
            (regression.with_matrix(with_errors(&regression.x)), outcome.instruments.as_ref().map(with_errors));
        let fit = method.estimate(&regression, z.as_ref(), self.divisor)?;
        let intervals = uncertainty(*method, &regression, z.as_ref(), &fit)?.interval_95;
        Ok(intervals[intervals.len() - directions.len()..].to_vec())
    }

    /// What the end of the interval that is farther from zero moves, the furthest first.
    fn bias(&self, direction: &Direction, size: [f64; 2], per_unit: &[f64]) -> Option<HiddenBias> {
        let largest = if size[0].abs() > size[1].abs() { size[0] } else { size[1] };
        let of = |(p, per_unit): (&ParameterResult, &f64)| {
            let deviation = p.standard_deviation_robust.filter(|deviation| *deviation > 0.0)?;
            let moved = MovedParameter { parameter: p.name.clone(), deviations: per_unit * largest / deviation };
            let beyond = p.farther_end().is_some_and(|half| (per_unit * largest).abs() > half);
            Some((moved, beyond))
        };
        let mut moved: Vec<_> = self.run.parameters.iter().zip(per_unit).filter_map(of).collect();
        moved.sort_by(|(a, _), (b, _)| b.deviations.abs().total_cmp(&a.deviations.abs()));
        let mut moved = moved.into_iter();
        let (MovedParameter { parameter, deviations }, _) = moved.next()?;
        Some(HiddenBias {
            error: direction.error,
            joint: direction.joint.map(|j| j + 1),
            size_interval_95: size,
            parameter,
            deviations,
            others: moved.filter_map(|(moved, beyond)| beyond.then_some(moved)).collect(),
        })
    }
}

/// The largest velocity of each joint.
pub(super) fn peak_velocities(recordings: &[&FilteredRecording], joints: usize) -> Vec<f64> {
    let mut peaks = vec![0.0_f64; joints];
    for dq in recordings.iter().map(|r| &r.motion.dq) {
        for k in 0..dq.len() {
            peaks.iter_mut().zip(dq.sample(k)).for_each(|(peak, dq)| *peak = peak.max(dq.abs()));
        }
    }
    peaks
}

/// What torques that are late by one second have more than they should, to first order: a central difference.
fn of_one_second(tau: &Series, recording: &FilteredRecording) -> Series {
    let half_rate = 0.5 * recording.recording.sample_rate_hz;
    let mut late = Series::zeros(tau.len(), tau.channels());
    for k in 1..tau.len().saturating_sub(1) {
        let (before, after) = (tau.sample(k - 1), tau.sample(k + 1));
        let difference = before.iter().zip(after).map(|(before, after)| half_rate * (before - after));
        late.sample_mut(k).iter_mut().zip(difference).for_each(|(late, difference)| *late = difference);
    }
    late
}

/// Friction of one N m or N at rest that falls with the velocity: `sign(dq) exp(-(dq / v)^2)` (B. Armstrong-Hélouvry, "Control of
/// machines with friction", 1991).
fn near_rest(dq: &Series, peaks: &[f64]) -> Series {
    let mut friction = Series::zeros(dq.len(), dq.channels());
    for k in 0..dq.len() {
        for ((friction, dq), peak) in friction.sample_mut(k).iter_mut().zip(dq.sample(k)).zip(peaks) {
            let relative = dq / (STRIBECK_VELOCITY * peak).max(f64::MIN_POSITIVE);
            *friction = if *dq == 0.0 { 0.0 } else { dq.signum() * (-relative * relative).exp() };
        }
    }
    friction
}
