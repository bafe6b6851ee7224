//! Identification of the dynamic parameters of robots from recorded motion and torques.
//!
//! A robot's torque model is linear in its dynamic parameters, `tau = phi(q, dq, ddq) theta`. The folders of this
//! crate follow the way of the data, from the robot and the recording to the report; a module uses only modules
//! listed above it.

pub mod series;

pub mod linear_algebra;

mod real;

mod vector;

mod pool;

mod clock;

pub mod robot;

pub mod dynamics;

pub mod regressor;

pub mod base_parameters;

pub mod recording;

pub mod signal;

pub mod trajectory;

pub mod control;

pub mod simulation;

pub mod regression;

pub mod statistics;

pub mod identification;

pub mod checks;

pub mod results;

pub mod preparation;

mod scheduling;

mod diagnosis;

pub mod run;

pub mod experiment;

#[cfg(feature = "parquet")]
pub mod campaign;

pub mod reduction;

pub mod report;
