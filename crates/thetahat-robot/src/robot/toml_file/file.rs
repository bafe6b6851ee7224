use std::{collections::BTreeMap, path::PathBuf};

use serde::Deserialize;
use toml::Spanned;

use crate::robot::{Friction, JointKind, TermDescription};
use thetahat_ground::one_or_each::{self, OneOrEach};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    /// Its name; none takes that of the URDF, or of the file.
    pub(super) name: Option<String>,
    /// A URDF or MJCF that has the joints and links, in the folder of this file or the one above.
    ///
    /// Declared here so that it is a known key; read by [`super::urdf_of`].
    #[serde(rename = "urdf", alias = "mjcf")]
    _urdf: Option<PathBuf>,
    /// The text of the URDF or MJCF itself.
    #[serde(rename = "urdf_text", alias = "mjcf_text")]
    _urdf_text: Option<String>,
    /// What the Denavit-Hartenberg numbers of `[[joint]]` mean; none is `"modified"`.
    pub(super) convention: Option<Convention>,
    /// Acceleration of gravity in the base frame, m/s^2; none is `[0, 0, -9.81]`.
    pub(super) gravity: Option<[f64; 3]>,
    /// Whether the root body moves freely: its pose is measured, and six equations without a torque are added.
    #[serde(default)]
    pub(super) floating_base: bool,
    /// The friction model of the joints; none is `"symmetric"`.
    pub(super) friction: Option<Friction>,
    /// The joints, if there is no URDF.
    #[serde(default)]
    pub(super) joint: Vec<Spanned<JointEntry>>,
    /// Conditions that close loops of links.
    #[serde(default, rename = "loop")]
    pub(super) loops: Vec<LoopEntry>,
    /// From motors to joints; none is one motor for each joint without gears, or that of the URDF.
    pub(super) transmission: Option<TransmissionEntry>,
    /// Torque terms in addition to links and drives.
    #[serde(default)]
    pub(super) term: Vec<TermDescription>,
    /// A-priori values of standard parameters by name, SI; others are zero, or those of the URDF.
    #[serde(default)]
    pub(super) parameters: BTreeMap<String, f64>,
    #[serde(default)]
    pub(super) locked: BTreeMap<String, f64>,
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub(super) until: Vec<String>,
}

/// What the Denavit-Hartenberg numbers of a joint mean.
#[derive(Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Convention {
    /// Khalil and Kleinfinger: alpha and a come before the joint.
    #[default]
    Modified,
    /// Denavit and Hartenberg as in most data sheets: a and alpha come after the joint.
    Standard,
}

/// A joint by its Denavit-Hartenberg numbers.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointEntry {
    /// Its name.
    pub(super) name: String,
    /// The joint that carries it; none is the joint before it in the file, and for the first the base.
    pub(super) parent: Option<String>,
    /// How it moves.
    pub(super) kind: JointKind,
    /// Angle about the parent's z axis, for a branch of a tree, degrees.
    #[serde(default)]
    pub(super) gamma_deg: f64,
    /// Length along the parent's z axis, for a branch of a tree, m.
    #[serde(default)]
    pub(super) b_m: f64,
    /// Angle between the z axes, degrees.
    #[serde(default)]
    pub(super) alpha_deg: f64,
    /// Length between the z axes, m.
    #[serde(default)]
    pub(super) a_m: f64,
    /// Angle about the z axis, degrees; the coordinate of a revolute joint is added.
    #[serde(default)]
    pub(super) theta_deg: f64,
    /// Length along the z axis, m; the coordinate of a prismatic joint is added.
    #[serde(default)]
    pub(super) d_m: f64,
    /// The joint that it follows, or several: its coordinate is the sum.
    #[serde(default)]
    pub(super) mimic: Option<OneOrEach<MimicEntry>>,
}

/// A joint that follows another.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MimicEntry {
    /// The joint that is followed.
    pub(super) joint: String,
    /// The factor of its coordinate.
    pub(super) ratio: f64,
    /// The offset of a revolute joint, degrees.
    pub(super) offset_deg: Option<f64>,
    /// The offset of a prismatic joint, m.
    pub(super) offset_m: Option<f64>,
}

/// A condition that closes a loop of links.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoopEntry {
    /// Its name, for messages.
    pub(super) name: String,
    /// What the two frames have in common.
    pub(super) kind: LoopKindEntry,
    /// A frame on one link.
    pub(super) from: LoopFrameEntry,
    /// A frame on the other.
    pub(super) to: LoopFrameEntry,
    /// The length of a rod between the origins, m; of kind `"distance"` alone.
    pub(super) length_m: Option<f64>,
    /// The joints that the loops move: not recorded, and without motors. Each is named by one loop.
    #[serde(default)]
    pub(super) passive: Vec<String>,
    /// Positions of revolute joints near which the loop is closed, degrees: they name the branch. Zero for joints not listed.
    #[serde(default)]
    pub(super) near_deg: BTreeMap<String, f64>,
    /// The same of prismatic joints, m.
    #[serde(default)]
    pub(super) near_m: BTreeMap<String, f64>,
}

/// What the two frames of a loop have in common.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LoopKindEntry {
    /// Their origins.
    Point,
    /// Their origins and z axes.
    Axis,
    /// All.
    Pose,
    /// The distance of their origins.
    Distance,
}

/// A frame on a link.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoopFrameEntry {
    /// The link's joint; none is the base.
    pub(super) link_of: Option<String>,
    /// Its origin in the link's axes, from the origin of the joint's frame, m.
    pub(super) point_m: [f64; 3],
    /// Its axes by roll, pitch and yaw in the link's axes, degrees.
    #[serde(default)]
    pub(super) rpy_deg: [f64; 3],
}

/// `q = N^-1 q_motor + offset`, `tau = N^T (drive_gain * tau_motor)`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TransmissionEntry {
    /// N: motors in rows, joints in columns; none is the identity, or that of the URDF.
    pub(super) matrix: Option<Spanned<Vec<Vec<f64>>>>,
    /// Offsets of revolute joints, degrees.
    pub(super) offset_deg: Option<OneOrEach<f64>>,
    /// Offsets of prismatic joints, m.
    pub(super) offset_m: Option<OneOrEach<f64>>,
    /// Motor torque per unit of the drive signal.
    pub(super) drive_gain: Option<OneOrEach<f64>>,
}
