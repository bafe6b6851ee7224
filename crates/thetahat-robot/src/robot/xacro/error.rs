use std::path::PathBuf;

use super::ExpressionError;
use crate::robot::{Place, UrdfError};

/// Why a xacro cannot be expanded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum XacroError {
    /// A file cannot be read.
    #[error("{reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why not, with its name.
        reason: String,
    },
    /// A file that cannot be used as a whole.
    #[error("{}: {problem}", path.display())]
    Reading {
        /// The file, or the one that names it.
        path: PathBuf,
        /// What is wrong.
        problem: Box<XacroProblem>,
    },
    /// A file is not XML, or larger than any robot's.
    #[error(transparent)]
    Xml(#[from] UrdfError),
    /// An element cannot be expanded.
    #[error("{place}: {problem}")]
    Element {
        /// The element.
        place: Place,
        /// What is wrong with it, and what to do.
        problem: Box<XacroProblem>,
    },
    /// An argument of the expansion is not `k:=v`, or a package not `NAME=DIR`.
    #[error("`{found}` is not of the form {expected}")]
    Option {
        /// What was given.
        found: String,
        /// The form.
        expected: &'static str,
    },
}

/// What is wrong with an element of a xacro.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum XacroProblem {
    /// An attribute is missing.
    #[error("it has no attribute {attribute}; {remedy}")]
    Missing {
        /// The attribute.
        attribute: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// An attribute has an impossible value.
    #[error("{attribute} is `{found}`, expected {expected}")]
    Value {
        /// The attribute.
        attribute: &'static str,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// A text or expression cannot be evaluated.
    #[error("`{text}`: {error}")]
    Text {
        /// The text.
        text: String,
        /// Why not.
        error: ExpressionError,
    },
    /// There is no macro of this name.
    #[error("no macro `{name}` is defined before this line; include the file that defines it, or correct the name")]
    UnknownMacro {
        /// Its name.
        name: String,
    },
    /// A call gives a parameter that the macro does not have.
    #[error("macro `{name}` has no parameter `{parameter}`; it has {}", if known.is_empty() { "none".to_owned() } else { known.join(" ") })]
    UnknownParameter {
        /// The macro.
        name: String,
        /// The parameter.
        parameter: String,
        /// Its parameters.
        known: Vec<String>,
    },
    /// A call lacks parameters.
    #[error("macro `{name}` needs {}; give each as an attribute, and blocks (*) as child elements", missing.join(" "))]
    MissingParameters {
        /// The macro.
        name: String,
        /// The parameters.
        missing: Vec<String>,
    },
    /// A call has a child element that no parameter takes.
    #[error("macro `{name}` takes no block <{block}>; remove it, or add a parameter *{block} to the macro")]
    UnusedBlock {
        /// The macro.
        name: String,
        /// The name of the element.
        block: String,
    },
    /// There is no block of this name.
    #[error("no block `{name}` is defined here; define a block property or a parameter *{name}")]
    UnknownBlock {
        /// Its name.
        name: String,
    },
    /// An included file is outside of the folders that may be read.
    #[error("{} is outside of the folders that may be read: that of the robot's package or file, and those that are named with --package NAME=DIR", path.display())]
    Outside {
        /// The file.
        path: PathBuf,
    },
    /// A file that an element names cannot be used.
    #[error("{error}")]
    File {
        /// Why.
        error: Box<XacroError>,
    },
    /// Several files by one pattern.
    #[error("`{pattern}` is a pattern of file names; include the files one by one")]
    Pattern {
        /// The pattern.
        pattern: String,
    },
    /// Includes, macros or elements that contain themselves.
    #[error(
        "files, macros and elements are nested more than {limit} deep, the most that is expanded; does one contain itself?"
    )]
    TooDeep {
        /// The largest depth.
        limit: usize,
    },
    /// The expansion is larger than any robot.
    #[error("the expansion has more than {limit} {what}, the most that is made")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The largest number.
        limit: usize,
    },
}
