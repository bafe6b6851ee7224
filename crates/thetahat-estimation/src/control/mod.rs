//! Controllers: PD and cascaded loops as data, with feed-forward, saturation, sample time and delay, and laws of the user's own.
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
//!
//! ```
//! use thetahat_estimation::control::ControllerDescription;
//! let text = "law = 'pd'\nposition_gain = [100]\nvelocity_gain = [20]\nsaturation = [50]";
//! let description: ControllerDescription = toml::from_str(text)?;
//! let controller = description.resolve(&[1.0], 1.0);
//! // 100 N m/rad times 0.1 rad less 20 N m s/rad times 0.25 rad/s; then the limit.
//! assert_eq!(controller.command(0, 0.1, 0.25, 0.0, 0.0), 5.0);
//! assert_eq!(controller.command(0, 1.0, 0.0, 0.0, 0.0), 50.0);
//! # Ok::<(), toml::de::Error>(())
//! ```

mod controller;
mod own_law;

pub use controller::{Controller, ControllerDescription, ControllerError, Law, VelocityEstimate};
pub use own_law::{ControlLaw, LawInput, OwnLaw};
