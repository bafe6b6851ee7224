use serde::Deserialize;

use super::{
    estimators::{Design, Method},
    fit::{Divisor, Fit},
    outcome::{Iteration, Outcome, Reason, Status},
};
use crate::{
    linear_algebra::{Matrix, norm},
    regression::Regression,
    simulation::SimulationError,
};

/// When the iteration stops.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Convergence {
    /// Largest change of an estimate, relative to its standard deviation.
    pub parameter_change: f64,
    /// Relative change of the error `|rho|`.
    pub error_change: f64,
    /// Iterations at the most.
    pub iterations: usize,
}

impl Default for Convergence {
    fn default() -> Self {
        Self { parameter_change: 0.05, error_change: 1e-3, iterations: 20 }
    }
}

/// Halvings of a step of the parameters whose simulation fails.
const HALVINGS: usize = 4;

/// Part of the smallest change so far below which a change is progress.
const PROGRESS: f64 = 0.8;
/// Iterations in a row without progress after which the steps of IV are halved.
const WITHOUT_PROGRESS: usize = 2;
/// Least part of a step that is left of it.
const LEAST_STEP: f64 = 1.0 / 16.0;

/// Iterates IDIM-IV (10) or DIDIM (19) from `start`: simulate, build Z, estimate, until both relative changes are small.
///
/// `instruments` simulates the loop with given parameters and returns Z. Where the simulation of new estimates fails, the
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
        estimation.take(z, regression, &mut <[f64]>::to_vec);
    }
    estimation.into_outcome()
}

/// How an estimation is made.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IterationOptions {
    /// What the squared residual is divided by.
    pub divisor: Divisor,
    /// When it stops.
    pub convergence: Convergence,
}

/// An estimation by IV or DIDIM under way. It asks for its simulations, so that those of several can run side by side.
///
/// What is simulated need not be the estimate: IV may simulate the parameters of a physical robot near it. They are any
/// vectors of which weighted means can be simulated as well.
#[derive(Debug, Clone)]
pub struct Estimation {
    method: Method,
    options: IterationOptions,
    /// The parameters to simulate next, and those simulated before.
    theta: Vec<f64>,
    before: Vec<f64>,
    /// How often the step to the next was halved.
    halvings: usize,
    /// Part of each step that is made, the smallest of the largest changes, and for how many iterations none was smaller.
    step: f64,
    smallest_change: f64,
    without_progress: usize,
    last: Option<(Fit, f64, Matrix)>,
    outcome: Outcome,
    is_done: bool,
}

impl Estimation {
    /// An estimation from the parameters that are simulated first.
    #[must_use]
    pub fn new(method: Method, options: IterationOptions, start: Vec<f64>) -> Self {
        let iterations = options.convergence.iterations;
        let reason = Reason::IterationLimit { iterations, relative_error_percent: f64::NAN, parameter_change: None };
        let outcome = Outcome { reason: Some(reason), ..Outcome::nothing() };
        let is_done = iterations == 0;
        let before = start.clone();
        Self {
            method,
            options,
            theta: start,
            before,
            halvings: 0,
            step: 1.0,
            smallest_change: f64::INFINITY,
            without_progress: 0,
            last: None,
            outcome,
            is_done,
        }
    }

    /// The parameters with which the loop is to be simulated; none at the end.
    #[must_use]
    pub fn wanted(&self) -> Option<&[f64]> {
        (!self.is_done).then_some(&self.theta)
    }

    /// The estimate of the last iteration.
    #[must_use]
    pub fn estimate(&self) -> Option<&[f64]> {
        self.last.as_ref().map(|(fit, _, _)| &fit.theta[..])
    }

    /// Wants other parameters simulated than those whose simulation failed.
    pub fn simulate_instead(&mut self, theta: Vec<f64>) {
        self.outcome.simulations += 1;
        self.theta = theta;
    }

    /// How it ended, or how far it is.
    #[must_use]
    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }

    /// Takes Z of the loop that was simulated with the parameters wanted, and estimates; where the simulation failed, half
    /// the step is wanted. `to_simulate` gives the parameters to simulate for an estimate.
    pub fn take(
        &mut self,
        z: Result<Matrix, SimulationError>,
        regression: &Regression,
        to_simulate: &mut dyn FnMut(&[f64]) -> Vec<f64>,
    ) {
        self.outcome.simulations += 1;
        match z {
            Ok(z) => match self.method.estimate(regression, Some(&z), self.options.divisor) {
                Ok(fit) => self.accept(fit, z, regression, to_simulate),
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

    /// Ends with the last estimate, where there is one.
    fn stall(&mut self, cause: SimulationError) {
        let Some((fit, _, z)) = self.last.take() else {
            return self.fail(Status::Diverged, Reason::Simulation(cause));
        };
        let relative_error_percent = fit.relative_error_percent;
        let parameter_change = self.outcome.iterations.last().and_then(|i| i.parameter_change);
        (self.outcome.fit, self.outcome.instruments) = (Some(fit), Some(z));
        self.fail(Status::Stalled, Reason::Stalled { cause, relative_error_percent, parameter_change });
    }

    fn accept(
        &mut self,
        fit: Fit,
        z: Matrix,
        regression: &Regression,
        to_simulate: &mut dyn FnMut(&[f64]) -> Vec<f64>,
    ) {
        let error = norm(&regression.whiten(&regression.residual(&fit.prediction)));
        let parameter_change = self.last.as_ref().map(|(before, _, _)| largest_change(before, &fit));
        let error_change = self.last.as_ref().map(|(_, before, _)| relative_change(*before, error));
        let relative_error_percent = fit.relative_error_percent;
        self.damp(parameter_change);
        let theta = fit.theta.clone();
        self.outcome.iterations.push(Iteration { theta, relative_error_percent, parameter_change, error_change });
        // A part of a step makes a part of the change.
        let small = |change: Option<f64>, limit: f64| change.is_some_and(|c| c <= limit * self.step);
        let Convergence { parameter_change: parameter_limit, error_change: error_limit, iterations } =
            self.options.convergence;
        if small(parameter_change, parameter_limit) && small(error_change, error_limit) {
            (self.outcome.status, self.outcome.reason) = (Status::Converged, None);
        } else if self.outcome.iterations.len() < iterations {
            self.step_to(to_simulate(&fit.theta));
            self.last = Some((fit, error, z));
            return;
        } else {
            let reason = Reason::IterationLimit { iterations, relative_error_percent, parameter_change };
            self.fail(Status::Stalled, reason);
        }
        (self.outcome.fit, self.outcome.instruments, self.is_done) = (Some(fit), Some(z), true);
    }

    /// Halves the steps of IV where the largest change has not become smaller in two iterations: where it grows, or goes to
    /// and fro. DIDIM keeps its steps: it is least squares on its own simulation.
    fn damp(&mut self, change: Option<f64>) {
        let Some(change) = change else { return };
        // A part of a step makes a part of the change.
        let whole = change / self.step;
        self.without_progress = if whole < PROGRESS * self.smallest_change { 0 } else { self.without_progress + 1 };
        self.smallest_change = self.smallest_change.min(whole);
        if self.method.design() == Design::Measured && self.without_progress >= WITHOUT_PROGRESS {
            (self.step, self.without_progress) = ((0.5 * self.step).max(LEAST_STEP), 0);
        }
    }

    /// Wants the parameters at the part of the way to `next` that is made.
    fn step_to(&mut self, mut next: Vec<f64>) {
        if self.step < 1.0 {
            next.iter_mut().zip(&self.theta).for_each(|(n, t)| *n = t + self.step * (*n - t));
        }
        self.before = std::mem::replace(&mut self.theta, next);
        self.halvings = 0;
    }
}

/// The largest change of an estimate in its standard deviations: a change that the data could not tell from none does not
/// hold up the iteration, however small the estimate is.
fn largest_change(before: &Fit, now: &Fit) -> f64 {
    let change = |i: usize| {
        let size = now.standard_deviation[i].max(f64::EPSILON * now.theta[i].abs()).max(f64::MIN_POSITIVE);
        (now.theta[i] - before.theta[i]).abs() / size
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
        Regression::of_one_series(x, y)
    }

    fn options(convergence: Convergence) -> IterationOptions {
        IterationOptions { convergence, ..IterationOptions::default() }
    }

    #[test]
    fn both_methods_find_the_fixed_point() {
        // Some noise, so that the deviations to which changes are compared are no rounding.
        let Regression { x, y, .. } = measured();
        let y = y.iter().enumerate().map(|(k, y)| y + 1e-8 * (7.7 * k as f64).sin()).collect();
        let regression = Regression::of_one_series(x.as_ref().clone(), y);
        let limits = Convergence { parameter_change: 1e-3, error_change: 1e-6, iterations: 50 };
        for method in [Method::IDIM_IV, Method::DIDIM] {
            let outcome = iterate(method, &regression, options(limits), &[1.0], &mut |theta| Ok(z_of(theta[0])));
            assert_eq!(outcome.status, Status::Converged);
            assert!((outcome.fit.unwrap().theta[0] - 2.0).abs() < 1e-8, "{method:?}");
        }
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
        // Halving comes close to 1.2 and no further; the fixed point is 2.
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

    /// Instruments that overreact: the parameters simulated next are twice as far on the other side.
    #[test]
    fn steps_that_grow_are_halved_until_the_iteration_settles() {
        let limits = Convergence { parameter_change: 1e-3, error_change: 1e-6, iterations: 60 };
        let regression = {
            let Regression { x, y, .. } = measured();
            let y = y.iter().enumerate().map(|(k, y)| y + 1e-2 * (7.7 * k as f64).sin()).collect();
            Regression::of_one_series(x.as_ref().clone(), y)
        };
        let mut estimation = Estimation::new(Method::IDIM_IV, options(limits), vec![2.1]);
        while let Some(theta) = estimation.wanted().map(<[f64]>::to_vec) {
            // The estimate depends on what is simulated through the noise; here the slope is made -1.6.
            estimation.take(Ok(z_of(theta[0])), &regression, &mut |_| vec![2.0 - 1.6 * (theta[0] - 2.0)]);
        }
        assert_eq!(estimation.into_outcome().status, Status::Converged);
    }
}
