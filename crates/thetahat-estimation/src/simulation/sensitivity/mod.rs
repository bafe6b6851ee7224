//! Exact sensitivities of the closed loop: its variational equations, integrated beside the states.
//!
//! [`Sensitivities`] drives a simulation and follows it: `loop_slopes` linearises the loop in a state (`controller_slopes` and
//! `held_slopes` the controller), `explicit` and `implicit` take the sensitivities through the stages of a step. They stand in
//! `columns`: rows are the components of the state, columns what the loop is sensitive to, side by side.

mod columns;
mod controller_slopes;
mod explicit;
mod held_slopes;
mod implicit;
mod linear_terms;
mod loop_slopes;
mod parameter_columns;
mod sensitive_to;
mod sensitivities;
mod stages;
mod torque_slopes;

pub use sensitive_to::{Motors, SensitiveTo};
pub use sensitivities::{Sample, Sensitivities};
