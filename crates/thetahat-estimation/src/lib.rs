//! Estimators of a robot's dynamic parameters, and what they stand on: filters, closed-loop simulation, statistics.

pub mod checks;
pub mod control;
pub mod identification;
pub mod regression;
pub mod signal;
pub mod simulation;
pub mod statistics;
pub mod trajectory;
