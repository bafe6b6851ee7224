use crate::{
    report::{error::ReportError, published::Published},
    results::Results,
};

/// A file of the report.
pub(super) struct Output {
    /// Its name.
    pub(super) name: &'static str,
    /// Renders its content from the results and published figures, if any.
    pub(super) render: fn(&Results, Option<&Published>) -> Result<Vec<u8>, ReportError>,
}
