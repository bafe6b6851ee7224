//! The number types of the kernels: one state ([`f64`]), or several states in the lanes of a vector ([`Lanes`]), with the same operations
//! in the same order, so that both give the same bits. [`Dual`] numbers carry a derivative.

mod dual;
mod functions;
mod lanes;
mod number;
mod scalar;
mod sin_cos;
mod tanh;

pub use dual::Dual;
pub use functions::{absolute, exp, function_of, power, square_root};
pub use lanes::{Lanes, MOST_LANES};
pub use number::{Parameter, Real};
pub use tanh::{sign_or, tanh};
