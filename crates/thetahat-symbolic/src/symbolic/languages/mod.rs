//! A [`Function`](super::Function) as code.

mod c;
mod documentation;
mod functions;
mod identifier;
mod latex;
mod matlab;
mod python;
mod rust;
mod statements;

use super::{error::SymbolicError, model::Function};

/// A language that code is generated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99, freestanding except for sine and cosine.
    C,
    /// Rust without the standard library.
    Rust,
    /// Python with NumPy.
    Python,
    /// MATLAB and Octave.
    Matlab,
    /// Equations for a paper.
    Latex,
}

impl Language {
    /// All languages, with their names on the command line.
    pub const ALL: [(&'static str, Self); 5] = [
        ("c", Self::C),
        ("rust", Self::Rust),
        ("python", Self::Python),
        ("matlab", Self::Matlab),
        ("latex", Self::Latex),
    ];

    /// The code of a function, whose names begin with `name`, or with the robot's name; LaTeX has no names.
    ///
    /// # Errors
    /// [`SymbolicError::NoIdentifier`] and [`SymbolicError::NotAnIdentifier`].
    pub fn code(self, function: &Function, name: Option<&str>) -> Result<String, SymbolicError> {
        let name = || identifier::prefix(&function.robot, name);
        Ok(match self {
            Self::C => c::code(function, &name()?),
            Self::Rust => rust::code(function, &name()?),
            Self::Python => python::code(function, &name()?),
            Self::Matlab => matlab::code(function, &name()?),
            Self::Latex => latex::code(function),
        })
    }
}
