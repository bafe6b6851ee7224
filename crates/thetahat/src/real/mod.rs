//! The numbers that the kernels are written for: one state ([`f64`]), or several states side by side in the lanes of a
//! vector ([`Lanes`]), with the same operations in the same order. Both give the same bits but for sines and cosines, which
//! differ by a unit in the last place.

mod lanes;
mod scalar;
mod sin_cos;

pub(crate) use lanes::Lanes;
pub(crate) use scalar::Real;
