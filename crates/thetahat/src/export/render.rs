//! The file of a robot in each format.

use super::{
    error::ExportError,
    format::Format,
    header,
    json::json,
    mjcf::mjcf,
    said::{Said, said},
    sdf::sdf,
    urdf_edit::edited,
    urdf_new,
};
use crate::robot::Robot;

/// An exported robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The format.
    pub format: Format,
    /// The content of the file.
    pub text: String,
    /// What the format cannot say of the robot, a sentence each; it is in the file as well.
    pub unsaid: Vec<String>,
    /// What was done beside, as how bodies were split; it is in the file as well.
    pub notes: Vec<String>,
    pub(super) said: Said,
}

impl Export {
    /// The robot as the format says it: the torques of the file are those of this robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.said.robot
    }

    /// Its standard parameters, SI, in the order of its table.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.said.parameters
    }
}

/// A robot with these standard parameters, SI and in the order of its table, as a file. `urdf` is the text of the URDF that
/// it was read from: it is edited, and all that is no inertia and no friction stays byte for byte. `about` are lines for the
/// comment at the start of the file.
///
/// Links need a mass above zero; whether they are bodies is not checked.
///
/// # Errors
/// [`ExportError::Robot`] for a URDF that is not that of the robot.
pub fn export_robot(
    robot: &Robot,
    urdf: Option<&str>,
    parameters: &[f64],
    format: Format,
    about: &[String],
) -> Result<Export, ExportError> {
    let said = said(robot, parameters, format);
    let mut notes = Vec::new();
    let header = |notes: &[String]| header::comment(robot, &said, about, notes);
    let text = match (format, urdf) {
        (Format::Urdf, Some(text)) => {
            let edited = edited(text, &said)?;
            let text = edited.with_header(&header(&edited.notes));
            notes = edited.notes;
            text
        }
        (Format::Urdf, None) => urdf_new::urdf(&said, &header(&[]), robot.transmission.ratios().as_deref()),
        (Format::Mjcf, _) => mjcf(&said, &header(&[])),
        (Format::Sdf, _) => sdf(&said, &header(&[])),
        (Format::Json, _) => json(&said, about)?,
    };
    Ok(Export { format, text, unsaid: said.unsaid.clone(), notes, said })
}
