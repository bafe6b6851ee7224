use crate::{
    report::{error::ReportError, published::Published},
    results::Results,
};

/// A file of the report.
pub(super) struct Output {
    /// Its name.
    pub(super) name: &'static str,
    /// Its content, from the results and, where there are any, published figures.
    pub(super) render: fn(&Results, Option<&Published>) -> Result<Vec<u8>, ReportError>,
}
