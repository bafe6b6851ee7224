//! Blocks whose noise is not correlated.

use super::step::{Row, Step};

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

/// The sums of products and of squares of neighbouring errors, and how many pairs there are: of an autoregression.
pub(super) fn neighbours(errors: &[Option<f64>]) -> [f64; 3] {
    let pairs = errors.windows(2).filter_map(|pair| Some([pair[0]?, pair[1]?]));
    pairs.fold([0.0; 3], |[p, s, n], [a, b]| [p + a * b, s + 0.5 * (a * a + b * b), n + 1.0])
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
        let row = (!block.rest[joint]).then(|| block.rows[joint].clone());
        let before = std::mem::replace(&mut self.before[joint], row.clone());
        let row = row?;
        Some(match before {
            Some(before) => row.less(&before, correlation),
            None => row.scaled((1.0 - correlation * correlation).sqrt()),
        })
    }
}
