//! The estimators over a [`Regression`](crate::regression::Regression) and instruments: IDIM-LS (8), IDIM-IV (9) and (10),
//! DIDIM (12) to (19), and the iteration of the last two over a simulator.
//!
//! | letter | word | shape |
//! | --- | --- | --- |
//! | `y` | decimated torques, joint by joint, each joint's samples in time order | r |
//! | `X` | observation matrix of the measured motion, same rows | r x b |
//! | `Z` | instrument matrix: the observation matrix of the simulated motion, same rows | r x b |
//! | `theta` | parameters | b |
//! | `rho` | residual, `y - X theta` for LS and IV, `y - Z theta` for DIDIM | r |
//!
//! Least squares are solved by QR with column pivoting, and IV through the orthonormal factor of Z, so that no
//! condition number is squared.

mod assembly;
mod essential;
mod estimators;
mod fit;
mod iteration;
mod outcome;
mod uncertainty;

pub use assembly::Assembly;
pub use essential::{Elimination, EliminationRule, eliminate, nested_f_test};
pub use estimators::{Design, Method, Needs, UnknownMethod, Weighting, didim, idim_iv, idim_ls};
pub use fit::{Divisor, EstimationError, Fit};
pub use iteration::{Convergence, Estimation, IterationOptions, iterate};
pub use outcome::{Iteration, Outcome, Reason, Status};
pub use uncertainty::{Uncertainty, uncertainty};
