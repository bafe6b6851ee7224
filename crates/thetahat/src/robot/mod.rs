//! The robot as data: links and joints, transmission, friction, and the one table of standard parameters.
//!
//! A robot is a tree of revolute and prismatic joints, read from our TOML in Denavit-Hartenberg form (modified, with
//! Khalil's gamma and b for trees, or standard), from a URDF, or from a TOML that stands on a URDF. Its dynamic
//! parameters are named once, in [`ParameterTable`].

mod description;
mod error;
mod joint;
mod parameters;
mod physical;
mod quantity;
mod source;
mod toml_file;
mod transmission;
mod tree;
mod urdf;

pub use description::Robot;
pub use error::RobotError;
pub use joint::{DenavitHartenberg, Joint, JointKind, Limits, Mimic, Placement};
pub use parameters::{Parameter, ParameterTable};
pub use physical::NotPhysical;
pub use quantity::{Bound, Friction, INERTIAL, JointQuantity, LinkQuantity, MotorQuantity, Quantity, Role};
pub use source::RobotSource;
pub use transmission::Transmission;
pub use urdf::{Place, UrdfError};

use joint::{LARGEST, MOST_JOINTS};
