//! A MuJoCo model of the user's own.

use std::path::{Path, PathBuf};

use roxmltree::Document;

use super::{element::Element, error::MjcfError, matched::Matched, settings::Settings, tree::Tree};
use thetahat_model::robot::{Robot, RobotError, parse_xml, read_text};

/// A MuJoCo model (MJCF) into which robots are exported: its bodies and joints get the identified values, and every other byte
/// stays.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MjcfModel {
    path: PathBuf,
    text: String,
}

impl MjcfModel {
    /// Reads a model.
    ///
    /// # Errors
    /// [`RobotError`] where there is no such text.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        Ok(Self::from_text(read_text(path)?, path))
    }

    /// The model of a text; `path` is its name in messages.
    #[must_use]
    pub fn from_text(text: String, path: &Path) -> Self {
        Self { path: path.to_owned(), text }
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Hands the robot as it is in the model to `then`.
    pub(in crate::export) fn with_robot<T>(
        &self,
        robot: &Robot,
        then: impl FnOnce(ModelParts<'_>) -> Result<T, MjcfError>,
    ) -> Result<T, MjcfError> {
        let document: Document<'_> = parse_xml(&self.text, &self.path)?;
        let root = Element::new(document.root_element(), &self.path);
        if root.tag() != "mujoco" {
            return Err(MjcfError::NotMjcf { place: root.place() });
        }
        if let Some(include) = root.descendants().find(|element| element.tag() == "include") {
            return Err(MjcfError::Include { place: include.place() });
        }
        let settings = Settings::read(root)?;
        let tree = Tree::read(root, &settings)?;
        let matched = Matched::new(root, tree, robot, &self.path)?;
        then(ModelParts { root, settings, matched })
    }
}

/// A robot found in a model.
pub(in crate::export) struct ModelParts<'a> {
    pub(super) root: Element<'a>,
    pub(super) settings: Settings<'a>,
    pub(super) matched: Matched<'a>,
}
