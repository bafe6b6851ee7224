//! What the crates of thetahat stand on. Internal: use the crate `thetahat`.

pub mod clock;
mod conversions;
pub mod digest;
pub mod files;
pub mod linear_algebra;
pub mod number;
pub mod one_or_each;
pub mod output;
pub mod pool;
pub mod real;
pub mod series;
pub mod vector;
pub mod visible;
