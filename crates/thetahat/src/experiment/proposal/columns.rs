use super::{
    super::column_names::{self, Signal},
    set_aside::{self, SetAside},
    source::{SelectedColumn, Source, channels},
    written::{Written, written},
};
use thetahat_data::recording::{ColumnSummary, Dimension};
use thetahat_model::robot::Robot;

/// A column and the number in its name.
type Numbered<'a> = (&'a ColumnSummary, Option<usize>);

/// The columns that hold a signal, one channel for each joint, in the order of the joints: those whose names say so, or
/// where the names of the columns say nothing, those of a file whose name does.
pub(super) fn by_name<'a>(
    source: &Source<'a>,
    robot: &Robot,
    signal: Signal,
) -> Result<Vec<SelectedColumn<'a>>, String> {
    let named = measured(source, robot, signal).0;
    let number = |c: &ColumnSummary| source.reading(&c.name).and_then(|reading| reading.number);
    let mut found: Vec<Numbered<'a>> = named.into_iter().map(|c| (c, number(c))).collect();
    if found.is_empty() && signal == Signal::Reference {
        found = desired(source);
    }
    if found.is_empty() && of_file(source) == Some(signal) {
        found = silent(source);
    }
    if found.is_empty() {
        found = in_units_of(source, signal);
    }
    let is_velocity = |c: &ColumnSummary| source.reading(&c.name).is_some_and(|r| r.signal == Signal::Velocity);
    if found.is_empty() && signal == Signal::Position && source.columns().any(is_velocity) {
        return Err("no column looks like it, and velocities are not enough: log the positions".to_owned());
    }
    let without_idle = || in_order(source, robot, without_idle(&found));
    in_order(source, robot, found.clone()).or_else(|problem| without_idle().map_err(|_| problem))
}

/// The columns that are not zero all the time: those of motors that are not connected are.
fn without_idle<'a>(columns: &[Numbered<'a>]) -> Vec<Numbered<'a>> {
    let is_zero = |column: &ColumnSummary| column.statistics.iter().all(|c| c.min == Some(0.0) && c.max == Some(0.0));
    columns.iter().copied().filter(|(column, _)| !is_zero(column)).collect()
}

/// The columns whose names say that they hold a signal, and those that stand next to its measurement.
pub(super) fn measured<'a>(
    source: &Source<'a>,
    robot: &Robot,
    signal: Signal,
) -> (Vec<&'a ColumnSummary>, Vec<SetAside>) {
    let is_of = |c: &&ColumnSummary| source.reading(&c.name).is_some_and(|reading| reading.signal == signal);
    set_aside::parted(source, robot, signal, source.columns().filter(is_of).collect())
}

/// The columns of a group that have a name in common, `observation.state` of `observation.state.elbow.pos`, in the order of the joints,
/// or of the log where their names are not those of the joints; none if they are not one for each joint.
pub(super) fn of_group<'a>(source: &Source<'a>, robot: &Robot, group: &str) -> Vec<SelectedColumn<'a>> {
    let is_of = |c: &&ColumnSummary| {
        let rest = c.name.strip_prefix(group).and_then(|rest| rest.chars().next());
        rest.is_some_and(|c| !c.is_alphabetic()) && !source.is_time(&c.name)
    };
    let numbered = |c: &'a ColumnSummary| (c, column_names::number(&c.name));
    let found: Vec<Numbered<'a>> = source.columns().filter(is_of).map(numbered).collect();
    let in_log: Vec<SelectedColumn<'a>> = found.iter().map(|(column, _)| SelectedColumn::of(column)).collect();
    let in_order = in_order(source, robot, found);
    in_order.unwrap_or_else(|_| if channels(&in_log) == robot.coordinate_count() { in_log } else { Vec::new() })
}

/// Whether the name of a column says that it holds a signal, or where that says nothing, the name of its file.
pub(super) fn says(source: &Source<'_>, column: &str, signal: Signal) -> bool {
    match (source.by_driver(column), column_names::is_silent(column)) {
        (Some(reading), _) => reading.signal == signal,
        (None, true) => of_file(source) == Some(signal),
        (None, false) => source.reading(column).is_some_and(|reading| reading.signal == signal),
    }
}

/// Whether the columns of a file say nothing, and its name says which signal they hold.
pub(super) fn of_file(source: &Source<'_>) -> Option<Signal> {
    let names = [source.stem(), source.folder()];
    names.iter().find_map(|name| column_names::read_file_name(name))
}

/// The columns of desired values whose names do not say of which signal.
fn desired<'a>(source: &Source<'a>) -> Vec<Numbered<'a>> {
    let desired = source.columns().filter(|c| column_names::says_only_desired(&c.name));
    desired.map(|c| (c, column_names::number(&c.name))).collect()
}

/// The columns whose names say nothing and that are no times.
pub(super) fn silent<'a>(source: &Source<'a>) -> Vec<Numbered<'a>> {
    let is_silent = |c: &&ColumnSummary| column_names::is_silent(&c.name) && source.by_driver(&c.name).is_none();
    let silent = source.columns().filter(is_silent).filter(|c| !source.is_time(&c.name));
    silent.map(|c| (c, column_names::number(&c.name))).collect()
}

/// The columns whose names say nothing but a unit of the signal, as `slew_deg` and `slew_kNm`.
fn in_units_of<'a>(source: &Source<'a>, signal: Signal) -> Vec<Numbered<'a>> {
    let is_of = |(column, _): &Numbered<'a>| match written(&column.name, signal) {
        Some(Written::Unit(unit)) => motion_or_load(unit.dimension()) == Some(signal),
        Some(Written::Counts(_) | Written::Unknown(_)) | None => false,
    };
    silent(source).into_iter().filter(is_of).collect()
}

/// The signal that alone is measured in a dimension.
fn motion_or_load(dimension: Dimension) -> Option<Signal> {
    match dimension {
        Dimension::Angle | Dimension::Length => Some(Signal::Position),
        Dimension::AngularVelocity | Dimension::LinearVelocity => Some(Signal::Velocity),
        Dimension::Torque | Dimension::Force => Some(Signal::Torque),
        Dimension::AngularAcceleration
        | Dimension::LinearAcceleration
        | Dimension::Current
        | Dimension::Voltage
        | Dimension::Time
        | Dimension::Dimensionless => None,
    }
}

fn in_order<'a>(
    source: &Source<'a>,
    robot: &Robot,
    mut found: Vec<Numbered<'a>>,
) -> Result<Vec<SelectedColumn<'a>>, String> {
    let joints = robot.coordinate_count();
    if let Some(ordered) = in_order_of_joints(source, robot, &found) {
        return Ok(ordered.into_iter().map(SelectedColumn::of).collect());
    }
    if let Some(lacking) = source.joint_unknown_to_driver(robot, found.iter().map(|(column, _)| *column)) {
        return Err(format!("the driver has no column of joint `{lacking}`"));
    }
    let chosen = |columns: &[&'a ColumnSummary]| columns.iter().map(|c| SelectedColumn::of(c)).collect::<Vec<_>>();
    let all = chosen(&found.iter().map(|(c, _)| *c).collect::<Vec<_>>());
    if channels(&all) != joints {
        return Err(looking_like_it(&all));
    }
    if all.len() == 1 {
        return Ok(all);
    }
    found.sort_by_key(|(_, number)| *number);
    let numbers: Vec<Option<usize>> = found.iter().map(|(_, number)| *number).collect();
    if numbers.windows(2).all(|n| matches!(n, [Some(a), Some(b)] if b - a == 1)) {
        return Ok(chosen(&found.iter().map(|(c, _)| *c).collect::<Vec<_>>()));
    }
    Err("their names have neither the joints' names nor consecutive numbers".to_owned())
}

/// How many columns look like a signal, and which.
fn looking_like_it(columns: &[SelectedColumn<'_>]) -> String {
    let names = columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(" ");
    match channels(columns) {
        0 => "no column looks like it".to_owned(),
        1 => format!("1 column looks like it ({names})"),
        several => format!("{several} columns look like it ({names})"),
    }
}

/// The columns by the names of the joints, where each joint has one; columns of other joints are left out.
fn in_order_of_joints<'a>(
    source: &Source<'a>,
    robot: &Robot,
    found: &[Numbered<'a>],
) -> Option<Vec<&'a ColumnSummary>> {
    let names: Vec<&str> = robot.coordinates().map(|joint| joint.name.as_str()).collect();
    let columns: Vec<&ColumnSummary> = found.iter().map(|(column, _)| *column).collect();
    source.columns_of(&names, &columns).into_iter().collect()
}
