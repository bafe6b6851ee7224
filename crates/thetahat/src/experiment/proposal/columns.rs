use super::{
    super::column_names::{self, Signal},
    source::{Chosen, Source, channels},
};
use crate::{recording::ColumnSummary, robot::Robot};

/// A column and the number in its name.
type Numbered<'a> = (&'a ColumnSummary, Option<usize>);

/// The columns that hold a signal, one channel for each joint, in the order of the joints: those whose names say so, or
/// where the names of the columns say nothing, those of a file whose name does.
pub(super) fn by_name<'a>(source: &Source<'a>, robot: &Robot, signal: Signal) -> Result<Vec<Chosen<'a>>, String> {
    let named =
        |c: &'a ColumnSummary| column_names::read(&c.name).filter(|r| r.signal == signal).map(|r| (c, r.number));
    let mut found: Vec<Numbered<'a>> = source.columns().filter_map(named).collect();
    if found.is_empty() && of_file(source) == Some(signal) {
        found = silent(source);
    }
    in_order(robot, found)
}

/// Whether the columns of a file say nothing, and its name says which signal they hold.
pub(super) fn of_file(source: &Source<'_>) -> Option<Signal> {
    let names = [source.stem(), source.folder()];
    names.iter().find_map(|name| column_names::read(name)).map(|r| r.signal)
}

/// The columns whose names say nothing and that are no times.
pub(super) fn silent<'a>(source: &Source<'a>) -> Vec<Numbered<'a>> {
    let untold = source.columns().filter(|c| column_names::is_silent(&c.name) && !source.is_time(&c.name));
    untold.map(|c| (c, column_names::number(&c.name))).collect()
}

fn in_order<'a>(robot: &Robot, mut found: Vec<Numbered<'a>>) -> Result<Vec<Chosen<'a>>, String> {
    let joints = robot.coordinate_count();
    let chosen = |columns: &[&'a ColumnSummary]| columns.iter().map(|c| Chosen::of(c)).collect::<Vec<_>>();
    let all = chosen(&found.iter().map(|(c, _)| *c).collect::<Vec<_>>());
    if channels(&all) != joints {
        let names: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
        return Err(format!("{} columns look like it ({})", channels(&all), names.join(" ")));
    }
    if all.len() == 1 {
        return Ok(all);
    }
    if let Some(ordered) = in_order_of_joints(robot, &found) {
        return Ok(chosen(&ordered));
    }
    found.sort_by_key(|(_, number)| *number);
    let numbers: Vec<Option<usize>> = found.iter().map(|(_, number)| *number).collect();
    if numbers.windows(2).all(|n| matches!(n, [Some(a), Some(b)] if b - a == 1)) {
        return Ok(chosen(&found.iter().map(|(c, _)| *c).collect::<Vec<_>>()));
    }
    Err("their names have neither the joints' names nor consecutive numbers".to_owned())
}

/// The columns by the names of the joints, where each joint's name is in exactly one of them.
fn in_order_of_joints<'a>(robot: &Robot, found: &[Numbered<'a>]) -> Option<Vec<&'a ColumnSummary>> {
    let of_joint = |name: &str| {
        let matching: Vec<_> = found.iter().filter(|(c, _)| contains_name(&c.name, name)).collect();
        match matching[..] {
            [(only, _)] => Some(*only),
            _ => None,
        }
    };
    robot.coordinates().map(|joint| of_joint(&joint.name)).collect()
}

/// Whether a column's name holds a joint's name as a word of its own.
fn contains_name(column: &str, joint: &str) -> bool {
    let boundary = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    column.match_indices(joint).any(|(start, found)| {
        boundary(column[..start].chars().next_back()) && boundary(column[start + found.len()..].chars().next())
    })
}
