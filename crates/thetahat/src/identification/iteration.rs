use serde::{Deserialize, Serialize};

use super::{
    estimators::Method,
    fit::{Divisor, EstimationError, Fit},
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

/// How an estimation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Both changes fell below their limits, or nothing had to be iterated.
    Converged,
    /// They did not within the iterations allowed.
    IterationLimit,
    /// A simulation failed.
    Diverged,
    /// The motion does not separate the parameters.
    NotIdentifiable,
}

/// Why an estimation has not converged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The motion does not give an estimate.
    #[error(transparent)]
    Estimation(EstimationError),
    /// A simulation failed, also after the step towards its parameters was halved.
    #[error(transparent)]
    Simulation(SimulationError),
    /// The changes were not small enough in time.
    #[error("no convergence within {iterations} iterations")]
    IterationLimit {
        /// Iterations allowed.
        iterations: usize,
    },
}

/// One iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// The estimates.
    pub theta: Vec<f64>,
    /// Relative error in percent.
    pub relative_error_percent: f64,
    /// Largest change of an estimate in its standard deviations; none for the first, which follows the start values.
    pub parameter_change: Option<f64>,
    /// Relative change of the error.
    pub error_change: Option<f64>,
}

/// The end of an estimation and the way there.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Why, where it is not converged.
    pub reason: Option<Reason>,
    /// The last estimate, absent where there is none to trust.
    pub fit: Option<Fit>,
    /// Every iteration.
    pub iterations: Vec<Iteration>,
    /// Closed-loop simulations run.
    pub simulations: usize,
    /// The instruments of the last estimate.
    pub instruments: Option<Matrix>,
}

impl Outcome {
    /// The outcome of a method that does not iterate.
    #[must_use]
    pub fn direct(result: Result<Fit, EstimationError>) -> Self {
        let (status, reason, fit) = match result {
            Ok(fit) => (Status::Converged, None, Some(fit)),
            Err(e) => (Status::NotIdentifiable, Some(Reason::Estimation(e)), None),
        };
        Self { status, reason, fit, iterations: Vec::new(), simulations: 0, instruments: None }
    }
}

/// Halvings of a step of the parameters whose simulation fails.
const HALVINGS: usize = 4;

/// Iterates IDIM-IV (10) or DIDIM (19) from `start`: simulate, build Z, estimate, until both relative changes are small.
///
/// `instruments` simulates the loop with given parameters and returns Z. Where the simulation of new estimates fails, the
/// step towards them is halved a few times before the iteration counts as diverged.
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
        estimation.take(z, regression);
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
#[derive(Debug, Clone)]
pub struct Estimation {
    method: Method,
    options: IterationOptions,
    /// The parameters to simulate next, and those simulated before.
    theta: Vec<f64>,
    before: Vec<f64>,
    /// How often the step to the next was halved.
    halvings: usize,
    last: Option<(Fit, f64)>,
    outcome: Outcome,
    is_done: bool,
}

impl Estimation {
    /// An estimation from its start values.
    #[must_use]
    pub fn new(method: Method, options: IterationOptions, start: Vec<f64>) -> Self {
        let iterations = options.convergence.iterations;
        let reason = Reason::IterationLimit { iterations };
        let outcome = Outcome {
            status: Status::IterationLimit,
            reason: Some(reason),
            fit: None,
            iterations: Vec::new(),
            simulations: 0,
            instruments: None,
        };
        let is_done = iterations == 0;
        let before = start.clone();
        Self { method, options, theta: start, before, halvings: 0, last: None, outcome, is_done }
    }

    /// The parameters with which the loop is to be simulated; none at the end.
    #[must_use]
    pub fn wanted(&self) -> Option<&[f64]> {
        (!self.is_done).then_some(&self.theta)
    }

    /// How it ended, or how far it is.
    #[must_use]
    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }

    /// Takes Z of the loop that was simulated with the parameters wanted, and estimates; where the simulation failed, half
    /// the step is wanted.
    pub fn take(&mut self, z: Result<Matrix, SimulationError>, regression: &Regression) {
        self.outcome.simulations += 1;
        match z {
            Ok(z) => match self.method.estimate(regression, Some(&z), self.options.divisor) {
                Ok(fit) => self.accept(fit, z, regression),
                Err(e) => self.fail(Status::NotIdentifiable, Reason::Estimation(e)),
            },
            Err(_) if self.halvings < HALVINGS && self.before != self.theta => {
                self.halvings += 1;
                self.theta.iter_mut().zip(&self.before).for_each(|(t, b)| *t = 0.5 * (*t + b));
            }
            Err(e) => self.fail(Status::Diverged, Reason::Simulation(e)),
        }
    }

    fn fail(&mut self, status: Status, reason: Reason) {
        (self.outcome.status, self.outcome.reason, self.is_done) = (status, Some(reason), true);
    }

    fn accept(&mut self, fit: Fit, z: Matrix, regression: &Regression) {
        let error = norm(&regression.whiten(&regression.residual(&fit.prediction)));
        let parameter_change = self.last.as_ref().map(|(before, _)| largest_change(before, &fit));
        let error_change = self.last.as_ref().map(|(_, before)| relative_change(*before, error));
        self.outcome.iterations.push(Iteration {
            theta: fit.theta.clone(),
            relative_error_percent: fit.relative_error_percent,
            parameter_change,
            error_change,
        });
        let small = |change: Option<f64>, limit: f64| change.is_some_and(|c| c <= limit);
        let limits = &self.options.convergence;
        if small(parameter_change, limits.parameter_change) && small(error_change, limits.error_change) {
            (self.outcome.status, self.outcome.reason) = (Status::Converged, None);
        } else if self.outcome.iterations.len() < limits.iterations {
            self.before = std::mem::replace(&mut self.theta, fit.theta.clone());
            self.halvings = 0;
            self.last = Some((fit, error));
            return;
        }
        (self.outcome.fit, self.outcome.instruments, self.is_done) = (Some(fit), Some(z), true);
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
        assert_eq!((outcome.status, outcome.iterations.len(), outcome.simulations), (Status::IterationLimit, 2, 2));
    }

    #[test]
    fn steps_to_a_failing_simulation_are_halved_and_then_it_is_a_status() {
        let fail = SimulationError::StepTooSmall { time_s: 0.0 };
        let outcome = iterate(Method::DIDIM, &measured(), IterationOptions::default(), &[1.0], &mut |theta| {
            if theta[0] > 1.2 { Err(fail.clone()) } else { Ok(z_of(theta[0])) }
        });
        // Halving comes close to 1.2 and no further; the fixed point is 2.
        assert!(outcome.iterations.len() > 1 && outcome.iterations.len() < outcome.simulations);
        assert_eq!(outcome.status, Status::Diverged);
        assert!(outcome.fit.is_none());
    }
}
