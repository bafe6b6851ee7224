use thetahat_ground::real::{Real, sign_or, tanh};

/// How the sign function of Coulomb friction is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// -1, 0 or 1: for measured velocities.
    Exact,
    /// `tanh(v / scale)`: for simulated velocities, with the scale in rad/s or m/s.
    Smooth {
        /// The velocity at which friction reaches 76 % of its Coulomb value.
        scale: f64,
    },
}

impl Sign {
    /// The sign of `v`.
    #[inline(always)]
    #[must_use]
    pub fn of(self, v: f64) -> f64 {
        self.of_each(v)
    }

    /// The sign in each lane; zero and NaN stay as they are.
    #[inline(always)]
    pub(crate) fn of_each<T: Real>(self, v: T) -> T {
        match self {
            Self::Exact => sign_or(v, v),
            Self::Smooth { scale } => tanh(v / v.like(scale)),
        }
    }
}
