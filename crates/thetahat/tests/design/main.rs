//! Designs: what is refused, limits that hold, and promises that are kept.

mod at_hand;
mod collision;
mod gravity;
mod limits;
mod motions;
mod payload;
mod refusals;
mod rehearsal;
mod support;
mod sweeps;
