//! Motions as functions of unknowns: sums of functions of time, and point-to-point moves with sweeps.

pub(in crate::design) mod basis;
pub(in crate::design) mod family;
pub(in crate::design) mod fourier;
pub(in crate::design) mod move_draws;
pub(in crate::design) mod move_slopes;
pub(in crate::design) mod move_sweeps;
#[cfg(test)]
mod move_tests;
pub(in crate::design) mod moves;
pub(in crate::design) mod splines;
pub(in crate::design) mod sums;
pub(in crate::design) mod sweeps;
