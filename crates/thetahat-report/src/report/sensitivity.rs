//! The report of a sweep over the simulator's errors: a table for the terminal, a CSV file and a page.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use super::{
    error::ReportError,
    figures::{Figure, keys_of},
    files,
    number::{NONE, given, optional, significant},
    page::{Page, render},
    plot::{Chart, Curve, NARROW},
    section::Section,
    table::{Group, Table},
    wrap::{TextWidth, wrap},
};
use crate::results::{BiasKind, Method, Sensitivity, SensitivityPoint, Status};
use thetahat_ground::{output::FileKind, visible::cell};

/// The methods of a sweep, in the order of the table's groups.
fn methods(sensitivity: &Sensitivity) -> Vec<Method> {
    sensitivity.nominal.iter().map(|point| point.method).collect()
}

/// The table of a sweep for the terminal.
#[must_use]
pub fn sensitivity_text(sensitivity: &Sensitivity, width: TextWidth) -> String {
    let lines: String = conclusions(sensitivity).iter().map(|line| wrap(line, "", width)).collect();
    table(sensitivity).to_text(width) + &lines
}

/// The files of a sweep.
pub const SENSITIVITY_FILES: [(&str, FileKind); 2] =
    [("sensitivity.csv", FileKind::Sensitivity), ("sensitivity.html", FileKind::Page(GENERATOR))];

const GENERATOR: &str = "thetahat sensitivity";

/// Writes `sensitivity.csv`, with every estimate, and `sensitivity.html` into a folder, which is created if it does not
/// exist. Returns their paths.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered or written.
pub fn write_sensitivity(sensitivity: &Sensitivity, directory: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let page = Page {
        title: &sensitivity.title,
        generator: GENERATOR,
        facts: facts(sensitivity),
        sections: sections(sensitivity),
        footer: "Changes are root mean squares over the shown estimates, in their standard deviations.",
        ..Page::default()
    };
    let [table, figures] = SENSITIVITY_FILES.map(|(name, _)| name);
    files::write_files(directory, vec![(table, csv_of(sensitivity)?), (figures, render(&page)?.into_bytes())])
}

fn facts(sensitivity: &Sensitivity) -> Vec<(&'static str, String)> {
    let nominal = sensitivity.nominal.iter().map(|p| {
        let text = format!("{} relative error {} %", p.method.name(), optional(p.relative_error_percent, 3));
        ("without error", text)
    });
    [("robot", sensitivity.robot.clone())].into_iter().chain(nominal).collect()
}

fn sections(sensitivity: &Sensitivity) -> Vec<Section> {
    let picture = Section {
        id: "sensitivity",
        title: "Effect of errors of the simulator",
        lines: conclusions(sensitivity),
        figures: vec![figure(sensitivity)],
        ..Section::default()
    };
    let all = Section { id: "table", title: "Every error", tables: vec![table(sensitivity)], ..Section::default() };
    vec![picture, all]
}

/// The effect of a small error of each kind on each method, by the smallest tried error with which it converged.
pub(super) fn conclusions(sensitivity: &Sensitivity) -> Vec<String> {
    let of_kind = |kind: BiasKind| {
        let per_method = methods(sensitivity).into_iter().filter_map(|method| {
            let [size, change] = smallest_change(sensitivity, kind, method)?;
            Some((size, format!("{} by {}", method.name(), significant(change / size, 2))))
        });
        let (sizes, changes): (Vec<f64>, Vec<String>) = per_method.unzip();
        let tried = sizes.into_iter().fold(0.0, f64::max);
        let (error, unit) = unit_of_error(kind);
        let changes = changes.join(", ");
        (tried > 0.0).then(|| {
            format!("{error} shifts {changes} standard deviations (scaled from {} {unit}).", significant(tried, 2))
        })
    };
    BiasKind::ALL.into_iter().filter_map(of_kind).collect()
}

/// The smallest error of a kind, in percent of a factor or in units of the added value, and its change.
fn smallest_change(sensitivity: &Sensitivity, kind: BiasKind, method: Method) -> Option<[f64; 2]> {
    let is_of = |p: &&SensitivityPoint| p.kind == kind && p.method == method && p.status == Status::Converged;
    let of_kind = sensitivity.points.iter().filter(is_of);
    let size =
        |p: &SensitivityPoint| if kind.is_factor() { 100.0 * (p.value - 1.0).abs() } else { shown_value(p).abs() };
    let changes = of_kind.filter_map(|p| Some((size(p), p.rms_change?))).filter(|(size, _)| *size > 0.0);
    let (size, change) = changes.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some([size, change])
}

/// One unit of an error in words, and the unit.
fn unit_of_error(kind: BiasKind) -> (String, &'static str) {
    match kind {
        BiasKind::Delay => ("1 ms of delay".to_owned(), "ms"),
        BiasKind::ReferenceOffset => ("1 mrad or mm of the reference's offset".to_owned(), "mrad or mm"),
        BiasKind::GearRatio
        | BiasKind::DriveGain
        | BiasKind::ControllerGain
        | BiasKind::ReferenceScale
        | BiasKind::Friction => (format!("1 % of error of the {}", kind.name()), "%"),
    }
}

const HEIGHT: f64 = 140.0;

fn figure(sensitivity: &Sensitivity) -> Figure {
    let methods = methods(sensitivity);
    let chart = |kind: BiasKind| {
        let curves: Vec<Curve> = methods.iter().map(|m| curve(sensitivity, kind, *m)).collect();
        Chart::new(axis(kind), &axis(kind), NARROW).with(HEIGHT, |panel| {
            let changes = curves.iter().flat_map(|c| c.points.iter().map(|p| p.1));
            let panel = panel.around(curves.iter(), 0.0).up_by_powers(changes);
            let panel = panel.upright("nominal", without_error(kind));
            curves.iter().fold(panel, |panel, curve| panel.line(curve).dots(curve))
        })
    };
    Figure {
        caption: "change of the estimates, standard deviations, over the error of the simulator".to_owned(),
        legend: keys_of(methods.iter().copied()),
        charts: BiasKind::ALL.into_iter().map(chart).collect(),
        notes: vec![
            "Changes are root mean squares over the shown estimates. The upright line is the simulator without error, \
                     where nothing changes: a logarithmic axis has no zero."
                .to_owned(),
        ],
        ..Figure::default()
    }
}

/// The value of an error kind without error.
fn without_error(kind: BiasKind) -> f64 {
    if kind.is_factor() { 1.0 } else { 0.0 }
}

/// The changes of one method over one kind of error.
fn curve(sensitivity: &Sensitivity, kind: BiasKind, method: Method) -> Curve {
    let of_kind = sensitivity.points.iter().filter(|p| p.kind == kind && p.method == method);
    let change = |p: &SensitivityPoint| p.rms_change.filter(|c| *c > 0.0).unwrap_or(f64::NAN);
    // Without error nothing changes, and the logarithmic axis has no zero: the curve has a gap there.
    let none = (without_error(kind), f64::NAN);
    let mut points: Vec<(f64, f64)> = of_kind.map(|p| (shown_value(p), change(p))).chain([none]).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Curve::new(method.name(), points)
}

fn axis(kind: BiasKind) -> String {
    match kind {
        BiasKind::Delay => "delay, ms".to_owned(),
        BiasKind::ReferenceOffset => "offset, mrad or mm".to_owned(),
        BiasKind::GearRatio
        | BiasKind::DriveGain
        | BiasKind::ControllerGain
        | BiasKind::ReferenceScale
        | BiasKind::Friction => format!("{}, factor", kind.name()),
    }
}

/// Times in ms, angles and lengths in mrad and mm.
fn shown_value(point: &SensitivityPoint) -> f64 {
    if point.kind.is_factor() { point.value } else { 1e3 * point.value }
}

fn table(sensitivity: &Sensitivity) -> Table {
    let strings = |texts: &[&str]| texts.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>();
    let methods = methods(sensitivity);
    let first = |p: &&SensitivityPoint| Some(&p.method) == methods.first();
    let row = |p: &SensitivityPoint| {
        let cells = methods.iter().flat_map(|m| cells(same_error(sensitivity, p, *m)));
        [axis(p.kind), given(shown_value(p))].into_iter().chain(cells).collect()
    };
    let figures = strings(&["rms", "max", "error %"]);
    Table {
        title: "Changes of the estimates with errors of the simulator, standard deviations".to_owned(),
        lead: 2,
        groups: methods.iter().map(|m| Group { label: m.name().to_owned(), columns: 3 }).collect(),
        head: strings(&["error", "value"]).into_iter().chain(methods.iter().flat_map(|_| figures.clone())).collect(),
        rows: sensitivity.points.iter().filter(first).map(row).collect(),
        notes: strings(&[
            "rms and max: over the shown estimates, compared with those without error; offset: of the reference.",
            "*: did not converge.",
        ]),
    }
}

fn same_error<'a>(
    sensitivity: &'a Sensitivity,
    point: &SensitivityPoint,
    method: Method,
) -> Option<&'a SensitivityPoint> {
    sensitivity.points.iter().find(|p| p.kind == point.kind && p.value == point.value && p.method == method)
}

fn cells(point: Option<&SensitivityPoint>) -> [String; 3] {
    let Some(point) = point.filter(|p| p.rms_change.is_some()) else {
        let why = point.map_or(NONE, |p| p.status.name());
        return [why, NONE, NONE].map(str::to_owned);
    };
    let most = point.largest_change.as_ref().map(|(name, c)| format!("{name} {}", significant(*c, 2)));
    let star = if point.status == Status::Converged { "" } else { "*" };
    [
        format!("{}{star}", optional(point.rms_change, 2)),
        most.unwrap_or_else(|| NONE.to_owned()),
        optional(point.relative_error_percent, 3),
    ]
}

fn csv_of(sensitivity: &Sensitivity) -> Result<Vec<u8>, ReportError> {
    let refuse = |source| ReportError::Csv { source };
    let mut writer = csv::Writer::from_writer(Vec::new());
    let head = ["error", "value", "method", "status", "relative_error_percent", "rms_change_sd"];
    let names = sensitivity.parameters.iter().map(|name| cell(name));
    writer.write_record(head.into_iter().map(Cow::Borrowed).chain(names).map(Cow::into_owned)).map_err(refuse)?;
    for point in sensitivity.nominal.iter().map(|p| (p, "none")).chain(sensitivity.points.iter().map(|p| (p, ""))) {
        writer.write_record(record(point, sensitivity.parameters.len())).map_err(refuse)?;
    }
    writer.into_inner().map_err(|e| refuse(e.into_error().into()))
}

/// Values in SI units.
fn record((point, kind): (&SensitivityPoint, &str), parameters: usize) -> Vec<String> {
    let number = |v: Option<f64>| v.map(|v| v.to_string()).unwrap_or_default();
    let kind = if kind.is_empty() { point.kind.name() } else { kind };
    let lead = [kind, &point.value.to_string(), point.method.name(), point.status.name()].map(str::to_owned);
    let figures = [number(point.relative_error_percent), number(point.rms_change)];
    let estimates = (0..parameters).map(|i| number(point.estimates.get(i).copied()));
    lead.into_iter().chain(figures).chain(estimates).collect()
}
