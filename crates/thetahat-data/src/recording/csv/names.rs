//! The names of columns: with the groups above them, the units below them, and numbers where they are missing or repeated.

use std::collections::HashMap;

use super::sample::Sample;
use super::unit_line::with_unit;

/// The names of a table's columns, each different; none if no line names them.
pub(super) fn column_names(sample: &Sample<'_>) -> Option<Vec<String>> {
    let row = sample.table.names?;
    let mut names = sample.cells(row);
    if has_repetitions(&names)
        && let Some(above) = row.checked_sub(1).filter(|&above| sample.is_group_line(above))
    {
        names = with_groups(&sample.cells(above), &names);
    }
    if let Some(units) = sample.table.units {
        let units = sample.cells(units);
        names = names.iter().zip(units).map(|(name, unit)| with_unit(name, &unit)).collect();
    }
    Some(each_different(&names))
}

/// Names below the names of their groups; an empty cell continues the group before it.
fn with_groups(groups: &[String], names: &[String]) -> Vec<String> {
    let mut current = "";
    let mut joined = Vec::new();
    for (group, name) in groups.iter().zip(names) {
        if !group.is_empty() {
            current = group;
        }
        joined.push(format!("{current} {name}").trim().to_owned());
    }
    joined
}

/// A column without a name has its number, from 1; those of one name are `name#1`, `name#2` and so on: the name alone says not which.
fn each_different(names: &[String]) -> Vec<String> {
    let number = |(name, number): (&String, usize)| match name.is_empty() {
        false => name.clone(),
        true if names.contains(&number.to_string()) => format!("column {number}"),
        true => number.to_string(),
    };
    let numbered: Vec<String> = names.iter().zip(1..).map(number).collect();
    let mut all = HashMap::<String, usize>::new();
    numbered.iter().for_each(|name| *all.entry(name.clone()).or_insert(0) += 1);
    let mut seen = HashMap::<String, usize>::new();
    let different = |name: String| {
        let count = seen.entry(name.clone()).and_modify(|count| *count += 1).or_insert(1);
        if all[&name] == 1 { name } else { format!("{name}#{count}") }
    };
    numbered.into_iter().map(different).collect()
}

fn has_repetitions(names: &[String]) -> bool {
    let mut sorted: Vec<&String> = names.iter().filter(|name| !name.is_empty()).collect();
    sorted.sort();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn repeated_and_missing_names_are_numbered() {
        assert_eq!(each_different(&strings(&["tau", "", "tau", "tau"])), ["tau#1", "2", "tau#2", "tau#3"]);
        assert_eq!(each_different(&strings(&["", "0", "1"])), ["column 1", "0", "1"]);
    }

    #[test]
    fn groups_stand_above_their_names() {
        let names = with_groups(&strings(&["", "position", "", "torque"]), &strings(&["t", "j1", "j2", "j1"]));
        assert_eq!(names, ["t", "position j1", "position j2", "torque j1"]);
    }
}
