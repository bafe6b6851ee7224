use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use thetahat::{Robot, Series, robot::JointKind};

/// Harmonics of the periodic motion; the first has the length of the recording as its period.
const HARMONICS: usize = 5;
/// Time in which the motion begins and ends.
const RAMP_S: f64 = 1.0;
/// Largest way from the centre and largest velocity.
const REVOLUTE: [f64; 2] = [1.2, 2.0];
const PRISMATIC: [f64; 2] = [0.2, 0.6];

/// Velocity of a slow motion, part of the largest.
const SLOW: f64 = 0.08;
/// Time of a move from rest to rest, and time from one to the next.
const MOVE_S: f64 = 1.2;
const EACH_S: f64 = 2.0;

/// How a twin moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// All joints at once, periodically.
    Periodic,
    /// The same, slowly.
    Slow,
    /// One joint after the other; the others rest.
    OneByOne,
    /// All joints at once, from rest to rest.
    Moves,
}

/// A random motion of every joint that begins and ends at rest.
pub fn motion(kind: Kind, robot: &Robot, duration_s: f64, rate_hz: f64, seed: u64) -> Series {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let samples = (duration_s * rate_hz) as usize + 1;
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let joints = robot.coordinate_count();
    let channel = |(j, limits): (usize, [f64; 2])| {
        let values = match kind {
            Kind::Periodic => swing(samples, rate_hz, RAMP_S, limits, &mut normal),
            Kind::Slow => swing(samples, rate_hz, RAMP_S, [limits[0], SLOW * limits[1]], &mut normal),
            Kind::OneByOne => {
                let own = samples / joints;
                let swing = swing(own, rate_hz, RAMP_S.min(0.2 * own as f64 / rate_hz), limits, &mut normal);
                let mut values = vec![0.0; samples];
                values[j * own..(j + 1) * own].copy_from_slice(&swing);
                values
            }
            Kind::Moves => moves(samples, rate_hz, limits, &mut normal),
        };
        let centre = 0.3 * limits[0] * normal();
        values.iter().map(|v| centre + v).collect::<Vec<f64>>()
    };
    let limits = robot.coordinates().map(|joint| match joint.kind {
        JointKind::Revolute => REVOLUTE,
        JointKind::Prismatic => PRISMATIC,
    });
    Series::side_by_side(&limits.enumerate().map(channel).collect::<Vec<_>>())
}

/// A periodic motion about zero within limits of way and velocity, whose period is its length.
fn swing(samples: usize, rate_hz: f64, ramp_s: f64, limits: [f64; 2], normal: &mut impl FnMut() -> f64) -> Vec<f64> {
    let duration_s = (samples - 1) as f64 / rate_hz;
    let waves: Vec<[f64; 2]> = (0..HARMONICS).map(|_| [normal(), normal()]).collect();
    let wave = |k: usize| {
        let t = k as f64 / rate_hz;
        let of = |(l, [a, b]): (usize, &[f64; 2])| {
            let phase = TAU * (l + 1) as f64 * t / duration_s;
            a * phase.sin() + b * phase.cos()
        };
        ramp(t / ramp_s) * ramp((duration_s - t) / ramp_s) * waves.iter().enumerate().map(of).sum::<f64>()
    };
    within((0..samples).map(wave).collect(), rate_hz, limits)
}

/// Moves from rest to rest.
fn moves(samples: usize, rate_hz: f64, limits: [f64; 2], normal: &mut impl FnMut() -> f64) -> Vec<f64> {
    let count = (samples as f64 / (rate_hz * EACH_S)).ceil() as usize;
    let targets: Vec<f64> = [0.0].into_iter().chain((0..count).map(|_| normal())).collect();
    let value = |k: usize| {
        let t = k as f64 / rate_hz;
        let i = (t / EACH_S) as usize;
        targets[i] + ramp((t - i as f64 * EACH_S) / MOVE_S) * (targets[i + 1] - targets[i])
    };
    within((0..samples).map(value).collect(), rate_hz, limits)
}

/// A motion made as large as its limits of way and velocity allow.
fn within(values: Vec<f64>, rate_hz: f64, limits: [f64; 2]) -> Vec<f64> {
    let steepest = values.windows(2).map(|w| (w[1] - w[0]).abs() * rate_hz).fold(0.0, f64::max);
    let farthest = values.iter().copied().map(f64::abs).fold(0.0, f64::max);
    let scale = (limits[0] / farthest).min(limits[1] / steepest);
    values.iter().map(|v| scale * v).collect()
}

/// From zero to one, with velocity and acceleration zero at both ends.
fn ramp(part: f64) -> f64 {
    let s = part.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}
