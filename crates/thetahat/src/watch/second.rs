//! The blocks of a second, whitened.

use super::{
    layout::Layout,
    likelihood::Sums,
    scale::Scales,
    step::{Row, Step},
    whitening::{BlockNoise, Whitening},
};

/// The blocks of a second until now.
#[derive(Debug, Clone)]
pub(super) struct Second {
    rows: Vec<(usize, Row)>,
    /// Sum of squares of each joint's speed while it moved, and how many blocks.
    speeds: Vec<[f64; 2]>,
    pub(super) began_s: f64,
    pub(super) blocks: usize,
}

impl Second {
    pub(super) fn new(joints: usize) -> Self {
        Self { rows: Vec::new(), speeds: vec![[0.0; 2]; joints], began_s: 0.0, blocks: 0 }
    }

    /// Adds a block.
    pub(super) fn push(&mut self, whitening: &mut Whitening, noise: &[Option<BlockNoise>], block: &Step) {
        if self.blocks == 0 {
            self.began_s = block.time_s;
        }
        self.blocks += 1;
        for (j, noise) in noise.iter().enumerate() {
            let Some(noise) = noise else { continue };
            let Some(row) = whitening.push(j, block, noise.correlation) else { continue };
            self.rows.push((j, row));
            let [squares, count] = &mut self.speeds[j];
            (*squares, *count) = (*squares + block.rows[j].x[0].powi(2), *count + 1.0);
        }
    }

    /// The rms speed of each joint that moved.
    pub(super) fn speeds(&self) -> Vec<Option<f64>> {
        self.speeds.iter().map(|[squares, count]| (*count > 0.0).then(|| (squares / count).sqrt())).collect()
    }

    /// The sums of its rows less the torque of some changes.
    pub(super) fn sums(&self, layout: Layout, noise: &[Option<BlockNoise>], scales: &Scales, changes: &[f64]) -> Sums {
        let mut sums = Sums::zeros(layout);
        let speeds = self.speeds();
        let weight = |j: usize| {
            let noise = noise[j]?;
            Some(1.0 / (noise.deviation.powi(2) * scales.factor(j, speeds[j]?)))
        };
        let weights: Vec<Option<f64>> = (0..layout.joints).map(weight).collect();
        for (j, row) in &self.rows {
            sums.add_row(*j, row, weights[*j].unwrap_or(0.0));
        }
        sums.less(changes);
        sums
    }
}
