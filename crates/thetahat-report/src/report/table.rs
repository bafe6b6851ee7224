//! A table of texts, and its layout for the terminal.

use serde::Serialize;

use super::wrap::{TextWidth, shortened, wrap};
use thetahat_ground::visible::visible;

/// Longest text of a leading column, of a column under a group, and of any other column.
const LEAD_CELL: usize = 24;
const GROUP_CELL: usize = 15;
const CELL: usize = 26;

/// Characters below which no column is narrowed to fit a terminal.
const NARROWEST: usize = 3;

/// Columns under one heading.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Group {
    /// The heading.
    pub label: String,
    /// Number of columns.
    pub columns: usize,
}

/// A table of texts: a few leading columns that identify a row, then columns of figures.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Table {
    /// Title.
    pub title: String,
    /// Number of leading columns: aligned left, and repeated if a table is split.
    pub lead: usize,
    /// Headings over the columns after the leading ones; empty, or covering all of them.
    pub groups: Vec<Group>,
    /// Heading of each column.
    pub head: Vec<String>,
    /// Rows of as many texts as there are columns.
    pub rows: Vec<Vec<String>>,
    /// Lines below the table.
    pub notes: Vec<String>,
}

impl Table {
    /// The table as lines that fit; a wider table is split into several with the same
    /// leading columns.
    #[must_use]
    pub fn to_text(&self, width: TextWidth) -> String {
        let table = self.visible();
        let mut text = wrap(&table.title, "", width);
        let widths = table.widths(width);
        for page in table.pages(&widths, width) {
            page.write(&table, &widths, &mut text);
        }
        for note in &table.notes {
            text.push_str(&wrap(note, "  ", width));
        }
        text
    }

    /// The same with control characters made visible.
    fn visible(&self) -> Self {
        let all = |texts: &[String]| texts.iter().map(|text| visible(text).into_owned()).collect();
        Self {
            title: visible(&self.title).into_owned(),
            lead: self.lead,
            groups: self
                .groups
                .iter()
                .map(|g| Group { label: visible(&g.label).into_owned(), columns: g.columns })
                .collect(),
            head: all(&self.head),
            rows: self.rows.iter().map(|row| all(row)).collect(),
            notes: all(&self.notes),
        }
    }

    /// Characters of each column, such that the leading columns with any one block fit.
    fn widths(&self, width: TextWidth) -> Vec<usize> {
        let mut widths = self.full_widths();
        for (_, block) in self.blocks() {
            let columns = || (0..self.lead).chain(block.iter().copied());
            let line = |widths: &[usize]| columns().map(|c| widths[c] + 1).sum::<usize>().saturating_sub(1);
            while line(&widths) > width.columns() {
                let Some(widest) = columns().max_by_key(|&c| widths[c]).filter(|&c| widths[c] > NARROWEST) else {
                    break;
                };
                widths[widest] -= 1;
            }
        }
        widths
    }

    /// Characters of each column without a limit; columns under a long heading are widened to fit it.
    fn full_widths(&self) -> Vec<usize> {
        let mut widths: Vec<usize> = (0..self.head.len()).map(|c| self.width(c)).collect();
        for (label, columns) in self.blocks() {
            let beneath: usize = columns.iter().map(|&c| widths[c] + 1).sum();
            if let Some(&first) = columns.first() {
                widths[first] += (label.chars().count().min(CELL) + 1).saturating_sub(beneath);
            }
        }
        widths
    }

    /// Characters that a column's own texts need.
    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| row.get(column));
        let widest = cells.chain([&self.head[column]]).map(|c| c.chars().count()).max().unwrap_or(0);
        widest.min(self.widest_cell(column))
    }

    fn widest_cell(&self, column: usize) -> usize {
        match (column < self.lead, self.groups.is_empty()) {
            (true, _) => LEAD_CELL,
            (false, true) => CELL,
            (false, false) => GROUP_CELL,
        }
    }

    /// The blocks of columns that stay together, each with its heading.
    fn blocks(&self) -> Vec<(&str, Vec<usize>)> {
        if self.groups.is_empty() {
            return (self.lead..self.head.len()).map(|c| ("", vec![c])).collect();
        }
        let mut next = self.lead;
        let of_group = |group: &Group| {
            next += group.columns;
            (next - group.columns..next).collect()
        };
        let columns: Vec<Vec<usize>> = self.groups.iter().map(of_group).collect();
        self.groups.iter().map(|g| g.label.as_str()).zip(columns).collect()
    }

    /// As many blocks side by side as fit.
    fn pages(&self, widths: &[usize], width: TextWidth) -> Vec<Page<'_>> {
        let lead: Vec<usize> = (0..self.lead).collect();
        let whole = Page { gap: 2, lead: lead.clone(), blocks: self.blocks() };
        let gap = if whole.width(widths) <= width.columns() { 2 } else { 1 };
        let mut pages: Vec<Page<'_>> = Vec::new();
        for block in whole.blocks {
            match pages.last_mut() {
                Some(page) if page.width_with(&block.1, widths) <= width.columns() => page.blocks.push(block),
                _ => pages.push(Page { gap, lead: lead.clone(), blocks: vec![block] }),
            }
        }
        pages
    }
}

/// Columns of a table side by side.
struct Page<'a> {
    gap: usize,
    lead: Vec<usize>,
    blocks: Vec<(&'a str, Vec<usize>)>,
}

impl Page<'_> {
    fn columns(&self) -> impl Iterator<Item = usize> {
        self.lead.iter().chain(self.blocks.iter().flat_map(|(_, columns)| columns)).copied()
    }

    fn width(&self, widths: &[usize]) -> usize {
        self.columns().map(|c| widths[c] + self.gap).sum::<usize>().saturating_sub(self.gap)
    }

    fn width_with(&self, columns: &[usize], widths: &[usize]) -> usize {
        self.width(widths) + columns.iter().map(|&c| widths[c] + self.gap).sum::<usize>()
    }

    fn write(&self, table: &Table, widths: &[usize], text: &mut String) {
        let rule = "-".repeat(self.width(widths));
        if !table.groups.is_empty() {
            push_line(text, &self.group_line(widths));
        }
        push_line(text, &self.line(&table.head, table.lead, widths));
        push_line(text, &rule);
        for row in &table.rows {
            push_line(text, &self.line(row, table.lead, widths));
        }
        push_line(text, &rule);
    }

    fn line(&self, cells: &[String], lead: usize, widths: &[usize]) -> String {
        let gap = " ".repeat(self.gap);
        let cell = |c: usize| {
            let text = shortened(cells.get(c).map_or("", String::as_str), widths[c]);
            if c < lead { format!("{text:<0$}", widths[c]) } else { format!("{text:>0$}", widths[c]) }
        };
        self.columns().map(cell).collect::<Vec<_>>().join(&gap)
    }

    /// The headings of the groups, each centred over its columns.
    fn group_line(&self, widths: &[usize]) -> String {
        let span = |columns: &[usize]| columns.iter().map(|&c| widths[c] + self.gap).sum::<usize>();
        let mut line = " ".repeat(span(&self.lead).saturating_sub(self.gap));
        for (label, columns) in &self.blocks {
            let width = span(columns) - self.gap;
            let label = shortened(label, width);
            line.push_str(&" ".repeat(self.gap));
            line.push_str(&format!("{label:-^width$}"));
        }
        line
    }
}

/// Texts as a table holds them.
pub(super) fn strings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|t| (*t).to_owned()).collect()
}

fn push_line(text: &mut String, line: &str) {
    text.push_str(line.trim_end());
    text.push('\n');
}
