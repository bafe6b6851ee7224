use std::path::PathBuf;

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
    #[error("{reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why not, with its name.
        reason: String,
    },
}
