//! Models of robots: descriptions, dynamics, regressor, base parameters, physical consistency, generated code.

pub mod base_parameters;
pub mod collision;
pub mod consistency;
pub mod dynamics;
pub mod regressor;
pub mod robot;
pub mod robot_summary;
pub mod symbolic;
