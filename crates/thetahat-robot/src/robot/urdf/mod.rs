//! Robots from URDF, the format of ROS (<https://docs.ros.org/en/rolling/p/urdfdom>).
//!
//! The reader uses links with their `<inertial>`, joints of the types revolute, continuous, prismatic and fixed with
//! `<origin>`, `<axis>`, `<limit>`, `<dynamics>` and `<mimic>`, and of each `<transmission>`, also of those in a
//! `<ros2_control>`, the reduction, the offset and the motor's inertia. A link that is fixed to another is merged into it. A base
//! that joints name as a parent while the file has no such link is added. Collision shapes are read if a design needs them.
//! Everything else, such as appearance and tags of simulators, is skipped.
//!
//! The inertial parameters of a robot from URDF refer to the axes and the origin of each link's frame, whatever the
//! axis of the joint. An angle that is a multiple of a right angle rounded to four decimals or more, such as 1.5708, is
//! interpreted as that multiple: otherwise parallel axes would not be parallel, and dependent parameters would count as
//! independent.

mod assembly;
mod document;
mod doubts;
mod element;
mod error;
mod joints;
mod links;
mod reader;
mod shapes;
mod structure;
mod transmissions;

#[doc(hidden)]
pub use document::parse as parse_xml;
pub use error::{Place, UrdfError};
#[doc(hidden)]
pub use links::roll_pitch_yaw;
pub use shapes::Solid;

pub(super) use reader::{LinkBody, Transmissions, link_bodies, read};

#[cfg(test)]
mod tests;
