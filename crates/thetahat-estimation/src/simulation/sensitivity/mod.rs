//! Exact sensitivities of the closed loop: its variational equations, integrated with the states.
//!
//! [`Sensitivities`] drives a simulation and follows it: `loop_slopes` linearises the loop in a state (`controller_slopes` and
//! `held_slopes` the controller), `explicit` and `implicit` propagate the sensitivities through the stages of a step. They are stored in
//! `columns`: one row for each component of the state, one column for each parameter.

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
mod transition_columns;

pub use sensitive_to::{Motors, SensitiveTo};
pub use sensitivities::{Sensitivities, SensitivitySample};
