//! The values of one column while its cells are read.

use super::super::table::{Column, Flaw, is_plausible};
use super::lists::{self, Lists};
use super::number::Numbers;
use super::stamp::Stamp;
use super::stamps::seconds;
use super::text::characters;

/// The cells of a column as numbers, or as stamps or lists of numbers if the first is one.
#[derive(Default)]
pub(super) struct Values {
    numbers: Vec<f64>,
    lists: Lists,
    stamps: Vec<Option<Stamp>>,
    flaw: Option<Flaw>,
    /// The first stamp, and its line.
    first_stamp: Option<(u64, String)>,
}

impl Values {
    /// Adds a cell; `line` is asked for only if the cell is flawed.
    pub(super) fn push(&mut self, cell: &[u8], numbers: &mut Numbers, line: impl Fn() -> u64) {
        if !self.stamps.is_empty() {
            return self.push_stamp(cell, line);
        }
        if !self.lists.is_empty() {
            return self.push_list(cell, line);
        }
        let number = numbers.read(cell);
        if number.is_none() && self.numbers.is_empty() && Stamp::parse(&characters(cell)).is_some() {
            self.first_stamp = Some((line(), characters(cell).trim().to_owned()));
            return self.push_stamp(cell, line);
        }
        if number.is_none() && self.numbers.is_empty() && lists::parse(cell).is_some() {
            return self.push_list(cell, line);
        }
        self.numbers.push(number.unwrap_or(f64::NAN));
        if !number.is_some_and(is_plausible) {
            self.note(flaw(number, cell, line()));
        }
    }

    /// Keeps the first flaw, or the first that is no missing value.
    fn note(&mut self, flaw: Flaw) {
        let is_only_missing = self.flaw.as_ref().is_some_and(Flaw::is_missing_value) && !flaw.is_missing_value();
        if self.flaw.is_none() || is_only_missing {
            self.flaw = Some(flaw);
        }
    }

    fn push_list(&mut self, cell: &[u8], line: impl Fn() -> u64) {
        let list = lists::parse(cell);
        let implausible = list.as_ref().and_then(|list| list.iter().copied().find(|value| !is_plausible(*value)));
        if !self.lists.push(list) || implausible.is_some() {
            self.note(flaw(implausible, cell, line()));
        }
    }

    fn push_stamp(&mut self, cell: &[u8], line: impl Fn() -> u64) {
        let stamp = Stamp::parse(&characters(cell));
        if self.flaw.is_none() && stamp.is_none() {
            self.flaw = Some(flaw(None, cell, line()));
        }
        self.stamps.push(stamp);
    }

    /// The column. Stamps are seconds from the first, lists have a channel for each of their numbers.
    pub(super) fn into_column(self, name: String, day_first: Option<bool>) -> Column {
        if !self.lists.is_empty() {
            return self.lists.into_column(name, self.flaw);
        }
        if self.stamps.is_empty() {
            return Column { flaw: self.flaw, ..Column::of_numbers(name, 1, self.numbers) };
        }
        let Some(values) = seconds(&self.stamps, day_first) else {
            let (line, found) = self.first_stamp.unwrap_or_default();
            let values = vec![f64::NAN; self.stamps.len()];
            let flaw = Some(Flaw::UnclearDate { line, found });
            return Column { flaw, in_seconds: true, ..Column::of_numbers(name, 1, values) };
        };
        Column { flaw: self.flaw, in_seconds: true, ..Column::of_numbers(name, 1, values) }
    }
}

pub(super) fn flaw(number: Option<f64>, cell: &[u8], line: u64) -> Flaw {
    match number {
        Some(found) => Flaw::NotFinite { line, found },
        None => Flaw::Text { line, found: characters(cell) },
    }
}
