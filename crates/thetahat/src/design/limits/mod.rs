//! Limits of joints, loads and distances between shapes, in the search and at 1 kHz.

pub(in crate::design) mod clearances;
pub(in crate::design) mod constraints;
pub(in crate::design) mod execution;
pub(in crate::design) mod joint_limits;
pub(in crate::design) mod loads;
pub(in crate::design) mod surroundings;
pub(in crate::design) mod sweep_room;
pub(in crate::design) mod verification;
pub(in crate::design) mod verified;
