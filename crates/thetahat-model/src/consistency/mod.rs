//! Physically consistent parameters: standard parameters that a robot made of rigid bodies can have.
//!
//! [`ConsistentSet`] is the set: the pseudo-inertia matrix of each link positive semidefinite, motor inertias and friction
//! not below zero, and [`Known`] properties. Base parameters are consistent if some standard parameters of the set have
//! them. [`fit`] finds the parameters of the set with the least squares, or nearest to an estimate, with or without a
//! [`Prior`]; [`examine`] determines whether and where an estimate is outside; [`nearest_to_simulate`] gives parameters in the
//! interior for instruments; [`completed_a_priori`] guesses missing a-priori values.
//!
//! Every problem is a small convex program, solved by a primal-dual interior-point method. Formulas, sources and the choice of the method: `docs/theory/physical_consistency.md`.
//!
//! ```
//! use thetahat_model::{consistency::{completed_a_priori, ConsistentSet}, robot::Robot};
//!
//! # let robot = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
//! # let robot = Robot::parse(robot, std::path::Path::new("r.toml")).unwrap();
//! // Bodies guessed from geometry are physical; bodies of negative mass are refused.
//! let a_priori = completed_a_priori(&robot, None);
//! assert!(ConsistentSet::new(&robot, &a_priori).is_ok());
//! let negative: Vec<f64> = a_priori.iter().map(|v| -v).collect();
//! assert!(ConsistentSet::new(&robot, &negative).is_err());
//! ```

mod belief;
mod bounds;
mod dependence;
mod elimination;
mod error;
mod examination;
mod fit;
mod guess;
mod interior;
mod interior_point;
mod known;
mod program;
mod pseudo_inertia;
mod set;
mod simulation;
mod symmetric;
#[cfg(test)]
mod tests;

pub use belief::{BaseKnowledge, knowledge_of_base};
pub use bounds::{bounds_of, interval_in};
pub use dependence::{Dependence, dependence_on_base};
pub use error::ConsistencyError;
pub use examination::{Examination, HEAVIEST, examine, examine_within};
pub use fit::{ConsistentFit, LeastSquares, Prior, fit, fit_within, require_interior};
pub use guess::{completed_a_priori, mass_factor, stated_links};
pub use known::Known;
pub use pseudo_inertia::{inertial_parameters, pseudo_inertia};
pub use set::{Beliefs, Condition, ConsistentSet};
pub use simulation::{InteriorOptions, nearest_to_simulate};
pub use symmetric::Symmetric;
