use crate::design::{
    limits::{clearances::Clearances, constraints::Constraints, loads::Loads},
    motions::{
        family::{MotionPoint, Motions},
        sums::{Derivatives, Slopes},
    },
    search::{criterion::Criterion, information::Information},
};
use thetahat_ground::{
    linear_algebra::{Matrix, dot},
    quadratic_program,
    series::Series,
};
use thetahat_model::dynamics::Sign;

/// What is optimised: the criterion of motions, within limits.
#[derive(Debug, Clone)]
pub(in crate::design) struct Problem {
    pub(in crate::design) information: Information,
    pub(in crate::design) criterion: Criterion,
    /// Motions at the instants over which the information is summed.
    pub(in crate::design) summed: Motions,
    /// Motions at the instants where limits are checked.
    pub(in crate::design) watched: Motions,
    /// Samples per second of the recording.
    pub(in crate::design) sample_rate_hz: f64,
    pub(in crate::design) constraints: Constraints,
    pub(in crate::design) loads: Loads,
    /// Least distances between shapes.
    pub(in crate::design) clearances: Option<Clearances>,
}

/// The motion that an optimisation ends at.
#[derive(Debug, Clone)]
pub(in crate::design) struct OptimiserResult {
    pub(in crate::design) x: Vec<f64>,
    pub(in crate::design) steps: usize,
}

/// Steps of one start with one smoothing of the sign.
const MOST_STEPS: usize = 120;
/// Another step follows as long as the predicted gain exceeds this, nats, whatever the step gained.
const LEAST_PREDICTED_GAIN: f64 = 1.0;
/// What a violation of torque or power costs, in nats for all of the limit.
const PRICE: f64 = 1e3;
/// Part of the predicted gain that a step must bring.
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a step.
const MOST_HALVINGS: usize = 12;
/// Rounds in which limits are added that a step would violate.
const MOST_ROUNDS: usize = 4;

/// The state of the descent.
struct State {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    watched: Watched,
}

/// A motion at the instants where limits are checked.
struct Watched {
    motion: Derivatives,
    /// Its torques for every possible robot, if loads are limited.
    torques: Vec<Series>,
    /// The largest use of a limit that may be violated on the way.
    soft_use: f64,
}

impl State {
    /// What is minimised: the criterion plus the price of the largest violation.
    fn merit(&self) -> f64 {
        self.value + price(self.watched.soft_use)
    }
}

impl Problem {
    /// The criterion of a motion; `None` if a parameter is not identifiable from it.
    pub(in crate::design) fn value(&self, x: &[f64], sign: Sign) -> Option<f64> {
        let [q, dq, ddq, _] = self.summed.at(x);
        self.criterion.value(&self.information.of_shares([&q, &dq, &ddq], &self.shares(x), sign))
    }

    /// The criterion with its derivatives by the unknowns.
    pub(in crate::design) fn value_and_gradient(&self, x: &[f64], sign: Sign) -> Option<(f64, Vec<f64>)> {
        let [q, dq, ddq, _] = self.summed.at(x);
        let found = self.information.criterion_and_slopes(&self.criterion, [&q, &dq, &ddq], &self.shares(x), sign)?;
        let by_seconds = found.by_share.iter().map(|slope| slope * self.sample_rate_hz).collect();
        Some((found.value, self.summed.chain(x, &Slopes { by_motion: found.by_motion, by_seconds })))
    }

    /// Samples of the recording for each instant.
    fn shares(&self, x: &[f64]) -> Vec<f64> {
        self.summed.seconds(x).iter().map(|seconds| seconds * self.sample_rate_hz).collect()
    }

    /// The motion at the instants where limits are checked. Limits that may be violated on the way are those of torque, power and distances, and all
    /// where motions are not linear.
    fn watch(&self, x: &[f64], sign: Sign) -> Watched {
        let motion = self.watched.at(x);
        let torques = self.loads.limited_torques(&motion, self.sign_of_loads(sign));
        let of_loads = self.loads.use_of(&motion, &torques);
        let soft_use = of_loads.max(self.clearance_use(&motion));
        let soft_use = if self.watched.is_linear() { soft_use } else { soft_use.max(self.constraints.use_of(&motion)) };
        Watched { motion, torques, soft_use }
    }

    /// The criterion of a motion plus the price of violated limits.
    pub(in crate::design) fn merit(&self, x: &[f64], sign: Sign) -> Option<f64> {
        Some(self.value(x, sign)? + price(self.watch(x, sign).soft_use))
    }

    /// Makes the limits that may be violated on the way tighter by a part, those of velocities as well where `of_all`, and distances larger by
    /// some, m.
    pub(in crate::design) fn tighten(&mut self, part: f64, distance: f64, of_all: bool) {
        self.loads.tighten(part);
        if of_all || !self.watched.is_linear() {
            self.constraints.tighten(part);
        }
        if let Some(clearances) = &mut self.clearances {
            clearances.margin += distance;
        }
    }

    /// The sign of velocities in torques: within a move it does not change, and dry friction is whole from its beginning.
    fn sign_of_loads(&self, sign: Sign) -> Sign {
        if self.watched.is_linear() { sign } else { Sign::Exact }
    }

    /// The use of distances alone: above one where shapes are too near to one another.
    pub(in crate::design) fn clearance_use(&self, motion: &Derivatives) -> f64 {
        self.clearances.as_ref().map_or(0.0, |clearances| clearances.use_of(motion))
    }

    fn state(&self, x: Vec<f64>, watched: Watched, sign: Sign) -> Option<State> {
        let (value, gradient) = self.value_and_gradient(&x, sign)?;
        Some(State { x, value, gradient, watched })
    }

    /// Sequential quadratic programming from a motion within its limits (J. Nocedal, S. Wright, "Numerical Optimization", 2006,
    /// chapter 18): damped BFGS, a line search, and the limits near which the motion comes.
    ///
    /// Limits of positions and their derivatives are linear in the unknowns of sums and hold in every step; those of moves and
    /// those of torque and power are linearised and may be violated on the way. A step that gains less than `least_gain`, in nats, is the
    /// last. `None` if a parameter is not identifiable from the motion.
    pub(in crate::design) fn optimise(&self, start: Vec<f64>, sign: Sign, least_gain: f64) -> Option<OptimiserResult> {
        let watched = self.watch(&start, sign);
        let mut state = self.state(start, watched, sign)?;
        let scale = dot(&state.gradient, &state.gradient).sqrt();
        let mut hessian = Hessian::new(state.x.len(), scale);
        let mut steps = 0;
        while steps < MOST_STEPS {
            let Some(step) = self.step(&state, &hessian.matrix, sign) else { break };
            let slope = dot(&state.gradient, &step);
            let Some(next) = self.search(&state, &step, slope, sign) else { break };
            steps += 1;
            let gain = state.merit() - next.merit();
            hessian.update(&state, &next);
            state = next;
            if gain < least_gain && -slope < least_gain.max(LEAST_PREDICTED_GAIN) {
                break;
            }
        }
        Some(OptimiserResult { x: state.x, steps })
    }

    /// The step of the quadratic program, within all linear limits.
    fn step(&self, state: &State, hessian: &Matrix, sign: Sign) -> Option<Vec<f64>> {
        let Watched { motion, torques, .. } = &state.watched;
        let at = MotionPoint { motions: &self.watched, x: &state.x, motion };
        let mut others = self.loads.rows(at, torques, self.sign_of_loads(sign));
        others.extend(self.watched.rows(&state.x));
        if let Some(clearances) = &self.clearances {
            others.extend(clearances.rows(at));
        }
        let mut places = self.constraints.near(motion);
        let mut found = None;
        for _ in 0..MOST_ROUNDS {
            let mut rows = self.constraints.rows(at, &places);
            rows.extend(others.iter().cloned());
            let step = quadratic_program::least(hessian, &state.gradient, &rows, PRICE)?;
            found = Some(step);
            let reached = found.as_ref().map(|step| self.watched.at(&moved(&state.x, step, 1.0)))?;
            if !self.constraints.add_violated(&reached, &mut places) {
                break;
            }
        }
        found
    }

    /// Whether limits hold that no step may violate: those that are linear in the unknowns.
    fn holds_hard_limits(&self, motion: &Derivatives) -> bool {
        !self.watched.is_linear() || self.constraints.use_of(motion) <= 1.0 + TOLERANCE
    }

    /// The longest of halved steps that brings enough.
    fn search(&self, from: &State, step: &[f64], slope: f64, sign: Sign) -> Option<State> {
        let mut part = 1.0;
        for _ in 0..MOST_HALVINGS {
            let predicted = part * slope.min(0.0) * SUFFICIENT;
            let x = moved(&from.x, step, part);
            let watched = self.watch(&x, sign);
            let is_less = |value: f64| value + price(watched.soft_use) < from.merit() + predicted;
            if self.holds_hard_limits(&watched.motion) && self.value(&x, sign).is_some_and(is_less) {
                return self.state(x, watched, sign);
            }
            part *= 0.5;
        }
        None
    }
}

/// What the largest use of soft limits costs, nats.
fn price(soft_use: f64) -> f64 {
    PRICE * (soft_use - 1.0).max(0.0)
}

/// Part of a limit by which a step may violate it.
const TOLERANCE: f64 = 1e-5;

fn moved(x: &[f64], step: &[f64], part: f64) -> Vec<f64> {
    x.iter().zip(step).map(|(x, p)| x + part * p).collect()
}

/// The approximation of second derivatives.
struct Hessian {
    matrix: Matrix,
    is_first: bool,
}

impl Hessian {
    fn new(size: usize, scale: f64) -> Self {
        Self { matrix: scaled_identity(size, scale), is_first: true }
    }

    /// Powell's damped BFGS, which keeps it positive definite.
    fn update(&mut self, before: &State, after: &State) {
        let s: Vec<f64> = after.x.iter().zip(&before.x).map(|(b, a)| b - a).collect();
        let mut y: Vec<f64> = after.gradient.iter().zip(&before.gradient).map(|(b, a)| b - a).collect();
        let sy = dot(&s, &y);
        if self.is_first && sy > 0.0 {
            self.matrix = scaled_identity(s.len(), dot(&y, &y) / sy);
        }
        self.is_first = false;
        let bs = self.matrix.times(&s);
        let sbs = dot(&s, &bs);
        let theta = if sy < 0.2 * sbs { 0.8 * sbs / (sbs - sy) } else { 1.0 };
        y.iter_mut().zip(&bs).for_each(|(y, b)| *y = theta * *y + (1.0 - theta) * b);
        let sy = dot(&s, &y);
        if sbs <= 0.0 || sy <= 0.0 {
            return;
        }
        for j in 0..s.len() {
            let (of_y, of_bs) = (y[j] / sy, bs[j] / sbs);
            for (i, value) in self.matrix.column_mut(j).iter_mut().enumerate() {
                *value += y[i] * of_y - bs[i] * of_bs;
            }
        }
    }
}

fn scaled_identity(size: usize, scale: f64) -> Matrix {
    Matrix::from_fn(size, size, |i, j| if i == j { scale } else { 0.0 })
}
