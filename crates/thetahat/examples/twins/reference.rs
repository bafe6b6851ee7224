use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use thetahat::{Robot, robot::JointKind, series::Series};

/// Harmonics of the periodic motion; the first has the length of the record as its period.
const HARMONICS: usize = 5;
/// Time in which the motion begins and ends.
const RAMP_S: f64 = 1.0;
/// Largest way from the centre and largest velocity.
const REVOLUTE: [f64; 2] = [1.2, 2.0];
const PRISMATIC: [f64; 2] = [0.2, 0.6];

/// A random periodic motion of every joint that begins and ends at rest.
pub fn periodic(robot: &Robot, duration_s: f64, rate_hz: f64, seed: u64) -> Series {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let samples = (duration_s * rate_hz) as usize + 1;
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut channel = |kind: JointKind| {
        let limits = match kind {
            JointKind::Revolute => REVOLUTE,
            JointKind::Prismatic => PRISMATIC,
        };
        let waves: Vec<[f64; 2]> = (0..HARMONICS).map(|_| [normal(), normal()]).collect();
        let wave = |k: usize| {
            let t = k as f64 / rate_hz;
            let of = |(l, [a, b]): (usize, &[f64; 2])| {
                let phase = TAU * (l + 1) as f64 * t / duration_s;
                a * phase.sin() + b * phase.cos()
            };
            ramp(t) * ramp(duration_s - t) * waves.iter().enumerate().map(of).sum::<f64>()
        };
        let values: Vec<f64> = (0..samples).map(wave).collect();
        let steepest = values.windows(2).map(|w| (w[1] - w[0]).abs() * rate_hz).fold(0.0, f64::max);
        let farthest = values.iter().copied().map(f64::abs).fold(0.0, f64::max);
        let scale = (limits[0] / farthest).min(limits[1] / steepest);
        let centre = 0.3 * limits[0] * normal();
        values.iter().map(|v| centre + scale * v).collect::<Vec<f64>>()
    };
    let channels: Vec<Vec<f64>> = robot.coordinates().map(|joint| channel(joint.kind)).collect();
    Series::from_channels(&channels)
}

/// From zero to one, with velocity and acceleration zero at both ends.
fn ramp(t: f64) -> f64 {
    let s = (t / RAMP_S).clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}
