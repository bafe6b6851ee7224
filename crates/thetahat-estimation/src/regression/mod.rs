//! The regression `y = X theta + e` that all estimators, tests and checks use.
//!
//! A [`Regression`] has the rows, their weights and their [`RowLayout`]. The triangular factors of a reduction are a regression
//! as well: few rows that represent all rows of the recordings.
//!
//! | letter | word | shape |
//! | --- | --- | --- |
//! | `y` | decimated torques, joint by joint, for each joint recording by recording, in time order | r |
//! | `X` | observation matrix of the measured motion, same rows | r x b |
//! | `Z` | instrument matrix: the observation matrix of the simulated motion, same rows | r x b |
//!
//! ```
//! use thetahat_estimation::regression::{Regression, RowLayout};
//! use thetahat_ground::linear_algebra::Matrix;
//!
//! // Two joints with two rows each; the second joint's torque is off by a tenth.
//! let x = Matrix::from_fn(4, 1, |_, _| 1.0);
//! let regression = Regression::new(x, vec![2.0, 2.0, 2.2, 2.2], RowLayout::new(2, &[2]));
//! let errors = regression.joint_relative_errors_percent(&[2.0; 4]);
//! assert_eq!(errors[0], Some(0.0));
//! assert!((errors[1].unwrap() - 100.0 * 0.2 / 2.2).abs() < 1e-12);
//! ```

mod instruments;
mod layout;
mod rows;

pub use instruments::InstrumentalVariables;
#[doc(hidden)]
pub use layout::BlockKey;
pub use layout::{RowBlock, RowLayout};
pub use rows::{Regression, relative_error_percent};
