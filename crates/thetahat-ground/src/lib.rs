//! Foundations shared by the crates of thetahat: numbers, vectors, linear algebra, series, files, threads. Internal: use the crate
//! `thetahat`.

pub mod series;

pub mod stretches;

pub mod interpolation;

pub mod linear_algebra;

pub mod quadratic_program;

mod conversions;

pub mod real;

pub mod vector;

pub mod pool;

pub mod clock;

pub mod number;

pub mod files;

pub mod visible;

pub mod output;

pub mod one_or_each;

pub mod digest;

pub mod syntax;
