//! The rotation from a joint's frame to its parent joint's frame, in two parts: `Rot(z, gamma)`, a [`Turn`], which is absent in
//! serial Denavit-Hartenberg robots, and `Rot(x, alpha) Rot(z, theta)`, a [`Rotation`].

use thetahat_ground::{
    real::Real,
    vector::{Mat3, Vec3},
};

/// `Rot(x, alpha) Rot(z, theta)` as sines and cosines: rotating a vector takes 12 operations instead of 15, a symmetric matrix
/// 34 instead of 75.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rotation<T = f64> {
    pub(crate) sin_alpha: f64,
    pub(crate) cos_alpha: f64,
    pub(crate) sin_theta: T,
    pub(crate) cos_theta: T,
}

/// `Rot(z, gamma)` by its sine and cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) sin: f64,
    pub(crate) cos: f64,
}

impl<T: Real> Rotation<T> {
    /// `R x`: from frame j to frame j-1.
    #[inline(always)]
    pub(crate) fn times(&self, x: Vec3<T>) -> Vec3<T> {
        let (s, c) = (self.sin_theta, self.cos_theta);
        let turned = s * x[0] + c * x[1];
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        [c * x[0] - s * x[1], turned * ca - x[2] * sa, turned * sa + x[2] * ca]
    }

    /// `R^T x`: from frame j-1 to frame j.
    #[inline(always)]
    pub(crate) fn transpose_times(&self, x: Vec3<T>) -> Vec3<T> {
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        let turned = x[1] * ca + x[2] * sa;
        let (s, c) = (self.sin_theta, self.cos_theta);
        [c * x[0] + s * turned, c * turned - s * x[0], x[2] * ca - x[1] * sa]
    }

    /// `R B R^T` for a symmetric B: turned about z, then about x.
    #[inline(always)]
    pub(crate) fn rotate_symmetric(&self, b: &Mat3<T>) -> Mat3<T> {
        let (s, c) = (self.sin_theta, self.cos_theta);
        let (xx, yy, xy) = turn_in_plane(s, c, b[0][0], b[1][1], b[0][1]);
        let (xz, yz) = (c * b[0][2] - s * b[1][2], s * b[0][2] + c * b[1][2]);
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        let (yy, zz, yz) = turn_by_constant(sa, ca, yy, b[2][2], yz);
        let (xy, xz) = (xy * ca - xz * sa, xy * sa + xz * ca);
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }
}

impl Turn {
    /// `Rot(z, gamma) x`.
    #[inline(always)]
    pub(crate) fn times<T: Real>(&self, x: Vec3<T>) -> Vec3<T> {
        [x[0] * self.cos - x[1] * self.sin, x[0] * self.sin + x[1] * self.cos, x[2]]
    }

    /// `Rot(z, gamma)^T x`.
    #[inline(always)]
    pub(crate) fn transpose_times<T: Real>(&self, x: Vec3<T>) -> Vec3<T> {
        [x[0] * self.cos + x[1] * self.sin, x[1] * self.cos - x[0] * self.sin, x[2]]
    }

    /// `Rot(z, gamma) B Rot(z, gamma)^T` for a symmetric B.
    #[inline(always)]
    pub(crate) fn rotate_symmetric<T: Real>(&self, b: &Mat3<T>) -> Mat3<T> {
        let (s, c) = (self.sin, self.cos);
        let (xx, yy, xy) = turn_by_constant(s, c, b[0][0], b[1][1], b[0][1]);
        let (xz, yz) = (b[0][2] * c - b[1][2] * s, b[0][2] * s + b[1][2] * c);
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, b[2][2]]]
    }
}

/// The entries `(uu, vv, uv)` of a symmetric matrix turned in the plane of axes u and v.
#[inline(always)]
fn turn_in_plane<T: Real>(s: T, c: T, uu: T, vv: T, uv: T) -> (T, T, T) {
    let (ss, cs) = (s * s, c * s);
    // With c^2 = 1 - s^2, and the trace in the plane unchanged.
    let turned = uu - ss * (uu - vv) - cs * 2.0 * uv;
    (turned, uu + vv - turned, cs * (uu - vv) + (ss.like(1.0) - ss * 2.0) * uv)
}

/// [`turn_in_plane`] with constants.
#[inline(always)]
fn turn_by_constant<T: Real>(s: f64, c: f64, uu: T, vv: T, uv: T) -> (T, T, T) {
    let (ss, cs) = (s * s, c * s);
    let turned = uu - (uu - vv) * ss - uv * (2.0 * cs);
    (turned, uu + vv - turned, (uu - vv) * cs + uv * (1.0 - 2.0 * ss))
}
