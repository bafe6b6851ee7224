//! Frames in frames, and bodies seen in them.

use crate::vector::{IDENTITY, Mat3, Vec3, add, dot, product, scale, times, turned};

/// A frame in another: `x = rotation x' + origin`.
#[derive(Clone, Copy)]
pub(in crate::robot) struct Frame {
    pub(in crate::robot) rotation: Mat3,
    pub(in crate::robot) origin: Vec3,
}

impl Frame {
    pub(in crate::robot) const SAME: Self = Self { rotation: IDENTITY, origin: [0.0; 3] };

    /// A frame that is given in this one, in the frame in which this one is given.
    pub(in crate::robot) fn then(&self, next: &Self) -> Self {
        Self {
            rotation: product(&self.rotation, &next.rotation),
            origin: add(self.origin, times(&self.rotation, next.origin)),
        }
    }
}

/// Mass, first moments and inertia about the origin of a frame.
#[derive(Clone, Copy, Default, PartialEq)]
pub(in crate::robot) struct Body {
    pub(in crate::robot) m: f64,
    pub(in crate::robot) ms: Vec3,
    pub(in crate::robot) inertia: Mat3,
}

impl Body {
    /// The same body, given in a frame, about the origin in which that frame is given.
    pub(in crate::robot) fn seen_in(&self, frame: &Frame) -> Self {
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

    pub(in crate::robot) fn absorb(&mut self, other: &Self) {
        self.m += other.m;
        self.ms = add(self.ms, other.ms);
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
    }

    /// From its parameters in the order of [`crate::robot::INERTIAL`].
    pub(in crate::robot) fn from_parameters([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Self {
        Self { m, ms: [mx, my, mz], inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] }
    }

    /// In the order of [`crate::robot::INERTIAL`].
    pub(in crate::robot) fn parameters(&self) -> [f64; 10] {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.inertia;
        let [mx, my, mz] = self.ms;
        [xx, xy, xz, yy, yz, zz, mx, my, mz, self.m]
    }
}
