use crate::robot::JointKind;
use thetahat_ground::real::Real;

/// Positions and velocities of the coordinates; for vectors `T`, of one state in each lane.
#[derive(Debug)]
pub struct State<'a, T = f64> {
    /// Positions, rad or m.
    pub q: &'a [T],
    /// Velocities, rad/s or m/s.
    pub dq: &'a [T],
    /// The recorded channels that torque terms use, channel after channel with one value for each coordinate; empty if no term
    /// uses one.
    pub channels: &'a [T],
}

impl<'a, T> State<'a, T> {
    /// A state of a robot whose torque terms use no recorded channel.
    #[inline(always)]
    #[must_use]
    pub fn new(q: &'a [T], dq: &'a [T]) -> Self {
        Self { q, dq, channels: &[] }
    }

    /// The state with the values of recorded channels.
    #[inline(always)]
    #[must_use]
    pub fn with_channels(self, channels: &'a [T]) -> Self {
        Self { channels, ..self }
    }
}

impl<T> Clone for State<'_, T> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for State<'_, T> {}

/// The coordinate that moves a joint: the joint's position is `ratio q + offset`, with ratio one and offset zero except for
/// joints that follow others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCoordinate {
    /// Number of the coordinate, from zero.
    pub coordinate: usize,
    /// The joint's velocity per velocity of the coordinate, and torque on the coordinate per torque of the joint.
    pub ratio: f64,
    /// The joint's position at coordinate zero, rad or m.
    pub offset: f64,
    /// Whether the joint turns or slides.
    pub kind: JointKind,
}

impl JointCoordinate {
    /// The joint's own position.
    #[inline(always)]
    pub(super) fn position<T: Real>(&self, q: &[T]) -> T {
        let q = q[self.coordinate];
        q * self.ratio + q.like(self.offset)
    }

    /// The joint's own velocity or acceleration.
    #[inline(always)]
    pub(super) fn rate<T: Real>(&self, rates: &[T]) -> T {
        rates[self.coordinate] * self.ratio
    }
}
