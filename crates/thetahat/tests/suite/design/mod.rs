//! Designs: what is refused, limits that hold, and predicts that are kept.

mod collision;
mod execution;
mod gravity;
mod limits;
mod motions;
mod payload;
mod prior_data;
mod refusals;
mod rehearsal;
mod support;
mod sweeps;
