//! Vectors and matrices of three, as plain arrays.

use crate::real::{Parameter, Real};

/// A vector of three.
pub type Vec3<T = f64> = [T; 3];
/// A matrix of three rows.
pub type Mat3<T = f64> = [[T; 3]; 3];

/// The identity.
pub const IDENTITY: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// `a + b`.
#[inline(always)]
pub fn add<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `s a`.
#[inline(always)]
pub fn scale<T: Real>(s: T, a: Vec3<T>) -> Vec3<T> {
    [s * a[0], s * a[1], s * a[2]]
}

/// `a . b`.
#[inline(always)]
pub fn dot<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
#[inline(always)]
pub fn cross<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `A x`.
#[inline(always)]
pub fn times<T: Real>(a: &Mat3<T>, x: Vec3<T>) -> Vec3<T> {
    [dot(a[0], x), dot(a[1], x), dot(a[2], x)]
}

/// `A x` with a constant A.
#[inline(always)]
pub fn constant_times<T: Real>(a: &Mat3, x: Vec3<T>) -> Vec3<T> {
    a.map(|row| x[0] * row[0] + x[1] * row[1] + x[2] * row[2])
}

/// `A^T x`.
#[inline(always)]
pub fn transpose_times<T: Real>(a: &Mat3, x: Vec3<T>) -> Vec3<T> {
    let column = |j: usize| x[0] * a[0][j] + x[1] * a[1][j] + x[2] * a[2][j];
    [column(0), column(1), column(2)]
}

/// A constant vector in every lane, or one vector for each lane.
#[inline(always)]
pub fn in_lanes<T: Real, P: Parameter<T>>(kind: T, v: Vec3<P>) -> Vec3<T> {
    [v[0].in_lanes(kind), v[1].in_lanes(kind), v[2].in_lanes(kind)]
}

/// `A B`.
#[inline]
pub fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    a.map(|row| transpose_times(b, row))
}

/// `A^T`.
#[inline]
pub fn transpose(a: &Mat3) -> Mat3 {
    [0, 1, 2].map(|j| [a[0][j], a[1][j], a[2][j]])
}

/// `R B R^T`.
#[inline]
pub fn turned(r: &Mat3, b: &Mat3) -> Mat3 {
    product(&product(r, b), &transpose(r))
}

/// `|a|`.
#[inline]
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// `a - b`.
#[inline]
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The rotation about an axis of length one.
pub fn axis_angle(axis: Vec3, angle: f64) -> Mat3 {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = axis;
    let skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let entry = |i: usize, j: usize| c * IDENTITY[i][j] + s * skew[i][j] + (1.0 - c) * axis[i] * axis[j];
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// The rotation of a quaternion of length one: w, x, y, z.
pub fn quaternion_rotation([w, x, y, z]: [f64; 4]) -> Mat3 {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// A rotation with the given z axis: the identity where it is z, with exact zeros and ones where it is an axis of the frame.
pub fn with_z(z: Vec3) -> Mat3 {
    let size = |i: &usize| z[*i].abs();
    let largest = [2, 0, 1].into_iter().reduce(|a, b| if size(&b) > size(&a) { b } else { a }).unwrap_or(2);
    let mut toward = [0.0; 3];
    toward[(largest + 1) % 3] = 1.0;
    let x = add(toward, scale(-dot(toward, z), z));
    let x = scale(1.0 / norm(x), x);
    transpose(&[x, cross(z, x), z])
}
