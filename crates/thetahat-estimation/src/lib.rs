//! Estimators of a robot's dynamic parameters, and what they stand on: filters, closed-loop simulation, statistics.

pub mod signal;

pub mod trajectory;

pub mod control;

pub mod simulation;

pub mod regression;

pub mod statistics;

pub mod identification;

pub mod checks;
