//! What there is to say of an export.

use super::{identified::IdentifiedModel, render::Export};

impl IdentifiedModel {
    /// What there is to say of its export, a line each; `read_back` is what [`Export::check`] found.
    #[must_use]
    pub fn in_words(&self, export: &Export, read_back: Option<f64>) -> String {
        let first = format!("{}: {}", self.identified.robot.name, export.format.title());
        let read_back = read_back.map(|difference| {
            format!("read back: torques at 1000 random states differ by {difference:.1e} of the largest at most")
        });
        let lines = [
            vec![first],
            self.about(),
            export.notes.clone(),
            export.not_represented.clone(),
            read_back.into_iter().collect(),
        ];
        lines.concat().into_iter().map(|line| line + "\n").collect()
    }
}
