//! Motions put together from the joints of others.
//!
//! The limits of a joint's position and its derivatives hold for its motion whatever the other joints do, so that what searches
//! found joint by joint can be exchanged between them.

use rand::{RngExt, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use crate::design::{motions::sums::Sums, search::optimiser::Problem};
use thetahat_model::dynamics::Sign;

/// Takes one joint's motion from `pool`, unchanged, reversed or mirrored, and then for each other joint the motion of the pool that
/// minimises the criterion. `None` if the pool has no other motion of the first joint.
pub(in crate::design) fn crossed(
    problem: &Problem,
    family: &Sums,
    x: &[f64],
    pool: &[Vec<f64>],
    sign: Sign,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<f64>> {
    let mut joints: Vec<usize> = (0..family.joints()).collect();
    joints.shuffle(rng);
    let (&first, others) = joints.split_first()?;
    let all = || pool.iter().flat_map(|donor| turned(family, first, &donor[family.own(first)]));
    let mut candidates: Vec<Vec<f64>> = all().filter(|own| *own != x[family.own(first)]).collect();
    if candidates.is_empty() {
        return None;
    }
    let donated = candidates.swap_remove(rng.random_range(0..candidates.len()));
    let merit = |x: &[f64]| problem.merit(x, sign).unwrap_or(f64::INFINITY);
    let mut child = with_joint(family, x, first, &donated);
    let mut least = merit(&child);
    for &joint in others {
        for donor in pool {
            let other = with_joint(family, &child, joint, &donor[family.own(joint)]);
            let of_other = if other == child { least } else { merit(&other) };
            if of_other < least {
                (child, least) = (other, of_other);
            }
        }
    }
    Some(child)
}

fn with_joint(family: &Sums, x: &[f64], joint: usize, own: &[f64]) -> Vec<f64> {
    let mut with = x.to_vec();
    with[family.own(joint)].copy_from_slice(own);
    with
}

/// A joint's motion as it is, backwards in time, and both about the middle of its range, where the start is free.
fn turned(family: &Sums, joint: usize, own: &[f64]) -> Vec<Vec<f64>> {
    let mut all = vec![own.to_vec(), family.reversed(joint, own)];
    if family.has_free_start() {
        let mirrored: Vec<Vec<f64>> = all.iter().map(|own| own.iter().map(|v| -v).collect()).collect();
        all.extend(mirrored);
    }
    all
}
