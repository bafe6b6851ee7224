//! Tests and figures that compare fits.

mod f_test;

pub use f_test::{FTest, f_test};
