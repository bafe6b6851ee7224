//! The comment at the start of a file: by its first words the file is known as one of this program.

use super::{represented::RepresentedRobot, xml};
use thetahat_model::robot::Robot;

/// First words of every exported file.
pub(super) const MARK: &str = thetahat_ground::output::EXPORT;

/// The comment.
pub(super) fn comment(robot: &Robot, represented: &RepresentedRobot, about: &[String], notes: &[String]) -> String {
    let first = format!("{MARK}{}: {}", env!("CARGO_PKG_VERSION"), robot.name);
    let lines: Vec<String> = [&[first], about, notes, &represented.not_represented].concat();
    xml::comment(&lines)
}
