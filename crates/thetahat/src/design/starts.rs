use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{
    limits::JointLimits,
    motions::Motions,
    optimiser::{Found, Problem},
    sums::Sums,
};
use crate::{dynamics::Sign, pool::in_parallel};

/// Random motions of which a descent begins with the best.
const DRAWS: usize = 3;
/// Descents of a search from such motions: it goes on with the best.
const BEGINNINGS: usize = 3;
/// Part of the limits that a random motion uses.
const USED: f64 = 0.9;
/// How far motions are led to the other side of a given start, in halves of the range, where that leaves them larger.
const SIDES: [f64; 5] = [0.0, 1.0, 3.0, 9.0, 27.0];

/// Descents from what was found moved by random numbers, in units that take a joint to its limit, and their size.
const KICKS: usize = 5;
const KICK: f64 = 0.5;
/// Least part of a random motion that is kept for shapes to stay apart.
const LEAST_PART: f64 = 0.02;
/// Largest distance of a random posture from the middle, parts of half the range.
const CENTRE: f64 = 0.8;
/// Gain of the last step of a descent, nats: with the wide sign, and of the last with the tight one.
const COARSE: f64 = 0.5;
const FINE: f64 = 0.01;

/// Velocity scales of the sign in the search: the wide one as a part of the median of the velocity limits, the tight one of
/// the smallest.
const SIGN_SCALES: [f64; 2] = [0.02, 0.005];

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
        let begin = |_| {
            let (random, first_value) = best_of_random(problem, &mut rng, tight)?;
            Local::from(problem, random, wide, first_value)
        };
        let mut best = (0..BEGINNINGS).filter_map(begin).reduce(Local::or_better)?;
        for _ in 0..KICKS {
            let kicked = kicked(problem, &best.found.x, &mut rng);
            if let Some(other) = Local::from(problem, kicked, wide, best.first_value) {
                best = best.or_better(other);
            }
        }
        let Found { x, steps } = problem.optimise(best.found.x, tight, FINE)?;
        let (value, first_value) = (problem.value(&x, tight)?, best.first_value);
        Some(Start { value, x, first_value, steps: best.found.steps + steps })
    }
}

/// The end of one descent.
struct Local {
    found: Found,
    /// The criterion, and what violated limits cost.
    merit: f64,
    /// The criterion of the random motion that it comes from.
    first_value: f64,
}

impl Local {
    fn from(problem: &Problem, start: Vec<f64>, sign: Sign, first_value: f64) -> Option<Self> {
        let found = problem.optimise(start, sign, COARSE)?;
        Some(Self { merit: problem.merit(&found.x, sign)?, found, first_value })
    }

    /// The better of both, with the steps of both.
    fn or_better(self, other: Self) -> Self {
        let steps = self.found.steps + other.found.steps;
        let better = if other.merit < self.merit { other } else { self };
        Self { found: Found { steps, ..better.found }, ..better }
    }
}

/// A motion moved by random numbers, by less where shapes would come too near, and made smaller where it exceeds its limits.
fn kicked(problem: &Problem, x: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let kick: Vec<f64> = x.iter().map(|_| KICK * Distribution::<f64>::sample(&StandardNormal, rng)).collect();
    apart(problem, &|part| {
        let moved = x.iter().zip(&kick).map(|(x, kick)| x + part * kick);
        match &problem.watched {
            Motions::Sums { family, .. } => within(problem, family, &moved.collect::<Vec<_>>(), 1.0),
            Motions::Moves { family, .. } => family.through(&moved.take(family.posture_unknowns()).collect::<Vec<_>>()),
        }
    })
}

/// Sums within their limits: each joint's motion about its start times the factor that leaves a part of the limits unused, but
/// no more than `most`. About a start near a limit the motion is led to the other side, as far as that makes the factor larger.
fn within(problem: &Problem, family: &Sums, x: &[f64], most: f64) -> Vec<f64> {
    let sides = if family.has_free_start() { &SIDES[..1] } else { &SIDES[..] };
    let led = sides.iter().map(|side| {
        let led = led(problem, family, x, *side);
        let room = problem.constraints.room(&problem.watched.at(&led), family.centre());
        (led, room)
    });
    let led: Vec<_> = led.collect();
    let of_joint = |joint: usize| {
        let factor = |(_, room): &(Vec<f64>, Vec<f64>)| (USED * room[joint]).min(most);
        let best = led.iter().reduce(|best, other| if factor(other) > factor(best) { other } else { best });
        best.map_or_else(Vec::new, |best| best.0[own(family, joint)].iter().map(|v| factor(best) * v).collect())
    };
    (0..family.joints()).flat_map(of_joint).collect()
}

/// The sums with each joint led to the far side of its range, by a part of half of it.
fn led(problem: &Problem, family: &Sums, x: &[f64], side: f64) -> Vec<f64> {
    let mut led = x.to_vec();
    for (joint, limits) in problem.constraints.limits().iter().enumerate() {
        let far = (limits.middle() - family.centre()[joint]).signum();
        let by = side * far * 0.5 * (limits.upper - limits.lower);
        let all = led[own(family, joint)].iter_mut().zip(family.excursion(joint));
        all.for_each(|(v, excursion)| *v += by * excursion);
    }
    led
}

/// The unknowns of a joint.
fn own(family: &Sums, joint: usize) -> std::ops::Range<usize> {
    let size = family.unknowns_of_joint();
    joint * size..(joint + 1) * size
}

/// The best of random motions, each as large as its limits allow, and its criterion.
fn best_of_random(problem: &Problem, rng: &mut ChaCha8Rng, sign: Sign) -> Option<(Vec<f64>, f64)> {
    let mut draw = || {
        let x = random(problem, rng);
        problem.merit(&x, sign).map(|merit| (x, merit))
    };
    let drawn: Vec<_> = (0..DRAWS).filter_map(|_| draw()).collect();
    let (x, _) = drawn.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    problem.value(&x, sign).map(|value| (x, value))
}

fn random(problem: &Problem, rng: &mut ChaCha8Rng) -> Vec<f64> {
    match &problem.watched {
        Motions::Sums { family, .. } => {
            let x = random_sums(problem, family, rng);
            if problem.clearances.is_none() {
                return x;
            }
            let centre = free_centre(family, rng);
            apart(problem, &|part| {
                let moved = x.iter().zip(&centre).map(|(x, c)| c + part * (x - c));
                within(problem, family, &moved.collect::<Vec<_>>(), 1.0)
            })
        }
        Motions::Moves { family, .. } => {
            let postures: Vec<f64> = (0..family.posture_unknowns()).map(|_| rng.random_range(-1.0..1.0)).collect();
            let joints = family.joints();
            let drawn: Vec<f64> = (0..joints).map(|_| rng.random_range(-CENTRE..CENTRE)).collect();
            let centre = family.start_in_units().unwrap_or(drawn);
            apart(problem, &|part| {
                let moved = postures.iter().enumerate().map(|(i, p)| {
                    let centre = if part < 1.0 { centre[i % joints] } else { 0.0 };
                    centre + part * (p - centre)
                });
                family.through(&moved.collect::<Vec<_>>())
            })
        }
    }
}

/// A motion by the part of it that is kept: the largest of some at which shapes are far enough apart, or else the smallest.
fn apart(problem: &Problem, motion: &dyn Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let mut part = 1.0;
    loop {
        let x = motion(part);
        if part < LEAST_PART || problem.clearance_use(&problem.watched.at(&x)) <= 1.0 {
            return x;
        }
        part *= 0.7;
    }
}

/// Unknowns of standing still in a random posture: zero where the posture is given.
fn free_centre(family: &Sums, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut centre = vec![0.0; family.unknowns()];
    if family.has_free_start() {
        for joint in 0..family.joints() {
            centre[own(family, joint).start] = rng.random_range(-CENTRE..CENTRE);
        }
    }
    centre
}

/// Normal coefficients, with each joint's scaled to its limits.
fn random_sums(problem: &Problem, family: &Sums, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let size = family.unknowns_of_joint();
    let free = usize::from(family.has_free_start());
    let mut x: Vec<f64> = (0..family.unknowns()).map(|_| StandardNormal.sample(rng)).collect();
    for j in 0..family.joints() {
        x[j * size..j * size + free].iter_mut().for_each(|c| *c *= 0.1);
    }
    within(problem, family, &x, f64::INFINITY)
}

/// The wide velocity scale, of all joints in the mean, then the tight one, which the slowest joint needs: joints that turn and
/// those that slide have one scale.
pub(super) fn sign_scales(limits: &[JointLimits]) -> [f64; 2] {
    let mut velocities: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    let [wide, tight] = SIGN_SCALES;
    [wide * velocities[velocities.len() / 2], tight * velocities[0]]
}
