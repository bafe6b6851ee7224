//! Vectors and matrices of three, as plain arrays.

pub(crate) type Vec3 = [f64; 3];
pub(crate) type Mat3 = [[f64; 3]; 3];

#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn scale(s: f64, a: Vec3) -> Vec3 {
    [s * a[0], s * a[1], s * a[2]]
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `A x`.
#[inline]
pub(crate) fn times(a: &Mat3, x: Vec3) -> Vec3 {
    [dot(a[0], x), dot(a[1], x), dot(a[2], x)]
}

/// `A^T x`.
#[inline]
pub(crate) fn transpose_times(a: &Mat3, x: Vec3) -> Vec3 {
    [
        a[0][0] * x[0] + a[1][0] * x[1] + a[2][0] * x[2],
        a[0][1] * x[0] + a[1][1] * x[1] + a[2][1] * x[2],
        a[0][2] * x[0] + a[1][2] * x[1] + a[2][2] * x[2],
    ]
}

/// `A B`.
#[inline]
pub(crate) fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    let column = |j: usize| times(a, [b[0][j], b[1][j], b[2][j]]);
    let (c0, c1, c2) = (column(0), column(1), column(2));
    [[c0[0], c1[0], c2[0]], [c0[1], c1[1], c2[1]], [c0[2], c1[2], c2[2]]]
}

/// `A B A^T` for a symmetric B.
#[inline]
pub(crate) fn rotate_symmetric(a: &Mat3, b: &Mat3) -> Mat3 {
    let ab = product(a, b);
    let row = |i: usize| times(a, ab[i]);
    [row(0), row(1), row(2)]
}
