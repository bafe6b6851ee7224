use crate::{
    report::{error::ReportError, published::Published},
    results::Results,
};
use thetahat_ground::output::FileKind;

/// A file of the report.
pub(super) struct Output {
    /// Its name.
    pub(super) name: &'static str,
    pub(super) kind: FileKind,
    /// Renders its content from the results and published figures, if any.
    pub(super) render: fn(&Results, Option<&Published>) -> Result<Vec<u8>, ReportError>,
}
