//! Base parameters: the combinations of standard parameters that torques determine.
//!
//! The observation matrix of random states (fixed seed) is examined column by column, in the order of the standard
//! parameters: a column that the kept ones do not span is kept, the others are regrouped into them (M. Gautier, "Numerical
//! calculation of the base inertial parameters of robots", 1990).
//!
//! The work is done joint by joint, from the last to the first, on the columns of a link and the link before it at a time. For
//! a free joint that drives nothing else, a combination of its link's parameters without effect on its own torque is equivalent
//! to a mass on the previous link, as in the recursion of P. Wensing, G. Niemeyer and J.-J. Slotine, "Observability in inertial
//! parameter identification", 2017; other combinations, for example of followers and coupled motors, are carried on to the next
//! joint. If a decision is not clear by orders of magnitude, the whole matrix is examined at once, and its rank by QR with
//! column pivoting must agree.
//!
//! ```
//! use std::path::Path;
//! use thetahat_model::{base_parameters::BaseParameters, dynamics::Model, robot::Robot};
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n[parameters]\nzz1 = 0.5\nia1 = 0.3";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! // About a vertical axis only the inertia about it acts, together with the motor's inertia.
//! let base = BaseParameters::of(&Model::new(&robot), &[])?;
//! assert_eq!(base.parameters()[0].expression, "zz1 + ia1");
//! assert!((base.from_standard(&robot.a_priori_parameters())[0] - (0.5 + 0.3)).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod combination;
mod dependencies;
mod error;
mod joint_by_joint;
mod left_to_right;
mod null_space;
mod observations;
mod regrouping;
#[cfg(test)]
mod tests;
mod whole;

pub use error::BaseParametersError;
pub use regrouping::{BaseParameter, BaseParameters};
