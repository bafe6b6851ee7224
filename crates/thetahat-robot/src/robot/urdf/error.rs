use std::{fmt, path::PathBuf};

/// A position in a URDF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// The line, from one.
    pub line: usize,
    /// The element, such as `<axis> of <joint name="elbow">`.
    pub element: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}: {}", self.path.display(), self.line, self.element)
    }
}

/// Why a URDF cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The file is not XML.
    #[error("{}, line {line}, column {column}: this is not XML: {problem}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, from one.
        line: usize,
        /// The column, from one.
        column: usize,
        /// The error of the XML reader.
        problem: String,
    },
    /// The file is a xacro that has not been expanded.
    #[error("{place} is xacro that has not been expanded; run `xacro {} > robot.urdf` and use robot.urdf", place.path.display())]
    Xacro {
        /// The position of the xacro element.
        place: Place,
    },
    /// The root element is not `<robot>`.
    #[error("{place} is the root of this file, but a URDF is one <robot name=\"...\">")]
    NotARobot {
        /// The root element.
        place: Place,
    },
    /// The file is larger than any robot's.
    #[error("{}: the file has more than {limit} {what}, the most that is read", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The excess quantity.
        what: &'static str,
        /// The largest number that is read.
        limit: usize,
    },
    /// An attribute or element is missing.
    #[error("{place} has no {missing}; {remedy}")]
    Missing {
        /// The element that lacks it.
        place: Place,
        /// What is missing.
        missing: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A value is invalid.
    #[error("{place}: {key} is `{found}`, expected {expected}")]
    Value {
        /// The element.
        place: Place,
        /// The attribute, or the text of the element.
        key: &'static str,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// A link or joint is named that the file does not have.
    #[error("{place} names the {kind} `{name}`, which this file does not have{}", similar.as_ref().map_or(String::new(), |s| format!("; is `{s}` meant?")))]
    UnknownName {
        /// The element.
        place: Place,
        /// `link` or `joint`.
        kind: &'static str,
        /// The name.
        name: String,
        /// A similar name, if there is one.
        similar: Option<String>,
    },
    /// Two links or two joints have one name.
    #[error("{place} has the name of the element in line {first_line}; rename one of the two")]
    DuplicateName {
        /// The second element.
        place: Place,
        /// Line of the first.
        first_line: usize,
    },
    /// A link is the child of two joints.
    #[error(
        "{place} makes `{link}` its child, which is the child of joint `{other}` already; a loop cannot be described, cut it at \
         one of the two joints"
    )]
    TwoParents {
        /// The second joint.
        place: Place,
        /// The link.
        link: String,
        /// The first joint.
        other: String,
    },
    /// The joints form a cycle.
    #[error("{place}: the joints {} form a cycle; one link must be nobody's child", joints.join(" -> "))]
    Cycle {
        /// The first joint of the cycle.
        place: Place,
        /// The joints of the cycle.
        joints: Vec<String>,
    },
    /// Several links, or none, have no parent.
    #[error(
        "{place} is nobody's child, as is `{first}` in line {first_line}; exactly one link is the base: join the two with a \
         joint of type fixed, or remove one"
    )]
    TwoRoots {
        /// The second root.
        place: Place,
        /// The first root.
        first: String,
        /// Its line.
        first_line: usize,
    },
    /// Several links that joints name as parents are missing, so that none can be the base.
    #[error(
        "{place}: the links {} are parents of joints, but this file has none of them; only one can be the base that is left \
         out: add `<link name=\"...\"/>` for each and join them with joints of type fixed", names.join(", ")
    )]
    MissingBases {
        /// The `<parent>` that names the first.
        place: Place,
        /// The names with their lines, such as `world (line 3)`.
        names: Vec<String>,
    },
    /// The lower limit of a joint is above its upper limit.
    #[error("{place}: lower is {lower}, above upper, {upper}; give the smaller number as lower")]
    LimitOrder {
        /// The `<limit>`.
        place: Place,
        /// The lower limit, rad or m.
        lower: f64,
        /// The upper limit, rad or m.
        upper: f64,
    },
    /// No joint moves.
    #[error("{}: no joint of this URDF moves; at least one must be revolute, continuous or prismatic", path.display())]
    NoMovingJoint {
        /// The file.
        path: PathBuf,
    },
    /// A joint with more than one coordinate.
    #[error("{place} is of type `{kind}`, which is not supported: {why}")]
    UnsupportedJoint {
        /// The joint.
        place: Place,
        /// Its type.
        kind: String,
        /// What is supported, or why not.
        why: &'static str,
    },
    /// A joint cannot follow the one it names.
    #[error("{place} cannot follow `{joint}`: {problem}")]
    Mimic {
        /// The `<mimic>`.
        place: Place,
        /// The joint that it names.
        joint: String,
        /// Why not.
        problem: &'static str,
    },
    /// A transmission cannot be expressed by one ratio for each joint.
    #[error(
        "{place} {problem}; lock all of its joints, or give [transmission] matrix in a TOML with urdf = \"...\" instead"
    )]
    Transmission {
        /// The transmission.
        place: Place,
        /// Why not.
        problem: String,
    },
}
