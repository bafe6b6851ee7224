//! The motions at which descents begin: random ones, and perturbed ones.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::design::{
    motions::{family::Motions, sums::Sums},
    search::optimiser::Problem,
};
use thetahat_model::dynamics::Sign;

/// A descent begins at the best of this many random motions.
const DRAWS: usize = 3;
/// Part of the limits that a random motion uses.
const USED: f64 = 0.9;
/// How far motions from a given start are shifted to the other side, in halves of the range, if that leaves them larger.
const SIDES: [f64; 5] = [0.0, 1.0, 3.0, 9.0, 27.0];
/// Size of random perturbations, in units that take a joint to its limit.
const KICK: f64 = 0.5;
/// Least part of a random motion that is kept for shapes to stay apart.
const LEAST_PART: f64 = 0.02;
/// Largest distance of a random posture from the middle, parts of half the range.
const CENTRE: f64 = 0.8;

/// A motion perturbed by random numbers, by less if shapes would come too close, and made smaller if it exceeds its limits.
pub(in crate::design) fn kicked(problem: &Problem, x: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let kick: Vec<f64> = x.iter().map(|_| KICK * Distribution::<f64>::sample(&StandardNormal, rng)).collect();
    apart(problem, &|part| {
        let moved = x.iter().zip(&kick).map(|(x, kick)| x + part * kick);
        match &problem.watched {
            Motions::Sums { family, .. } => within(problem, family, &moved.collect::<Vec<_>>(), 1.0),
            Motions::Moves { family, .. } => family.through(&moved.take(family.posture_unknowns()).collect::<Vec<_>>()),
        }
    })
}

/// Sums made smaller, joint by joint, until they are within limits that became tighter; moves as they are, whose limits a descent may violate.
pub(in crate::design) fn fitted(problem: &Problem, x: &[f64]) -> Vec<f64> {
    let Motions::Sums { family, .. } = &problem.watched else { return x.to_vec() };
    let room = problem.constraints.room(&problem.watched.at(x), family.centre());
    let of_joint = |(joint, room): (usize, &f64)| {
        x[family.own(joint)].iter().map(|value| room.min(1.0) * value).collect::<Vec<_>>()
    };
    room.iter().enumerate().flat_map(of_joint).collect()
}

/// Sums within their limits: each joint's motion about its start times the factor that leaves a part of the limits unused, but
/// no more than `most`. About a start near a limit the motion is shifted to the other side, if that makes the factor larger.
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
        best.map_or_else(Vec::new, |best| best.0[family.own(joint)].iter().map(|v| factor(best) * v).collect())
    };
    (0..family.joints()).flat_map(of_joint).collect()
}

/// The sums with each joint shifted to the far side of its range, by a multiple of half of it.
fn led(problem: &Problem, family: &Sums, x: &[f64], side: f64) -> Vec<f64> {
    let mut led = x.to_vec();
    for (joint, limits) in problem.constraints.limits().iter().enumerate() {
        let far = (limits.middle() - family.centre()[joint]).signum();
        let by = side * far * 0.5 * (limits.upper - limits.lower);
        let all = led[family.own(joint)].iter_mut().zip(family.excursion(joint));
        all.for_each(|(v, excursion)| *v += by * excursion);
    }
    led
}

/// The best of random motions, each as large as its limits allow, and its criterion.
pub(in crate::design) fn best_of_random(
    problem: &Problem,
    rng: &mut ChaCha8Rng,
    sign: Sign,
) -> Option<(Vec<f64>, f64)> {
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
            centre[family.own(joint).start] = rng.random_range(-CENTRE..CENTRE);
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
