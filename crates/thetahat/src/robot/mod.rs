//! The robot as data: links and joints, transmission, friction, and the one table of standard parameters.
//!
//! A robot is a serial chain of revolute and prismatic joints in modified Denavit-Hartenberg form
//! (Khalil and Kleinfinger, 1986). Its dynamic parameters are named once, in [`ParameterTable`].

mod description;
mod error;
mod parameters;
mod transmission;

pub use description::{Joint, JointKind, Robot};
pub use error::RobotError;
pub use parameters::{Friction, INERTIAL, Parameter, ParameterTable, Quantity};
pub use transmission::Transmission;
