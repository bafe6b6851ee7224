//! Models of robots: descriptions, dynamics, regressor, base parameters, physical consistency, generated code.

#[doc(inline)]
pub use thetahat_robot::robot;

pub mod dynamics;

pub mod regressor;

pub mod base_parameters;

pub mod robot_summary;

pub mod consistency;

pub mod collision;
