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
//!
//! ```
//! use thetahat_estimation::{identification::{uncertainty, Method}, regression::Regression};
//! use thetahat_ground::linear_algebra::Matrix;
//!
//! // y = 2 x with a small error: the interval contains 2.
//! let x = Matrix::from_fn(100, 1, |k, _| (0.1 * k as f64).sin());
//! let y = (0..100).map(|k| 2.0 * x.at(k, 0) + 1e-3 * (7.0 * k as f64).cos()).collect();
//! let regression = Regression::single_series(x, y);
//! let fit = Method::IDIM_LS.estimate(&regression, None, Default::default())?;
//! let [low, high] = uncertainty(Method::IDIM_LS, &regression, None, &fit)?.interval_95[0];
//! assert!(low < 2.0 && 2.0 < high && high - low < 1e-2);
//! # Ok::<(), thetahat_estimation::identification::EstimationError>(())
//! ```

mod assembly;
mod essential;
mod estimators;
mod fit;
mod iteration;
mod joint_weights;
mod linearised;
mod outcome;
mod prediction_error;
mod row_mask;
mod separated;
mod steps;
mod stretches;
mod uncertainty;
mod user_estimator;

pub use assembly::Assembly;
pub use essential::{Elimination, EliminationRule, eliminate, nested_f_test};
pub use estimators::{DesignMatrix, Method, Needs, Response, UnknownMethod, Weighting, didim, idim_iv, idim_ls};
pub use fit::{Divisor, EstimationError, Fit, SimulatedResponse};
pub use iteration::{Convergence, Estimation, IterationOptions, Revision, iterate};
pub use joint_weights::JointWeights;
pub use linearised::{GaussNewtonStep, StepProjection};
pub use outcome::{Iteration, Outcome, Reason, Status};
pub use prediction_error::{PredictionErrorEstimation, SimulationRequest};
pub use row_mask::{NearRest, RowMask};
#[doc(hidden)]
pub use row_mask::{hardly_moves, share_of_row};
#[doc(hidden)]
pub use separated::{DependentColumn, SeparatedColumns};
#[doc(hidden)]
pub use stretches::uncertainty_of_stretches;
pub use uncertainty::{Uncertainty, uncertainty};
pub use user_estimator::{UserError, UserEstimate, UserEstimator, UserEstimatorName, UserRegression};
