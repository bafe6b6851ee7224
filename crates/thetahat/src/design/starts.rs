use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::optimiser::{Found, Problem};
use crate::{dynamics::Sign, pool::in_parallel};

/// Random motions of which a search begins with the best.
const DRAWS: usize = 12;
/// Part of the limits that a random motion uses.
const USED: f64 = 0.9;

/// How several searches are made.
#[derive(Debug, Clone)]
pub(super) struct Searches {
    pub(super) count: usize,
    pub(super) seed: u64,
    pub(super) threads: usize,
    /// Velocity scales of the regularised sign, wide ones first.
    pub(super) sign_scales: Vec<f64>,
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
        let last = Sign::Smooth { scale: *self.sign_scales.last()? };
        let (mut x, first_value) = best_of_random(problem, &mut rng, last)?;
        let mut steps = 0;
        for &scale in &self.sign_scales {
            let found: Found = problem.optimise(x, Sign::Smooth { scale })?;
            (x, steps) = (found.x, steps + found.steps);
        }
        let value = problem.value(&x, last)?;
        Some(Start { x, first_value, value, steps })
    }
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
pub(super) fn random(problem: &Problem, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let size = problem.family.unknowns_of_joint();
    let free = usize::from(problem.family.has_free_start());
    let mut x: Vec<f64> = (0..problem.family.unknowns()).map(|_| StandardNormal.sample(rng)).collect();
    for j in 0..problem.family.joints() {
        x[j * size..j * size + free].iter_mut().for_each(|c| *c *= 0.1);
    }
    for joint in 0..problem.family.joints() {
        let mut alone = vec![0.0; x.len()];
        let own = joint * size..(joint + 1) * size;
        alone[own.clone()].copy_from_slice(&x[own.clone()]);
        let used = problem.constraints.use_of(&problem.watched(&alone));
        x[own].iter_mut().for_each(|v| *v *= USED / used);
    }
    x
}
