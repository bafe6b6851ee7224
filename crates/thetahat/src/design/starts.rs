use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::optimiser::{Found, Problem};
use crate::{dynamics::Sign, pool::in_parallel};

/// Random motions of which a search begins with the best.
const DRAWS: usize = 12;
/// Part of the limits that a random motion uses.
const USED: f64 = 0.9;

/// Descents from what was found moved by random numbers, in units that take a joint to its limit, and their size.
const KICKS: usize = 6;
const KICK: f64 = 0.5;
/// Gain of the last step of a descent, nats: with the wide sign, and of the last with the tight one.
const COARSE: f64 = 1.0;
const FINE: f64 = 0.01;

/// How several searches are made.
#[derive(Debug, Clone)]
pub(super) struct Searches {
    pub(super) count: usize,
    pub(super) seed: u64,
    pub(super) threads: usize,
    /// Velocity scales of the regularised sign: a wide one, then a tight one.
    pub(super) sign_scales: [f64; 2],
}

/// A search that ended, with the criterion of its motion.
#[derive(Debug, Clone)]
pub(super) struct Start {
    pub(super) x: Vec<f64>,
    pub(super) first_value: f64,
    pub(super) value: f64,
    pub(super) steps: usize,
}

impl Searches {
    /// Every search that found a motion; the result does not depend on the number of threads.
    pub(super) fn run(&self, problem: &Problem) -> Vec<Start> {
        in_parallel(self.count, self.threads, |number| self.search(problem, number)).into_iter().flatten().collect()
    }

    fn search(&self, problem: &Problem, number: usize) -> Option<Start> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(number as u64);
        let [wide, tight] = self.sign_scales.map(|scale| Sign::Smooth { scale });
        let (random, first_value) = best_of_random(problem, &mut rng, tight)?;
        let mut best = Local::from(problem, random, wide)?;
        for _ in 0..KICKS {
            let kicked = kicked(problem, &best.found.x, &mut rng);
            if let Some(other) = Local::from(problem, kicked, wide) {
                best = best.or_better(other);
            }
        }
        let Found { x, steps } = problem.optimise(best.found.x, tight, FINE)?;
        Some(Start { value: problem.value(&x, tight)?, x, first_value, steps: best.found.steps + steps })
    }
}

/// The end of one descent.
struct Local {
    found: Found,
    value: f64,
}

impl Local {
    fn from(problem: &Problem, start: Vec<f64>, sign: Sign) -> Option<Self> {
        let found = problem.optimise(start, sign, COARSE)?;
        Some(Self { value: problem.value(&found.x, sign)?, found })
    }

    /// The better of both, with the steps of both.
    fn or_better(self, other: Self) -> Self {
        let steps = self.found.steps + other.found.steps;
        let Self { found, value } = if other.value < self.value { other } else { self };
        Self { found: Found { steps, ..found }, value }
    }
}

/// A motion moved by random numbers, each joint's made smaller where it exceeds its limits.
fn kicked(problem: &Problem, x: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut kicked: Vec<f64> = x
        .iter()
        .map(|x| {
            let number: f64 = StandardNormal.sample(rng);
            x + KICK * number
        })
        .collect();
    for joint in 0..problem.family.joints() {
        let used = use_of_joint(problem, &kicked, joint);
        kicked[own(problem, joint)].iter_mut().for_each(|v| *v *= (USED / used).min(1.0));
    }
    kicked
}

/// The unknowns of a joint.
fn own(problem: &Problem, joint: usize) -> std::ops::Range<usize> {
    let size = problem.family.unknowns_of_joint();
    joint * size..(joint + 1) * size
}

/// The largest use of a limit by one joint's motion.
fn use_of_joint(problem: &Problem, x: &[f64], joint: usize) -> f64 {
    let mut alone = vec![0.0; x.len()];
    let own = own(problem, joint);
    alone[own.clone()].copy_from_slice(&x[own]);
    problem.constraints.use_of(&problem.watched(&alone))
}

/// The best of random motions, each as large as its limits allow.
fn best_of_random(problem: &Problem, rng: &mut ChaCha8Rng, sign: Sign) -> Option<(Vec<f64>, f64)> {
    let mut draw = || {
        let x = random(problem, rng);
        problem.value(&x, sign).map(|value| (x, value))
    };
    let drawn: Vec<_> = (0..DRAWS).filter_map(|_| draw()).collect();
    drawn.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Normal coefficients, with each joint's scaled to its limits.
fn random(problem: &Problem, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let size = problem.family.unknowns_of_joint();
    let free = usize::from(problem.family.has_free_start());
    let mut x: Vec<f64> = (0..problem.family.unknowns()).map(|_| StandardNormal.sample(rng)).collect();
    for j in 0..problem.family.joints() {
        x[j * size..j * size + free].iter_mut().for_each(|c| *c *= 0.1);
    }
    for joint in 0..problem.family.joints() {
        let used = use_of_joint(problem, &x, joint);
        x[own(problem, joint)].iter_mut().for_each(|v| *v *= USED / used);
    }
    x
}
