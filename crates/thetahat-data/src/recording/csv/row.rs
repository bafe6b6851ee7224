//! A row of a sample: its line, and what its cells contain.

use super::number::{Decimal, Numbers};
use super::stamp::Stamp;
use super::text::{Line, MOST_COLUMNS, begins_comment, cells, characters};

/// Most cells of a row that are examined.
const MOST_CELLS: usize = MOST_COLUMNS + 1;
/// Words for a value that is missing, in lower case.
const MISSING: [&str; 8] = ["", "-", "--", "n/a", "na", "nil", "none", "null"];

/// What a cell contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellKind {
    /// A number, or a stamp.
    Value,
    Missing,
    Text,
}

pub(super) struct Row {
    pub(super) line: Line,
    pub(super) is_comment: bool,
    pub(super) cells: Vec<CellKind>,
    pub(super) decimal: DecimalEvidence,
}

impl Row {
    /// A row of a text; the decimal sign may be set.
    pub(super) fn of(text: &[u8], line: Line, delimiter: u8, set: Option<Decimal>) -> Self {
        let mut decimal = DecimalEvidence::default();
        let is_comment = begins_comment(line.bytes(text));
        let cells = cells_of_line(line.bytes(text), delimiter);
        let cells = cells.iter().map(|cell| cell_kind(cell, delimiter, set, &mut decimal)).collect();
        Self { line, is_comment, cells, decimal }
    }

    /// The texts of its cells.
    pub(super) fn texts(&self, text: &[u8], delimiter: u8) -> Vec<String> {
        let cells = cells_of_line(self.line.bytes(text), delimiter);
        cells.iter().map(|cell| characters(cell).trim().to_owned()).collect()
    }

    pub(super) fn values(&self) -> usize {
        self.cells.iter().filter(|cell| **cell == CellKind::Value).count()
    }

    pub(super) fn holds(&self, column: usize, kind: CellKind) -> bool {
        self.cells.get(column) == Some(&kind)
    }
}

/// What the numbers of a row show of the decimal sign.
#[derive(Default)]
pub(super) struct DecimalEvidence {
    pub(super) shown: Option<Decimal>,
    pub(super) has_point: bool,
}

/// A line that is a comment, without the sign of it.
fn without_comment_sign(line: &[u8]) -> &[u8] {
    let start = line.trim_ascii_start();
    match start.iter().position(|b| !matches!(b, b'#' | b'%')) {
        Some(0) => line,
        Some(signs) => &start[signs..],
        None => &[],
    }
}

fn cells_of_line(line: &[u8], delimiter: u8) -> Vec<Vec<u8>> {
    cells(without_comment_sign(line), delimiter, MOST_CELLS)
}

fn cell_kind(cell: &[u8], delimiter: u8, set: Option<Decimal>, decimal: &mut DecimalEvidence) -> CellKind {
    let by_commas = (delimiter == b',').then_some(Decimal::Point);
    if Numbers::new(set.or(by_commas), true).read(cell).is_some() {
        decimal.add(cell);
        return CellKind::Value;
    }
    let text = characters(cell);
    match text.trim() {
        text if MISSING.contains(&text.to_ascii_lowercase().as_str()) => CellKind::Missing,
        text if Stamp::parse(text).is_some() => CellKind::Value,
        _ => CellKind::Text,
    }
}

impl DecimalEvidence {
    fn add(&mut self, number: &[u8]) {
        self.has_point |= number.contains(&b'.');
        if self.shown.is_none() && number.iter().any(|b| matches!(b, b'.' | b',')) {
            self.shown = Decimal::shown_by(&characters(number));
        }
    }
}
