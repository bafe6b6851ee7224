//! Results with their report.

use std::collections::BTreeMap;

use serde::Serialize;
use thetahat::{Results, report::Published};
use thetahat_report::report::{self, TextWidth};

use super::residual::ResidualAnswer;
use crate::session::Outcome;

const REPORT: &str = "report.html";

/// The answer of an identification.
#[derive(Serialize)]
pub(crate) struct Identified<'a> {
    results: &'a Results,
    /// The page of the report.
    report: String,
    /// The other files that the command line writes, by name.
    files: BTreeMap<&'static str, String>,
    /// The output of the command line, without the names of files.
    text: String,
    residual: Option<ResidualAnswer>,
}

impl<'a> Identified<'a> {
    pub(crate) fn of(results: &'a Results, published: Option<&Published>) -> Outcome<Self> {
        let mut files = BTreeMap::new();
        for name in report::file_names() {
            let content = report::render(name, results, published)?.unwrap_or_default();
            files.insert(name, String::from_utf8(content)?);
        }
        let width = TextWidth::default();
        let text = format!(
            "{}\n\n{}\n{}",
            report::headline(results),
            report::brief(results, width),
            report::card_text(results, width)
        );
        let report = files.remove(REPORT).unwrap_or_default();
        Ok(Self { results, report, files, text, residual: ResidualAnswer::of(results) })
    }
}
