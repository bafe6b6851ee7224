use std::{
    io::Read,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    description::Robot,
    error::RobotError,
    locking::{Locks, LocksOf, merged, resolve_all},
    mjcf, toml_file, urdf,
};
use thetahat_ground::{digest::sha256, files};

/// Longest robot description, bytes.
const LONGEST: u64 = 16 << 20;

/// A file that a robot was read from, with a digest that identifies its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RobotFile {
    /// Its name without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal digits: what `sha256sum` prints.
    pub sha256: String,
}

impl RobotFile {
    fn new(path: &Path, text: &str) -> Self {
        Self {
            name: path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
            sha256: sha256(text.as_bytes()),
        }
    }
}

/// The complete text of a robot: including the text of the URDF or MJCF that a TOML refers to, and of what an MJCF includes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotSource {
    path: PathBuf,
    text: String,
    /// The URDF or MJCF that a TOML refers to.
    urdf: Option<(PathBuf, String)>,
    /// The files of the MJCF, if it includes others.
    origins: mjcf::Origins,
}

impl RobotSource {
    /// Reads the description, and the URDF or MJCF that it refers to.
    ///
    /// # Errors
    /// [`RobotError`] for a file that cannot be read.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        Self::from_text(read_text(path)?, path)
    }

    /// A description from its text; `path` is its name in messages, and its key `urdf` and the files that an MJCF includes are
    /// relative to its folder.
    ///
    /// # Errors
    /// As [`RobotSource::read`].
    pub fn from_text(text: String, path: &Path) -> Result<Self, RobotError> {
        let urdf = if is_xml(&text) { None } else { toml_file::urdf_of(&text, path)? };
        let path = path.to_owned();
        let (text, urdf, origins) = match urdf {
            Some(toml_file::Urdf::File(file)) => {
                let (below, origins) = joined(read_text(&file)?, &file)?;
                (text, Some((file, below)), origins)
            }
            // An embedded text is complete.
            Some(toml_file::Urdf::Text(name, below)) => (text, Some((name, below)), mjcf::Origins::default()),
            None => {
                let (text, origins) = joined(text, &path)?;
                (text, None, origins)
            }
        };
        Ok(Self { path, text, urdf, origins })
    }

    /// The file of the description.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file of the URDF or MJCF that a TOML refers to.
    #[must_use]
    pub fn urdf_path(&self) -> Option<&Path> {
        self.urdf.as_ref().map(|(path, _)| path.as_path())
    }

    /// The files, the description first, then the URDF or MJCF that it refers to and the files that the MJCF includes. For a
    /// text with an embedded URDF or MJCF, as made by [`RobotSource::to_text`], only that.
    #[must_use]
    pub fn files(&self) -> Vec<RobotFile> {
        let own = (!toml_file::has_embedded_urdf(&self.text)).then_some((&self.path, &self.text));
        let mut files: Vec<(&PathBuf, &String)> =
            own.into_iter().chain(self.urdf.iter().map(|(path, text)| (path, text))).collect();
        if !self.origins.files().is_empty() {
            // The MJCF with the texts that it includes is no file.
            files.pop();
            files.extend(self.origins.files().iter().map(|(path, text)| (path, text)));
        }
        files.into_iter().map(|(path, text)| RobotFile::new(path, text)).collect()
    }

    /// The text of the URDF that the robot is read from; none if a TOML defines the joints, and for an MJCF.
    #[must_use]
    pub fn urdf_text(&self) -> Option<&str> {
        self.xml().filter(|text| !mjcf::is_mjcf(text))
    }

    /// The text of the MJCF that the robot is read from, with what it includes; none for other descriptions.
    #[must_use]
    pub fn mjcf_text(&self) -> Option<&str> {
        self.xml().filter(|text| mjcf::is_mjcf(text))
    }

    fn xml(&self) -> Option<&str> {
        let own = is_xml(&self.text).then_some(&self.text);
        own.or(self.urdf.as_ref().map(|(_, text)| text)).map(String::as_str)
    }

    /// The kind of description in words: `URDF`, `MJCF`, `TOML`, `TOML on URDF` or `TOML on MJCF`.
    #[must_use]
    pub fn format(&self) -> &'static str {
        match (&self.urdf, self.mjcf_text().is_some()) {
            (_, is_mjcf) if is_xml(&self.text) => {
                if is_mjcf {
                    "MJCF"
                } else {
                    "URDF"
                }
            }
            (None, _) => "TOML",
            (Some(_), false) => "TOML on URDF",
            (Some(_), true) => "TOML on MJCF",
        }
    }

    /// The robot.
    ///
    /// # Errors
    /// [`RobotError`], with the file and the line or key.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        self.read_with(&[])
    }

    /// The robot with joints locked in addition to those that its description locks; `path` is the file that states `locks`,
    /// for messages. Transmissions of a URDF that name only locked joints are ignored.
    ///
    /// # Errors
    /// As [`RobotSource::robot`], and [`RobotError::Lock`].
    pub fn robot_with_locks(&self, locks: &Locks, path: &Path) -> Result<Robot, RobotError> {
        self.read_with(&[LocksOf { path, locks }])
    }

    /// The robot without the transmissions of a URDF, which may couple joints, or the gears of an MJCF.
    ///
    /// # Errors
    /// As [`RobotSource::robot`].
    pub fn robot_without_transmission(&self) -> Result<Robot, RobotError> {
        self.read_as(urdf::Transmissions::Ignored, &[])
    }

    fn read_with(&self, locks: &[LocksOf<'_>]) -> Result<Robot, RobotError> {
        self.read_as(urdf::Transmissions::Read, locks)
    }

    fn read_as(&self, transmissions: urdf::Transmissions, locks: &[LocksOf<'_>]) -> Result<Robot, RobotError> {
        if !is_xml(&self.text) {
            let below =
                self.urdf.as_ref().map(|(path, text)| toml_file::Underlying { path, text, origins: &self.origins });
            return toml_file::read(&self.text, &self.path, below, transmissions, locks);
        }
        let whole = match mjcf::is_mjcf(&self.text) {
            true => mjcf::read(&self.text, &self.path, &self.origins, transmissions)?,
            false => urdf::read(&self.text, &self.path, transmissions, locks)?,
        };
        let values = resolve_all(&whole.joints, locks)?;
        merged(&whole, &values).map_err(|source| RobotError::lock(&self.path, source))
    }

    /// One text with everything, from which [`Robot::parse`] builds the same robot without any file.
    #[must_use]
    pub fn to_text(&self) -> String {
        match &self.urdf {
            Some((_, urdf)) if !toml_file::has_embedded_urdf(&self.text) => {
                toml_file::with_embedded_urdf(&self.text, urdf)
            }
            _ => self.text.clone(),
        }
    }
}

impl Robot {
    /// Reads a robot description: if its text starts with `<`, an MJCF with the root element `<mujoco>` or a URDF, otherwise TOML,
    /// which may refer to one of them.
    ///
    /// # Errors
    /// [`RobotError`], with the file and the line or key.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        RobotSource::read(path)?.robot()
    }

    /// Reads a robot description from its text, as for [`Robot::read`] or from [`RobotSource::to_text`]; `path` is its name in
    /// messages, and the key `urdf` of a TOML and the files that an MJCF includes are relative to its folder.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, RobotError> {
        RobotSource::from_text(text.to_owned(), path)?.robot()
    }
}

/// An MJCF with what it includes; other texts unchanged.
fn joined(text: String, path: &Path) -> Result<(String, mjcf::Origins), RobotError> {
    if mjcf::is_mjcf(&text) { mjcf::join(text, path, &read_text) } else { Ok((text, mjcf::Origins::default())) }
}

fn is_xml(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

/// The text of a description, of at most 16 MiB.
#[doc(hidden)]
pub fn read_text(path: &Path) -> Result<String, RobotError> {
    let unreadable = |e: std::io::Error| RobotError::Unreadable { path: path.to_owned(), reason: e.to_string() };
    let mut text = String::new();
    files::open(path).and_then(|file| file.take(LONGEST + 1).read_to_string(&mut text)).map_err(unreadable)?;
    if text.len() as u64 > LONGEST {
        return Err(RobotError::TooLarge {
            path: path.to_owned(),
            what: "MiB of text",
            limit: (LONGEST >> 20) as usize,
        });
    }
    Ok(text)
}
