use crate::checks::subject::Subject;

/// One of the recordings of an experiment.
#[derive(Debug, Clone)]
pub struct Companion<'a> {
    /// Its name in messages.
    pub name: &'a str,
    /// Whether it is held back for validation.
    pub held_back: bool,
    /// Its data. The parameters are those of all recordings.
    pub subject: Subject<'a>,
}

impl Companion<'_> {
    /// Its name, marked if it is held back.
    pub(in crate::checks) fn label(&self) -> String {
        if self.held_back { format!("{} (held back)", self.name) } else { self.name.to_owned() }
    }
}
