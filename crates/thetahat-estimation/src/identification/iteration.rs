use serde::Deserialize;

use super::{
    estimators::{DesignMatrix, Method, Needs},
    fit::{Divisor, Fit},
    outcome::{Iteration, Outcome, Reason, Status},
    steps::Steps,
};
use crate::{regression::Regression, simulation::SimulationError};
use thetahat_ground::linear_algebra::{Matrix, norm};

/// When the iteration stops.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Convergence {
    /// Largest change of an estimate, relative to its standard deviation.
    pub parameter_change: f64,
    /// Relative change of the error `|rho|`.
    pub error_change: f64,
    /// Most iterations.
    pub iterations: usize,
}

impl Default for Convergence {
    fn default() -> Self {
        Self { parameter_change: 0.05, error_change: 1e-3, iterations: 20 }
    }
}

/// Halvings of a step of the parameters whose simulation fails.
const HALVINGS: usize = 4;
/// Changes, in multiples of their limit, within which several iterations in a row count as settled.
const SETTLED: f64 = 5.0;
const SETTLED_FOR: usize = 3;

impl Convergence {
    /// Whether changes, the last one first, have settled: they are then caused by the simulations and not by the estimates.
    pub(super) fn are_settled(&self, changes: impl Iterator<Item = f64>) -> bool {
        changes.take(SETTLED_FOR).filter(|change| *change <= SETTLED * self.parameter_change).count() == SETTLED_FOR
    }
}

/// Iterates IDIM-IV (10) or DIDIM (19) from `start`: simulate, build Z, estimate, until both relative changes are small.
///
/// step towards them is halved a few times before the iteration ends with the previous estimate.
/// step towards them is halved a few times before the iteration ends with the estimate before.
pub fn iterate(
    method: Method,
    regression: &Regression,
    options: IterationOptions,
    start: &[f64],
    instruments: &mut dyn FnMut(&[f64]) -> Result<Matrix, SimulationError>,
) -> Outcome {
    let mut estimation = Estimation::new(method, options, start.to_vec());
    while let Some(theta) = estimation.wanted() {
        let z = instruments(theta);
        estimation.take(z, regression, &mut |fit, _| fit);
    }
    estimation.into_outcome()
}

/// Settings of an estimation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IterationOptions {
    /// What the squared residual is divided by.
    pub divisor: Divisor,
    /// When the iteration stops.
    pub convergence: Convergence,
}

/// An estimation by IV or DIDIM in progress. It requests its simulations, so that those of several can run together.
#[derive(Debug, Clone)]
pub struct Estimation {
    method: Method,
    options: IterationOptions,
    /// The parameters to simulate next, and the ones simulated before.
    theta: Vec<f64>,
    before: Vec<f64>,
    /// How often the step to the next parameters was halved.
    halvings: usize,
    steps: Steps,
    last: Option<(Fit, f64, Matrix)>,
    outcome: Outcome,
    is_done: bool,
}

/// Revises an estimate with its instruments before it is accepted: a constrained one may replace it.
pub type Revision<'a> = &'a mut dyn FnMut(Fit, &Matrix) -> Fit;

impl Estimation {
    /// An estimation from the parameters that are simulated first.
    #[must_use]
    pub fn new(method: Method, options: IterationOptions, start: Vec<f64>) -> Self {
        let iterations = options.convergence.iterations;
        let reason = Reason::IterationLimit { iterations, relative_error_percent: f64::NAN, parameter_change: None };
        let outcome = Outcome { reason: Some(reason), ..Outcome::nothing() };
        let is_done = iterations == 0;
        let before = start.clone();
        Self { method, options, theta: start, before, halvings: 0, steps: Steps::new(), last: None, outcome, is_done }
    }

    /// The parameters with which to simulate the loop; none at the end.
    #[must_use]
    pub fn wanted(&self) -> Option<&[f64]> {
        (!self.is_done).then_some(&self.theta)
    }

    /// Factor of the tolerances for that simulation: below one if changes do not shrink.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.steps.tolerance
    }

    /// Sets the factor of the tolerances that was used, if it is not the requested one.
    pub fn simulated_with(&mut self, tolerance: f64) {
        self.steps.tolerance = tolerance;
    }

    /// Whether an estimate was made.
    #[must_use]
    pub fn has_estimate(&self) -> bool {
        self.last.is_some()
    }

    /// Requests a simulation with other start values, after the simulation of the previous ones failed.
    pub fn start_anew(&mut self, start: Vec<f64>) {
        self.outcome.simulations += 1;
        self.before.clone_from(&start);
        self.theta = start;
        self.steps.restart();
    }

    /// Requests another simulation of the last estimate, revised, after its simulation failed; false without an estimate.
    pub fn simulate_anew(&mut self, revise: Revision<'_>) -> bool {
        let Some((fit, error, z)) = self.last.take() else { return false };
        let fit = revise(fit, &z);
        self.outcome.simulations += 1;
        self.theta.clone_from(&fit.theta);
        self.steps.restart();
        self.last = Some((fit, error, z));
        true
    }

    /// The outcome, final or so far.
    #[must_use]
    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }

    /// Receives Z of the loop simulated with the requested parameters, and estimates; if the simulation failed, half the step is requested.
    pub fn take(&mut self, z: Result<Matrix, SimulationError>, regression: &Regression, revise: Revision<'_>) {
        self.outcome.simulations += 1;
        match z {
            Ok(z) => match self.method.estimate(regression, Some(&z), self.options.divisor) {
                Ok(fit) => {
                    let fit = revise(fit, &z);
                    self.accept(fit, z, regression);
                }
                Err(e) => self.fail(Status::NotIdentifiable, Reason::Estimation(e)),
            },
            Err(_) if self.halvings < HALVINGS && self.before != self.theta => {
                self.halvings += 1;
                self.theta.iter_mut().zip(&self.before).for_each(|(t, b)| *t = 0.5 * (*t + b));
            }
            Err(cause) => self.stall(cause),
        }
    }

    fn fail(&mut self, status: Status, reason: Reason) {
        (self.outcome.status, self.outcome.reason, self.is_done) = (status, Some(reason), true);
    }

    /// Ends with the last estimate, if there is one.
    fn stall(&mut self, cause: SimulationError) {
        let Some((fit, _, z)) = self.last.take() else {
            return self.fail(Status::Diverged, Reason::Simulation(cause));
        };
        let relative_error_percent = fit.relative_error_percent;
        let parameter_change = self.outcome.iterations.last().and_then(|i| i.parameter_change);
        (self.outcome.fit, self.outcome.instruments) = (Some(fit), Some(z));
        self.fail(Status::Stalled, Reason::Stalled { cause, relative_error_percent, parameter_change });
    }

    /// Whether further simulations would not change an estimate by IV: the last instruments are all valid.
    fn is_settled(&self) -> bool {
        let changes = self.outcome.iterations.iter().rev().map_while(|i| i.parameter_change);
        let is_iv = self.method.needs() == Needs::Instruments && self.method.design() == DesignMatrix::Measured;
        is_iv && self.options.convergence.are_settled(changes)
    }

    fn accept(&mut self, fit: Fit, z: Matrix, regression: &Regression) {
        let error = norm(&regression.whiten(&regression.residual(&fit.prediction)));
        // The first simulation used start values, not an estimate.
        let parameter_change = self.last.as_ref().map(|_| largest_change(&self.theta, &fit));
        let error_change = self.last.as_ref().map(|(_, before, _)| relative_change(*before, error));
        let relative_error_percent = fit.relative_error_percent;
        let theta = fit.theta.clone();
        self.outcome.iterations.push(Iteration { theta, relative_error_percent, parameter_change, error_change });
        let small = |change: Option<f64>, limit: f64| change.is_some_and(|c| c <= limit);
        let Convergence { parameter_change: parameter_limit, error_change: error_limit, iterations } =
            self.options.convergence;
        if (small(parameter_change, parameter_limit) && small(error_change, error_limit)) || self.is_settled() {
            (self.outcome.status, self.outcome.reason) = (Status::Converged, None);
        } else if self.outcome.iterations.len() < iterations {
            let next =
                self.steps.next(&self.theta, &fit.theta, &regression.whiten_matrix(&regression.x), parameter_change);
            self.before = std::mem::replace(&mut self.theta, next);
            self.halvings = 0;
            self.last = Some((fit, error, z));
            return;
        } else {
            let reason = Reason::IterationLimit { iterations, relative_error_percent, parameter_change };
            self.fail(Status::Stalled, reason);
        }
        (self.outcome.fit, self.outcome.instruments, self.is_done) = (Some(fit), Some(z), true);
    }
}

/// The largest change from the simulated parameters to their estimate, in standard deviations: a change that is not distinguishable from
/// zero does not delay convergence, however small the estimate is.
fn largest_change(simulated: &[f64], now: &Fit) -> f64 {
    let change = |i: usize| {
        let size = now.standard_deviation[i].max(f64::EPSILON * now.theta[i].abs()).max(f64::MIN_POSITIVE);
        (now.theta[i] - simulated[i]).abs() / size
    };
    (0..now.theta.len()).map(change).fold(0.0, f64::max)
}

fn relative_change(before: f64, now: f64) -> f64 {
    if now == before { 0.0 } else { (now - before).abs() / before }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A simulator whose regressor depends weakly on the parameter: a contraction for DIDIM.
    fn z_of(theta: f64) -> Matrix {
        Matrix::from_fn(50, 1, |k, _| (0.3 * k as f64).sin() + 0.1 * theta * (0.7 * k as f64).cos())
    }

    fn measured() -> Regression {
        let x = z_of(2.0);
        let y = x.times(&[2.0]);
        Regression::single_series(x, y)
    }

    fn options(convergence: Convergence) -> IterationOptions {
        IterationOptions { convergence, ..IterationOptions::default() }
    }

    #[test]
    fn both_methods_find_the_fixed_point() {
        // Some noise, so that the standard deviations to which changes are compared are not rounding errors.
        let Regression { x, y, .. } = measured();
        let y = y.iter().enumerate().map(|(k, y)| y + 1e-8 * (7.7 * k as f64).sin()).collect();
        let regression = Regression::single_series(x.as_ref().clone(), y);
        let limits = Convergence { parameter_change: 1e-3, error_change: 1e-6, iterations: 50 };
        for method in [Method::IDIM_IV, Method::DIDIM] {
            let outcome = iterate(method, &regression, options(limits), &[1.0], &mut |theta| Ok(z_of(theta[0])));
            assert_eq!(outcome.status, Status::Converged);
            assert!((outcome.fit.unwrap().theta[0] - 2.0).abs() < 1e-8, "{method:?}");
        }
    }

    /// A simulator that alternates between two states: its instruments are valid in both, and DIDIM has no fixed point.
    #[test]
    fn iv_settles_where_any_instruments_give_nearly_the_same() {
        let Regression { x, y, .. } = measured();
        let y = y.iter().enumerate().map(|(k, y)| y + 1e-2 * (7.7 * k as f64).sin()).collect();
        let regression = Regression::single_series(x.as_ref().clone(), y);
        let run = |method: Method, jump: f64| {
            let mut calls = 0;
            let mut jumping = |_: &[f64]| {
                calls += 1;
                Ok(z_of(if calls % 2 == 0 { 2.0 + jump } else { 2.0 - jump }))
            };
            iterate(method, &regression, IterationOptions::default(), &[1.0], &mut jumping).status
        };
        assert_eq!(run(Method::IDIM_IV, 2.0), Status::Converged);
        assert_eq!([run(Method::IDIM_IV, 8.0), run(Method::DIDIM, 2.0)], [Status::Stalled; 2]);
    }

    #[test]
    fn changes_settle_within_five_limits_three_times_in_a_row() {
        let settled = |changes: &[f64]| Convergence::default().are_settled(changes.iter().copied());
        assert!(settled(&[0.2, 0.25, 0.1, 7.0]));
        assert!(!settled(&[0.2, 0.26, 0.1, 0.1]) && !settled(&[0.2, 0.1]));
    }

    #[test]
    fn the_limit_of_iterations_is_a_status() {
        let limits = Convergence { iterations: 2, parameter_change: 0.0, error_change: 0.0 };
        let outcome = iterate(Method::DIDIM, &measured(), options(limits), &[0.0], &mut |theta| Ok(z_of(theta[0])));
        assert_eq!((outcome.status, outcome.iterations.len(), outcome.simulations), (Status::Stalled, 2, 2));
    }

    #[test]
    fn steps_to_a_failing_simulation_are_halved_and_then_it_is_a_status() {
        let fail = SimulationError::StepTooSmall { time_s: 0.0 };
        let outcome = iterate(Method::DIDIM, &measured(), IterationOptions::default(), &[1.0], &mut |theta| {
            if theta[0] > 1.2 { Err(fail.clone()) } else { Ok(z_of(theta[0])) }
        });
        // Halving approaches 1.2 and stops there; the fixed point is 2.
        assert!(outcome.iterations.len() > 1 && outcome.iterations.len() < outcome.simulations);
        assert_eq!(outcome.status, Status::Stalled);
        assert_eq!(outcome.fit.unwrap().theta, outcome.iterations.last().unwrap().theta);
        let reason = outcome.reason.unwrap().to_string();
        assert!(reason.contains("kept is the last estimate, error"), "{reason}");
    }

    #[test]
    fn without_any_estimate_it_has_diverged() {
        let fail = SimulationError::StepTooSmall { time_s: 0.0 };
        let options = IterationOptions::default();
        let outcome = iterate(Method::IDIM_IV, &measured(), options, &[1.0], &mut |_| Err(fail.clone()));
        assert_eq!((outcome.status, outcome.fit), (Status::Diverged, None));
    }

    /// Instruments that overreact: each estimate is on the other side of the fixed point, and farther away.
    #[test]
    fn steps_that_grow_are_mixed_until_the_iteration_settles() {
        let limits = Convergence { parameter_change: 1e-3, error_change: 1e-6, iterations: 60 };
        let regression = {
            let Regression { x, y, .. } = measured();
            let y = y.iter().enumerate().map(|(k, y)| y + 1e-2 * (7.7 * k as f64).sin()).collect();
            Regression::single_series(x.as_ref().clone(), y)
        };
        let mut estimation = Estimation::new(Method::IDIM_IV, options(limits), vec![2.1]);
        while let Some(theta) = estimation.wanted().map(<[f64]>::to_vec) {
            let overreact = &mut |fit: Fit, _: &Matrix| Fit { theta: vec![2.0 - 1.6 * (theta[0] - 2.0)], ..fit };
            estimation.take(Ok(z_of(theta[0])), &regression, overreact);
        }
        assert_eq!(estimation.into_outcome().status, Status::Converged);
    }
}
