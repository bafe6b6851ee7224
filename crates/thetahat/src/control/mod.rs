//! Controllers as data: PD and cascaded loops with feed-forward, saturation, sample time and delay.
//!
//! A controller acts on each motor by itself, in the motor's position expressed in joint units, and gives the drive
//! signal (motor torque, or volts where the drive has a gain).
//!
//! | letter | word | unit |
//! | --- | --- | --- |
//! | `e` | position error, reference less motor position in joint units | rad (m) |
//! | `dr ddr` | velocity and acceleration of the reference | rad/s, rad/s^2 |
//! | `v` | velocity that the controller sees | rad/s |
//! | `u` | drive signal | N m at the motor, or V |

mod controller;

pub use controller::{Controller, ControllerDescription, ControllerError, Law, VelocityEstimate};
