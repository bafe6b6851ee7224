//! The units that the names of columns say, one for each channel.

use super::{
    super::column_names::{self, Signal},
    source::{SelectedColumn, Source},
    written::{Written, dimensions, written},
};
use thetahat_data::recording::{Dimension, Unit};
use thetahat_model::robot::{Joint, JointKind};

/// The units of a signal's channels, as names say them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NamedUnits {
    pub(super) units: Vec<Unit>,
    /// Whether the name of a channel says its unit.
    pub(super) is_said: Vec<bool>,
    pub(super) why: &'static str,
    /// The word for the counts of a device, where values are such.
    pub(super) counts: Option<String>,
}

/// A column with a unit that cannot be its own, and why, as the end of a sentence.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Misfit {
    pub(super) column: String,
    pub(super) problem: String,
    /// Whether the column may be of another joint.
    pub(super) is_of_a_joint: bool,
}

/// The units of a signal's channels; `None` if no name states any. Channels without a unit have that of the others.
pub(super) fn named_units(
    signal: Signal,
    columns: &[SelectedColumn<'_>],
    kinds: &[JointKind],
) -> Result<Option<NamedUnits>, Misfit> {
    let mut counts = None;
    let mut said: Vec<Option<Unit>> = Vec::new();
    for column in columns {
        let unit = match written(&column.name, signal) {
            None => None,
            Some(Written::Unit(unit)) if dimensions(signal).contains(&unit.dimension()) => Some(unit),
            Some(Written::Unit(unit)) => return Err(no_unit(column, unit.symbol(), signal)),
            Some(Written::Unknown(text)) => return Err(no_unit(column, &text, signal)),
            Some(Written::Counts(word)) => {
                let unit = counted(signal).ok_or_else(|| no_unit(column, &word, signal))?;
                counts = Some(word);
                Some(unit)
            }
        };
        said.extend(column.channels.iter().map(|_| unit));
    }
    let of_columns = said.iter().flatten().next().copied();
    let Some(first) = of_columns else { return Ok(None) };
    let is_partial = said.contains(&None);
    let why = if is_partial { "from the names, and a guess where they have none" } else { "from the names" };
    let units = said.iter().zip(kinds).map(|(unit, kind)| unit.unwrap_or_else(|| matching(first, *kind)));
    // Counts of positions become angles and lengths by their gain.
    let units = match (&counts, signal) {
        (Some(_), Signal::Position) => kinds.iter().map(|kind| matching(Unit::Radian, *kind)).collect(),
        (Some(_) | None, _) => units.collect(),
    };
    Ok(Some(NamedUnits { units, is_said: said.iter().map(Option::is_some).collect(), why, counts }))
}

/// Checks that the units measure what the joints do.
pub(super) fn require_units_of_joints<'j>(
    units: &[Unit],
    columns: &[SelectedColumn<'_>],
    joints: impl Iterator<Item = &'j Joint>,
) -> Result<(), Misfit> {
    let names = columns.iter().flat_map(|column| column.channels.iter().map(|_| &column.name));
    for ((unit, name), joint) in units.iter().zip(names).zip(joints) {
        if !fits(*unit, joint.kind) {
            let moves = match joint.kind {
                JointKind::Revolute => "turns",
                JointKind::Prismatic => "slides",
            };
            let problem = format!("written in {unit}, {}, and joint `{}` {moves}", unit.dimension(), joint.name);
            return Err(Misfit { column: name.clone(), problem, is_of_a_joint: true });
        }
    }
    Ok(())
}

/// Whether a unit can be one of a joint's own.
pub(super) fn fits(unit: Unit, kind: JointKind) -> bool {
    matching(unit, kind) == unit
}

/// A unit, or the SI unit in its place for a joint of the other kind.
pub(super) fn matching(unit: Unit, kind: JointKind) -> Unit {
    match (unit.dimension(), kind) {
        (Dimension::Angle, JointKind::Prismatic) => Unit::Metre,
        (Dimension::Length, JointKind::Revolute) => Unit::Radian,
        (Dimension::AngularVelocity, JointKind::Prismatic) => Unit::MetrePerSecond,
        (Dimension::LinearVelocity, JointKind::Revolute) => Unit::RadianPerSecond,
        (Dimension::Torque, JointKind::Prismatic) => Unit::Newton,
        (Dimension::Force, JointKind::Revolute) => Unit::NewtonMetre,
        _ => unit,
    }
}

/// The unit of counts, where a gain can turn them into the signal.
fn counted(signal: Signal) -> Option<Unit> {
    match signal {
        Signal::Position => Some(Unit::Radian),
        Signal::Torque => Some(Unit::One),
        Signal::Reference | Signal::Velocity | Signal::Time => None,
    }
}

/// The unit that the name of the file hints at, where the columns say nothing. It is never taken: files of torques in N m are called
/// currents too, and folders are renamed.
pub(super) fn hint_of_file(source: &Source<'_>, signal: Signal, columns: &[SelectedColumn<'_>]) -> Option<Unit> {
    match written(&source.stem(), signal).filter(|_| are_silent(columns)) {
        Some(Written::Unit(unit)) => Some(unit),
        Some(Written::Counts(_) | Written::Unknown(_)) | None => None,
    }
}

fn are_silent(columns: &[SelectedColumn<'_>]) -> bool {
    columns.iter().all(|column| column_names::is_silent(&column.name))
}

fn no_unit(column: &SelectedColumn<'_>, text: &str, signal: Signal) -> Misfit {
    let a_signal = match signal {
        Signal::Time => "a time",
        Signal::Position | Signal::Reference => "a position",
        Signal::Velocity => "a velocity",
        Signal::Torque => "a torque",
    };
    let problem = format!("written in {text:?}, which is no unit of {a_signal} that thetahat knows");
    Misfit { column: column.name.clone(), problem, is_of_a_joint: false }
}
