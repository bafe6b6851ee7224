use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::robot::{RobotError, mjcf::is_mjcf};
use thetahat_ground::files;

/// The URDF or MJCF that a TOML refers to.
pub(in crate::robot) enum Urdf {
    /// A file.
    File(PathBuf),
    /// The text itself, with the name of its original file.
    Text(PathBuf, String),
}

#[derive(Deserialize)]
struct Keys {
    #[serde(alias = "mjcf")]
    urdf: Option<PathBuf>,
    #[serde(alias = "mjcf_text")]
    urdf_text: Option<String>,
}

/// The URDF or MJCF of a description at `path`, if it refers to one.
pub(in crate::robot) fn urdf_of(text: &str, path: &Path) -> Result<Option<Urdf>, RobotError> {
    let keys = toml::from_str::<Keys>(text).map_err(|e| RobotError::of_toml(&e, path))?;
    Ok(match (keys.urdf, keys.urdf_text) {
        (name, Some(text)) => Some(Urdf::Text(name.unwrap_or_else(|| PathBuf::from("urdf_text")), text)),
        (Some(name), None) => Some(Urdf::File(allowed_file(path, &name)?)),
        (None, None) => None,
    })
}

/// The path of a file named by the description at `path`: inside its folder or the folder above, links followed, so that a
/// foreign description cannot read any other file.
fn allowed_file(path: &Path, name: &Path) -> Result<PathBuf, RobotError> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let file = folder.join(name);
    let real = |path: &Path| files::real(path).ok();
    match real(&file).zip(real(&folder.join(".."))) {
        Some((file, above)) if !file.starts_with(&above) => Err(RobotError::Value {
            path: path.to_owned(),
            key: "urdf or mjcf".to_owned(),
            expected: "a file in the folder of this description or the one above",
            found: name.display().to_string(),
        }),
        // A missing file is reported where it is read.
        _ => Ok(file),
    }
}

/// Whether the description embeds its URDF or MJCF.
pub(in crate::robot) fn has_embedded_urdf(text: &str) -> bool {
    toml::from_str::<Keys>(text).is_ok_and(|keys| keys.urdf_text.is_some())
}

/// The description with its URDF or MJCF embedded in the key `urdf_text` or `mjcf_text`.
pub(in crate::robot) fn with_embedded_urdf(text: &str, urdf: &str) -> String {
    let key = if is_mjcf(urdf) { "mjcf_text" } else { "urdf_text" };
    format!("{key} = {}\n{}", toml::Value::String(urdf.to_owned()), text.trim_start_matches('\u{feff}'))
}
