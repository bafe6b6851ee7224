//! Vectors and matrices of three, as plain arrays.

use crate::real::{Parameter, Real};

pub(crate) type Vec3<T = f64> = [T; 3];
pub(crate) type Mat3<T = f64> = [[T; 3]; 3];

pub(crate) const IDENTITY: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[inline(always)]
pub(crate) fn add<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn scale<T: Real>(s: T, a: Vec3<T>) -> Vec3<T> {
    [s * a[0], s * a[1], s * a[2]]
}

#[inline(always)]
pub(crate) fn dot<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `A x`.
#[inline(always)]
pub(crate) fn times<T: Real>(a: &Mat3<T>, x: Vec3<T>) -> Vec3<T> {
    [dot(a[0], x), dot(a[1], x), dot(a[2], x)]
}

/// `A x` with a constant A.
#[inline(always)]
pub(crate) fn constant_times<T: Real>(a: &Mat3, x: Vec3<T>) -> Vec3<T> {
    a.map(|row| x[0] * row[0] + x[1] * row[1] + x[2] * row[2])
}

/// `A^T x`.
#[inline(always)]
pub(crate) fn transpose_times<T: Real>(a: &Mat3, x: Vec3<T>) -> Vec3<T> {
    let column = |j: usize| x[0] * a[0][j] + x[1] * a[1][j] + x[2] * a[2][j];
    [column(0), column(1), column(2)]
}

/// A constant vector, in every lane; or one for each.
#[inline(always)]
pub(crate) fn in_lanes<T: Real, P: Parameter<T>>(kind: T, v: Vec3<P>) -> Vec3<T> {
    [v[0].in_lanes(kind), v[1].in_lanes(kind), v[2].in_lanes(kind)]
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
