//! Foundations shared by the crates of thetahat: numbers, vectors, linear algebra, series, files, threads. Internal: use the crate
//! `thetahat`.

pub mod clock;
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
