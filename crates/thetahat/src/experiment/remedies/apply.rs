//! Remedies that were asked for, made in the text of an experiment.

use super::steps::Draft;
use crate::experiment::{description::Experiment, error::ExperimentError};
use thetahat_ground::visible::visible;
use thetahat_report::results::{RecordingStep, Remedy, SettingChange};

/// Most characters of a finding in a comment.
const LONGEST: usize = 160;

impl<'a> Draft<'a> {
    pub(super) fn of(experiment: &'a Experiment) -> Self {
        let (text, file) = (experiment.text.clone(), experiment.file.clone());
        Self { text, file, robot: &experiment.robot, changes: Vec::new() }
    }
}

impl Experiment {
    /// The text of this experiment with the remedies of these codes, and a comment at its start that says what was changed and why.
    ///
    /// # Errors
    /// [`ExperimentError::UnknownRemedy`] for a code that is not among the remedies, [`ExperimentError::NoRemedy`] for one that
    /// this text has no place for.
    #[doc(hidden)]
    pub fn with_remedies(&self, remedies: &[Remedy], codes: &[String]) -> Result<String, ExperimentError> {
        let unknown = codes.iter().find(|code| remedies.iter().all(|remedy| remedy.code != **code));
        if let Some(code) = unknown {
            let known = remedies.iter().map(|remedy| format!("{} ({})", remedy.code, remedy.label)).collect();
            return Err(ExperimentError::UnknownRemedy { path: self.path.clone(), code: code.clone(), known });
        }
        let mut draft = Draft::of(self);
        let mut comment = String::new();
        for remedy in remedies.iter().filter(|remedy| codes.contains(&remedy.code)) {
            let before = draft.changes.len();
            remedy.steps.iter().try_for_each(|step| self.make(&mut draft, step, remedy))?;
            comment += &said(remedy, &draft.changes[before..]);
        }
        let name = self.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(format!("# {} with {}:\n{comment}\n{}", visible(&name), visible(&codes.join(", ")), draft.text))
    }

    fn make(&self, draft: &mut Draft<'_>, step: &RecordingStep, remedy: &Remedy) -> Result<(), ExperimentError> {
        let (code, label) = (remedy.code.clone(), remedy.label.clone());
        draft.make(step).ok_or_else(|| ExperimentError::NoRemedy { path: self.path.clone(), code, label })
    }
}

/// A remedy and its changes as lines of a comment.
fn said(remedy: &Remedy, changes: &[SettingChange]) -> String {
    let found: String = visible(&remedy.found).chars().take(LONGEST).collect();
    let mut text = format!("# {}: {} ({found})\n", visible(&remedy.code), visible(&remedy.label));
    for change in changes {
        let value = |value: &Option<String>| {
            value.as_ref().map_or_else(|| "nothing".to_owned(), |value| visible(value).into_owned())
        };
        text +=
            &format!("#   {}: {} instead of {}\n", visible(&change.key), value(&change.after), value(&change.before));
    }
    text
}
