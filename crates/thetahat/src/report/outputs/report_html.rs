//! `report.html`: every section on one page.

use super::output::Output;
use crate::{
    report::{error::ReportError, facts, html, published::Published, sections},
    results::Results,
};

pub(super) const OUTPUT: Output = Output { name: "report.html", render };

fn render(results: &Results, published: Option<&Published>) -> Result<Vec<u8>, ReportError> {
    let page = html::page_of(&results.title, &facts::head(results), &sections::all(results, published))?;
    Ok(page.into_bytes())
}
