use std::path::PathBuf;

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
    #[error("macro `{name}` has no parameter `{parameter}`; it has: {}", known.join(" "))]
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

/// Why an expression of a xacro has no value.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// It is not an expression.
    #[error("column {column}: expected {expected}, found {found}")]
    Syntax {
        /// The column, from one.
        column: usize,
        /// What is allowed there.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// `${` or `$(` without its end.
    #[error("`{open}` is not closed; close it, or write `$${}` for the letters themselves", &open[1..])]
    Open {
        /// The beginning.
        open: &'static str,
    },
    /// A name that is not defined.
    #[error("no property `{name}` is defined here; define it before this line, or correct the name")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A property that is defined by itself.
    #[error("property `{name}` is defined by itself; give one of its properties a value")]
    Circular {
        /// The property.
        name: String,
    },
    /// An operator does not take these values.
    #[error("`{operator}` does not take {left} and {right}")]
    Operands {
        /// The operator.
        operator: &'static str,
        /// The kind of the first value.
        left: &'static str,
        /// The kind of the second value.
        right: &'static str,
    },
    /// A function does not take these arguments.
    #[error("{function} takes {expected}")]
    Arguments {
        /// The function.
        function: String,
        /// What it takes.
        expected: &'static str,
    },
    /// The value is not a function.
    #[error("{found} is not a function that is known here{}", name.as_ref().map_or(String::new(), |n| format!(" (`{n}`)")))]
    NotAFunction {
        /// The kind of the value.
        found: &'static str,
        /// Its name.
        name: Option<String>,
    },
    /// A list or dictionary does not have this entry.
    #[error("{of} has no entry `{key}`")]
    NoEntry {
        /// What is indexed.
        of: &'static str,
        /// The index or key.
        key: String,
    },
    /// A division by zero, a root of a negative number, or an integer beyond 64 bits.
    #[error("{operation} has no value that is a number")]
    NoNumber {
        /// The operation.
        operation: &'static str,
    },
    /// A value or the evaluation is larger than any robot needs.
    #[error("more than {limit} {what}, the most that is evaluated")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The largest number.
        limit: usize,
    },
    /// A part of Python or xacro that is not read.
    #[error("{what}: this is not read; {remedy}")]
    Unsupported {
        /// What.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// `$(arg NAME)` without a value.
    #[error(
        "argument `{name}` has no value; give it with --xacro-arg {name}:=VALUE, or a default by <xacro:arg name=\"{name}\" default=\"...\"/>"
    )]
    UnknownArgument {
        /// The argument.
        name: String,
    },
    /// `$(find NAME)` of a package that is not found.
    #[error("package `{name}` was not found in the folders above this file; name its folder with --package {name}=DIR")]
    UnknownPackage {
        /// The package.
        name: String,
    },
    /// `$(...)` with a command that is not known.
    #[error("`$({command})` is not known; the commands are find, arg, optenv with a default, and dirname")]
    UnknownCommand {
        /// The command.
        command: String,
    },
    /// A variable of the environment, which is not read.
    #[error(
        "the environment is not read; replace `$({command})` by an argument and give its value with --xacro-arg NAME:=VALUE"
    )]
    Environment {
        /// The command.
        command: String,
    },
    /// `xacro.fatal` of the file itself.
    #[error("the file says: {message}")]
    Fatal {
        /// Its message.
        message: String,
    },
    /// A YAML file that cannot be used.
    #[error("{}, line {line}: {problem}", path.display())]
    Yaml {
        /// The file.
        path: PathBuf,
        /// The line, from one.
        line: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// A file that cannot be read.
    #[error("{error}")]
    File {
        /// Why.
        error: Box<XacroError>,
    },
}
