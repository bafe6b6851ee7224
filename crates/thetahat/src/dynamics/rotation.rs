//! The rotation from one joint's frame to that of the joint before it.

use crate::vector::{Mat3, Vec3};

/// `Rot(z, gamma) Rot(x, alpha) Rot(z, theta)` by its sines and cosines: with them a vector takes 12 operations instead
/// of 15, a symmetric matrix 34 instead of 75. The turn by gamma, zero in serial Denavit-Hartenberg robots, is left out
/// where it is zero.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rotation {
    /// Whether gamma differs from zero.
    pub(crate) has_gamma: bool,
    pub(crate) sin_gamma: f64,
    pub(crate) cos_gamma: f64,
    pub(crate) sin_alpha: f64,
    pub(crate) cos_alpha: f64,
    pub(crate) sin_theta: f64,
    pub(crate) cos_theta: f64,
}

impl Rotation {
    /// `R x`: from frame j to frame j-1.
    #[inline]
    pub(crate) fn times(&self, x: Vec3) -> Vec3 {
        let (s, c) = (self.sin_theta, self.cos_theta);
        let turned = s * x[0] + c * x[1];
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        self.turn_by_gamma([c * x[0] - s * x[1], ca * turned - sa * x[2], sa * turned + ca * x[2]])
    }

    /// `R^T x`: from frame j-1 to frame j.
    #[inline]
    pub(crate) fn transpose_times(&self, x: Vec3) -> Vec3 {
        let x = self.turn_back_by_gamma(x);
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        let turned = ca * x[1] + sa * x[2];
        let (s, c) = (self.sin_theta, self.cos_theta);
        [c * x[0] + s * turned, c * turned - s * x[0], ca * x[2] - sa * x[1]]
    }

    /// `R B R^T` for a symmetric B: turned about z, then about x, then about z.
    #[inline]
    pub(crate) fn rotate_symmetric(&self, b: &Mat3) -> Mat3 {
        let (s, c) = (self.sin_theta, self.cos_theta);
        let [xx, yy, xy, xz, yz] = turn_about_z(s, c, [b[0][0], b[1][1], b[0][1], b[0][2], b[1][2]]);
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        let (yy, zz, yz) = turn_in_plane(sa, ca, yy, b[2][2], yz);
        let mut turned = [xx, yy, ca * xy - sa * xz, sa * xy + ca * xz, yz];
        if self.has_gamma {
            turned = turn_about_z(self.sin_gamma, self.cos_gamma, turned);
        }
        let [xx, yy, xy, xz, yz] = turned;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    #[inline]
    fn turn_by_gamma(&self, x: Vec3) -> Vec3 {
        let (s, c) = (self.sin_gamma, self.cos_gamma);
        if self.has_gamma { [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]] } else { x }
    }

    #[inline]
    fn turn_back_by_gamma(&self, x: Vec3) -> Vec3 {
        let (s, c) = (self.sin_gamma, self.cos_gamma);
        if self.has_gamma { [c * x[0] + s * x[1], c * x[1] - s * x[0], x[2]] } else { x }
    }
}

/// The entries `xx, yy, xy, xz, yz` of a symmetric matrix turned about z, which leaves `zz`.
#[inline]
fn turn_about_z(s: f64, c: f64, [xx, yy, xy, xz, yz]: [f64; 5]) -> [f64; 5] {
    let (xx, yy, xy) = turn_in_plane(s, c, xx, yy, xy);
    [xx, yy, xy, c * xz - s * yz, s * xz + c * yz]
}

/// The entries `(uu, vv, uv)` of a symmetric matrix turned in the plane of axes u and v.
#[inline]
fn turn_in_plane(s: f64, c: f64, uu: f64, vv: f64, uv: f64) -> (f64, f64, f64) {
    let (ss, cs) = (s * s, c * s);
    // With c^2 = 1 - s^2, and the trace in the plane unchanged.
    let turned = uu - ss * (uu - vv) - 2.0 * cs * uv;
    (turned, uu + vv - turned, cs * (uu - vv) + (1.0 - 2.0 * ss) * uv)
}
