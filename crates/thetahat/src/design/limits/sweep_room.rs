//! The distance that a joint can sweep alone: within its limits, while shapes stay apart.

use crate::design::{
    error::DesignError,
    limits::{clearances::Clearances, joint_limits::JointLimits},
    text::description::Design,
};
use thetahat_ground::series::Series;

/// Postures of a way that are looked at.
const POSTURES: usize = 1000;
/// Part of its range that a joint must have to sweep.
const LEAST_PART: f64 = 0.02;

/// A way that ends where shapes come too near to one another.
struct Way {
    /// Along the joint, with its sign, rad or m.
    length: f64,
    /// The pair that ends it.
    blocked_by: Option<usize>,
}

impl Design {
    /// The longer of the two ways of a joint from the start posture, rad or m with its sign.
    pub(in crate::design) fn sweep_way(
        &self,
        joint: usize,
        limits: &JointLimits,
        start: &[f64],
        clearances: Option<&Clearances>,
    ) -> Result<f64, DesignError> {
        let ways = [limits.lower, limits.upper].map(|end| way(start, joint, end, clearances));
        let [lower, upper] = &ways;
        let longer = if -lower.length > upper.length { lower } else { upper };
        if longer.length.abs() >= LEAST_PART * (limits.upper - limits.lower) {
            return Ok(longer.length);
        }
        Err(self.no_room(limits, start[joint], &ways, clearances))
    }

    fn no_room(
        &self,
        limits: &JointLimits,
        start: f64,
        ways: &[Way; 2],
        clearances: Option<&Clearances>,
    ) -> DesignError {
        let in_file = |value: f64| limits.kind.to_file(value);
        let pair = ways.iter().find_map(|way| way.blocked_by);
        let pair = clearances.zip(pair).map(|(clearances, pair)| clearances.scene.names(pair).join(" and "));
        DesignError::NoRoomToSweep {
            path: self.path.clone(),
            joint: limits.joint.clone(),
            pair: pair.unwrap_or_default(),
            start: in_file(start),
            from: in_file(start + ways[0].length),
            to: in_file(start + ways[1].length),
            unit: limits.kind.file_unit(),
        }
    }
}

/// The way of a joint to an end, or to the last posture before shapes come too near.
fn way(start: &[f64], joint: usize, end: f64, clearances: Option<&Clearances>) -> Way {
    let all = end - start[joint];
    let mut postures = Series::zeros(POSTURES + 1, start.len());
    for k in 0..=POSTURES {
        let posture = postures.sample_mut(k);
        posture.copy_from_slice(start);
        posture[joint] += all * k as f64 / POSTURES as f64;
    }
    match clearances.and_then(|clearances| clearances.first_too_near(&postures)) {
        Some((k, pair)) => Way { length: all * k.saturating_sub(1) as f64 / POSTURES as f64, blocked_by: Some(pair) },
        None => Way { length: all, blocked_by: None },
    }
}
