//! Checks of the robot's description.

pub(in crate::checks) mod a_priori;
pub(in crate::checks) mod description;
pub(in crate::checks) mod mirrored;
pub(in crate::checks) mod wrong_robot;
