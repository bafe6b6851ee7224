use crate::robot::JointKind;
use thetahat_ground::real::{Real, sign_or, tanh};

/// The velocities v of `tanh(dq / v)`, at which friction reaches 76 % of its Coulomb value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionTransition {
    /// Of joints that turn, rad/s.
    pub turning: f64,
    /// Of joints that slide, m/s.
    pub sliding: f64,
}

impl FrictionTransition {
    /// The same number for all joints, rad/s or m/s.
    #[must_use]
    pub const fn of_all(velocity: f64) -> Self {
        Self { turning: velocity, sliding: velocity }
    }

    /// That of joints that slide, if it is another number.
    #[must_use]
    pub fn sliding_apart(self) -> Option<f64> {
        (self.sliding != self.turning).then_some(self.sliding)
    }

    /// That of a joint.
    #[inline(always)]
    #[must_use]
    pub const fn of(self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => self.turning,
            JointKind::Prismatic => self.sliding,
        }
    }
}

/// How the sign function of Coulomb friction is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// -1, 0 or 1: for measured velocities.
    Exact,
    /// `tanh(dq / v)`: for simulated velocities, with the v of the joint's kind.
    Smooth(FrictionTransition),
}

impl Sign {
    /// `tanh(dq / v)` with the same number v for all joints, rad/s or m/s.
    #[must_use]
    pub const fn smooth(v: f64) -> Self {
        Self::Smooth(FrictionTransition::of_all(v))
    }

    /// The sign of the velocity `v` of a joint.
    #[inline(always)]
    #[must_use]
    pub fn of(self, v: f64, kind: JointKind) -> f64 {
        self.of_each(v, kind)
    }

    /// The sign in each lane; zero and NaN stay as they are.
    #[inline(always)]
    pub(crate) fn of_each<T: Real>(self, v: T, kind: JointKind) -> T {
        match self {
            Self::Exact => sign_or(v, v),
            Self::Smooth(transition) => tanh(v / v.like(transition.of(kind))),
        }
    }
}
