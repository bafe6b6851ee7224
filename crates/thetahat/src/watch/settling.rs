//! Baseline and noise of the first seconds.
//!
//! The residual of a fitted model is no white noise: neighbouring blocks are correlated, and some errors last. The first is taken as an
//! autoregression of each joint, the second as a factor on the variance, by which the means of seconds differ more than that.

use super::{
    likelihood::{Sums, changes_of, of_joint, posterior},
    step::Step,
    subject::Row,
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

/// The noise of a joint's blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlockNoise {
    /// Correlation of neighbours.
    pub(super) correlation: f64,
    /// Deviation of what a block adds to that, N m or N.
    pub(super) deviation: f64,
    /// The factor on its variance that it has for lasting errors.
    pub(super) inflation: f64,
}

/// What the first seconds show.
#[derive(Debug, Clone)]
pub(super) struct Settled {
    /// The changes from the identified model.
    pub(super) baseline: Vec<f64>,
    /// Their precision.
    pub(super) precision: Matrix,
    /// The noise of each joint; `None` of those that did not move enough.
    pub(super) noise: Vec<Option<BlockNoise>>,
}

/// Rows of blocks less what is correlated with the block before, in which the joint moves as well.
#[derive(Debug, Clone)]
pub(super) struct Whitening {
    before: Vec<Option<Row>>,
}

impl Whitening {
    pub(super) fn new(joints: usize) -> Self {
        Self { before: vec![None; joints] }
    }

    /// The row of a joint in a block.
    pub(super) fn push(&mut self, joint: usize, block: &Step, correlation: f64) -> Option<Row> {
        let row = Some(block.rows[joint]).filter(|_| !block.rest[joint]);
        let before = std::mem::replace(&mut self.before[joint], row);
        let row = row?;
        Some(match before {
            Some(before) => row.less(&before, correlation),
            None => row.scaled((1.0 - correlation * correlation).sqrt()),
        })
    }
}

impl Settled {
    /// Of blocks without gaps; `prior` are the deviations of the changes that are believed before.
    pub(super) fn of(blocks: &[Step], blocks_per_tick: usize, prior: &[f64]) -> Option<Self> {
        let joints = blocks.first()?.rows.len();
        let before = |i: usize, k: usize| if i == k { prior[i].powi(-2) } else { 0.0 };
        let before = Matrix::from_fn(changes_of(joints), changes_of(joints), before);
        let mut noise: Vec<_> = (0..joints).map(|j| first_noise(blocks, j)).collect();
        let mut fitted = posterior(&before, &whitened(blocks, &noise))?;
        for _ in 0..PASSES {
            noise = (0..joints).map(|j| noise[j].and_then(|_| noise_of(blocks, j, &fitted.0))).collect();
            fitted = posterior(&before, &whitened(blocks, &noise))?;
        }
        let ticks: Vec<Sums> = blocks.chunks_exact(blocks_per_tick).map(|blocks| whitened(blocks, &noise)).collect();
        for (j, noise) in noise.iter_mut().enumerate() {
            let Some(noise) = noise else { continue };
            noise.inflation = inflation(&ticks, j, &fitted.0);
            noise.deviation *= noise.inflation.sqrt();
        }
        let (baseline, precision) = posterior(&before, &whitened(blocks, &noise))?;
        Some(Self { baseline, precision, noise })
    }
}

/// The sums of whitened blocks.
fn whitened(blocks: &[Step], noise: &[Option<BlockNoise>]) -> Sums {
    let mut whitening = Whitening::new(noise.len());
    let mut sums = Sums::zeros(noise.len());
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

/// The noise of a joint's residual after some changes.
fn noise_of(blocks: &[Step], joint: usize, changes: &[f64]) -> Option<BlockNoise> {
    let changes = of_joint(changes, joint);
    let error = |block: &Step| {
        let row = &block.rows[joint];
        (!block.rest[joint]).then(|| row.y - row.torque(&changes))
    };
    let errors: Vec<Option<f64>> = blocks.iter().map(error).collect();
    let count = errors.iter().flatten().count();
    let pairs = errors.windows(2).filter_map(|pair| Some([pair[0]?, pair[1]?]));
    let [product, square, all] =
        pairs.fold([0.0; 3], |[p, s, n], [a, b]| [p + a * b, s + 0.5 * (a * a + b * b), n + 1.0]);
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
fn inflation(ticks: &[Sums], joint: usize, changes: &[f64]) -> f64 {
    let Some(mut total) = ticks.first().cloned() else { return 1.0 };
    ticks[1..].iter().for_each(|tick| total.add(tick));
    let (all, _) = total.own(joint);
    // A hundredth of the mean information keeps what is not excited in a second out.
    let floor =
        |i: usize, k: usize| if i == k { 1e-2 * all.at(i, i).max(f64::MIN_POSITIVE) / ticks.len() as f64 } else { 0.0 };
    let floor = Matrix::from_fn(3, 3, floor);
    let (mut found, mut expected) = (0.0, 0.0);
    for tick in ticks {
        let mut tick = tick.clone();
        tick.less(changes);
        let (information, score) = tick.own(joint);
        let Some(factor) = information.plus(&floor, 1.0).cholesky() else { continue };
        found += factor.solve(&score).iter().zip(&score).map(|(a, b)| a * b).sum::<f64>();
        let part = factor.solve_matrix(&information);
        expected += (0..3).map(|i| part.at(i, i)).sum::<f64>();
    }
    let expected = (expected - 3.0).max(1.0);
    (found / expected * (1.0 + BOUND * (2.0 / expected).sqrt())).max(1.0)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::watch::subject::CHANGES;

    /// One joint that swings, with noise of deviation 0.2 and correlation 0.5, and friction that is 0.3 and 0.4 more than identified.
    fn blocks(count: usize) -> Vec<Step> {
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        let mut noise = 0.0;
        let block = |k: usize| {
            let white: f64 = StandardNormal.sample(&mut generator);
            noise = 0.5 * noise + 0.2 * white;
            let dq = (0.13 * k as f64).sin();
            let mut x = [0.0; CHANGES];
            x[..3].copy_from_slice(&[dq, dq.signum(), 1.0]);
            let row = Row { y: 0.3 * dq + 0.4 * dq.signum() + noise, x, ..Row::default() };
            Step { time_s: 0.05 * k as f64, rows: vec![row], rest: vec![dq.abs() < 0.1] }
        };
        (0..count).map(block).collect()
    }

    #[test]
    fn baseline_and_noise_are_found() {
        let settled = Settled::of(&blocks(4000), 20, &[10.0; CHANGES]).unwrap();
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
        assert_eq!(Settled::of(&blocks, 20, &[10.0; CHANGES]).unwrap().noise, [None]);
    }
}
