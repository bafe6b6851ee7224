//! Baseline and noise of the first seconds.
//!
//! The residual of a fitted model is no white noise: neighbouring blocks are correlated, and some errors last. The first is taken as an
//! autoregression of each joint, the second as a factor on the variance, by which the means of seconds differ more than that.

use super::{
    layout::{Layout, OWN},
    likelihood::{Sums, posterior},
    scale::Scales,
    second::Second,
    step::{Row, Step},
    whitening::{BlockNoise, Whitening, neighbours},
};
use thetahat_ground::linear_algebra::Matrix;

/// Fits of baseline and noise in turn.
const PASSES: usize = 4;
/// Blocks in which a joint must move for its noise to be known.
const FEWEST_BLOCKS: usize = 40;
/// Largest correlation of neighbours.
const LARGEST: f64 = 0.95;
/// Deviations by which the factor on the variance is raised for being known from a few seconds: its upper 95 % bound.
const BOUND: f64 = 1.645;

/// What the first seconds show.
#[derive(Debug, Clone)]
pub(super) struct Settled {
    /// The changes from the identified model.
    pub(super) baseline: Vec<f64>,
    /// Their precision.
    pub(super) precision: Matrix,
    /// The noise of each joint; `None` of those that did not move enough.
    pub(super) noise: Vec<Option<BlockNoise>>,
    pub(super) scales: Scales,
}

impl Settled {
    /// Of blocks without gaps; `before` is the precision of the changes that are believed before.
    pub(super) fn of(
        layout: Layout,
        blocks: &[Step],
        blocks_per_tick: usize,
        rest: &[f64],
        before: &Matrix,
    ) -> Option<Self> {
        let mut noise: Vec<_> = (0..layout.joints).map(|j| first_noise(blocks, j)).collect();
        let mut fitted = posterior(before, &whitened(layout, blocks, &noise))?;
        for _ in 0..PASSES {
            let of = |j: usize| noise[j].and_then(|_| noise_of(blocks, j, &layout.pick(&fitted.0, j)));
            noise = (0..layout.joints).map(of).collect();
            fitted = posterior(before, &whitened(layout, blocks, &noise))?;
        }
        let mut whitening = Whitening::new(layout.joints);
        let second = |blocks: &[Step]| {
            let mut second = Second::new(layout.joints);
            blocks.iter().for_each(|block| second.push(&mut whitening, &noise, block));
            second
        };
        let seconds: Vec<Second> = blocks.chunks_exact(blocks_per_tick).map(second).collect();
        let mut scales = Scales::new(rest, seconds.len(), &whitened(layout, blocks, &noise));
        let sums = |noise: &[Option<BlockNoise>]| -> Vec<Sums> {
            let unit = Scales::units(rest);
            seconds.iter().map(|second| second.sums(layout, noise, &unit, &fitted.0)).collect()
        };
        let white = sums(&noise);
        for (j, noise) in noise.iter_mut().enumerate() {
            let Some(noise) = noise else { continue };
            noise.inflation = inflation(&white, &scales, j);
            noise.deviation *= noise.inflation.sqrt();
        }
        sums(&noise).iter().zip(&seconds).for_each(|(sums, second)| scales.push(sums, &second.speeds()));
        let (baseline, precision) = posterior(before, &whitened(layout, blocks, &noise))?;
        Some(Self { baseline, precision, noise, scales })
    }
}

/// The sums of whitened blocks.
fn whitened(layout: Layout, blocks: &[Step], noise: &[Option<BlockNoise>]) -> Sums {
    let mut whitening = Whitening::new(noise.len());
    let mut sums = Sums::zeros(layout);
    for block in blocks {
        for (j, noise) in noise.iter().enumerate() {
            let Some(noise) = noise else { continue };
            if let Some(row) = whitening.push(j, block, noise.correlation) {
                sums.add_row(j, &row, noise.deviation.powi(-2));
            }
        }
    }
    sums
}

fn moving(blocks: &[Step], joint: usize) -> impl Iterator<Item = &Row> {
    blocks.iter().filter(move |block| !block.rest[joint]).map(move |block| &block.rows[joint])
}

/// The residual's rms as white noise.
fn first_noise(blocks: &[Step], joint: usize) -> Option<BlockNoise> {
    let count = moving(blocks, joint).count();
    let square: f64 = moving(blocks, joint).map(|row| row.y * row.y).sum();
    let deviation = (square / count as f64).sqrt().max(f64::MIN_POSITIVE);
    (count >= FEWEST_BLOCKS).then_some(BlockNoise { correlation: 0.0, deviation, inflation: 1.0 })
}

/// The noise of a joint's residual after some changes of its row.
fn noise_of(blocks: &[Step], joint: usize, changes: &[f64]) -> Option<BlockNoise> {
    let error = |block: &Step| {
        let row = &block.rows[joint];
        (!block.rest[joint]).then(|| row.y - row.torque(changes))
    };
    let errors: Vec<Option<f64>> = blocks.iter().map(error).collect();
    let count = errors.iter().flatten().count();
    let [product, square, all] = neighbours(&errors);
    if count < FEWEST_BLOCKS || square <= 0.0 {
        return None;
    }
    // Three changes of its own were fitted.
    let lost = count as f64 / (count as f64 - 3.0);
    let correlation = (product / square).clamp(0.0, LARGEST);
    let variance = lost * square / all * (1.0 - correlation * correlation);
    Some(BlockNoise { correlation, deviation: variance.sqrt(), inflation: 1.0 })
}

/// The square of the seconds' scores over what whitened noise gives: at least one, and by the upper bound of what so few seconds show.
fn inflation(seconds: &[Sums], scales: &Scales, joint: usize) -> f64 {
    let squares = seconds.iter().filter_map(|second| scales.square(second, joint));
    let [found, expected] = squares.fold([0.0; 2], |[f, e], [found, expected]| [f + found, e + expected]);
    let expected = (expected - OWN as f64).max(1.0);
    (found / expected * (1.0 + BOUND * (2.0 / expected).sqrt())).max(1.0)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    const LAYOUT: Layout = Layout { joints: 1, model: 0 };

    /// One joint that swings, with noise of deviation 0.2 and correlation 0.5, and friction that is 0.3 and 0.4 more than identified.
    fn blocks(count: usize) -> Vec<Step> {
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        let mut noise = 0.0;
        let block = |k: usize| {
            let white: f64 = StandardNormal.sample(&mut generator);
            noise = 0.5 * noise + 0.2 * white;
            let dq = (0.13 * k as f64).sin();
            let mut row = Row { y: 0.3 * dq + 0.4 * dq.signum() + noise, ..Row::zeros(LAYOUT.of_joint()) };
            row.x[..OWN].copy_from_slice(&[dq, dq.signum(), 1.0]);
            Step { time_s: 0.05 * k as f64, rows: vec![row], rest: vec![dq.abs() < 0.1] }
        };
        (0..count).map(block).collect()
    }

    fn settled(blocks: &[Step]) -> Option<Settled> {
        let size = LAYOUT.all();
        let believed = Matrix::from_fn(size, size, |i, k| if i == k { 1e-2 } else { 0.0 });
        Settled::of(LAYOUT, blocks, 20, &[0.1], &believed)
    }

    #[test]
    fn baseline_and_noise_are_found() {
        let settled = settled(&blocks(4000)).unwrap();
        let noise = settled.noise[0].unwrap();
        assert!((noise.correlation - 0.5).abs() < 0.05, "{noise:?}");
        assert!((noise.deviation / noise.inflation.sqrt() - 0.2).abs() < 0.01, "{noise:?}");
        assert!((1.0..1.3).contains(&noise.inflation), "{noise:?}");
        for (found, expected) in settled.baseline.iter().zip([0.3, 0.4, 0.0]) {
            assert!((found - expected).abs() < 0.05, "{:?}", settled.baseline);
        }
    }

    #[test]
    fn a_joint_that_rests_has_no_noise() {
        let mut blocks = blocks(200);
        blocks.iter_mut().for_each(|block| block.rest[0] = true);
        assert_eq!(settled(&blocks).unwrap().noise, [None]);
    }
}
