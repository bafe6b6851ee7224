//! A condition between two links.

use thetahat_ground::vector::Vec3;

/// A point of a link, in the axes of its joint's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Anchor {
    /// The link's joint, or [`BASE`].
    pub(super) joint: usize,
    pub(super) point: Vec3,
}

/// A condition between two links.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::dynamics) struct Condition {
    /// The loop, from zero.
    pub(super) of_loop: usize,
    pub(super) ends: [Anchor; 2],
    /// The distance of the points, m; none if they coincide.
    pub(super) distance: Option<f64>,
}

impl Condition {
    /// Number of its equations.
    pub(super) fn equations(&self) -> usize {
        if self.distance.is_some() { 1 } else { 3 }
    }
}
