//! A [`Function`](super::Function) as code.

mod c;
mod documentation;
mod identifier;
mod statements;

use super::{error::SymbolicError, model::Function};

/// A language that code is generated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99, freestanding but for sine and cosine.
    C,
}

impl Language {
    /// All languages, with their names on the command line.
    pub const ALL: [(&'static str, Self); 1] = [("c", Self::C)];

    /// The code of a function, whose names begin with `name`, or with the robot's name.
    ///
    /// # Errors
    /// [`SymbolicError::NoIdentifier`] and [`SymbolicError::NotAnIdentifier`].
    pub fn code(self, function: &Function, name: Option<&str>) -> Result<String, SymbolicError> {
        let name = identifier::prefix(&function.robot, name)?;
        Ok(match self {
            Self::C => c::code(function, &name),
        })
    }
}
