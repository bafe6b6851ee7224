//! The first rows of a text, split at a given delimiter, and the place of the table in them.

use super::number::{Decimal, Numbers};
use super::row::{CellKind, Row};
use super::text::Line;
use super::unit_line::is_unit_line;

/// The first rows of a text, split at a given delimiter.
pub(super) struct Sample<'a> {
    text: &'a [u8],
    pub(super) delimiter: u8,
    rows: Vec<Row>,
    /// Number of columns of the table.
    width: usize,
    /// Columns that contain values.
    value_columns: Vec<usize>,
    pub(super) table: TablePlace,
}

/// Least number of columns named by their numbers.
const LEAST_NUMBERED: usize = 4;
/// The rows that make up the table, by their index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct TablePlace {
    pub(super) names: Option<usize>,
    pub(super) units: Option<usize>,
    /// The first row of values; the number of rows if there is none.
    pub(super) values: usize,
}

impl<'a> Sample<'a> {
    /// The decimal sign and whether there are names may be set.
    pub(super) fn of(
        text: &'a [u8],
        lines: &[Line],
        delimiter: u8,
        set: Option<Decimal>,
        header: Option<bool>,
    ) -> Self {
        let rows = lines.iter().map(|line| Row::of(text, *line, delimiter, set)).collect();
        let table = TablePlace::default();
        let mut sample = Self { text, delimiter, rows, width: 0, value_columns: Vec::new(), table };
        sample.width = sample.usual_width();
        sample.leave_out_trailing_cells();
        sample.value_columns = sample.columns_of_values();
        sample.table = sample.table_place(header);
        sample
    }

    /// Number of columns of the table.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// The place of a row, the last line if there is no such row.
    pub(super) fn line(&self, row: usize) -> Option<Line> {
        self.rows.get(row).map(|row| row.line)
    }

    /// The texts of a row's cells.
    pub(super) fn cells(&self, row: usize) -> Vec<String> {
        let mut texts = self.rows.get(row).map(|row| row.texts(self.text, self.delimiter)).unwrap_or_default();
        texts.truncate(self.width.max(1));
        texts
    }

    /// The texts of the cells of all rows of values.
    pub(super) fn rows_of_values(&self) -> impl Iterator<Item = Vec<String>> {
        (self.table.values..self.rows.len()).filter(|&row| !self.rows[row].is_comment).map(|row| self.cells(row))
    }

    /// Whether a column begins with text.
    pub(super) fn is_text(&self, column: usize) -> bool {
        self.rows.get(self.table.values).is_some_and(|row| row.holds(column, CellKind::Text))
    }

    /// Whether a row of texts may name groups of the columns below it.
    pub(super) fn is_group_line(&self, row: usize) -> bool {
        self.rows.get(row).is_some_and(|row| !row.is_comment && row.cells.len() == self.width && row.values() == 0)
    }

    pub(super) fn has_rows(&self) -> bool {
        self.rows.iter().any(|row| !row.is_comment)
    }

    /// How numbers are read, as set or as the sample shows.
    pub(super) fn numbers(&self, set: Option<Decimal>) -> Numbers {
        let by_commas = self.delimiter == b',';
        let shown = self.values().find_map(|row| row.decimal.shown);
        let decimal = set.or(shown).or(by_commas.then_some(Decimal::Point));
        let has_point = || self.values().any(|row| row.decimal.has_point);
        let grouped = set.is_some() || shown.is_some() || by_commas && has_point();
        Numbers::new(decimal, grouped)
    }

    fn values(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().skip(self.table.values).filter(|row| !row.is_comment)
    }

    /// The rows of the table: names and values.
    fn table_rows(&self) -> impl Iterator<Item = &Row> {
        self.table.names.and_then(|names| self.rows.get(names)).into_iter().chain(self.values())
    }

    /// Number of rows of the table as long as the usual one.
    pub(super) fn agreeing(&self) -> usize {
        self.table_rows().filter(|row| row.cells.len() == self.width).count()
    }

    pub(super) fn is_consistent(&self) -> bool {
        self.agreeing() == self.table_rows().count()
    }

    /// The fraction of cells that are values.
    pub(super) fn numeric(&self) -> f64 {
        let cells: usize = self.values().map(|row| row.cells.len()).sum();
        self.values().map(Row::values).sum::<usize>() as f64 / cells.max(1) as f64
    }

    /// Whether every line is one value, judged by the first rows.
    pub(super) fn is_one_column(&self) -> bool {
        self.width == 1 && self.is_consistent() && self.values().all(|row| row.values() == 1)
    }

    /// Whether the first row of values may contain names: some columns of values begin with text, and some with values.
    pub(super) fn begins_unclearly(&self) -> bool {
        let mut rows = self.values();
        let Some(first) = rows.next().filter(|_| self.table.names.is_none()) else { return false };
        let others: Vec<&Row> = rows.collect();
        let steady = |&c: &usize| !others.is_empty() && others.iter().all(|row| row.holds(c, CellKind::Value));
        let columns: Vec<usize> = (0..first.cells.len()).filter(steady).collect();
        let begins_with = |kind| columns.iter().any(|&column| first.holds(column, kind));
        begins_with(CellKind::Value) && begins_with(CellKind::Text)
    }

    /// The length of most rows of values, otherwise of most rows; of the first ones if there are several.
    fn usual_width(&self) -> usize {
        let rows = || self.rows.iter().filter(|row| !row.is_comment);
        let is_mostly_values = |row: &&Row| 2 * row.values() >= row.cells.len();
        let of_values: Vec<usize> = rows().filter(is_mostly_values).map(|row| row.cells.len()).collect();
        let of_all: Vec<usize> = rows().map(|row| row.cells.len()).collect();
        most_frequent(if of_values.is_empty() { &of_all } else { &of_values })
    }

    /// Leaves out an empty last cell that every row has, and the last cell of names that no row of values has.
    fn leave_out_trailing_cells(&mut self) {
        let width = self.width;
        let mut of_table = self.rows.iter().filter(|row| !row.is_comment && row.cells.len() == width).peekable();
        let has_rows = of_table.peek().is_some() && width > 1;
        if has_rows && of_table.all(|row| row.holds(width - 1, CellKind::Missing)) {
            self.width -= 1;
        }
        let (width, text, delimiter) = (self.width, self.text, self.delimiter);
        let is_trailing = |row: &Row| {
            let last = || row.texts(text, delimiter).pop().unwrap_or_default();
            let is_comment_column = || row.values() == 0 && last().eq_ignore_ascii_case("comment");
            row.cells.len() == width + 1 && (row.holds(width, CellKind::Missing) || is_comment_column())
        };
        self.rows.iter_mut().filter(|row| is_trailing(row)).for_each(|row| row.cells.truncate(width));
    }

    /// Columns of which at least half of the later rows are values.
    fn columns_of_values(&self) -> Vec<usize> {
        let rows: Vec<&Row> = self.rows.iter().filter(|r| !r.is_comment && r.cells.len() == self.width).collect();
        let later = &rows[rows.len() / 2..];
        let count = |column| later.iter().filter(|row| row.holds(column, CellKind::Value)).count();
        (0..self.width).filter(|&column| count(column) > 0 && 2 * count(column) >= later.len()).collect()
    }

    fn table_place(&self, header: Option<bool>) -> TablePlace {
        let names = match header {
            Some(false) => None,
            Some(true) => self.names_row().or_else(|| self.first_row()),
            None => self.names_row().or_else(|| self.numbered_row()),
        };
        let Some(last) = names else {
            return TablePlace { names: None, units: None, values: self.first_row().unwrap_or(self.rows.len()) };
        };
        let values = (last + 1..self.rows.len()).find(|&row| !self.rows[row].is_comment).unwrap_or(self.rows.len());
        let is_units = |row: &usize| is_unit_line(&self.cells(*row));
        // A line of units, of descriptions below one, or a comment of units below the names.
        if let Some(units) = (last + 1..values).find(|row| self.is_names(*row) && is_units(row)) {
            return TablePlace { names: Some(last), units: Some(units), values };
        }
        let units = [Some(last), last.checked_sub(1)].into_iter().flatten().find(is_units);
        let above = units.and_then(|units| units.checked_sub(1)).filter(|&row| self.is_names(row));
        match above {
            Some(names) => TablePlace { names: Some(names), units, values },
            None => TablePlace { names: Some(last), units: None, values },
        }
    }

    /// The last row of names above the first values. A comment is a row of names if no other row is one.
    fn names_row(&self) -> Option<usize> {
        if self.value_columns.is_empty() {
            return self.rows.iter().position(|row| !row.is_comment && row.cells.len() == self.width);
        }
        let before = self.rows.iter().position(|row| self.is_values(row)).unwrap_or(self.rows.len());
        let last = |is_comment| (0..before).rfind(|&i| self.rows[i].is_comment == is_comment && self.is_names(i));
        last(false).or_else(|| last(true))
    }

    /// A first row of the numbers 0, 1, 2 and so on, the names that pandas writes for columns without names. The first cell may be empty;
    /// otherwise the first of several rows that are not of whole numbers.
    fn numbered_row(&self) -> Option<usize> {
        let first = self.first_row().filter(|&row| self.rows[row].cells.len() == self.width)?;
        let cells = self.cells(first);
        let above_index = cells.first().is_some_and(String::is_empty);
        let numbers = &cells[usize::from(above_index)..];
        let are_numbers = numbers.iter().zip(0..).all(|(cell, number)| cell.parse() == Ok::<usize, _>(number));
        let next = || self.cells(first + 1).iter().filter(|cell| cell.parse::<i64>().is_err()).count();
        let is_likely = above_index && numbers.len() > 1 || numbers.len() >= LEAST_NUMBERED && 2 * next() > self.width;
        (are_numbers && is_likely).then_some(first)
    }

    fn is_names(&self, row: usize) -> bool {
        let row = &self.rows[row];
        row.cells.len() == self.width
            && row.cells.contains(&CellKind::Text)
            && !self.value_columns.iter().any(|&column| row.holds(column, CellKind::Value))
    }

    fn is_values(&self, row: &Row) -> bool {
        !row.is_comment
            && row.cells.len() == self.width
            && row.values() > 0
            && !self.value_columns.iter().any(|&column| row.holds(column, CellKind::Text))
    }

    /// The first row that is neither a comment nor a title.
    fn first_row(&self) -> Option<usize> {
        self.rows.iter().position(|row| !row.is_comment && !self.is_title(row))
    }

    /// Whether a row is a sentence above a table. Between commas it may be the name of a single column with decimal commas.
    fn is_title(&self, row: &Row) -> bool {
        self.delimiter != b','
            && self.width > 1
            && row.cells == [CellKind::Text]
            && row.line.bytes(self.text).trim_ascii().contains(&b' ')
    }
}

/// The most frequent of some lengths, the first of several.
fn most_frequent(lengths: &[usize]) -> usize {
    let count = |length: &usize| lengths.iter().filter(|other| *other == length).count();
    lengths.iter().rev().max_by_key(|length| count(length)).copied().unwrap_or_default()
}
