//! Models of a robot as expressions, and generated code in several languages.
//!
//! A [`Function`] is a list of operations ([`Program`]) with the information for its reader; [`Language::code`] writes it. The
//! recursions on expressions are arranged to take few operations: see `docs/manual/generated_code.md`.
//!
//! ```
//! use std::path::Path;
//! use thetahat_model::robot::Robot;
//! use thetahat_symbolic::symbolic::{DriveTorques, Function, Inputs, Language, ModelKind, ParameterSet, Request};
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! let (model, parameters) = (ModelKind::InverseDynamics, ParameterSet::Base);
//! let request = Request { model, parameters, values: None, drives: DriveTorques::Inertia, about: Vec::new(), friction_transition: None };
//! let function = Function::new(&robot, &request)?;
//! // About a vertical axis: tau = zz1r ddq.
//! let inputs = Inputs { ddq: &[2.0], theta: &[0.5, 0.0, 0.0, 0.0], ..Inputs::default() };
//! assert_eq!(function.program.evaluate(&inputs), [1.0]);
//! assert!(Language::C.code(&function, None)?.contains("void pendulum_inverse_dynamics("));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod base_formulas;
mod derivative;
mod drives;
mod error;
mod expression;
mod forward_dynamics;
mod graph;
mod inertia;
mod joints;
mod kinematics;
mod languages;
mod mass_matrix;
mod model;
mod newton_euler;
mod program;
mod regressor;
mod request;
mod snapping;
#[cfg(test)]
mod term_tests;
mod terms;
#[cfg(test)]
mod tests;
mod tip_columns;
mod twists;

pub use base_formulas::{BaseFormula, BaseFormulas, GeometrySymbol};
pub use error::SymbolicError;
pub use graph::Array;
pub use languages::Language;
pub use model::{Function, FunctionParameter};
pub use program::{Inputs, OperationCount, Program};
pub use request::{DriveTorques, ModelKind, ParameterSet, Request};
pub use snapping::Snapped;
