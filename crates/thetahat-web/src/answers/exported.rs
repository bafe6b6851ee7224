//! The identified robot as a file.

use serde::Serialize;
use thetahat::export::{Format, IdentifiedModel};

use crate::session::Outcome;

/// A robot's file.
#[derive(Serialize)]
pub(crate) struct Exported {
    file: String,
    /// What goes beside the file: how sure its parameters are.
    covariance: Option<String>,
    /// What there is to say of it.
    text: String,
}

impl Exported {
    pub(crate) fn of(model: &IdentifiedModel, format: Format) -> Outcome<Self> {
        let export = model.export(format)?;
        Ok(Self {
            covariance: model.covariance_json_or_reason()?.ok(),
            text: model.in_words(&export, None),
            file: export.text,
        })
    }
}
