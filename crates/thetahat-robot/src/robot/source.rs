use std::path::{Path, PathBuf};

use super::{
    description::Robot,
    error::RobotError,
    floating::Base,
    loading::{Loaded, expanded_name, load},
    locking::{Locks, LocksOf, merged, resolve_all},
    mjcf,
    text_file::{self, RobotFile},
    toml_file, urdf,
    xacro::XacroOptions,
};

/// The complete text of a robot: including the text of the URDF or MJCF that a TOML refers to, and of what an MJCF includes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotSource {
    path: PathBuf,
    text: String,
    /// The URDF or MJCF that a TOML refers to.
    urdf: Option<(PathBuf, String)>,
    /// The files that were read.
    files: Vec<RobotFile>,
    /// Where they are.
    paths: Vec<PathBuf>,
    /// Whether the text is that of an expanded xacro.
    is_expanded: bool,
    /// The files of the MJCF, if it includes others.
    origins: mjcf::Origins,
}

impl RobotSource {
    /// Reads the description, and the URDF or MJCF that it refers to.
    ///
    /// # Errors
    /// [`RobotError`] for a file that cannot be read.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        Self::read_with_xacro(path, &XacroOptions::default())
    }

    /// Reads the description, and the URDF that it refers to; either may be a xacro, which is expanded with these options.
    ///
    /// # Errors
    /// As [`RobotSource::read`], and [`RobotError::Xacro`].
    pub fn read_with_xacro(path: &Path, options: &XacroOptions) -> Result<Self, RobotError> {
        Self::of(load(path, options)?, path, options)
    }

    /// A description from its text; `path` is its name in messages, and its key `urdf` and the files that an MJCF includes are
    /// relative to its folder.
    ///
    /// # Errors
    /// As [`RobotSource::read`].
    pub fn from_text(text: String, path: &Path) -> Result<Self, RobotError> {
        let own = (!toml_file::has_embedded_urdf(&text)).then(|| RobotFile::new(path, text.as_bytes()));
        let loaded =
            Loaded { text, files: own.into_iter().collect(), paths: vec![path.to_owned()], is_expanded: false };
        Self::of(loaded, path, &XacroOptions::default())
    }

    fn of(own: Loaded, path: &Path, options: &XacroOptions) -> Result<Self, RobotError> {
        let Loaded { text, mut files, mut paths, mut is_expanded } = own;
        let urdf = if is_xml(&text) { None } else { toml_file::urdf_of(&text, path)? };
        let own_place = path.to_owned();
        let mut origins = mjcf::Origins::default();
        let mut joined = |text: String, path: &Path, files: &mut Vec<RobotFile>| -> Result<String, RobotError> {
            let (text, found) = joined(text, path)?;
            if !found.files().is_empty() {
                // The MJCF with the texts that it includes is no file.
                files.pop();
                files.extend(found.files().iter().map(|(path, text)| RobotFile::new(path, text.as_bytes())));
            }
            origins = found;
            Ok(text)
        };
        let (text, urdf) = match urdf {
            Some(toml_file::Urdf::File(file)) => {
                let loaded = load(&file, options)?;
                files.extend(loaded.files);
                paths.extend(loaded.paths);
                is_expanded |= loaded.is_expanded;
                let below = joined(loaded.text, &file, &mut files)?;
                (text, Some((file, below)))
            }
            // An embedded text is complete.
            Some(toml_file::Urdf::Text(name, below)) => {
                files.push(RobotFile::new(&name, below.as_bytes()));
                (text, Some((name, below)))
            }
            None => (joined(text, &own_place, &mut files)?, None),
        };
        paths.extend(origins.files().iter().map(|(path, _)| path.clone()));
        Ok(Self { path: own_place, text, urdf, files, paths, is_expanded, origins })
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

    /// The files, the description first and then the URDF or MJCF that it refers to, each with the files that a xacro or an MJCF
    /// includes. For a text with an embedded URDF or MJCF, as made by [`RobotSource::to_text`], only that.
    #[must_use]
    pub fn files(&self) -> Vec<RobotFile> {
        self.files.clone()
    }

    /// The paths of all files that were read, which a program must not replace: also those that a xacro or an MJCF includes. Some may
    /// be named twice.
    #[must_use]
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
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
        let shown = |path: &Path| if self.is_expanded { expanded_name(path) } else { path.to_owned() };
        if !is_xml(&self.text) {
            let names = self.urdf.as_ref().map(|(path, text)| (shown(path), text));
            let below = names.as_ref().map(|(path, text)| toml_file::Underlying { path, text, origins: &self.origins });
            return toml_file::read(&self.text, &self.path, below, transmissions, locks);
        }
        let whole = match mjcf::is_mjcf(&self.text) {
            true => mjcf::read(&self.text, &self.path, &self.origins, transmissions, Base::Fixed)?,
            false => urdf::read(&self.text, &shown(&self.path), transmissions, locks, Base::Fixed)?,
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
    if mjcf::is_mjcf(&text) {
        mjcf::join(text, path, &|file| Ok(text_file::read(file)?.text))
    } else {
        Ok((text, mjcf::Origins::default()))
    }
}

fn is_xml(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}
