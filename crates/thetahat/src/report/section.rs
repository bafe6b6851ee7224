use serde::Serialize;

use super::{figures::Figure, table::Table};

/// A section of the page.
#[derive(Debug, Default, Serialize)]
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) lines: Vec<String>,
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) tables: Vec<Table>,
    pub(super) figures: Vec<Figure>,
    /// Tables that open on demand.
    pub(super) folded: Vec<Table>,
    /// Files that open on demand, each with its title.
    pub(super) files: Vec<(&'static str, String)>,
}

impl Section {
    pub(super) fn is_empty(&self) -> bool {
        self.tables.is_empty()
            && self.figures.is_empty()
            && self.folded.is_empty()
            && self.files.is_empty()
            && self.lines.is_empty()
    }
}
