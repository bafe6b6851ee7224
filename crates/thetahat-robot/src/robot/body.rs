//! Frames relative to frames, and rigid bodies expressed in them.

use thetahat_ground::vector::{
    IDENTITY, Mat3, Vec3, add, dot, product, scale, times, transpose, transpose_times, turned,
};

/// A frame relative to a parent frame: `x = rotation x' + origin`.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Frame {
    #[doc(hidden)]
    pub rotation: Mat3,
    #[doc(hidden)]
    pub origin: Vec3,
}

impl Frame {
    #[doc(hidden)]
    pub const SAME: Self = Self { rotation: IDENTITY, origin: [0.0; 3] };

    /// Transforms a point of this frame to the parent frame.
    #[doc(hidden)]
    pub fn of_point(&self, point: Vec3) -> Vec3 {
        add(self.origin, times(&self.rotation, point))
    }

    /// The parent frame relative to this one.
    #[doc(hidden)]
    pub fn inverse(&self) -> Self {
        let origin = scale(-1.0, transpose_times(&self.rotation, self.origin));
        Self { rotation: transpose(&self.rotation), origin }
    }

    /// Composes: a frame relative to this one, expressed in the parent frame.
    #[doc(hidden)]
    pub fn then(&self, next: &Self) -> Self {
        Self { rotation: product(&self.rotation, &next.rotation), origin: self.of_point(next.origin) }
    }
}

/// Mass, first moments and inertia about the origin of a frame.
#[derive(Clone, Copy, Default, PartialEq)]
#[doc(hidden)]
pub struct RigidBody {
    #[doc(hidden)]
    pub m: f64,
    #[doc(hidden)]
    pub ms: Vec3,
    #[doc(hidden)]
    pub inertia: Mat3,
}

impl RigidBody {
    /// The body, given in a frame, about the origin of the parent frame.
    #[doc(hidden)]
    pub fn seen_in(&self, frame: &Frame) -> Self {
        let (p, s) = (frame.origin, times(&frame.rotation, self.ms));
        let mut inertia = turned(&frame.rotation, &self.inertia);
        let spherical = 2.0 * dot(p, s) + self.m * dot(p, p);
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= p[i] * s[j] + s[i] * p[j] + self.m * p[i] * p[j];
            }
            row[i] += spherical;
        }
        Self { m: self.m, ms: add(s, scale(self.m, p)), inertia }
    }

    #[doc(hidden)]
    pub fn absorb(&mut self, other: &Self) {
        self.m += other.m;
        self.ms = add(self.ms, other.ms);
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
    }

    /// From its parameters in the order of [`crate::robot::INERTIAL`].
    #[doc(hidden)]
    pub fn from_parameters([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Self {
        Self { m, ms: [mx, my, mz], inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] }
    }

    /// In the order of [`crate::robot::INERTIAL`].
    #[doc(hidden)]
    pub fn parameters(&self) -> [f64; 10] {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.inertia;
        let [mx, my, mz] = self.ms;
        [xx, xy, xz, yy, yz, zz, mx, my, mz, self.m]
    }
}
