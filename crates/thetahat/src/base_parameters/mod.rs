//! Base parameters: the independent combinations of standard parameters that torques can show.
//!
//! The observation matrix of random states (fixed seed) is examined column by column, in the order of the standard
//! parameters: a column that the kept ones do not span is kept, the others are regrouped into them. The number of base
//! parameters is the rank by QR with column pivoting, and the two must agree (M. Gautier, "Numerical calculation of the
//! base inertial parameters of robots", 1990).

mod regrouping;

pub use regrouping::{BaseParameter, BaseParameters, BaseParametersError};
