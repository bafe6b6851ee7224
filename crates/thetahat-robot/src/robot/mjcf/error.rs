use std::path::PathBuf;

use crate::robot::{Place, UrdfError};

/// Why an MJCF cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MjcfError {
    /// The file is not XML that can be read.
    #[error(transparent)]
    Xml(Box<UrdfError>),
    /// The file is a part that a model includes.
    #[error(
        "{place} is a part of a model; give the file of the model, whose root is <mujoco>, which includes this one"
    )]
    Part {
        /// The root element.
        place: Place,
    },
    /// The file is larger than any robot's.
    #[error("{}: the model has more than {limit} {what}, the most that is read", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The excess quantity.
        what: &'static str,
        /// The largest number that is read.
        limit: usize,
    },
    /// A file cannot be included.
    #[error("{place} includes `{file}`: {problem}")]
    Include {
        /// The `<include>`.
        place: Place,
        /// The file.
        file: String,
        /// Why not, and what to do.
        problem: &'static str,
    },
    /// An attribute or element is missing.
    #[error("{place} has no {missing}; {remedy}")]
    Missing {
        /// The element that lacks it.
        place: Place,
        /// What is missing.
        missing: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A value is invalid.
    #[error("{place}: {key} is `{found}`, expected {expected}")]
    Value {
        /// The element, which may be that of a class.
        place: Place,
        /// The attribute.
        key: &'static str,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// A class, joint or body is named that the model does not have.
    #[error("{place} names the {kind} `{name}`, which this model does not have; correct the name")]
    UnknownName {
        /// The element.
        place: Place,
        /// `class`, `joint` or `body`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Two elements of a kind have one name.
    #[error("{place} has the name of the element in line {first_line}; rename one of the two")]
    DuplicateName {
        /// The second element.
        place: Place,
        /// Line of the first, in its file.
        first_line: usize,
    },
    /// An element that describes more than a tree of hinges and slides.
    #[error("{place} is not supported: {why}")]
    Unsupported {
        /// The element.
        place: Place,
        /// Why, and what to do.
        why: &'static str,
    },
    /// A geom whose mass counts has a shape without a formula.
    #[error(
        "{place} gives `{body}` its mass by {shape}, which is not weighed here; give the body an <inertial>, as MuJoCo's \
         `mj_saveLastXML` does with <compiler saveinertial=\"true\"/>, or mass=\"0\" to the geom"
    )]
    Unweighed {
        /// The geom.
        place: Place,
        /// The body.
        body: String,
        /// The shape, in words.
        shape: &'static str,
    },
    /// A joint cannot follow another.
    #[error("{place} makes `{joint}` follow another joint: {problem}")]
    Follower {
        /// The `<joint>` of `<equality>`.
        place: Place,
        /// The joint.
        joint: String,
        /// Why not, and what to do.
        problem: &'static str,
    },
    /// No joint moves.
    #[error("{}: no body of this model has a hinge or slide; at least one is needed", path.display())]
    NoMovingJoint {
        /// The file.
        path: PathBuf,
    },
}

impl From<UrdfError> for MjcfError {
    fn from(error: UrdfError) -> Self {
        Self::Xml(Box::new(error))
    }
}
