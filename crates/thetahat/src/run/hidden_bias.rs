//! The bias of an estimate by errors that its residual hardly shows and no interval holds: torques that are late, and friction
//! that grows near rest.
//!
//! The torque that the estimate predicts is simulated with such an error, and estimated from: the change says how far the error
//! moves the estimate (C. Gouriéroux, A. Monfort, E. Renault, "Indirect inference", Journal of Applied Econometrics 8, 1993), and
//! is linear in the size of the error. The same simulated errors beside the parameters, as further columns, say which
//! sizes the record leaves possible.

use std::iter::once;

use super::{identification::Identification, prepared::filtered};
use crate::{
    diagnosis::Estimated,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    identification::{Divisor, EstimationError, Fit, Response, uncertainty},
    linear_algebra::Matrix,
    preparation::{FilteredRecording, Problem},
    results::{HiddenBias, HiddenError, ParameterResult, RunResult},
    series::Series,
    signal::SignalError,
};

/// Velocity at which friction that grows near rest has fallen to `1/e`, relative to the joint's largest one.
const STRIBECK_VELOCITY: f64 = 0.1;

/// An error, and the torque that one unit of it makes, in the rows of the regression.
struct Direction {
    error: HiddenError,
    joint: Option<usize>,
    torque: Vec<f64>,
}

impl Identification {
    /// The bias of a run by each error, the largest one that the record leaves possible; none for a run without estimates
    /// or without intervals, and none where torques take another channel or none are fitted.
    pub(super) fn hidden_biases(&self, problem: &Problem, run: &RunResult, estimated: &Estimated) -> Vec<HiddenBias> {
        let Some(fit) = &estimated.outcome.fit else { return Vec::new() };
        let is_linear = run.method.response() == Response::Torque && estimated.outcome.offset.is_none();
        if !is_linear || !self.setup().robot.channels().is_empty() {
            return Vec::new();
        }
        let Ok(directions) = self.directions(problem, fit) else { return Vec::new() };
        let divisor = self.setup().settings.estimation.variance;
        Bounded { estimated, run, divisor }.biases(directions).unwrap_or_default()
    }

    /// The errors that are considered.
    fn directions(&self, problem: &Problem, fit: &Fit) -> Result<Vec<Direction>, SignalError> {
        let recordings = filtered(&self.main);
        let theta = DynamicParameters::new(&problem.model, &problem.estimated.to_standard(&fit.theta));
        let peaks = peak_velocities(&recordings, problem.model.coordinate_count());
        let (mut late, mut stribeck) = (Vec::new(), Vec::new());
        for (number, recording) in recordings.iter().enumerate() {
            let assembly = problem.assembly(number);
            let tau = predicted(&problem.model, &theta, recording);
            late.push(assembly.measurement_vector(&of_one_second(&tau, recording))?);
            stribeck.push(assembly.measurement_vector(&near_rest(&recording.motion.dq, &peaks))?);
        }
        let layout = &problem.regression.layout;
        let (late, stribeck) = (layout.stack_vectors(late), layout.stack_vectors(stribeck));
        let of_joint = |joint: usize| {
            let mut torque = vec![0.0; stribeck.len()];
            layout.rows_of_joint(joint).for_each(|row| torque[row] = stribeck[row]);
            Direction { error: HiddenError::FrictionNearRest, joint: Some(joint), torque }
        };
        let of_joints = (0..layout.joints()).map(of_joint);
        let late = Direction { error: HiddenError::LateTorque, joint: None, torque: late };
        Ok(once(late).chain(of_joints).filter(|d| d.torque.iter().any(|t| *t != 0.0)).collect())
    }
}

/// A run whose residual bounds the errors.
struct Bounded<'a> {
    estimated: &'a Estimated,
    run: &'a RunResult,
    divisor: Divisor,
}

impl Bounded<'_> {
    fn biases(&self, mut directions: Vec<Direction>) -> Result<Vec<HiddenBias>, EstimationError> {
        let Estimated { method, regression, outcome } = self.estimated;
        let z = outcome.instruments.as_ref();
        let influence = method.influence(regression, z)?;
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
        let bias = |(direction, size): (&Direction, &[f64; 2])| {
            self.bias(direction, *size, &influence.transpose_times(&direction.torque))
        };
        Ok(directions.iter().zip(&sizes).filter_map(bias).collect())
    }

    /// 95 % intervals of the sizes of errors that are estimated beside the parameters.
    fn sizes(&self, directions: &[Direction]) -> Result<Vec<[f64; 2]>, EstimationError> {
        let Estimated { method, regression, outcome } = self.estimated;
        let torques = directions.iter().flat_map(|d| d.torque.iter().copied()).collect();
        let errors = Matrix::from_columns(regression.x.rows(), torques);
        let beside = |matrix: &Matrix| Matrix::beside(&[matrix, &errors]);
        let (regression, z) = (regression.with_matrix(beside(&regression.x)), outcome.instruments.as_ref().map(beside));
        let fit = method.estimate(&regression, z.as_ref(), self.divisor)?;
        let intervals = uncertainty(*method, &regression, z.as_ref(), &fit)?.interval_95;
        Ok(intervals[intervals.len() - directions.len()..].to_vec())
    }

    /// The parameter that moves by most of its standard deviations, with the end of the interval that moves it further.
    fn bias(&self, direction: &Direction, size: [f64; 2], per_unit: &[f64]) -> Option<HiddenBias> {
        let largest = if size[0].abs() > size[1].abs() { size[0] } else { size[1] };
        let of = |(p, per_unit): (&ParameterResult, &f64)| {
            let deviation = p.standard_deviation_robust.filter(|deviation| *deviation > 0.0)?;
            Some((p.name.clone(), per_unit * largest / deviation))
        };
        let all = self.run.parameters.iter().zip(per_unit).filter_map(of);
        let (parameter, deviations) = all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (error, joint) = (direction.error, direction.joint.map(|j| j + 1));
        Some(HiddenBias { error, joint, size_interval_95: size, parameter, deviations })
    }
}

/// The largest velocity of each joint.
fn peak_velocities(recordings: &[&FilteredRecording], joints: usize) -> Vec<f64> {
    let mut peaks = vec![0.0_f64; joints];
    for dq in recordings.iter().map(|r| &r.motion.dq) {
        for k in 0..dq.len() {
            peaks.iter_mut().zip(dq.sample(k)).for_each(|(peak, dq)| *peak = peak.max(dq.abs()));
        }
    }
    peaks
}

/// The torques that parameters predict for the motion of a recording.
fn predicted(model: &Model, theta: &DynamicParameters, recording: &FilteredRecording) -> Series {
    let motion = &recording.motion;
    let mut tau = Series::zeros(motion.q.len(), motion.q.channels());
    let mut workspace = Workspace::new(model);
    for k in 0..tau.len() {
        let state = State::new(motion.q.sample(k), motion.dq.sample(k));
        let ddq = motion.ddq.sample(k);
        model.inverse_dynamics(theta, state, ddq, Sign::Exact, &mut workspace, tau.sample_mut(k));
    }
    tau
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
