//! Vectors and matrices of three, as plain arrays.

pub(crate) type Vec3 = [f64; 3];
pub(crate) type Mat3 = [[f64; 3]; 3];

pub(crate) const IDENTITY: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

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
    [0, 1, 2].map(|j| a[0][j] * x[0] + a[1][j] * x[1] + a[2][j] * x[2])
}

/// `A B`.
pub(crate) fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    a.map(|row| transpose_times(b, row))
}

pub(crate) fn transpose(a: &Mat3) -> Mat3 {
    [0, 1, 2].map(|j| [a[0][j], a[1][j], a[2][j]])
}

/// `R B R^T`.
pub(crate) fn turned(r: &Mat3, b: &Mat3) -> Mat3 {
    product(&product(r, b), &transpose(r))
}

pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}
