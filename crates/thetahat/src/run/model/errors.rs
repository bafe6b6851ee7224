//! The errors of predicted torques: all samples, moving, and near rest.

use super::{
    factors::{SETTLED, near_rest_limits},
    law_factors::LawFactors,
    rows::ModelRows,
};
use crate::run::prepared::PreparedRecording;
use thetahat_model::{dynamics::FrictionTransition, robot::JointKind};
use thetahat_report::results::{ModelError, ModelJointError};

/// Whether the sign of each row's friction is not settled at a sample between the row before and the row after.
pub(super) fn turning(
    prepared: &[PreparedRecording],
    rows: &ModelRows,
    (transition, kinds): (FrictionTransition, &[JointKind]),
) -> Vec<bool> {
    let mut turning = Vec::new();
    for j in 0..rows.layout.joints() {
        for (p, decimator) in prepared.iter().zip(&rows.decimators) {
            let limits = near_rest_limits(p.filtered.near_rest.as_ref(), rows.layout.joints());
            let limit = limits[j].max(SETTLED * transition.of(kinds[j]));
            let dq = &p.filtered.motion.dq;
            let kept: Vec<usize> = decimator.kept().collect();
            let turns = |k: usize| {
                let [from, to] = [k.saturating_sub(1), (k + 1).min(kept.len() - 1)].map(|row| kept[row]);
                (from..=to).any(|sample| dq.sample(sample)[j].abs() < limit)
            };
            turning.extend((0..kept.len()).map(turns));
        }
    }
    turning
}

/// Sums of squares of some rows.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    error: f64,
    torque: f64,
    rows: usize,
}

impl Squares {
    fn and(self, other: Self) -> Self {
        Self { error: self.error + other.error, torque: self.torque + other.torque, rows: self.rows + other.rows }
    }

    /// `100 |y - prediction| / |y|`; none if y is zero.
    fn percent(self) -> Option<f64> {
        (self.torque > 0.0).then(|| 100.0 * (self.error / self.torque).sqrt())
    }
}

/// The squares of the errors of predicted torques, joint by joint.
pub(super) struct SquaredErrors {
    moving: Vec<Squares>,
    near_rest: Vec<Squares>,
}

impl SquaredErrors {
    /// Of no row.
    pub(super) fn of_nothing(joints: usize) -> Self {
        Self { moving: vec![Squares::default(); joints], near_rest: vec![Squares::default(); joints] }
    }

    /// Those of all rows.
    pub(super) fn of(rows: &LawFactors, theta: &[f64]) -> Self {
        let mut errors = Self::of_nothing(rows.joints());
        errors.add(rows, None, theta);
        errors
    }

    /// Adds the rows of one part, or all.
    pub(super) fn add(&mut self, rows: &LawFactors, part: Option<usize>, theta: &[f64]) {
        for block in rows.blocks.iter().filter(|block| part.is_none_or(|part| block.part == part)) {
            let found = Squares { error: block.square(theta), torque: block.torque_square(), rows: block.rows };
            let of = if block.is_near_rest { &mut self.near_rest } else { &mut self.moving };
            of[block.joint] = of[block.joint].and(found);
        }
    }

    pub(super) fn error(&self) -> ModelError {
        let joints = self.moving.iter().zip(&self.near_rest).map(|(moving, near_rest)| {
            let all = moving.and(*near_rest);
            ModelJointError {
                percent: all.percent(),
                moving_percent: moving.percent(),
                near_rest_percent: near_rest.percent(),
                near_rest_share_percent: 100.0 * near_rest.rows as f64 / all.rows.max(1) as f64,
                rms: (all.error / all.rows.max(1) as f64).sqrt(),
            }
        });
        let all = self.moving.iter().chain(&self.near_rest).fold(Squares::default(), |all, of| all.and(*of));
        ModelError { percent: all.percent().unwrap_or(0.0), joints: joints.collect() }
    }
}
