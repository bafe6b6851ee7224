//! The explicit Runge-Kutta pair of Dormand and Prince, orders 5 and 4, with the step control of MATLAB's `ode45` and
//! the quartic interpolant of Shampine (1986).
//!
//! J. R. Dormand, P. J. Prince, "A family of embedded Runge-Kutta formulae", 1980; L. F. Shampine, M. W. Reichelt, "The
//! MATLAB ODE suite", 1997.

use super::{
    solver::WorkCounts,
    step_control::{AcceptedStep, Next, Sizes, StepControl, StepTooSmall, StepView, Verdict},
};

/// Times of the stages, as parts of the step.
pub(super) const C: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// Weights of the slopes before, in the state of each stage; the last is the step itself.
pub(super) const A: [&[f64]; 7] = [
    &[],
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the fifth-order formula less the weights of the fourth-order formula.
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
/// The integration of `dy/dt = f(t, y)` over consecutive intervals, with preallocated scratch: nothing is allocated while it runs.
///
/// It does not call f but requests its values from the caller, so that several integrations can be interleaved:
///
/// ```
/// use thetahat_estimation::simulation::{DormandPrince, Next};
///
/// let mut integrator = DormandPrince::adaptive(1e-3, 1e-6, vec![1.0]);
/// integrator.begin(0.0, 1.0);
/// loop {
///     match integrator.proceed()? {
///         Next::Slope => {
///             let (_, y, slope) = integrator.wanted();
///             slope[0] = -y[0];
///         }
///         Next::Step(_) | Next::Linearisation => {}
///         Next::End => break,
///     }
/// }
/// assert!((integrator.state()[0] - (-1.0_f64).exp()).abs() < 1e-3);
/// # Ok::<(), thetahat_estimation::simulation::StepTooSmall>(())
/// ```
#[derive(Debug, Clone)]
pub struct DormandPrince {
    control: StepControl,
    stages: [Vec<f64>; 7],
    state: Vec<f64>,
    trial: Vec<f64>,
    dense: Vec<f64>,
    phase: Phase,
}

/// The phase of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Between two intervals.
    Idle,
    /// An interval is begun.
    Begun,
    /// The slope of this stage is requested.
    Stage(usize),
    /// A step is accepted; the value is the next size to try.
    Accepted(f64),
}

impl DormandPrince {
    /// An integrator at an initial state, with steps chosen by the error estimate against tolerances relative to the
    /// state, and absolute where the state is near zero.
    #[must_use]
    pub fn adaptive(relative_tolerance: f64, absolute_tolerance: f64, state: Vec<f64>) -> Self {
        Self::new(Sizes::Adaptive { relative: relative_tolerance, absolute: absolute_tolerance }, state)
    }

    /// An integrator at an initial state, with equal steps of the fifth-order formula.
    #[must_use]
    pub fn fixed(step_s: f64, state: Vec<f64>) -> Self {
        Self::new(Sizes::Fixed(step_s), state)
    }

    fn new(sizes: Sizes, state: Vec<f64>) -> Self {
        let zeros = || vec![0.0; state.len()];
        Self {
            control: StepControl::new(sizes, 0.2),
            stages: std::array::from_fn(|_| zeros()),
            trial: zeros(),
            dense: zeros(),
            phase: Phase::Idle,
            state,
        }
    }

    /// The work done so far.
    #[must_use]
    pub fn counts(&self) -> WorkCounts {
        self.control.counts
    }

    /// The state at the last accepted step.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// The stage of the requested slope.
    pub(super) fn stage(&self) -> usize {
        if let Phase::Stage(stage) = self.phase { stage } else { 0 }
    }

    /// The step just accepted, until [`Self::proceed`].
    pub(super) fn accepted(&self) -> AcceptedStep<'_> {
        let StepControl { time: start_s, step, .. } = self.control;
        AcceptedStep { start_s, step, from: &self.state, slopes: &self.stages, interpolant: &P }
    }

    /// Begins the interval from `t0` to `t1`, at the current state.
    pub fn begin(&mut self, t0: f64, t1: f64) {
        self.control.begin(t0, t1);
        self.phase = Phase::Begun;
        self.trial.copy_from_slice(&self.state);
    }

    /// The time and the state of the requested slope, and where to write it.
    pub fn wanted(&mut self) -> (f64, &[f64], &mut [f64]) {
        let stage = if let Phase::Stage(s) = self.phase { s } else { 0 };
        let StepControl { time, step, .. } = self.control;
        let time = if stage == 0 { time } else { time + C[stage] * step };
        (time, &self.trial, &mut self.stages[stage])
    }

    /// Advances to the next requested slope, accepted step, or the end of the interval.
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
                self.control.counts.evaluations += 1;
                let step = self.control.first_step(&self.state, &self.stages[0]);
                Ok(self.try_step(step))
            }
            Phase::Stage(6) => {
                self.control.counts.evaluations += 6;
                self.judge()
            }
            Phase::Stage(s) => Ok(self.place_stage(s + 1)),
            Phase::Accepted(next) => {
                let planned = self.control.pass(next);
                self.state.copy_from_slice(&self.trial);
                self.stages.swap(0, 6);
                Ok(self.try_step(planned))
            }
        }
    }

    /// Tries a step of at most this size, or ends the interval.
    fn try_step(&mut self, planned: f64) -> Next<'_> {
        if self.control.set_step(planned) {
            return self.place_stage(1);
        }
        self.phase = Phase::Idle;
        Next::End
    }

    /// Leaves the state of a stage in `trial`.
    fn place_stage(&mut self, stage: usize) -> Next<'_> {
        self.trial.copy_from_slice(&self.state);
        let step = self.control.step;
        for (slope, a) in self.stages.iter().zip(A[stage]) {
            self.trial.iter_mut().zip(slope).for_each(|(y, k)| *y += step * a * k);
        }
        self.phase = Phase::Stage(stage);
        Next::Slope
    }

    /// Accepts the step of which all stages are known, or tries a shorter one.
    fn judge(&mut self) -> Result<Next<'_>, StepTooSmall> {
        let Self { control, stages, state, trial, .. } = self;
        let step = control.step;
        let errors = (0..state.len()).map(|i| {
            let difference: f64 = E.iter().zip(&*stages).map(|(e, k)| e * k[i]).sum();
            [step * difference.abs(), state[i].abs().max(trial[i].abs())]
        });
        match control.judge(errors)? {
            Verdict::Accept(next) => Ok(self.accept(next)),
            Verdict::Repeat => Ok(self.place_stage(1)),
        }
    }

    fn accept(&mut self, next: f64) -> Next<'_> {
        self.phase = Phase::Accepted(next);
        Next::Step(StepView {
            start_s: self.control.time,
            end_s: self.control.step_end(),
            step: self.control.step,
            from: &self.state,
            slopes: &self.stages,
            interpolant: &P,
            out: &mut self.dense,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates to `end`; `accept` sees every step.
    fn integrate(
        mut integrator: DormandPrince,
        end: f64,
        slope: impl Fn(&[f64], &mut [f64]),
        mut accept: impl FnMut(StepView<'_>),
    ) -> Result<Vec<f64>, StepTooSmall> {
        integrator.begin(0.0, end);
        loop {
            match integrator.proceed()? {
                Next::Slope => {
                    let (_, y, dy) = integrator.wanted();
                    slope(y, dy);
                }
                Next::Step(step) => accept(step),
                Next::Linearisation => {}
                Next::End => return Ok(integrator.state().to_vec()),
            }
        }
    }

    /// Harmonic oscillator over two periods: the error at the end and the largest error between.
    fn oscillate(new: impl Fn(Vec<f64>) -> DormandPrince) -> (f64, f64) {
        let mut largest = 0.0_f64;
        let slope = |y: &[f64], dy: &mut [f64]| (dy[0], dy[1]) = (y[1], -y[0]);
        let accept = |mut step: StepView<'_>| {
            for part in [0.25, 0.5, 0.75, 1.0] {
                let t = step.start_s + part * (step.end_s - step.start_s);
                largest = largest.max((step.at(t)[0] - t.cos()).abs());
            }
        };
        let y = integrate(new(vec![1.0, 0.0]), 4.0 * std::f64::consts::PI, slope, accept).unwrap();
        ((y[0] - 1.0).abs().max(y[1].abs()), largest)
    }

    /// A slope of time alone, `t^4`: integrated exactly by a fifth-order formula whose stages are at the right times.
    #[test]
    fn stages_are_at_their_times() {
        let mut integrator = DormandPrince::fixed(0.5, vec![0.0]);
        integrator.begin(1.0, 3.0);
        loop {
            match integrator.proceed().unwrap() {
                Next::Slope => {
                    let (t, _, dy) = integrator.wanted();
                    dy[0] = t.powi(4);
                }
                Next::Step(_) | Next::Linearisation => {}
                Next::End => break,
            }
        }
        assert!((integrator.state()[0] - (3.0_f64.powi(5) - 1.0) / 5.0).abs() < 1e-12);
        for (c, weights) in C.iter().zip(A) {
            assert!((weights.iter().sum::<f64>() - c).abs() < 1e-14, "the stage at {c}");
        }
    }

    #[test]
    fn fixed_steps_converge_with_the_fifth_order_and_the_interpolant_with_the_fourth() {
        let run = |step_s| oscillate(|start| DormandPrince::fixed(step_s, start));
        let (coarse, fine) = (run(0.1), run(0.05));
        let order = (coarse.0 / fine.0).log2();
        let dense_order = (coarse.1 / fine.1).log2();
        assert!((4.8..6.2).contains(&order), "order {order}");
        assert!(dense_order > 3.8, "order of the interpolant {dense_order}");
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        for tolerance in [1e-4, 1e-7, 1e-10] {
            let (end, dense) = oscillate(|start| DormandPrince::adaptive(tolerance, tolerance, start));
            assert!(end.max(dense) < 20.0 * tolerance, "{tolerance:e}: {end:e} {dense:e}");
        }
    }

    #[test]
    fn a_step_that_vanishes_is_reported_with_its_time() {
        let result =
            integrate(DormandPrince::adaptive(1e-3, 1e-6, vec![1.0]), 2.0, |y, dy| dy[0] = y[0] * y[0], |_| {});
        assert!(matches!(result, Err(StepTooSmall(t)) if (t - 1.0).abs() < 0.01), "{result:?}");
    }
}
