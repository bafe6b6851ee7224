use serde::Serialize;

use super::{
    figures::{Figure, Forest, Heat},
    table::Table,
};

/// A section of the page, shown in the order of its fields.
#[derive(Debug, Default, Serialize)]
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// Whether it is folded, and the hint in its heading.
    pub(super) is_folded: bool,
    pub(super) hint: String,
    pub(super) lines: Vec<String>,
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) figures: Vec<Figure>,
    pub(super) forests: Vec<Forest>,
    pub(super) heats: Vec<Heat>,
    pub(super) tables: Vec<Table>,
    /// Figures, estimates and tables that open on demand.
    pub(super) folded_figures: Vec<Figure>,
    pub(super) folded_forests: Vec<Forest>,
    pub(super) folded: Vec<Table>,
    /// Files that open on demand, each with its title.
    pub(super) files: Vec<(&'static str, String)>,
}

impl Section {
    pub(super) fn is_empty(&self) -> bool {
        let texts = self.lines.is_empty() && self.files.is_empty() && self.facts.is_empty();
        let figures = self.figures.is_empty() && self.folded_figures.is_empty();
        let forests = self.forests.is_empty() && self.folded_forests.is_empty() && self.heats.is_empty();
        texts && figures && forests && self.tables.is_empty() && self.folded.is_empty()
    }

    /// The same, opened on demand.
    pub(super) fn folded(self, hint: impl Into<String>) -> Self {
        Self { is_folded: true, hint: hint.into(), ..self }
    }
}
