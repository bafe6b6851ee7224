//! Comparison of several results: tables for the terminal, and a page.

use std::path::Path;

use super::{
    error::ReportError,
    number::{NONE, optional, signed, with_deviation},
    page::{Page, render},
    section::Section,
    table::{Group, Table, strings},
    wrap::{TextWidth, wrap},
};
use crate::results::{ComparedParameter, ParameterResult, SettingDifference, Side, SideBySide, Unseen};
use thetahat_ground::output::{FileKind, replace_file};

/// Deviations from which a difference is marked.
const FAR: f64 = 3.0;

/// The comparison for the terminal.
#[must_use]
pub fn comparison_text(compared: &SideBySide, width: TextWidth) -> String {
    let tables = tables(compared);
    let mut text = tables.iter().map(|table| table.to_text(width)).collect::<Vec<_>>().join("\n");
    if compared.settings.is_empty() {
        text += "\nNo setting differs.\n";
    }
    text + "\n" + &conclusions(compared).iter().map(|line| wrap(line, "", width)).collect::<String>()
}

/// The kind of the page.
pub const COMPARISON_PAGE: FileKind = FileKind::Page(GENERATOR);

pub(super) const GENERATOR: &str = "thetahat comparison";

/// Writes the comparison as a page, whole or not at all.
///
/// # Errors
/// [`ReportError`] where the page cannot be rendered or written.
pub fn write_comparison(compared: &SideBySide, path: &Path) -> Result<(), ReportError> {
    let section = Section {
        id: "comparison",
        title: "Comparison",
        lines: conclusions(compared),
        tables: tables(compared),
        ..Section::default()
    };
    let page =
        Page { title: "Comparison of results", generator: GENERATOR, sections: vec![section], ..Page::default() };
    replace_file(path, render(&page)?.as_bytes()).map_err(|source| ReportError::Write { path: path.to_owned(), source })
}

fn tables(compared: &SideBySide) -> Vec<Table> {
    [Some(sides(compared)), settings(compared), Some(parameters(compared))].into_iter().flatten().collect()
}

/// A, B, C ...; numbers after Z.
fn label(side: usize) -> String {
    u8::try_from(side).ok().filter(|s| *s < 26).map_or_else(|| side.to_string(), |s| char::from(b'A' + s).to_string())
}

fn sides(compared: &SideBySide) -> Table {
    let row = |(k, side): (usize, &Side)| {
        vec![
            label(k),
            side.source.to_string(),
            side.verdict.map_or_else(|| NONE.to_owned(), |v| v.to_string()),
            optional(side.relative_error_percent, 3),
            optional(side.unseen.map(Unseen::percent), 3),
        ]
    };
    let files = compared.sides.iter().enumerate();
    Table {
        title: "Results".to_owned(),
        lead: 2,
        head: strings(&["", "estimates", "verdict", "error %", "validation %"]),
        rows: compared.sides.iter().enumerate().map(row).collect(),
        notes: files.map(|(k, side)| format!("{}: {} ({})", label(k), side.file.display(), side.title)).collect(),
        ..Table::default()
    }
}

fn settings(compared: &SideBySide) -> Option<Table> {
    let row = |difference: &SettingDifference| {
        let values = difference.values.iter().map(|v| v.clone().unwrap_or_else(|| NONE.to_owned()));
        [difference.key.clone()].into_iter().chain(values).collect()
    };
    let labels = (0..compared.sides.len()).map(label);
    (!compared.settings.is_empty()).then(|| Table {
        title: "Settings that differ".to_owned(),
        lead: 1,
        head: ["setting".to_owned()].into_iter().chain(labels).collect(),
        rows: compared.settings.iter().map(row).collect(),
        ..Table::default()
    })
}

fn parameters(compared: &SideBySide) -> Table {
    let sides = compared.sides.len();
    let value = |p: &Option<ParameterResult>| {
        let text = |p: &ParameterResult| with_deviation(p.estimate, p.deviation());
        p.as_ref().map_or_else(|| NONE.to_owned(), text)
    };
    let difference = |d: &Option<f64>| {
        let text = |d: f64| if d.abs() > FAR { format!("* {}", signed(d)) } else { signed(d) };
        d.map_or_else(|| NONE.to_owned(), text)
    };
    let row = |p: &ComparedParameter| {
        let others = p.estimates.iter().zip(&p.deviations).skip(1);
        let cells = others.flat_map(|(estimate, deviations)| [value(estimate), difference(deviations)]);
        let first = [p.name.clone(), p.unit.clone(), value(&p.estimates[0])];
        first.into_iter().chain(cells).collect()
    };
    let head = (1..sides).flat_map(|_| strings(&["estimate±sd", "diff/sd"]));
    let group = |(k, columns)| Group { label: label(k), columns };
    Table {
        title: "Parameters".to_owned(),
        lead: 2,
        groups: [(0, 1)].into_iter().chain((1..sides).map(|k| (k, 2))).map(group).collect(),
        head: strings(&["name", "unit", "estimate±sd"]).into_iter().chain(head).collect(),
        rows: compared.parameters.iter().map(row).collect(),
        notes: vec![format!(
            "diff/sd: the estimate minus that of A, in standard deviations of the difference as if the recordings were independent; *: \
             more than {FAR}. sd: with correlated errors if known."
        )],
    }
}

/// One sentence for each result but the first.
fn conclusions(compared: &SideBySide) -> Vec<String> {
    (1..compared.sides.len()).map(|side| conclusion(compared, side)).collect()
}

fn conclusion(compared: &SideBySide, side: usize) -> String {
    let of = |p: &'_ ComparedParameter| p.deviations[side].map(f64::abs);
    let differences: Vec<(f64, &str)> =
        compared.parameters.iter().filter_map(|p| Some((of(p)?, p.name.as_str()))).collect();
    if differences.is_empty() {
        return format!("{} against A: no common parameter has a standard deviation.", label(side));
    }
    let far = differences.iter().filter(|(d, _)| *d > FAR).count();
    let most = differences.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let most =
        most.map_or_else(String::new, |(d, name)| format!(", most {name} by {}", signed(*d).trim_start_matches('+')));
    format!(
        "{} against A: {far} of {} parameters differ by more than {FAR} deviations{most}.",
        label(side),
        differences.len()
    )
}
