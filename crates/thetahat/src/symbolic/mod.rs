//! Symbolic models of a robot, and code of them.

mod base_formulas;
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
mod snapping;
#[cfg(test)]
mod tests;

pub use base_formulas::{BaseFormula, BaseFormulas, GeometrySymbol};
pub use error::SymbolicError;
pub use graph::Array;
pub use languages::Language;
pub use model::{DriveTorques, Function, FunctionParameter, ModelKind, ParameterSet, Request};
pub use program::{Inputs, OperationCount, Program};
pub use snapping::{Snapped, snapped};
