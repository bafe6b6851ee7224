//! The numbers that the kernels are written for: one state ([`f64`]), or several states side by side in the lanes of a
//! vector ([`Lanes`]), with the same operations in the same order: both give the same bits. [`Dual`] numbers carry a derivative.

mod dual;
mod functions;
mod lanes;
mod number;
mod scalar;
mod sin_cos;
mod tanh;

pub(crate) use dual::Dual;
pub(crate) use functions::{absolute, exp, function_of, power, square_root};
pub(crate) use lanes::{Lanes, MOST_LANES};
pub(crate) use number::{Parameter, Real};
pub(crate) use tanh::{sign_or, tanh};
