use std::path::Path;

use super::{error::DriverError, file::Driver, presets::PRESETS};
use thetahat_ground::{files, syntax::in_plain_words};

impl Driver {
    /// The preset of a name, or the driver of a file: a name with the ending `.toml`. A part of a name is enough where one preset alone
    /// has it, as `go2` of `unitree-go2`.
    ///
    /// ```
    /// use thetahat::experiment::Driver;
    /// let franka = Driver::find("franka")?;
    /// assert_eq!(franka.position.columns[0], "q_*");
    /// assert!(Driver::find("frank").unwrap_err().to_string().contains("franka"));
    /// # Ok::<(), thetahat::experiment::DriverError>(())
    /// ```
    ///
    /// # Errors
    /// [`DriverError`] with the names of the presets, or with file and key.
    pub fn find(name: &str) -> Result<Self, DriverError> {
        let path = Path::new(name);
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            let unreadable = |reason: String| DriverError::Unreadable { path: path.to_owned(), reason };
            let text = files::read_to_string(path).map_err(|e| unreadable(e.to_string()))?;
            return Self::parse(name, &text, path);
        }
        match preset(name) {
            Ok((name, text)) => Self::parse(name, text, Path::new(name)),
            Err(similar) => {
                Err(DriverError::Unknown { name: name.to_owned(), similar, known: Self::names().collect() })
            }
        }
    }

    /// The names of the presets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// The presets.
    ///
    /// # Errors
    /// Infallible in practice: the files are part of the program and tested.
    pub fn presets() -> Result<Vec<Self>, DriverError> {
        Self::names().map(Self::find).collect()
    }

    fn parse(name: &str, text: &str, path: &Path) -> Result<Self, DriverError> {
        let syntax =
            |e: toml::de::Error| DriverError::Syntax { path: path.to_owned(), message: in_plain_words(&e.to_string()) };
        let driver = Self { name: name.to_owned(), ..toml::from_str(text).map_err(syntax)? };
        driver.check(path)?;
        Ok(driver)
    }
}

/// The preset of a name or of a part of it; else the names that have the part.
fn preset(name: &str) -> Result<(&'static str, &'static str), Vec<&'static str>> {
    let asked = words(name);
    let has_part = |known: &str| !asked.is_empty() && words(known).windows(asked.len()).any(|part| part == asked);
    let is_whole = |known: &str| words(known) == asked;
    let found: Vec<(&str, &str)> = PRESETS.iter().copied().filter(|(known, _)| has_part(known)).collect();
    match found.iter().find(|(known, _)| is_whole(known)) {
        Some(preset) => Ok(*preset),
        None if found.len() == 1 => Ok(found[0]),
        None => Err(found.into_iter().map(|(known, _)| known).collect()),
    }
}

/// The words of a name, as `ur_rtde` and `UR-RTDE` have the same.
fn words(name: &str) -> Vec<String> {
    let parts = name.split(|c: char| !c.is_ascii_alphanumeric());
    parts.filter(|part| !part.is_empty()).map(str::to_ascii_lowercase).collect()
}
