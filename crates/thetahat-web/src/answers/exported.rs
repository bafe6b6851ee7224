//! The identified robot as a file.

use serde::Serialize;
use thetahat::export::{ExportFormat, IdentifiedModel};

use crate::session::Outcome;

/// A robot's file.
#[derive(Serialize)]
pub(crate) struct Exported {
    file: String,
    /// The file with the covariance of its parameters.
    covariance: Option<String>,
    /// Remarks on the export.
    text: String,
}

impl Exported {
    pub(crate) fn of(model: &IdentifiedModel, format: ExportFormat) -> Outcome<Self> {
        let export = model.export(format)?;
        Ok(Self {
            covariance: model.covariance_json_or_reason()?.ok(),
            text: model.in_words(&export, None),
            file: export.text,
        })
    }
}
