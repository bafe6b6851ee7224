//! The changes that a robot may have, in their order.
//!
//! First those that are said: viscous and Coulomb friction and offset of each joint, then a payload. Those that are only allowed for follow: the
//! curve of each joint's friction and its delay, and the errors of the model's other parameters.

use std::ops::Range;

/// Viscous and Coulomb friction and offset of a joint.
pub(super) const OWN: usize = 3;
/// Names of a payload's parameters in the frame of the last link.
pub(super) const PAYLOAD: [&str; 10] = ["m", "mx", "my", "mz", "xx", "xy", "xz", "yy", "yz", "zz"];
/// Errors of a joint's model: friction at three speeds near rest and between both directions, and a delay of the torque.
pub(super) const CURVE: usize = 5;

/// How many changes there are, and where.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) joints: usize,
    /// Parameters of the model without friction and offsets.
    pub(super) model: usize,
}

impl Layout {
    /// The number of changes that are said.
    pub(super) fn said(self) -> usize {
        OWN * self.joints + PAYLOAD.len()
    }

    pub(super) fn all(self) -> usize {
        self.said() + CURVE * self.joints + self.model
    }

    /// The number of changes that act on one joint: its own, the payload, its curve, and the model's parameters.
    pub(super) fn of_joint(self) -> usize {
        OWN + PAYLOAD.len() + CURVE + self.model
    }

    /// The places of the changes that act on a joint, in the order of its rows.
    pub(super) fn places(self, joint: usize) -> [Range<usize>; 4] {
        let curve = self.said() + CURVE * joint;
        [
            OWN * joint..OWN * (joint + 1),
            OWN * self.joints..self.said(),
            curve..curve + CURVE,
            self.said() + CURVE * self.joints..self.all(),
        ]
    }

    /// The changes that act on a joint.
    pub(super) fn pick(self, changes: &[f64], joint: usize) -> Vec<f64> {
        self.places(joint).into_iter().flat_map(|places| &changes[places]).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_have_their_places() {
        let layout = Layout { joints: 2, model: 4 };
        assert_eq!((layout.said(), layout.all(), layout.of_joint()), (16, 30, 22));
        let places: Vec<usize> = layout.places(1).into_iter().flatten().collect();
        assert_eq!(places, [&[3, 4, 5][..], &Vec::from_iter(6..16), &Vec::from_iter(21..30)].concat());
        let changes: Vec<f64> = (0..30).map(f64::from).collect();
        assert_eq!(layout.pick(&changes, 0)[..5], [0.0, 1.0, 2.0, 6.0, 7.0]);
    }
}
