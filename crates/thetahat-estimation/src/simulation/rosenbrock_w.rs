//! The linearly implicit method ROS34PW2 of Rang and Angermann: four stages, order 3 with an error estimate of order 2,
//! L-stable and stiffly accurate, and of the same order with any approximation of the Jacobian (a W-method).
//!
//! J. Rang, L. Angermann, "New Rosenbrock W-methods of order 3 for partial differential algebraic equations of index 1",
//! BIT Numerical Mathematics 45 (2005), 761-787. The general form is (7.4) of E. Hairer, G. Wanner, *Solving Ordinary
//! Differential Equations II*, section IV.7.
//!
//! For `dq/dt = v`, `M(q) dv/dt = tau(t, q, v) - ...` with the slopes `-K` and `-D` of the right-hand side in q and v, each
//! stage solves one system of n equations with the same matrix,
//!
//! `(M + h gamma D + (h gamma)^2 K) w = M r_v - h gamma K r_q`, and the part of the positions is `r_q + h gamma w`.

use super::{
    solver::WorkCounts,
    step_control::{AcceptedStep, Next, Sizes, StepControl, StepTooSmall, StepView, Verdict},
};
use thetahat_model::dynamics::{factorise, solve_factorised};

/// Stages of a step.
pub(super) const STAGES: usize = 4;
/// The coefficient that the stages share.
pub(super) const GAMMA: f64 = 0.435_866_521_508_459;
/// Weights of the previous slopes in the state of each stage.
pub(super) const ALPHA: [[f64; STAGES]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0],
    [0.871_733_043_016_918, 0.0, 0.0, 0.0],
    [0.844_570_600_153_694_2, -0.112_990_642_364_841_85, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];
/// Weights of the previous slopes in the linear part of each stage.
pub(super) const COUPLING: [[f64; STAGES]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0],
    [-0.871_733_043_016_918, 0.0, 0.0, 0.0],
    [-0.903_380_570_130_440_8, 0.054_180_672_388_095_33, 0.0, 0.0],
    [0.242_123_807_060_953_46, -1.223_250_583_904_514_7, 0.545_260_255_335_102_1, 0.0],
];
/// Weights of the slopes in the step.
pub(super) const B: [f64; STAGES] = [0.242_123_807_060_953_46, -1.223_250_583_904_514_7, 1.545_260_255_335_102, GAMMA];
/// Weights of the embedded formula of second order.
const EMBEDDED: [f64; STAGES] = [0.378_109_031_458_193_7, -0.096_042_292_212_423_18, 0.5, 0.217_932_605_754_229_5];
/// Coefficients of s, s^2, s^3, s^4 in the interpolant at the fraction s of a step: the weights that satisfy the conditions of
/// second order of a W-method and `sum b alpha^2 = s^3 / 3` at every s, and so are `B` at one.
const INTERPOLANT: [[f64; 4]; STAGES] = [
    [1.056_429_845_579_41, -1.386_488_269_975_96, 0.572_182_231_457_503_6, 0.0],
    [2.296_429_974_281_07, -8.262_611_700_275_69, 4.742_931_142_090_1, 0.0],
    [-1.307_599_564_525_38, 7.250_979_895_056_06, -4.398_120_075_195_58, 0.0],
    [-1.045_260_255_335_1, 2.398_120_075_195_58, -0.916_993_298_352_021, 0.0],
];

/// A mechanical system where a step starts: `M dv/dt` changes by `-K` per position, `-D` per velocity and `rate` per second.
/// Omitting parts of K, D and the rate costs accuracy in stiff systems, but not the order.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// The mass matrix M, n by n, row by row.
    pub mass: Vec<f64>,
    /// D, symmetric.
    pub damping: Vec<f64>,
    /// K, symmetric.
    pub stiffness: Vec<f64>,
    /// The derivative in time.
    pub rate: Vec<f64>,
}

/// The integration of a mechanical system, positions and velocities in one state, from interval to interval.
///
/// Like [`super::DormandPrince`] it requests slopes, and once a step a [`Linearisation`]:
///
/// ```
/// use thetahat_estimation::simulation::{Next, RosenbrockW};
///
/// // dv/dt = -1e6 (v - 1): the time constant is a microsecond.
/// let mut integrator = RosenbrockW::new(1e-3, 1e-6, vec![0.0, 0.0]);
/// integrator.begin(0.0, 1.0);
/// loop {
///     match integrator.proceed()? {
///         Next::Slope => {
///             let (_, y, slope) = integrator.wanted();
///             (slope[0], slope[1]) = (y[1], -1e6 * (y[1] - 1.0));
///         }
///         Next::Linearisation => {
///             let (_, _, _, at) = integrator.wanted_linearisation();
///             (at.mass[0], at.damping[0]) = (1.0, 1e6);
///         }
///         Next::Step(_) => {}
///         Next::End => break,
///     }
/// }
/// assert!((integrator.state()[1] - 1.0).abs() < 1e-6 && integrator.counts().steps < 100);
/// # Ok::<(), thetahat_estimation::simulation::StepTooSmall>(())
/// ```
#[derive(Debug, Clone)]
pub struct RosenbrockW {
    control: StepControl,
    /// The right-hand side where the step starts.
    start: Vec<f64>,
    /// The right-hand side of a stage, then the stage's slope.
    slopes: [Vec<f64>; STAGES],
    state: Vec<f64>,
    trial: Vec<f64>,
    dense: Vec<f64>,
    linearisation: Linearisation,
    /// The factors of `M + h gamma D + (h gamma)^2 K`.
    matrix: Vec<f64>,
    /// Scratch: the previous slopes, as weighted in a stage.
    before: Vec<f64>,
    /// Scratch: the right side of a stage.
    right: Vec<f64>,
    phase: Phase,
}

/// The phase of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Between two intervals.
    Idle,
    /// An interval is begun.
    Begun,
    /// The slope at the start of the step is requested.
    Start,
    /// The linearisation is requested.
    Linearisation,
    /// The slope of this stage is requested.
    Stage(usize),
    /// A step is accepted; the value is the next size to try.
    Accepted(f64),
}

impl RosenbrockW {
    /// An integrator at an initial state, positions before velocities, with tolerances relative to the state, and absolute
    /// where the state is near zero.
    #[must_use]
    pub fn new(relative_tolerance: f64, absolute_tolerance: f64, state: Vec<f64>) -> Self {
        Self::with_sizes(Sizes::Adaptive { relative: relative_tolerance, absolute: absolute_tolerance }, state)
    }

    fn with_sizes(sizes: Sizes, state: Vec<f64>) -> Self {
        let n = state.len() / 2;
        let [mass, damping, stiffness, matrix] = [(); 4].map(|()| vec![0.0; n * n]);
        let zeros = || vec![0.0; 2 * n];
        Self {
            control: StepControl::new(sizes, 1.0 / 3.0),
            start: zeros(),
            slopes: std::array::from_fn(|_| zeros()),
            trial: zeros(),
            dense: zeros(),
            linearisation: Linearisation { mass, damping, stiffness, rate: vec![0.0; n] },
            matrix,
            before: zeros(),
            right: vec![0.0; n],
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
        AcceptedStep { start_s, step, from: &self.state, slopes: &self.slopes, interpolant: &INTERPOLANT }
    }

    /// The linearisation of the accepted step, and the factors of its `M + h gamma D + (h gamma)^2 K`.
    pub(super) fn solved(&self) -> (&Linearisation, &[f64]) {
        (&self.linearisation, &self.matrix)
    }

    /// Begins the interval from `t0` to `t1`, at the current state.
    pub fn begin(&mut self, t0: f64, t1: f64) {
        self.control.begin(t0, t1);
        self.phase = Phase::Begun;
        self.trial.copy_from_slice(&self.state);
    }

    /// The time and the state of the requested slope, and where to write it.
    pub fn wanted(&mut self) -> (f64, &[f64], &mut [f64]) {
        let StepControl { time, step, .. } = self.control;
        match self.phase {
            Phase::Stage(stage) => {
                let time = time + ALPHA[stage].iter().sum::<f64>() * step;
                (time, &self.trial, &mut self.slopes[stage])
            }
            Phase::Idle | Phase::Begun | Phase::Start | Phase::Linearisation | Phase::Accepted(_) => {
                (time, &self.state, &mut self.start)
            }
        }
    }

    /// Whether the requested slope is that at the start of a step, whose mass matrix the linearisation needs.
    #[must_use]
    pub fn is_at_start(&self) -> bool {
        self.phase == Phase::Start
    }

    /// The time, the state and the step size at which the linearisation is requested, and where to write it.
    pub fn wanted_linearisation(&mut self) -> (f64, &[f64], f64, &mut Linearisation) {
        (self.control.time, &self.state, self.control.step, &mut self.linearisation)
    }

    /// Advances to the next request, an accepted step, or the end of the interval.
    ///
    /// # Errors
    /// [`StepTooSmall`] with the time where the step vanishes.
    pub fn proceed(&mut self) -> Result<Next<'_>, StepTooSmall> {
        match self.phase {
            Phase::Idle => Ok(Next::End),
            Phase::Begun => Ok(self.ask(Phase::Start)),
            Phase::Start => {
                self.control.counts.evaluations += 1;
                let planned = self.control.first_step(&self.state, &self.start);
                Ok(if self.control.set_step(planned) { self.ask_linearisation() } else { self.end() })
            }
            Phase::Linearisation => self.begin_stages(),
            Phase::Stage(stage) => {
                self.control.counts.evaluations += 1;
                self.solve_stage(stage);
                if stage + 1 < STAGES { Ok(self.place_stage(stage + 1)) } else { self.judge() }
            }
            Phase::Accepted(next) => {
                self.state.copy_from_slice(&self.trial);
                let goes_on = self.control.pass_and_plan(next);
                Ok(if goes_on { self.ask(Phase::Start) } else { self.end() })
            }
        }
    }

    fn ask(&mut self, phase: Phase) -> Next<'_> {
        self.phase = phase;
        Next::Slope
    }

    fn ask_linearisation(&mut self) -> Next<'_> {
        self.phase = Phase::Linearisation;
        Next::Linearisation
    }

    fn end(&mut self) -> Next<'_> {
        self.phase = Phase::Idle;
        Next::End
    }

    /// Factorises the matrix of the stages, cutting the step until that succeeds, and solves the first stage.
    fn begin_stages(&mut self) -> Result<Next<'_>, StepTooSmall> {
        let scaled = self.control.step * GAMMA;
        let Linearisation { mass, damping, stiffness, rate } = &self.linearisation;
        for (entry, (m, (d, k))) in self.matrix.iter_mut().zip(mass.iter().zip(damping.iter().zip(stiffness))) {
            *entry = m + scaled * (d + scaled * k);
        }
        if factorise(&mut self.matrix, rate.len()).is_err() {
            // Friction with negative damping: in a small enough step the mass dominates.
            self.control.cut(0.5)?;
            return Ok(self.ask_linearisation());
        }
        self.slopes[0].copy_from_slice(&self.start);
        self.solve_stage(0);
        Ok(self.place_stage(1))
    }

    /// Writes the state of a stage to `trial`.
    fn place_stage(&mut self, stage: usize) -> Next<'_> {
        self.move_trial(&ALPHA[stage]);
        self.ask(Phase::Stage(stage))
    }

    /// `trial = state + h sum weights slopes`.
    fn move_trial(&mut self, weights: &[f64; STAGES]) {
        self.trial.copy_from_slice(&self.state);
        for (slope, weight) in self.slopes.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let factor = self.control.step * weight;
            self.trial.iter_mut().zip(slope).for_each(|(y, k)| *y += factor * k);
        }
    }

    /// Turns the right-hand side of a stage into its slope `k`: `(1 - h gamma J) (k + g) = f + g + h gamma_i df/dt` with
    /// `g = sum_j (gamma_ij / gamma) k_j`.
    fn solve_stage(&mut self, stage: usize) {
        let n = self.right.len();
        let step = self.control.step;
        let scaled = step * GAMMA;
        self.before.fill(0.0);
        let (earlier, rest) = self.slopes.split_at_mut(stage);
        for (slope, weight) in earlier.iter().zip(&COUPLING[stage]) {
            self.before.iter_mut().zip(slope).for_each(|(g, k)| *g += weight / GAMMA * k);
        }
        let Some(slope) = rest.first_mut() else { return };
        slope.iter_mut().zip(&self.before).for_each(|(f, g)| *f += g);
        let in_time = step * (GAMMA + COUPLING[stage].iter().sum::<f64>());
        let (of_positions, of_velocities) = slope.split_at_mut(n);
        let Linearisation { mass, stiffness, rate, .. } = &self.linearisation;
        for (i, right) in self.right.iter_mut().enumerate() {
            let row = i * n..(i + 1) * n;
            let inertial = product(&mass[row.clone()], of_velocities);
            *right = inertial + in_time * rate[i] - scaled * product(&stiffness[row], of_positions);
        }
        solve_factorised(&self.matrix, &mut self.right);
        let (positions_before, velocities_before) = self.before.split_at(n);
        for i in 0..n {
            of_positions[i] += scaled * self.right[i] - positions_before[i];
            of_velocities[i] = self.right[i] - velocities_before[i];
        }
    }

    /// Accepts the step once all its stages are known, or tries a shorter one.
    fn judge(&mut self) -> Result<Next<'_>, StepTooSmall> {
        self.move_trial(&B);
        let Self { control, slopes, state, trial, .. } = self;
        let step = control.step;
        let errors = (0..state.len()).map(|i| {
            let weights = B.iter().zip(&EMBEDDED);
            let difference: f64 = weights.zip(&*slopes).map(|((b, embedded), k)| (b - embedded) * k[i]).sum();
            [step * difference.abs(), state[i].abs().max(trial[i].abs())]
        });
        match control.judge(errors)? {
            Verdict::Accept(next) => Ok(self.accept(next)),
            Verdict::Repeat => Ok(self.ask_linearisation()),
        }
    }

    fn accept(&mut self, next: f64) -> Next<'_> {
        self.phase = Phase::Accepted(next);
        Next::Step(StepView {
            start_s: self.control.time,
            end_s: self.control.step_end(),
            step: self.control.step,
            from: &self.state,
            slopes: &self.slopes,
            interpolant: &INTERPOLANT,
            out: &mut self.dense,
        })
    }
}

fn product(row: &[f64], x: &[f64]) -> f64 {
    row.iter().zip(x).map(|(a, x)| a * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pendulum with friction; the method sees the fraction `known` of its damping and stiffness.
    struct Pendulum {
        friction: f64,
        scale: f64,
        torque: fn(f64) -> f64,
        known: f64,
    }

    impl Pendulum {
        fn integrate(&self, mut method: RosenbrockW, end: f64, mut accept: impl FnMut(StepView<'_>)) -> RosenbrockW {
            method.begin(0.0, end);
            loop {
                match method.proceed().unwrap() {
                    Next::Slope => {
                        let (t, y, slope) = method.wanted();
                        let (position, velocity) = (y[0], y[1]);
                        let friction = self.friction * (velocity / self.scale).tanh();
                        (slope[0], slope[1]) = (velocity, (self.torque)(t) - position.sin() - friction);
                    }
                    Next::Linearisation => {
                        let (_, y, _, at) = method.wanted_linearisation();
                        let slope = self.friction / self.scale / (y[1] / self.scale).cosh().powi(2);
                        (at.mass[0], at.damping[0], at.stiffness[0]) =
                            (1.0, self.known * slope, self.known * y[0].cos());
                    }
                    Next::Step(step) => accept(step),
                    Next::End => return method,
                }
            }
        }

        fn end(&self, sizes: Sizes) -> (Vec<f64>, Vec<f64>) {
            let mut halfway = Vec::new();
            let method = RosenbrockW::with_sizes(sizes, vec![1.0, 0.5]);
            let method = self.integrate(method, 4.0, |mut step| {
                if (step.start_s..step.end_s).contains(&2.003) {
                    halfway = step.at(2.003).to_vec();
                }
            });
            (method.state().to_vec(), halfway)
        }
    }

    fn distance(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Order 3 with the Jacobian exact, 30 % off and omitted, and without the derivative in time; the interpolant is of second order, so
    /// that its error falls by a factor of eight per halving.
    #[test]
    fn the_order_does_not_depend_on_the_jacobian() {
        for known in [1.0, 0.7, 0.0] {
            let pendulum = Pendulum { friction: 0.4, scale: 0.8, torque: |t| (3.0 * t).cos(), known };
            let exact = pendulum.end(Sizes::Fixed(1e-4));
            let [coarse, fine] = [0.02, 0.01].map(|step| pendulum.end(Sizes::Fixed(step)));
            let order = (distance(&coarse.0, &exact.0) / distance(&fine.0, &exact.0)).log2();
            assert!((2.8..3.4).contains(&order), "known {known}: order {order}");
            assert!(distance(&fine.1, &exact.1) < 1e-5, "known {known}: {}", distance(&fine.1, &exact.1));
        }
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        let pendulum = Pendulum { friction: 0.4, scale: 0.1, torque: |t| (3.0 * t).cos(), known: 1.0 };
        let exact = pendulum.end(Sizes::Fixed(2e-4));
        for tolerance in [1e-3, 1e-5, 1e-7] {
            let found = pendulum.end(Sizes::Adaptive { relative: tolerance, absolute: tolerance });
            let error = distance(&found.0, &exact.0).max(distance(&found.1, &exact.1));
            assert!(error < 30.0 * tolerance, "{tolerance:e}: {error:e}");
        }
    }

    /// `v^2 / 2 - cos q` stays within the tolerance of where it was, over twenty seconds without friction.
    #[test]
    fn energy_is_kept() {
        let pendulum = Pendulum { friction: 0.0, scale: 1.0, torque: |_| 0.0, known: 1.0 };
        let energy = |y: &[f64]| 0.5 * y[1] * y[1] - y[0].cos();
        let start = vec![1.2, 0.0];
        let method = pendulum.integrate(RosenbrockW::new(1e-8, 1e-10, start.clone()), 20.0, |_| {});
        assert!((energy(method.state()) - energy(&start)).abs() < 1e-6);
    }

    /// Negative damping makes `M + h gamma D` indefinite: the step is cut until it is definite.
    #[test]
    fn friction_that_drives_is_integrated_with_small_steps() {
        let pendulum = Pendulum { friction: -5.0, scale: 0.01, torque: |_| 0.0, known: 1.0 };
        let method = pendulum.integrate(RosenbrockW::new(1e-5, 1e-8, vec![0.0, 1e-4]), 0.5, |_| {});
        assert!(method.state()[1] > 1.0 && method.counts().steps < 2000);
    }
}
