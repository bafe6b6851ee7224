//! The robot as data: links and joints, transmission, friction, and the one table of standard parameters.
//!
//! A robot is a tree of revolute and prismatic joints, whose loops of links are closed by conditions. It is read from our TOML in
//! Denavit-Hartenberg form (modified, with Khalil's gamma and b for trees, or standard), from a URDF, from an MJCF, or from a TOML that
//! stands on one of them. Its dynamic parameters are named once, in [`ParameterTable`].
//!
//! ```
//! use std::path::Path;
//! use thetahat_robot::robot::Robot;
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n[parameters]\nzz1 = 0.5\nia1 = 0.3";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! let table = robot.parameter_table();
//! assert_eq!(table.index_of("zz1").map(|index| robot.a_priori_parameters()[index]), Some(0.5));
//! assert_eq!(robot.coordinate_count(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod body;
mod branches;
mod description;
mod encoding;
mod error;
mod floating;
mod joint;
mod loading;
mod locking;
mod loops;
mod mjcf;
mod opened;
mod parameters;
mod physical;
mod quantity;
mod sound;
mod source;
mod terms;
mod text_file;
mod toml_file;
mod transmission;
mod tree;
mod urdf;
mod xacro;

#[doc(hidden)]
pub use body::{Frame, RigidBody};
pub use branches::Branch;
pub use description::{Doubt, DoubtGrade, Robot};
pub use error::RobotError;
pub use joint::{DenavitHartenberg, Joint, JointKind, Limits, Mimic, Placement, Share};
#[doc(hidden)]
pub use locking::LinkPart;
pub use locking::{LockError, LockedJoint, Locks};
pub use loops::{Loop, LoopFrame, LoopKind};
pub use mjcf::MjcfError;
pub use parameters::{Parameter, ParameterTable};
pub use physical::NotPhysical;
#[doc(hidden)]
pub use physical::{EXPECTED_GRAVITY, is_gravity};
pub use quantity::{
    Bound, Friction, INERTIAL, JointQuantity, LinkQuantity, MotorQuantity, Quantity, Role, TermQuantity,
};
pub use sound::NotARobot;
pub use source::RobotSource;
pub use terms::{
    ChannelFactor, Cylinder, Direction, Expression, LinkPoint, PointDescription, Shape, Stribeck, StribeckLaw,
    TermColumn, TermDescription, TermError, TwoPoints, Variable, channels_of,
};
#[doc(hidden)]
pub use terms::{Formula, MathFunction};
pub use text_file::RobotFile;
#[doc(hidden)]
pub use text_file::read_text;
pub use transmission::Transmission;
pub use urdf::{Place, Solid, UrdfError};
#[doc(hidden)]
pub use urdf::{parse_xml, roll_pitch_yaw};
pub use xacro::{ExpandedXacro, ExpressionError, XacroError, XacroOptions, XacroProblem, expand_xacro};

use joint::{LARGEST, MOST_JOINTS};
