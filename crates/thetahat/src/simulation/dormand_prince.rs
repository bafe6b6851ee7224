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

/// Why an integration stops early.
#[derive(Debug, Clone, PartialEq)]
pub enum IntegrationError<E> {
    /// The system has no slope or refuses a step.
    Stopped(E),
    /// The step that the tolerance asks for is below the spacing of numbers at this time, in s.
    StepTooSmall(f64),
}

/// What is integrated: `dy/dt = f(t, y)`, and what becomes of each accepted step.
pub trait System {
    /// Why it can stop.
    type Error;

    /// Writes the slope `f(t, y)` to `dy`.
    ///
    /// # Errors
    /// Where there is none.
    fn slope(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Self::Error>;

    /// Takes note of an accepted step.
    ///
    /// # Errors
    /// To stop the integration.
    fn accept(&mut self, step: &mut StepView<'_>) -> Result<(), Self::Error>;
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

/// The integrator with its scratch: nothing is allocated while it runs.
#[derive(Debug, Clone)]
pub struct Integrator {
    solver: Solver,
    stages: [Vec<f64>; 7],
    trial: Vec<f64>,
    dense: Vec<f64>,
    next_step: Option<f64>,
    counts: WorkCounts,
}

impl Integrator {
    /// An integrator for `states` states.
    #[must_use]
    pub fn new(solver: Solver, states: usize) -> Self {
        Self {
            solver,
            stages: std::array::from_fn(|_| vec![0.0; states]),
            trial: vec![0.0; states],
            dense: vec![0.0; states],
            next_step: None,
            counts: WorkCounts::default(),
        }
    }

    /// The work done so far.
    #[must_use]
    pub fn counts(&self) -> WorkCounts {
        self.counts
    }

    /// Integrates a system from `t0` to `t1`, leaving the state at `t1` in `y`.
    ///
    /// # Errors
    /// [`IntegrationError`], with the time where the step vanishes.
    pub fn integrate<S: System>(
        &mut self,
        t0: f64,
        t1: f64,
        y: &mut [f64],
        system: &mut S,
    ) -> Result<(), IntegrationError<S::Error>> {
        let mut t = t0;
        system.slope(t, y, &mut self.stages[0]).map_err(IntegrationError::Stopped)?;
        self.counts.evaluations += 1;
        let mut h = self.first_step(t1 - t0, y);
        while t < t1 {
            let last = t + 1.000_001 * h >= t1;
            let asked = if last { t1 - t } else { h };
            let (taken, next) = self.step(t, asked, y, system)?;
            let reached = last && taken == asked;
            let end = if reached { t1 } else { t + taken };
            let mut view =
                StepView { start_s: t, end_s: end, step: taken, from: y, stages: &self.stages, out: &mut self.dense };
            system.accept(&mut view).map_err(IntegrationError::Stopped)?;
            y.copy_from_slice(&self.trial);
            self.stages.swap(0, 6);
            t = end;
            // A step cut short by the end of the interval does not hold back the next one.
            h = if reached { next.max(h) } else { next };
        }
        self.next_step = Some(h);
        Ok(())
    }

    /// Takes a step of at most `h` that meets the tolerance: its size and the size to try next. The new state is left in
    /// `trial`, the slope there in the last stage.
    fn step<S: System>(
        &mut self,
        t: f64,
        mut h: f64,
        y: &[f64],
        system: &mut S,
    ) -> Result<(f64, f64), IntegrationError<S::Error>> {
        let mut failed = false;
        loop {
            self.evaluate_stages(t, h, y, system).map_err(IntegrationError::Stopped)?;
            let Solver::Adaptive { relative_tolerance, absolute_tolerance } = self.solver else {
                self.counts.steps += 1;
                return Ok((h, h));
            };
            let error = self.error(h, y, absolute_tolerance / relative_tolerance) / relative_tolerance;
            if error <= 1.0 {
                self.counts.steps += 1;
                let factor = if failed { 1.0 } else { 1.0 / (1.25 * error.powf(0.2)).max(0.2) };
                return Ok((h, h * factor));
            }
            self.counts.rejected += 1;
            h *= if failed || !error.is_finite() { 0.5 } else { (0.8 * error.powf(-0.2)).max(0.1) };
            failed = true;
            if h < 16.0 * f64::EPSILON * t.abs().max(1e-6) {
                return Err(IntegrationError::StepTooSmall(t));
            }
        }
    }

    fn evaluate_stages<S: System>(&mut self, t: f64, h: f64, y: &[f64], system: &mut S) -> Result<(), S::Error> {
        for s in 1..7 {
            let (done, rest) = self.stages.split_at_mut(s);
            self.trial.copy_from_slice(y);
            for (slope, a) in done.iter().zip(A[s]) {
                self.trial.iter_mut().zip(slope).for_each(|(y, k)| *y += h * a * k);
            }
            system.slope(t + C[s] * h, &self.trial, &mut rest[0])?;
        }
        self.counts.evaluations += 6;
        Ok(())
    }

    /// Largest error of a component against its own size, or `threshold` where that is smaller.
    fn error(&self, h: f64, y: &[f64], threshold: f64) -> f64 {
        (0..y.len())
            .map(|i| {
                let difference: f64 = E.iter().zip(&self.stages).map(|(e, k)| e * k[i]).sum();
                h * difference.abs() / y[i].abs().max(self.trial[i].abs()).max(threshold)
            })
            .fold(0.0, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { f64::max(a, b) })
    }

    fn first_step(&self, interval: f64, y: &[f64]) -> f64 {
        match (self.solver, self.next_step) {
            (Solver::Fixed { step_s }, _) => step_s,
            (_, Some(step)) => step,
            (Solver::Adaptive { relative_tolerance, absolute_tolerance }, None) => {
                let threshold = absolute_tolerance / relative_tolerance;
                let rate = y.iter().zip(&self.stages[0]).map(|(y, k)| k.abs() / y.abs().max(threshold));
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

    struct Oscillator {
        largest_dense_error: f64,
    }

    impl System for Oscillator {
        type Error = std::convert::Infallible;

        fn slope(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Self::Error> {
            (dy[0], dy[1]) = (y[1], -y[0]);
            Ok(())
        }

        fn accept(&mut self, step: &mut StepView<'_>) -> Result<(), Self::Error> {
            for part in [0.25, 0.5, 0.75, 1.0] {
                let t = step.start_s + part * (step.end_s - step.start_s);
                self.largest_dense_error = self.largest_dense_error.max((step.at(t)[0] - t.cos()).abs());
            }
            Ok(())
        }
    }

    /// Harmonic oscillator over two periods: the error at the end and the largest error between.
    fn oscillate(solver: Solver) -> (f64, f64) {
        let mut y = [1.0, 0.0];
        let mut system = Oscillator { largest_dense_error: 0.0 };
        let end = 4.0 * std::f64::consts::PI;
        Integrator::new(solver, 2).integrate(0.0, end, &mut y, &mut system).unwrap();
        ((y[0] - 1.0).abs().max(y[1].abs()), system.largest_dense_error)
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

    struct Explosion;

    impl System for Explosion {
        type Error = std::convert::Infallible;

        fn slope(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Self::Error> {
            dy[0] = y[0] * y[0];
            Ok(())
        }

        fn accept(&mut self, _: &mut StepView<'_>) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    #[test]
    fn a_step_that_vanishes_is_reported_with_its_time() {
        let result = Integrator::new(Solver::ODE45, 1).integrate(0.0, 2.0, &mut [1.0], &mut Explosion);
        assert!(matches!(result, Err(IntegrationError::StepTooSmall(t)) if (t - 1.0).abs() < 0.01), "{result:?}");
    }
}
