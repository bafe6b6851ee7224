//! Shared by all methods of integration: tolerances, step sizes, and the interpolant of an accepted step.

use super::solver::WorkCounts;

/// The step required by the tolerance is below the spacing of numbers at this time, in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepTooSmall(pub f64);

/// The next request or event of an integration.
#[derive(Debug)]
pub enum Next<'a> {
    /// The slope at the requested state is to be written.
    Slope,
    /// The right-hand side is to be linearised at the start of the step; only [`super::RosenbrockW`] requests it.
    Linearisation,
    /// A step is accepted.
    Step(StepView<'a>),
    /// The end of the interval is reached: begin another one, or stop.
    End,
}

/// How a step's size follows from the error estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sizes {
    /// Steps chosen so that the error stays below the tolerance.
    Adaptive {
        /// Tolerance relative to the state.
        relative: f64,
        /// Tolerance where the state is near zero.
        absolute: f64,
    },
    /// Equal steps in s.
    Fixed(f64),
}

/// Largest step as a fraction of the interval, as in `ode45`.
const LARGEST_STEP: f64 = 0.1;

/// The sizes of steps from interval to interval, by the rules of MATLAB's `ode45`.
#[derive(Debug, Clone)]
pub(super) struct StepControl {
    sizes: Sizes,
    /// One over the order of the error estimate.
    exponent: f64,
    /// Start of the step.
    pub(super) time: f64,
    end: f64,
    /// The size of the step that is tried.
    pub(super) step: f64,
    /// The size without the end of the interval.
    planned: f64,
    /// Whether the step is to reach the end of the interval.
    last: bool,
    /// Whether the step's error was too large, so that it was cut.
    failed: bool,
    next_step: Option<f64>,
    pub(super) counts: WorkCounts,
}

/// The decision on a step whose error is known.
pub(super) enum Verdict {
    /// Accept it and try this size next.
    Accept(f64),
    /// Try again with the size that is set.
    Repeat,
}

impl StepControl {
    pub(super) fn new(sizes: Sizes, exponent: f64) -> Self {
        Self {
            sizes,
            exponent,
            time: 0.0,
            end: 0.0,
            step: 0.0,
            planned: 0.0,
            last: false,
            failed: false,
            next_step: None,
            counts: WorkCounts::default(),
        }
    }

    /// Begins the interval from `t0` to `t1`.
    pub(super) fn begin(&mut self, t0: f64, t1: f64) {
        (self.time, self.end) = (t0, t1);
    }

    /// Sets a step of at most this size; false at the end of the interval.
    pub(super) fn set_step(&mut self, planned: f64) -> bool {
        if self.time >= self.end {
            self.next_step = Some(planned);
            return false;
        }
        let last = self.time + 1.000_001 * planned >= self.end;
        self.step = if last { self.end - self.time } else { planned };
        (self.planned, self.last, self.failed) = (planned, last, false);
        true
    }

    /// Advances to the end of the accepted step and returns the next planned size: a step cut short by the end of the interval does not
    /// limit the next one.
    pub(super) fn pass(&mut self, next: f64) -> f64 {
        let reached = self.reaches_end();
        self.time = self.step_end();
        if reached { next.max(self.planned) } else { next }
    }

    /// Advances to the end of the accepted step, and plans the next one, whose first slope is not known yet; false at the end of the
    /// interval.
    pub(super) fn pass_and_plan(&mut self, next: f64) -> bool {
        self.next_step = Some(self.pass(next));
        self.time < self.end
    }

    /// Accepts the step by the error and the size of each component, or sets a shorter one.
    pub(super) fn judge(&mut self, errors: impl Iterator<Item = [f64; 2]>) -> Result<Verdict, StepTooSmall> {
        let Sizes::Adaptive { relative, absolute } = self.sizes else {
            self.counts.steps += 1;
            return Ok(Verdict::Accept(self.step));
        };
        let threshold = absolute / relative;
        let each = errors.map(|[error, size]| error / size.max(threshold));
        let error =
            each.fold(0.0_f64, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { f64::max(a, b) }) / relative;
        if error <= 1.0 {
            let factor = if self.failed { 1.0 } else { 1.0 / (1.25 * error.powf(self.exponent)).max(0.2) };
            self.counts.steps += 1;
            return Ok(Verdict::Accept(self.step * factor));
        }
        let halve = self.failed || !error.is_finite();
        self.cut(if halve { 0.5 } else { (0.8 * error.powf(-self.exponent)).max(0.1) })?;
        Ok(Verdict::Repeat)
    }

    /// Cuts the current step.
    pub(super) fn cut(&mut self, factor: f64) -> Result<(), StepTooSmall> {
        self.counts.rejected += 1;
        (self.step, self.failed) = (self.step * factor, true);
        let smallest = 16.0 * f64::EPSILON * self.time.abs().max(1e-6);
        if self.step < smallest { Err(StepTooSmall(self.time)) } else { Ok(()) }
    }

    fn reaches_end(&self) -> bool {
        self.last && !self.failed
    }

    /// The end of the current step.
    pub(super) fn step_end(&self) -> f64 {
        if self.reaches_end() { self.end } else { self.time + self.step }
    }

    /// The first step of an interval, from the slope at its start.
    pub(super) fn first_step(&self, state: &[f64], slope: &[f64]) -> f64 {
        match (self.sizes, self.next_step) {
            (Sizes::Fixed(step), _) => step,
            (Sizes::Adaptive { .. }, Some(step)) => step,
            (Sizes::Adaptive { relative, absolute }, None) => {
                let threshold = absolute / relative;
                let rate = state.iter().zip(slope).map(|(y, k)| k.abs() / y.abs().max(threshold));
                let limit = rate.fold(0.0, f64::max) / (0.8 * relative.powf(self.exponent));
                let largest = LARGEST_STEP * (self.end - self.time);
                if largest * limit > 1.0 { 1.0 / limit } else { largest }
            }
        }
    }
}

/// An accepted step and its interpolant.
#[derive(Debug)]
pub struct StepView<'a> {
    /// Time at the start.
    pub start_s: f64,
    /// Time at the end.
    pub end_s: f64,
    pub(super) step: f64,
    pub(super) from: &'a [f64],
    pub(super) slopes: &'a [Vec<f64>],
    /// For each slope the coefficients of s, s^2, s^3, s^4 at the fraction s of the step.
    pub(super) interpolant: &'static [[f64; 4]],
    pub(super) out: &'a mut [f64],
}

impl StepView<'_> {
    /// The state at a time within the step: to fourth order for Dormand-Prince, to second for a linearly implicit method.
    pub fn at(&mut self, t: f64) -> &[f64] {
        let weights = slope_weights(self.interpolant, self.step, (t - self.start_s) / self.step);
        for (i, out) in self.out.iter_mut().enumerate() {
            *out = self.from[i] + weights.iter().zip(self.slopes).map(|(w, k)| w * k[i]).sum::<f64>();
        }
        self.out
    }
}

/// The weights of a step's slopes in the state at the fraction `s` of a step, relative to the state at the start.
pub(super) fn slope_weights(interpolant: &[[f64; 4]], step: f64, s: f64) -> [f64; 7] {
    let weight = |p: &[f64; 4]| step * s * (p[0] + s * (p[1] + s * (p[2] + s * p[3])));
    let mut weights = [0.0; 7];
    weights.iter_mut().zip(interpolant).for_each(|(w, p)| *w = weight(p));
    weights
}

/// The step that an integration has just accepted.
#[derive(Debug, Clone, Copy)]
pub(super) struct AcceptedStep<'a> {
    /// Time at the start.
    pub(super) start_s: f64,
    /// Its size.
    pub(super) step: f64,
    /// The state where it starts.
    pub(super) from: &'a [f64],
    /// The slope of each stage.
    pub(super) slopes: &'a [Vec<f64>],
    /// As in [`StepView`].
    pub(super) interpolant: &'static [[f64; 4]],
}
