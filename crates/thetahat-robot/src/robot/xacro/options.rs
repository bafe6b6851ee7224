use std::path::PathBuf;

use super::XacroError;

/// What a xacro needs from outside: values of its arguments, and folders of packages.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct XacroOptions {
    /// Arguments by name.
    pub arguments: Vec<(String, String)>,
    /// Folders of packages by name.
    pub packages: Vec<(String, PathBuf)>,
}

impl XacroOptions {
    /// Adds an argument from its text, `k:=v`.
    ///
    /// # Errors
    /// [`XacroError::Option`] for another form.
    pub fn add_argument(&mut self, text: &str) -> Result<(), XacroError> {
        let (name, value) = named(text, ":=", "NAME:=VALUE, such as prefix:=left_")?;
        self.arguments.push((name, value));
        Ok(())
    }

    /// Adds the folder of a package from its text, `NAME=DIR`.
    ///
    /// # Errors
    /// [`XacroError::Option`] for another form.
    pub fn add_package(&mut self, text: &str) -> Result<(), XacroError> {
        let (name, folder) = named(text, "=", "NAME=DIR, such as arm_description=robots/arm_description")?;
        self.packages.push((name, PathBuf::from(folder)));
        Ok(())
    }
}

fn named(text: &str, separator: &str, expected: &'static str) -> Result<(String, String), XacroError> {
    let parts = text.split_once(separator).filter(|(name, _)| !name.trim().is_empty());
    let (name, value) = parts.ok_or_else(|| XacroError::Option { found: text.to_owned(), expected })?;
    Ok((name.trim().to_owned(), value.to_owned()))
}
