//! Torque terms whose constants are found with the parameters, and friction laws compared.

pub(in crate::run) mod column_source;
pub(in crate::run) mod comparison;
pub(in crate::run) mod of_positions;
pub(in crate::run) mod profile;
pub(in crate::run) mod profiled_robot;
