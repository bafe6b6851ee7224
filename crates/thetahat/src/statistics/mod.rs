//! Tests and figures that compare fits, and covariances of estimates under weaker assumptions than the classical one.

mod block;
mod f_test;
mod lagged;
mod rows;
mod sandwich;
mod stationary;
mod student;

pub use f_test::{FTest, f_test};
pub use rows::RowBlocks;
pub use sandwich::Sandwich;
pub use stationary::EstimatedVariance;
pub use student::t_quantile;
