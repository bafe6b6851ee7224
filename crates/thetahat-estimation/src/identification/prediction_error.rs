//! CLIE and CLOE: the minimum of (11) by Gauss-Newton steps (13) with Levenberg's damping.

use super::{
    fit::{Fit, SimulatedResponse},
    iteration::IterationOptions,
    linearised::{Linearised, StepProjection, in_deviations, offset},
    outcome::{Iteration, Outcome, Reason, Status},
};
use crate::{regression::Regression, simulation::SimulationError};
use thetahat_ground::linear_algebra::norm;

/// First damping that is not zero, relative to the squared norms of the columns of J.
const FIRST_DAMPING: f64 = 1e-3;
/// Factor of the damping after a step that does not reduce the error, and its inverse after one that does.
const DAMPING_FACTOR: f64 = 10.0;
/// Damping below which steps are undamped.
const NO_DAMPING: f64 = 1e-5;
/// Damping beyond which the steps are too short to help.
const MOST_DAMPING: f64 = 1e8;
/// Size of the undamped step, in standard deviations, below which it is limited by the errors of the simulation: simulations then get finer
/// tolerances, a few times. They do as well where no step reduces the error.
const NEAR: f64 = 3.0;
/// Ratio to the previous undamped step below which the step counts as shrinking.
const PROGRESS: f64 = 0.5;
const FINER: f64 = 0.1;
const REFINEMENTS: i32 = 2;
/// An estimation with near start values simulates with coarser tolerances by one factor...
const COARSE: i32 = -1;
/// ... until the undamped step is this small, in standard deviations: the errors of coarse simulations are then of its size.
const FAR: f64 = 10.0;
/// Relative increase of the error that a finer simulation of the same parameters may cause.
const BY_TOLERANCE: f64 = 1e-3;
/// The undamped step, in standard deviations, up to which a point counts as the minimum if no step reduces the error.
const AT_MINIMUM: f64 = 1.0;
/// Relative increase of the error that does not refuse a step that is linearised already: its undamped step shows whether it is near.
const LINEARISED: f64 = 1e-4;
/// Relative increase of the error that counts as rounding.
const ROUNDING: f64 = 1e-13;

/// A simulation that an estimation requests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulationRequest<'a> {
    /// The response with these parameters.
    Response(&'a [f64]),
    /// The response and its sensitivities.
    Sensitivities(&'a [f64]),
}

/// An estimation by CLIE or CLOE in progress. It requests its simulations, so that those of several can run together.
///
/// A step is accepted if it reduces the weighted error `|y - response|`; otherwise it is damped and repeated. A failed simulation counts as
/// an infinite error. The iteration has converged where the undamped step is small against the
/// standard deviations.
#[derive(Debug, Clone)]
pub struct PredictionErrorEstimation {
    options: IterationOptions,
    stage: Stage,
    /// Start values that have not been tried.
    starts: Vec<Vec<f64>>,
    /// The parameters with the smallest error so far, and that error.
    best: Option<(Vec<f64>, f64)>,
    point: Option<Linearised>,
    damping: f64,
    linearised: usize,
    /// The undamped steps in standard deviations at each linearisation, and how often tolerances were made finer.
    whole_steps: Vec<f64>,
    refinements: i32,
    starts_near: bool,
    is_held_up: bool,
    outcome: Outcome,
}

#[derive(Debug, Clone, PartialEq)]
enum Stage {
    /// A start value is tried.
    Start(Vec<f64>),
    /// The best parameters are linearised.
    Linearise(Vec<f64>),
    /// The parameters after a step are tried.
    Step(Vec<f64>),
    /// The parameters after an undamped step that hardly fails are tried, and linearised at the same time.
    Leap(Vec<f64>),
    Over,
}

impl PredictionErrorEstimation {
    /// An estimation from the best of some start values.
    #[must_use]
    pub fn new(options: IterationOptions, mut starts: Vec<Vec<f64>>) -> Self {
        starts.reverse();
        let iterations = options.convergence.iterations;
        let reason = Reason::IterationLimit { iterations, relative_error_percent: f64::NAN, parameter_change: None };
        let outcome = Outcome { reason: Some(reason), ..Outcome::nothing() };
        let stage = starts.pop().filter(|_| iterations > 0).map_or(Stage::Over, Stage::Start);
        Self {
            options,
            stage,
            starts,
            best: None,
            point: None,
            damping: 0.0,
            linearised: 0,
            whole_steps: Vec::new(),
            refinements: 0,
            starts_near: false,
            is_held_up: false,
            outcome,
        }
    }

    /// The same for start values near the minimum: simulations are coarse at first, and undamped steps are linearised at once.
    #[must_use]
    pub fn with_near_starts(self) -> Self {
        Self { refinements: COARSE, starts_near: true, ..self }
    }

    /// What to simulate next; none at the end.
    #[must_use]
    pub fn wanted(&self) -> Option<SimulationRequest<'_>> {
        match &self.stage {
            Stage::Start(theta) | Stage::Step(theta) => Some(SimulationRequest::Response(theta)),
            Stage::Linearise(theta) | Stage::Leap(theta) => Some(SimulationRequest::Sensitivities(theta)),
            Stage::Over => None,
        }
    }

    /// Factor of the tolerances of the simulations.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        FINER.powi(self.refinements)
    }

    /// Whether simulations prevent it from reaching the minimum, which is near: one of a step fails, or even the finest ones have errors
    /// that keep the steps from shrinking.
    #[must_use]
    pub fn is_held_up(&self) -> bool {
        self.is_held_up
    }

    /// Restarts from the result of the undamped step, whatever its error.
    pub fn start_anew(&mut self, project: &mut StepProjection<'_>) {
        let Some(point) = &self.point else { return };
        self.stage = Stage::Start(project(point.step(0.0)));
        self.whole_steps.clear();
        (self.best, self.damping, self.is_held_up) = (None, 0.0, false);
    }

    /// The iterations done.
    #[must_use]
    pub fn iterations(&self) -> &[Iteration] {
        &self.outcome.iterations
    }

    /// The outcome, final or so far.
    #[must_use]
    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }

    /// Receives the requested response. `project` projects a step onto parameters that can be simulated.
    pub fn take_response(
        &mut self,
        response: Result<Vec<f64>, SimulationError>,
        regression: &Regression,
        project: &mut StepProjection<'_>,
    ) {
        self.outcome.simulations += 1;
        let found = response.map(|response| error(regression, &response)).and_then(|error| {
            if error.is_finite() { Ok(error) } else { Err(SimulationError::StepTooSmall { time_s: 0.0 }) }
        });
        match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Start(theta) => self.start(theta, found),
            Stage::Step(theta) => self.judge(theta, found, project),
            Stage::Linearise(_) | Stage::Leap(_) | Stage::Over => {}
        }
    }

    /// Receives the requested response and sensitivities. `project` projects a step onto parameters that can be simulated.
    pub fn take_sensitivities(
        &mut self,
        simulated: Result<SimulatedResponse, SimulationError>,
        regression: &Regression,
        project: &mut StepProjection<'_>,
    ) {
        self.outcome.simulations += 1;
        match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Linearise(theta) => match simulated {
                Ok(simulated) => self.linearise(theta, simulated, regression, project),
                Err(cause) => self.stall(cause),
            },
            Stage::Leap(theta) => match simulated {
                Ok(simulated) => {
                    let found = error(regression, &simulated.response);
                    let best = self.best.as_ref().map_or(f64::INFINITY, |(_, error)| *error);
                    if found <= best * (1.0 + LINEARISED) {
                        self.linearise(theta, simulated, regression, project);
                    } else {
                        self.judge(theta, Ok(found), project);
                    }
                }
                Err(cause) => self.judge(theta, Err(cause), project),
            },
            Stage::Start(_) | Stage::Step(_) | Stage::Over => {}
        }
    }

    /// Keeps the best start value; without one the estimation has diverged.
    fn start(&mut self, theta: Vec<f64>, found: Result<f64, SimulationError>) {
        let failure = found.as_ref().err().cloned();
        if let Ok(error) = found
            && self.best.as_ref().is_none_or(|(_, best)| error < *best)
        {
            self.best = Some((theta, error));
        }
        self.stage = match (self.starts.pop(), &self.best, failure) {
            (Some(next), _, _) => Stage::Start(next),
            (None, Some((best, _)), _) => Stage::Linearise(best.clone()),
            (None, None, Some(cause)) if self.point.is_some() => return self.stall(cause),
            (None, None, Some(cause)) => return self.end(Status::Diverged, Some(Reason::Simulation(cause))),
            (None, None, None) => Stage::Over,
        };
    }

    fn linearise(
        &mut self,
        theta: Vec<f64>,
        simulated: SimulatedResponse,
        regression: &Regression,
        project: &mut StepProjection<'_>,
    ) {
        let fit = Fit::of_response(regression, &simulated, &theta, self.options.divisor);
        if let Ok(fit) = &fit {
            self.note(fit, regression);
        }
        let point = Linearised::new(theta, simulated, fit, regression);
        let before = self.whole_step();
        self.whole_steps.push(point.whole_step_in_deviations(project).unwrap_or(f64::INFINITY));
        let now = self.whole_step();
        let is_stuck = now < NEAR && now > PROGRESS * before;
        let is_small = now <= self.options.convergence.parameter_change;
        self.best = Some((point.theta.clone(), error(regression, &point.simulated.response)));
        self.point = Some(point);
        self.linearised += 1;
        if self.is_coarse() && now <= FAR {
            self.leave_coarse(is_small, project);
        } else if is_small || self.is_settled() {
            self.end(Status::Converged, None);
        } else if self.linearised >= self.options.convergence.iterations {
            self.end_at_limit();
        } else if is_stuck && self.refinements < REFINEMENTS {
            self.refine();
        } else {
            self.is_held_up = is_stuck;
            self.step(project);
        }
    }

    fn is_coarse(&self) -> bool {
        self.refinements < 0
    }

    /// Goes on with simulations as fine as those of an estimation that is never coarse.
    fn leave_coarse(&mut self, is_minimum: bool, project: &mut StepProjection<'_>) {
        if is_minimum {
            return self.refine();
        }
        self.refinements = 0;
        // What follows is not compared with the steps of coarse simulations.
        self.whole_steps.clear();
        if let Some((_, error)) = &mut self.best {
            *error *= 1.0 + BY_TOLERANCE;
        }
        self.step(project);
    }

    /// The last undamped step in standard deviations; infinite if there is none.
    fn whole_step(&self) -> f64 {
        self.whole_steps.last().copied().unwrap_or(f64::INFINITY)
    }

    /// Whether undamped steps are as small as the errors of the finest simulations allow.
    fn is_settled(&self) -> bool {
        let steps = self.whole_steps.iter().rev().copied();
        self.refinements == REFINEMENTS && self.options.convergence.are_settled(steps)
    }

    /// Tries the step with the current damping.
    fn step(&mut self, project: &mut StepProjection<'_>) {
        let Some(point) = &self.point else { return };
        let next = project(point.step(self.damping));
        let leaps = self.starts_near && self.damping == 0.0 && !self.is_coarse();
        self.stage = if leaps { Stage::Leap(next) } else { Stage::Step(next) };
    }

    /// Accepts a step that reduces the error; damps any other.
    fn judge(&mut self, theta: Vec<f64>, found: Result<f64, SimulationError>, project: &mut StepProjection<'_>) {
        let best = self.best.as_ref().map_or(f64::INFINITY, |(_, error)| *error);
        self.is_held_up = found.is_err() && self.whole_step() < NEAR;
        match found {
            Ok(error) if error <= best * (1.0 + ROUNDING) => {
                self.damping /= DAMPING_FACTOR;
                if self.damping < NO_DAMPING {
                    self.damping = 0.0;
                }
                self.stage = Stage::Linearise(theta.clone());
                self.best = Some((theta, error));
            }
            _ if self.damping < MOST_DAMPING => {
                self.damping = (self.damping * DAMPING_FACTOR).max(FIRST_DAMPING);
                self.step(project);
            }
            Ok(_) | Err(_) if self.is_coarse() => self.refine(),
            Ok(_) if self.refinements < REFINEMENTS => self.refine(),
            Ok(_) => self.end_at_limit(),
            Err(cause) => self.stall(cause),
        }
    }

    /// Linearises again at the best parameters, with finer simulations.
    fn refine(&mut self) {
        let Some((best, _)) = &self.best else { return };
        self.stage = Stage::Linearise(best.clone());
        (self.refinements, self.damping) = (self.refinements + 1, 0.0);
    }

    /// Records an iteration.
    fn note(&mut self, fit: &Fit, regression: &Regression) {
        // Linearising the same parameters again, with finer simulations, is not a change of the estimate.
        let before = self.point.as_ref().and_then(|p| p.fit.as_ref().ok()).filter(|before| before.theta != fit.theta);
        let size = |fit: &Fit| norm(&regression.whiten(&regression.residual(&fit.prediction)));
        let error_change = before.map(|b| (size(b) - size(fit)).abs() / size(b).max(f64::MIN_POSITIVE));
        let parameter_change = before.map(|b| in_deviations(fit, fit.theta.iter().zip(&b.theta).map(|(n, b)| n - b)));
        let relative_error_percent = fit.relative_error_percent;
        let theta = fit.theta.clone();
        self.outcome.iterations.push(Iteration { theta, relative_error_percent, parameter_change, error_change });
    }

    fn has_stopped(&self) -> bool {
        let limits = self.options.convergence;
        let small = |change: Option<f64>, limit: f64| change.is_some_and(|c| c <= limit);
        self.outcome.iterations.last().is_some_and(|last| {
            small(last.parameter_change, limits.parameter_change) && small(last.error_change, limits.error_change)
        })
    }

    fn reached(&self) -> (f64, Option<f64>) {
        let last = self.outcome.iterations.last();
        (last.map_or(f64::NAN, |i| i.relative_error_percent), last.and_then(|i| i.parameter_change))
    }

    /// Ends if no step reduces the error or no iterations are left. Near the minimum, with changes below their limits, this is as accurate
    /// as the simulations.
    fn end_at_limit(&mut self) {
        if self.whole_step() <= AT_MINIMUM && self.has_stopped() {
            return self.end(Status::Converged, None);
        }
        let (relative_error_percent, parameter_change) = self.reached();
        let iterations = self.outcome.iterations.len();
        let reason = Reason::IterationLimit { iterations, relative_error_percent, parameter_change };
        self.end(Status::Stalled, Some(reason));
    }

    fn stall(&mut self, cause: SimulationError) {
        let (relative_error_percent, parameter_change) = self.reached();
        let reason = Reason::Stalled { cause, relative_error_percent, parameter_change };
        self.end(Status::Stalled, Some(reason));
    }

    /// Ends with the estimate of the last linearisation.
    fn end(&mut self, status: Status, reason: Option<Reason>) {
        (self.outcome.status, self.outcome.reason, self.stage) = (status, reason, Stage::Over);
        let Some(point) = self.point.take() else { return };
        match point.fit {
            Ok(fit) => {
                let offset = offset(&point.simulated, &fit.theta);
                (self.outcome.fit, self.outcome.offset) = (Some(fit), Some(offset));
                self.outcome.instruments = Some(point.simulated.sensitivities);
            }
            Err(e) => {
                (self.outcome.status, self.outcome.reason) = (Status::NotIdentifiable, Some(Reason::Estimation(e)))
            }
        }
    }
}

fn error(regression: &Regression, response: &[f64]) -> f64 {
    norm(&regression.whiten(&regression.residual(response)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::{Divisor, Method, linearised::GaussNewtonStep};
    use thetahat_ground::linear_algebra::Matrix;

    /// `exp(-a t) + b t^2`: not linear in a.
    fn simulate(theta: &[f64]) -> SimulatedResponse {
        let t = |k: usize| 0.05 * k as f64;
        let response = (0..60).map(|k| (-theta[0] * t(k)).exp() + theta[1] * t(k).powi(2)).collect();
        let derivative = |k: usize, j: usize| if j == 0 { -t(k) * (-theta[0] * t(k)).exp() } else { t(k).powi(2) };
        SimulatedResponse { response, sensitivities: Matrix::from_fn(60, 2, derivative) }
    }

    fn record() -> Regression {
        let SimulatedResponse { mut response, sensitivities } = simulate(&[1.5, 0.2]);
        response.iter_mut().enumerate().for_each(|(k, y)| *y += 1e-3 * (7.7 * k as f64).sin());
        Regression::single_series(sensitivities, response)
    }

    fn estimate(start: Vec<Vec<f64>>, limit: f64) -> Outcome {
        let regression = record();
        let mut options = IterationOptions::default();
        options.convergence.parameter_change = 1e-6;
        let mut estimation = PredictionErrorEstimation::new(options, start);
        let simulated = |theta: &[f64]| {
            if theta[0] > limit { Err(SimulationError::StepTooSmall { time_s: 1.0 }) } else { Ok(simulate(theta)) }
        };
        while let Some(wanted) = estimation.wanted() {
            match wanted {
                SimulationRequest::Response(theta) => {
                    let response = simulated(theta).map(|s| s.response);
                    estimation.take_response(response, &regression, &mut |step| step.theta);
                }
                SimulationRequest::Sensitivities(theta) => {
                    let found = simulated(theta);
                    estimation.take_sensitivities(found, &regression, &mut |step| step.theta);
                }
            }
        }
        estimation.into_outcome()
    }

    #[test]
    fn the_minimum_is_found_from_far_away() {
        let outcome = estimate(vec![vec![0.3, 2.0]], f64::INFINITY);
        assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.reason);
        let fit = outcome.fit.unwrap();
        // At the minimum the residual is orthogonal to the sensitivities.
        let regression = record();
        let gradient = simulate(&fit.theta).sensitivities.transpose_times(&regression.residual(&fit.prediction));
        let variance = norm(&regression.residual(&fit.prediction)).powi(2) / 58.0;
        let in_deviations = gradient.iter().zip(&fit.standard_deviation).map(|(g, sd)| g.abs() * sd / variance);
        assert!(in_deviations.fold(0.0, f64::max) < 1e-5, "{gradient:?}");
        assert!((fit.theta[0] - 1.5).abs() < 4.0 * fit.standard_deviation[0]);
        assert_eq!(fit.prediction, simulate(&fit.theta).response);
        let errors: Vec<f64> = outcome.iterations.iter().map(|i| i.relative_error_percent).collect();
        assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "{errors:?}");
    }

    /// Simulations whose errors keep the steps from shrinking: the last estimate is kept and has not converged.
    #[test]
    fn a_fit_that_goes_nowhere_has_stalled() {
        let regression = record();
        let start = vec![1.0, 0.0];
        let mut estimation = PredictionErrorEstimation::new(IterationOptions::default(), vec![start.clone()]);
        while let Some(wanted) = estimation.wanted() {
            match wanted {
                // The error grows with every step.
                SimulationRequest::Response(theta) => {
                    let worse = if theta == start { 0.0 } else { 10.0 };
                    let response = simulate(theta).response.iter().map(|r| r + worse).collect();
                    estimation.take_response(Ok(response), &regression, &mut |step| step.theta);
                }
                SimulationRequest::Sensitivities(theta) => {
                    let found = simulate(theta);
                    estimation.take_sensitivities(Ok(found), &regression, &mut |step| step.theta);
                }
            }
        }
        let outcome = estimation.into_outcome();
        assert_eq!((outcome.status, outcome.fit.unwrap().theta), (Status::Stalled, start));
    }

    /// Coarse simulations err by the size of the noise; the last ones are fine.
    #[test]
    fn an_estimation_with_near_starts_ends_with_fine_simulations() {
        let regression = record();
        let mut options = IterationOptions::default();
        options.convergence.parameter_change = 1e-6;
        let start = PredictionErrorEstimation::new(options, vec![vec![0.3, 2.0]]);
        let mut estimation = start.with_near_starts();
        let mut tolerances = Vec::new();
        while let Some(wanted) = estimation.wanted() {
            let tolerance = estimation.tolerance();
            tolerances.push(tolerance);
            let simulated = |theta: &[f64]| {
                let (mut found, error) = (simulate(theta), 1e-4 * (tolerance - 1.0).max(0.0));
                found.response.iter_mut().enumerate().for_each(|(k, r)| *r += error * (k as f64).sin());
                found
            };
            match wanted {
                SimulationRequest::Response(theta) => {
                    let response = Ok(simulated(theta).response);
                    estimation.take_response(response, &regression, &mut |step| step.theta);
                }
                SimulationRequest::Sensitivities(theta) => {
                    let found = Ok(simulated(theta));
                    estimation.take_sensitivities(found, &regression, &mut |step| step.theta);
                }
            }
        }
        let coarse = tolerances.iter().take_while(|t| (**t - 10.0).abs() < 1e-12).count();
        assert!(coarse >= 2 && tolerances[coarse..].iter().all(|t| *t <= 1.0), "{tolerances:?}");
        assert!(tolerances.len() > coarse + 2);
        let outcome = estimation.into_outcome();
        assert_eq!(outcome.status, Status::Converged);
        let (found, expected) = (outcome.fit.unwrap(), estimate(vec![vec![0.3, 2.0]], f64::INFINITY).fit.unwrap());
        for (i, theta) in found.theta.iter().enumerate() {
            let deviations = (theta - expected.theta[i]).abs() / expected.standard_deviation[i];
            assert!(deviations < 1e-3, "{deviations} deviations of parameter {i}");
        }
    }

    #[test]
    fn the_better_of_two_starts_is_taken() {
        let near = estimate(vec![vec![1.4, 0.2]], f64::INFINITY);
        let both = estimate(vec![vec![-3.0, 5.0], vec![1.4, 0.2]], f64::INFINITY);
        assert_eq!(both.fit, near.fit);
        assert_eq!(both.simulations, near.simulations + 1);
    }

    #[test]
    fn steps_to_a_failing_simulation_are_shortened_and_the_last_estimate_is_kept() {
        let outcome = estimate(vec![vec![1.0, 0.0]], 1.3);
        assert_eq!(outcome.status, Status::Stalled);
        let theta = outcome.fit.unwrap().theta;
        assert!(theta[0] > 1.2 && theta[0] <= 1.3, "{theta:?}");
        assert!(outcome.reason.unwrap().to_string().contains("kept is the last estimate"));
    }

    /// Simulations fail between the start and the minimum, which is near: the estimation restarts where they succeed.
    #[test]
    fn near_the_minimum_a_failing_simulation_asks_for_another_set() {
        let free = estimate(vec![vec![1.4, 0.2]], f64::INFINITY).fit.unwrap();
        let [limit, start] = [1.0, 2.0].map(|n| free.theta[0] - n * free.standard_deviation[0]);
        let simulated = |theta: &[f64]| {
            if theta[0] > limit { Err(SimulationError::StepTooSmall { time_s: 1.0 }) } else { Ok(simulate(theta)) }
        };
        let (regression, mut is_kept) = (record(), false);
        let options = IterationOptions::default();
        let mut estimation = PredictionErrorEstimation::new(options, vec![vec![start, free.theta[1]]]);
        let mut anew = Vec::new();
        while let Some(wanted) = estimation.wanted() {
            let mut project = |step: GaussNewtonStep| {
                let first = if is_kept { step.theta[0].min(limit) } else { step.theta[0] };
                vec![first, step.theta[1]]
            };
            match wanted {
                SimulationRequest::Response(theta) => {
                    let response = simulated(theta).map(|s| s.response);
                    estimation.take_response(response, &regression, &mut project);
                }
                SimulationRequest::Sensitivities(theta) => {
                    estimation.take_sensitivities(simulated(theta), &regression, &mut project);
                }
            }
            if estimation.is_held_up() && !is_kept {
                is_kept = true;
                anew.push(estimation.outcome.simulations);
                estimation.start_anew(&mut |step| vec![step.theta[0].min(limit), step.theta[1]]);
            }
        }
        assert_eq!(anew, [3], "the start, its linearisation and the first step");
        let outcome = estimation.into_outcome();
        assert_eq!((outcome.status, outcome.fit.unwrap().theta[0]), (Status::Converged, limit));
    }

    #[test]
    fn without_any_simulation_it_has_diverged() {
        let outcome = estimate(vec![vec![2.0, 0.0]], 1.0);
        assert_eq!((outcome.status, outcome.fit), (Status::Diverged, None));
    }

    #[test]
    fn the_covariance_is_that_of_the_linearised_regression() {
        let fit = estimate(vec![vec![1.4, 0.2]], f64::INFINITY).fit.unwrap();
        let (regression, simulated) = (record(), simulate(&fit.theta));
        let y = regression.y.iter().zip(offset(&simulated, &fit.theta)).map(|(y, o)| y - o).collect();
        let linear = Regression::single_series(simulated.sensitivities, y);
        let expected = Method::IDIM_LS.estimate(&linear, None, Divisor::default()).unwrap();
        for i in 0..2 {
            assert!((fit.theta[i] - expected.theta[i]).abs() < 1e-5 * fit.standard_deviation[i]);
            assert!((fit.standard_deviation[i] / expected.standard_deviation[i] - 1.0).abs() < 1e-9);
        }
    }
}
