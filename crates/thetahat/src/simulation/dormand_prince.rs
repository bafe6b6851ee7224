//! The explicit Runge-Kutta pair of Dormand and Prince, orders 5 and 4, with the step control of MATLAB's `ode45` and
//! the quartic interpolant of Shampine (1986).
//!
//! J. R. Dormand, P. J. Prince, "A family of embedded Runge-Kutta formulae", 1980; L. F. Shampine, M. W. Reichelt, "The
//! MATLAB ODE suite", 1997.

use serde::Deserialize;

/// How to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Solver {
    /// Steps chosen by the error estimate, as `ode45` does.
    Adaptive {
        /// Tolerance relative to the state.
        relative_tolerance: f64,
        /// Tolerance where the state is near zero, rad and rad/s.
        absolute_tolerance: f64,
    },
    /// Equal steps of the fifth-order formula.
    Fixed {
        /// Step in s.
        step_s: f64,
    },
}

impl Solver {
    /// The default tolerances of `ode45`.
    pub const ODE45: Self = Self::Adaptive { relative_tolerance: 1e-3, absolute_tolerance: 1e-6 };
}

/// Work done by an integrator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkCounts {
    /// Right-hand sides.
    pub evaluations: usize,
    /// Steps taken.
    pub steps: usize,
    /// Steps repeated with a smaller size.
    pub rejected: usize,
}

/// The step that the tolerance asks for is below the spacing of numbers at this time, in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepTooSmall(pub f64);

/// What an integration comes to next.
#[derive(Debug)]
pub enum Next<'a> {
    /// The slope of [`Integrator::wanted`] is to be written.
    Slope,
    /// A step is accepted.
    Step(StepView<'a>),
    /// The end of the interval is reached: [`Integrator::begin`] another one, or leave it.
    End,
}

const C: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
const A: [&[f64]; 7] = [
    &[],
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the fifth-order less those of the fourth-order formula.
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Coefficients of s, s^2, s^3, s^4 in the interpolant at the fraction s of a step.
const P: [[f64; 4]; 7] = [
    [1.0, -183.0 / 64.0, 37.0 / 12.0, -145.0 / 128.0],
    [0.0, 0.0, 0.0, 0.0],
    [0.0, 1500.0 / 371.0, -1000.0 / 159.0, 1000.0 / 371.0],
    [0.0, -125.0 / 32.0, 125.0 / 12.0, -375.0 / 64.0],
    [0.0, 9477.0 / 3392.0, -729.0 / 106.0, 25515.0 / 6784.0],
    [0.0, -11.0 / 7.0, 11.0 / 3.0, -55.0 / 28.0],
    [0.0, 3.0 / 2.0, -4.0, 5.0 / 2.0],
];
/// Largest step as a part of the interval, as `ode45` has it.
const LARGEST_STEP: f64 = 0.1;

/// The integration of `dy/dt = f(t, y)` from interval to interval, with its scratch: nothing is allocated while it runs.
///
/// It does not call f, it asks for it, so that several can take turns:
///
/// ```
/// use thetahat::simulation::{Integrator, Next, Solver};
///
/// let mut integrator = Integrator::new(Solver::ODE45, vec![1.0]);
/// integrator.begin(0.0, 1.0);
/// loop {
///     match integrator.proceed()? {
///         Next::Slope => {
///             let (_, y, slope) = integrator.wanted();
///             slope[0] = -y[0];
///         }
///         Next::Step(_) => {}
///         Next::End => break,
///     }
/// }
/// assert!((integrator.state()[0] - (-1.0_f64).exp()).abs() < 1e-3);
/// # Ok::<(), thetahat::simulation::StepTooSmall>(())
/// ```
#[derive(Debug, Clone)]
pub struct Integrator {
    solver: Solver,
    stages: [Vec<f64>; 7],
    state: Vec<f64>,
    trial: Vec<f64>,
    dense: Vec<f64>,
    next_step: Option<f64>,
    counts: WorkCounts,
    phase: Phase,
    time: f64,
    end: f64,
    trying: Trying,
}

/// Where an integration is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Between two intervals.
    Idle,
    /// An interval is begun.
    Begun,
    /// The slope of this stage is wanted.
    Stage(usize),
    /// A step is accepted and not yet taken; the size to try next.
    Accepted(f64),
}

/// The step that is tried.
#[derive(Debug, Clone, Copy, Default)]
struct Trying {
    step: f64,
    /// Its size if the interval had no end.
    planned: f64,
    /// Whether it is to reach the end of the interval.
    last: bool,
    /// Whether its error was too large and it was cut.
    failed: bool,
}

impl Integrator {
    /// An integrator at an initial state.
    #[must_use]
    pub fn new(solver: Solver, state: Vec<f64>) -> Self {
        let zeros = || vec![0.0; state.len()];
        Self {
            solver,
            stages: std::array::from_fn(|_| zeros()),
            trial: zeros(),
            dense: zeros(),
            next_step: None,
            counts: WorkCounts::default(),
            phase: Phase::Idle,
            time: 0.0,
            end: 0.0,
            trying: Trying::default(),
            state,
        }
    }

    /// The work done so far.
    #[must_use]
    pub fn counts(&self) -> WorkCounts {
        self.counts
    }

    /// The state at the last accepted step.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Begins the interval from `t0` to `t1`, at the state reached.
    pub fn begin(&mut self, t0: f64, t1: f64) {
        (self.time, self.end, self.phase) = (t0, t1, Phase::Begun);
        self.trial.copy_from_slice(&self.state);
    }

    /// The time and the state of the slope that is wanted, and where to write it.
    pub fn wanted(&mut self) -> (f64, &[f64], &mut [f64]) {
        let stage = if let Phase::Stage(s) = self.phase { s } else { 0 };
        let time = if stage == 0 { self.time } else { self.time + C[stage] * self.trying.step };
        (time, &self.trial, &mut self.stages[stage])
    }

    /// Goes on to the next slope that is wanted, accepted step, or the end of the interval.
    ///
    /// # Errors
    /// [`StepTooSmall`] with the time where the step vanishes.
    pub fn proceed(&mut self) -> Result<Next<'_>, StepTooSmall> {
        match self.phase {
            Phase::Idle => Ok(Next::End),
            Phase::Begun => {
                self.phase = Phase::Stage(0);
                Ok(Next::Slope)
            }
            Phase::Stage(0) => {
                self.counts.evaluations += 1;
                let step = self.first_step(self.end - self.time);
                Ok(self.try_step(step))
            }
            Phase::Stage(6) => {
                self.counts.evaluations += 6;
                self.judge()
            }
            Phase::Stage(s) => Ok(self.place_stage(s + 1)),
            Phase::Accepted(next) => {
                let reached = self.reaches_end();
                self.time = self.step_end();
                self.state.copy_from_slice(&self.trial);
                self.stages.swap(0, 6);
                // A step cut short by the end of the interval does not hold back the next one.
                Ok(self.try_step(if reached { next.max(self.trying.planned) } else { next }))
            }
        }
    }

    /// Tries a step of at most this size, or ends the interval.
    fn try_step(&mut self, planned: f64) -> Next<'_> {
        if self.time >= self.end {
            (self.next_step, self.phase) = (Some(planned), Phase::Idle);
            return Next::End;
        }
        let last = self.time + 1.000_001 * planned >= self.end;
        let step = if last { self.end - self.time } else { planned };
        self.trying = Trying { step, planned, last, failed: false };
        self.place_stage(1)
    }

    /// Leaves the state of a stage in `trial`.
    fn place_stage(&mut self, stage: usize) -> Next<'_> {
        self.trial.copy_from_slice(&self.state);
        for (slope, a) in self.stages.iter().zip(A[stage]) {
            let step = self.trying.step;
            self.trial.iter_mut().zip(slope).for_each(|(y, k)| *y += step * a * k);
        }
        self.phase = Phase::Stage(stage);
        Next::Slope
    }

    /// Accepts the step of which all stages are known, or tries a shorter one.
    fn judge(&mut self) -> Result<Next<'_>, StepTooSmall> {
        let step = self.trying.step;
        let Solver::Adaptive { relative_tolerance, absolute_tolerance } = self.solver else {
            return Ok(self.accept(step));
        };
        let error = self.error(step, absolute_tolerance / relative_tolerance) / relative_tolerance;
        if error <= 1.0 {
            let factor = if self.trying.failed { 1.0 } else { 1.0 / (1.25 * error.powf(0.2)).max(0.2) };
            return Ok(self.accept(step * factor));
        }
        self.counts.rejected += 1;
        let cut = if self.trying.failed || !error.is_finite() { 0.5 } else { (0.8 * error.powf(-0.2)).max(0.1) };
        (self.trying.step, self.trying.failed) = (step * cut, true);
        if self.trying.step < 16.0 * f64::EPSILON * self.time.abs().max(1e-6) {
            return Err(StepTooSmall(self.time));
        }
        Ok(self.place_stage(1))
    }

    fn accept(&mut self, next: f64) -> Next<'_> {
        self.counts.steps += 1;
        self.phase = Phase::Accepted(next);
        Next::Step(StepView {
            start_s: self.time,
            end_s: self.step_end(),
            step: self.trying.step,
            from: &self.state,
            stages: &self.stages,
            out: &mut self.dense,
        })
    }

    fn reaches_end(&self) -> bool {
        self.trying.last && !self.trying.failed
    }

    fn step_end(&self) -> f64 {
        if self.reaches_end() { self.end } else { self.time + self.trying.step }
    }

    /// Largest error of a component against its own size, or `threshold` where that is smaller.
    fn error(&self, h: f64, threshold: f64) -> f64 {
        let y = &self.state;
        (0..y.len())
            .map(|i| {
                let difference: f64 = E.iter().zip(&self.stages).map(|(e, k)| e * k[i]).sum();
                h * difference.abs() / y[i].abs().max(self.trial[i].abs()).max(threshold)
            })
            .fold(0.0, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { f64::max(a, b) })
    }

    fn first_step(&self, interval: f64) -> f64 {
        match (self.solver, self.next_step) {
            (Solver::Fixed { step_s }, _) => step_s,
            (_, Some(step)) => step,
            (Solver::Adaptive { relative_tolerance, absolute_tolerance }, None) => {
                let threshold = absolute_tolerance / relative_tolerance;
                let rate = self.state.iter().zip(&self.stages[0]).map(|(y, k)| k.abs() / y.abs().max(threshold));
                let limit = rate.fold(0.0, f64::max) / (0.8 * relative_tolerance.powf(0.2));
                let largest = LARGEST_STEP * interval;
                if largest * limit > 1.0 { 1.0 / limit } else { largest }
            }
        }
    }
}

/// An accepted step and its interpolant.
#[derive(Debug)]
pub struct StepView<'a> {
    /// Time at its start.
    pub start_s: f64,
    /// Time at its end.
    pub end_s: f64,
    step: f64,
    from: &'a [f64],
    stages: &'a [Vec<f64>; 7],
    out: &'a mut [f64],
}

impl StepView<'_> {
    /// The state at a time within the step, to fourth order.
    pub fn at(&mut self, t: f64) -> &[f64] {
        let s = (t - self.start_s) / self.step;
        let weight = |p: &[f64; 4]| self.step * s * (p[0] + s * (p[1] + s * (p[2] + s * p[3])));
        let b: [f64; 7] = std::array::from_fn(|i| weight(&P[i]));
        for (i, out) in self.out.iter_mut().enumerate() {
            *out = self.from[i] + b.iter().zip(self.stages).map(|(b, k)| b * k[i]).sum::<f64>();
        }
        self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates to `end`; `accept` sees every step.
    fn integrate(
        solver: Solver,
        start: &[f64],
        end: f64,
        slope: impl Fn(&[f64], &mut [f64]),
        mut accept: impl FnMut(StepView<'_>),
    ) -> Result<Vec<f64>, StepTooSmall> {
        let mut integrator = Integrator::new(solver, start.to_vec());
        integrator.begin(0.0, end);
        loop {
            match integrator.proceed()? {
                Next::Slope => {
                    let (_, y, dy) = integrator.wanted();
                    slope(y, dy);
                }
                Next::Step(step) => accept(step),
                Next::End => return Ok(integrator.state().to_vec()),
            }
        }
    }

    /// Harmonic oscillator over two periods: the error at the end and the largest error between.
    fn oscillate(solver: Solver) -> (f64, f64) {
        let mut largest = 0.0_f64;
        let slope = |y: &[f64], dy: &mut [f64]| (dy[0], dy[1]) = (y[1], -y[0]);
        let accept = |mut step: StepView<'_>| {
            for part in [0.25, 0.5, 0.75, 1.0] {
                let t = step.start_s + part * (step.end_s - step.start_s);
                largest = largest.max((step.at(t)[0] - t.cos()).abs());
            }
        };
        let y = integrate(solver, &[1.0, 0.0], 4.0 * std::f64::consts::PI, slope, accept).unwrap();
        ((y[0] - 1.0).abs().max(y[1].abs()), largest)
    }

    #[test]
    fn fixed_steps_converge_with_the_fifth_order_and_the_interpolant_with_the_fourth() {
        let run = |step_s| oscillate(Solver::Fixed { step_s });
        let (coarse, fine) = (run(0.1), run(0.05));
        let order = (coarse.0 / fine.0).log2();
        let dense_order = (coarse.1 / fine.1).log2();
        assert!((4.8..6.2).contains(&order), "order {order}");
        assert!(dense_order > 3.8, "order of the interpolant {dense_order}");
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        for tolerance in [1e-4, 1e-7, 1e-10] {
            let (end, dense) =
                oscillate(Solver::Adaptive { relative_tolerance: tolerance, absolute_tolerance: tolerance });
            assert!(end.max(dense) < 20.0 * tolerance, "{tolerance:e}: {end:e} {dense:e}");
        }
    }

    #[test]
    fn a_step_that_vanishes_is_reported_with_its_time() {
        let result = integrate(Solver::ODE45, &[1.0], 2.0, |y, dy| dy[0] = y[0] * y[0], |_| {});
        assert!(matches!(result, Err(StepTooSmall(t)) if (t - 1.0).abs() < 0.01), "{result:?}");
    }
}
