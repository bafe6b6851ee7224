use std::path::Path;

use super::{error::DriverError, file::Driver, presets::PRESETS};
use thetahat_ground::files;

impl Driver {
    /// The preset of a name, or the driver of a file: a name with the ending `.toml`.
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
        let preset = PRESETS.iter().find(|(known, _)| *known == name);
        match preset {
            Some((name, text)) => Self::parse(name, text, Path::new(name)),
            None => Err(DriverError::Unknown { name: name.to_owned(), known: Self::names().collect() }),
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
        let syntax = |e: toml::de::Error| {
            let message = e.to_string().trim_end().to_owned();
            DriverError::Syntax { path: path.to_owned(), message }
        };
        let driver = Self { name: name.to_owned(), ..toml::from_str(text).map_err(syntax)? };
        driver.check(path)?;
        Ok(driver)
    }
}
