//! `results.json`: everything except the curves.

use super::output::Output;
use crate::{
    report::{error::ReportError, published::Published},
    results::Results,
};
use thetahat_ground::output::FileKind;

pub(super) const OUTPUT: Output = Output { name: "results.json", kind: FileKind::Results, render };

fn render(results: &Results, _: Option<&Published>) -> Result<Vec<u8>, ReportError> {
    Ok(results.to_json()?.into_bytes())
}
