//! Selects the channels of a signal from a table, in the requested order.

use std::path::Path;

use super::checks::require_finite;
use super::error::RecordingError;
use super::format::{Format, Holds};
use super::table::{Column, MissingValues, Table, indexed, is_other_spelling};
use thetahat_ground::series::Series;

/// The named columns of a table, joined.
#[cfg(test)]
pub(super) fn series(table: &Table, format: Format, asked: &[String], path: &Path) -> Result<Series, RecordingError> {
    columns(table, format, asked, path)?.series(path, MissingValues::Refused)
}

/// The named columns of a table, in the order of the names.
///
/// A column of several channels gives all of them, `name[3]` its third. Without names, all columns of a file that is one table, or the only
/// numeric variable of another file.
pub(super) fn columns<'a>(
    table: &'a Table,
    format: Format,
    asked: &[String],
    path: &Path,
) -> Result<SelectedColumns<'a>, RecordingError> {
    let columns = match asked {
        [] => unnamed(table, format, path)?,
        _ => asked.iter().map(|name| find(table, format, name, path)).collect::<Result<_, _>>()?,
    };
    Ok(SelectedColumns(columns))
}

/// Columns of a table in the order of the channels.
pub(super) struct SelectedColumns<'a>(Vec<Selected<'a>>);

/// A column, and which of its channels: none means all.
type Selected<'a> = (&'a Column, Option<usize>);

impl<'a> SelectedColumns<'a> {
    /// The channels side by side, if all values are finite numbers, or missing where those are kept.
    pub(super) fn series(&self, path: &Path, missing: MissingValues) -> Result<Series, RecordingError> {
        for (column, _) in &self.0 {
            column.require_sound(path, missing)?;
            require_finite(&column.values, path, &column.name, missing)?;
        }
        same_samples(&self.0, path)?;
        Ok(side_by_side(&self.0))
    }

    /// The columns, each with the index of its first channel.
    pub(super) fn with_channels(&self) -> impl Iterator<Item = (usize, &'a Column)> {
        let mut channel = 0;
        self.0.iter().map(move |(column, only)| {
            let first = channel;
            channel += if only.is_some() { 1 } else { column.channels };
            (first, *column)
        })
    }
}

fn unnamed<'a>(table: &'a Table, format: Format, path: &Path) -> Result<Vec<Selected<'a>>, RecordingError> {
    let numeric: Vec<&Column> = table.columns.iter().filter(|c| c.is_numeric()).collect();
    match (format.is_one_table(), numeric.as_slice()) {
        (true, [_, ..]) => Ok(table.columns.iter().map(|column| (column, None)).collect()),
        (false, [only]) => Ok(vec![(only, None)]),
        _ => Err(RecordingError::NoColumnListed { file: path.to_owned(), found: names(table) }),
    }
}

fn find<'a>(table: &'a Table, format: Format, asked: &str, path: &Path) -> Result<Selected<'a>, RecordingError> {
    if let Some(column) = named(table, asked, path)? {
        return Ok((column, None));
    }
    if let Some(found) = named_channel(table, asked) {
        return Ok(found);
    }
    let part = indexed(asked).map(|(name, index)| Ok((named(table, name, path)?, index))).transpose()?;
    let (file, found) = (path.to_owned(), names(table));
    match part {
        Some((Some(column), index)) if (1..=column.channels).contains(&index) => Ok((column, Some(index - 1))),
        Some((Some(column), _)) if column.is_numeric() => {
            Err(RecordingError::MissingChannel { file, column: asked.to_owned(), found: column.channels })
        }
        Some((Some(column), _)) => Ok((column, None)),
        _ => without_name(table, format, asked, path)?
            .map(|column| (column, None))
            .ok_or_else(|| RecordingError::MissingColumn { file, column: asked.to_owned(), found }),
    }
}

/// A channel with a name of its own.
fn named_channel<'a>(table: &'a Table, asked: &str) -> Option<Selected<'a>> {
    let channel = |column: &'a Column| Some((column, Some(column.channel_names.iter().position(|n| n == asked)?)));
    table.columns.iter().find_map(channel)
}

/// A column that is asked for by another spelling of its name; in a text, also by its number from 1.
fn without_name<'a>(
    table: &'a Table,
    format: Format,
    asked: &str,
    path: &Path,
) -> Result<Option<&'a Column>, RecordingError> {
    let is_repeated =
        |name: &str| name.strip_prefix(asked).and_then(|rest| rest.strip_prefix('#')).is_some_and(is_number);
    let is_asked = |column: &&Column| is_other_spelling(asked, &column.name) || is_repeated(&column.name);
    let mut columns = table.columns.iter().filter(is_asked);
    match (columns.next(), columns.count()) {
        (Some(column), 0) => return Ok(Some(column)),
        (Some(_), others) => {
            let (file, column) = (path.to_owned(), asked.to_owned());
            return Err(RecordingError::AmbiguousColumn { file, column, found: others + 1 });
        }
        (None, _) => {}
    }
    let number = asked.parse::<usize>().ok().filter(|_| format.holds() == Holds::Lines);
    Ok(number.and_then(|number| table.columns.get(number.checked_sub(1)?)))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// The only column of a name; none if there is none.
fn named<'a>(table: &'a Table, name: &str, path: &Path) -> Result<Option<&'a Column>, RecordingError> {
    let mut columns = table.columns.iter().filter(|column| column.name == name);
    match (columns.next(), columns.count()) {
        (column, 0) => Ok(column),
        (_, others) => {
            let (file, column) = (path.to_owned(), name.to_owned());
            Err(RecordingError::AmbiguousColumn { file, column, found: others + 1 })
        }
    }
}

fn names(table: &Table) -> Vec<String> {
    table.columns.iter().map(|column| column.name.clone()).collect()
}

fn same_samples(columns: &[Selected<'_>], path: &Path) -> Result<(), RecordingError> {
    let [(first, _), others @ ..] = columns else { return Ok(()) };
    match others.iter().find(|(column, _)| column.samples() != first.samples()) {
        None => Ok(()),
        Some((other, _)) => Err(RecordingError::DifferentLengths {
            first: first.name.clone(),
            first_file: path.to_owned(),
            first_samples: first.samples(),
            second: other.name.clone(),
            second_file: path.to_owned(),
            second_samples: other.samples(),
        }),
    }
}

fn side_by_side(columns: &[Selected<'_>]) -> Series {
    let channels: Vec<&[f64]> = columns.iter().flat_map(|(column, only)| chosen(column, *only)).collect();
    let samples = channels.first().map_or(0, |channel| channel.len());
    let mut values = Vec::with_capacity(samples * channels.len());
    for sample in 0..samples {
        values.extend(channels.iter().map(|channel| channel[sample]));
    }
    Series::shaped(channels.len(), values)
}

fn chosen(column: &Column, only: Option<usize>) -> Vec<&[f64]> {
    let range = only.map_or(0..column.channels, |channel| channel..channel + 1);
    range.map(|channel| column.channel(channel)).collect()
}
