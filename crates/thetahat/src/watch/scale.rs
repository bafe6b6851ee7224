//! Noise by the speed of the motion: it may be larger where a joint moves otherwise than while settling.

use std::collections::VecDeque;

use super::{layout::OWN, likelihood::Sums};
use thetahat_ground::linear_algebra::Matrix;

/// Octaves of speed above that near rest, each with a noise of its own; what is faster counts to the last.
const OCTAVES: usize = 7;
/// The factor on the variance that is believed of an octave before it was seen, and the seconds that this counts for.
const UNSEEN: [f64; 2] = [2.0, 6.0];
/// The largest factor by which one second counts.
const LARGEST: f64 = 20.0;
/// Seconds of an octave after which earlier ones count by a factor e less.
const MEMORY: f64 = 300.0;
/// Seconds that wait before they count, so that a change is said before it passes for noise.
const WAIT: usize = 16;

/// Factors on the variance of each joint's noise.
#[derive(Debug, Clone)]
pub(super) struct Scales {
    joints: Vec<[Scale; OCTAVES]>,
    /// Speed of each joint below which it is near rest.
    rest: Vec<f64>,
    /// Information that a joint's friction and offset have at least, where a second shows little.
    floors: Vec<Matrix>,
    waiting: VecDeque<Vec<Score>>,
}

#[derive(Debug, Clone, Copy)]
struct Scale {
    found: f64,
    expected: f64,
}

/// What a second shows of a joint's noise: a square, and its expected value.
#[derive(Debug, Clone, Copy)]
struct Score {
    joint: usize,
    octave: usize,
    found: f64,
    expected: f64,
}

impl Scales {
    /// Of joints with these speeds near rest, whose friction and offset so many seconds show with this information.
    pub(super) fn new(rest: &[f64], seconds: usize, all: &Sums) -> Self {
        let joints = rest.len();
        let [unseen, count] = UNSEEN.map(|value| value * OWN as f64);
        let scale = Scale { found: unseen * count / OWN as f64, expected: count };
        // A hundredth of the mean information keeps what is not excited in a second out.
        let floor = |j: usize| {
            let (information, _) = all.own(j);
            let least = |i: usize| 1e-2 * information.at(i, i).max(f64::MIN_POSITIVE) / seconds as f64;
            Matrix::from_fn(OWN, OWN, |i, k| if i == k { least(i) } else { 0.0 })
        };
        Self {
            joints: vec![[scale; OCTAVES]; joints],
            rest: rest.to_vec(),
            floors: (0..joints).map(floor).collect(),
            waiting: VecDeque::new(),
        }
    }

    /// Factors of one.
    pub(super) fn units(rest: &[f64]) -> Self {
        let one = Scale { found: 1.0, expected: 1.0 };
        Self {
            joints: vec![[one; OCTAVES]; rest.len()],
            rest: rest.to_vec(),
            floors: Vec::new(),
            waiting: VecDeque::new(),
        }
    }

    /// The factor of a joint at a speed.
    pub(super) fn factor(&self, joint: usize, speed: f64) -> f64 {
        let Scale { found, expected } = self.joints[joint][self.octave(joint, speed)];
        (found / expected).max(1.0)
    }

    /// Takes a second less the torque of what is known, and the speed of each joint that moved.
    pub(super) fn push(&mut self, second: &Sums, speeds: &[Option<f64>]) {
        let of = |(joint, speed): (usize, &Option<f64>)| {
            let [found, expected] = self.square(second, joint)?;
            Some(Score { joint, octave: self.octave(joint, (*speed)?), found: found.min(LARGEST * expected), expected })
        };
        self.waiting.push_back(speeds.iter().enumerate().filter_map(of).collect());
        if self.waiting.len() > WAIT {
            self.waiting.pop_front().into_iter().flatten().for_each(|score| self.take(score));
        }
    }

    fn take(&mut self, Score { joint, octave, found, expected }: Score) {
        let scale = &mut self.joints[joint][octave];
        // The square is in units of the variance with the factor at that time, which changes slowly.
        let factor = (scale.found / scale.expected).max(1.0);
        let kept = (-expected / (OWN as f64 * MEMORY)).exp();
        scale.found = kept * scale.found + factor * found;
        scale.expected = kept * scale.expected + expected;
    }

    /// The square of a second's score over its deviations, and what it is by noise alone.
    pub(super) fn square(&self, second: &Sums, joint: usize) -> Option<[f64; 2]> {
        let (information, score) = second.own(joint);
        let factor = information.plus(&self.floors[joint], 1.0).cholesky()?;
        let found = factor.solve(&score).iter().zip(&score).map(|(a, b)| a * b).sum::<f64>();
        let part = factor.solve_matrix(&information);
        Some([found, (0..OWN).map(|i| part.at(i, i)).sum()])
    }

    /// Forgets the seconds that wait: they hold a change.
    pub(super) fn forget_waiting(&mut self) {
        self.waiting.clear();
    }

    fn octave(&self, joint: usize, speed: f64) -> usize {
        ((speed / self.rest[joint]).max(1.0).log2() as usize).min(OCTAVES - 1)
    }
}
