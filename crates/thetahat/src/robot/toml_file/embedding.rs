use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::robot::RobotError;

/// The URDF that a TOML stands on.
pub(in crate::robot) enum Urdf {
    /// A file.
    File(PathBuf),
    /// The text itself, under the name of the file that it came from.
    Text(PathBuf, String),
}

#[derive(Deserialize)]
struct Keys {
    urdf: Option<PathBuf>,
    urdf_text: Option<String>,
}

/// The URDF of a description at `path`, if it stands on one.
pub(in crate::robot) fn urdf_of(text: &str, path: &Path) -> Result<Option<Urdf>, RobotError> {
    let keys = toml::from_str::<Keys>(text).map_err(|e| RobotError::of_toml(&e, path))?;
    let beside = |name: PathBuf| path.parent().unwrap_or(Path::new("")).join(name);
    Ok(match (keys.urdf, keys.urdf_text) {
        (name, Some(text)) => Some(Urdf::Text(name.unwrap_or_else(|| PathBuf::from("urdf_text")), text)),
        (Some(name), None) => Some(Urdf::File(beside(name))),
        (None, None) => None,
    })
}

/// Whether the description carries its URDF in itself.
pub(in crate::robot) fn has_embedded_urdf(text: &str) -> bool {
    toml::from_str::<Keys>(text).is_ok_and(|keys| keys.urdf_text.is_some())
}

/// The description with its URDF in itself, in the key `urdf_text`.
pub(in crate::robot) fn with_embedded_urdf(text: &str, urdf: &str) -> String {
    format!("urdf_text = {}\n{}", toml::Value::String(urdf.to_owned()), text.trim_start_matches('\u{feff}'))
}
