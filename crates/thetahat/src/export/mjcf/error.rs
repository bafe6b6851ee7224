use std::path::PathBuf;

use thetahat_model::robot::{Place, UrdfError};

/// Why a MuJoCo model of the user's own is not edited.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MjcfError {
    /// The file is no XML that can be read.
    #[error(transparent)]
    Xml(Box<UrdfError>),
    /// The root element is not `<mujoco>`.
    #[error("{place} is the root of this file, but an MJCF is one <mujoco>; give the file of the model")]
    NotMjcf {
        /// The root element.
        place: Place,
    },
    /// A part of the model is in another file.
    #[error(
        "{place} takes in another file, which is not edited; write the model as one file, as MuJoCo's `mj_saveLastXML` does, and \
         give that"
    )]
    Include {
        /// The element.
        place: Place,
    },
    /// A compiler setting changes what is written.
    #[error("{place}: {key} = `{found}` {consequence}")]
    Setting {
        /// The element.
        place: Place,
        /// The attribute.
        key: &'static str,
        /// Its value.
        found: String,
        /// What it does, and what to do.
        consequence: &'static str,
    },
    /// A value is not what it must be.
    #[error("{place}: {key} is `{found}`, expected {expected}")]
    Value {
        /// The element.
        place: Place,
        /// The attribute.
        key: String,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// A joint of the robot is not in the model.
    #[error(
        "{}: no body has the joint `{joint}` of the identified robot{}; it has the joints {}. Name the joints of the model as those of \
         the robot",
        path.display(),
        if *in_default { ", which stands in a <default> alone" } else { "" },
        found.join(", ")
    )]
    NoJoint {
        /// The model.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Whether a `<default>` names it.
        in_default: bool,
        /// The joints of the model.
        found: Vec<String>,
    },
    /// Two joints have one name.
    #[error("{place} has the name of another joint; rename one of the two")]
    SameName {
        /// The second.
        place: Place,
    },
    /// A body has several joints of the robot, whose links would be the same body.
    #[error(
        "{place} has the joints {} of the identified robot, and a body is one link; give each joint a body of its own",
        joints.join(", ")
    )]
    SeveralJoints {
        /// The body.
        place: Place,
        /// Its joints.
        joints: Vec<String>,
    },
    /// A joint moves in another way.
    #[error("{place} is of the type {found}, and the identified joint is {expected}")]
    OtherKind {
        /// The joint.
        place: Place,
        /// What it is.
        found: String,
        /// What the robot's is.
        expected: &'static str,
    },
    /// A joint stands on another link.
    #[error("{place} is carried by {found}, and the identified joint by {expected}")]
    OtherParent {
        /// The joint.
        place: Place,
        /// What carries it.
        found: String,
        /// What carries it in the robot.
        expected: String,
    },
    /// The joints are elsewhere.
    #[error(
        "{place}: with all joints at zero its axis differs by {angle:.1e} rad and {distance:.1e} m from that of the identified robot \
         standing on {base}; the model must be of the same geometry, with the same zeros and directions of the joints"
    )]
    OtherAxis {
        /// The joint.
        place: Place,
        /// The body that was taken as the robot's base.
        base: String,
        /// Between the axes, rad.
        angle: f64,
        /// Between the axes, m.
        distance: f64,
    },
    /// A body that moves with a link has its inertia from its geoms.
    #[error(
        "{place} moves with the link of joint `{joint}`, and has its inertia from its geoms, which are not weighed here; give it an \
         <inertial>, or mass=\"0\" to its geoms"
    )]
    NoInertial {
        /// The body.
        place: Place,
        /// The joint.
        joint: String,
    },
    /// Bodies are made by an element that is not followed.
    #[error("{place} makes bodies that move with the link of joint `{joint}`, and is not followed; write them out")]
    Made {
        /// The element.
        place: Place,
        /// The joint.
        joint: String,
    },
    /// A bound of the compiler is above what is written.
    #[error(
        "{place}: {key} = {bound} would change `{body}`, which has {found:.3e}; take the bound out, or estimate with a-priori values \
         that leave the link more"
    )]
    Bound {
        /// The compiler's element.
        place: Place,
        /// `boundmass` or `boundinertia`.
        key: &'static str,
        /// Its value, kg or kg m^2.
        bound: f64,
        /// The body.
        body: String,
        /// What it gets.
        found: f64,
    },
    /// A tendon has the name of a coupled motor's and other joints.
    #[error("{place} has the name of the tendon of a coupled motor, and other joints or coefficients; rename it")]
    OtherTendon {
        /// The tendon.
        place: Place,
    },
}

impl From<UrdfError> for MjcfError {
    fn from(error: UrdfError) -> Self {
        Self::Xml(Box::new(error))
    }
}
