//! The figures of the page.

use serde::Serialize;

use super::{
    plot::{Chart, Curve, NARROW, WIDE},
    tables::runs_of,
    units,
};
use crate::results::{IterationResult, Method, ParameterResult, Results, RunResult};

/// Class of the measured curve.
const MEASURED: &str = "measured";

/// Ratios to the last estimate beyond these are cut off.
const RATIOS: [f64; 2] = [-1.0, 3.0];

/// Charts with one legend.
#[derive(Debug, Serialize)]
pub(super) struct Figure {
    pub(super) caption: String,
    /// Class and text of each entry.
    pub(super) legend: Vec<(&'static str, &'static str)>,
    pub(super) charts: Vec<Chart>,
}

impl Figure {
    pub(super) fn new(caption: String, legend: Vec<(&'static str, &'static str)>, charts: Vec<Chart>) -> Self {
        Self { caption, legend, charts }
    }
}

/// Runs of a case that have curves of a kind.
fn drawn<'a>(results: &'a Results, case: &str, curves: fn(&RunResult) -> &[Vec<f64>]) -> Vec<&'a RunResult> {
    runs_of(results, case).into_iter().filter(|r| !curves(r).is_empty()).collect()
}

fn predicted(run: &RunResult) -> &[Vec<f64>] {
    &run.plots.predicted
}

fn simulated(run: &RunResult) -> &[Vec<f64>] {
    &run.plots.simulated_position
}

fn legend(runs: &[&RunResult]) -> Vec<(&'static str, &'static str)> {
    runs.iter().map(|r| (r.method.name(), r.method.name())).collect()
}

/// The legend of some methods.
pub(super) fn legend_of(methods: &[Method]) -> Vec<(&'static str, &'static str)> {
    methods.iter().map(|m| (m.name(), m.name())).collect()
}

fn points(time: &[f64], values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    time.iter().copied().zip(values).collect()
}

/// `values - reference`, scaled, of one joint.
fn difference(time: &[f64], values: Option<&Vec<f64>>, reference: &[f64], scale: f64) -> Vec<(f64, f64)> {
    let values = values.map_or(&[][..], Vec::as_slice);
    points(time, values.iter().zip(reference).map(|(v, r)| scale * (v - r)))
}

/// Width of one of so many charts.
fn width(charts: usize) -> f64 {
    if charts == 1 { WIDE } else { NARROW }
}

/// One chart for each joint; none where no run of the case has a curve.
fn per_joint(
    results: &Results,
    (runs, caption): (&[&RunResult], String),
    joints: usize,
    chart: impl Fn(usize) -> Chart,
) -> Option<Figure> {
    let charts: Vec<Chart> = (0..joints).map(chart).collect();
    let usable = !runs.is_empty() && !charts.is_empty() && !results.plots.time_s.is_empty();
    usable.then(|| Figure { caption, legend: legend(runs), charts })
}

/// Measured and reconstructed torques of a case.
pub(super) fn torques(results: &Results, case: &str) -> Option<Figure> {
    let runs = drawn(results, case, predicted);
    let plots = &results.plots;
    let chart = |joint: usize| {
        let measured = points(&plots.time_s, plots.measured[joint].iter().copied());
        let reconstructed = runs.iter().map(|r| {
            let values = r.plots.predicted.get(joint).into_iter().flatten().copied();
            Curve::new(r.method.name(), points(&plots.time_s, values))
        });
        let curves: Vec<Curve> = [Curve::new(MEASURED, measured)].into_iter().chain(reconstructed).collect();
        Chart::over_time(
            format!("Joint {}, {}", joint + 1, units::torque(results, joint)),
            &curves,
            width(plots.measured.len()),
        )
    };
    let caption = format!("{case}: measured and reconstructed torque over time, s");
    let mut figure = per_joint(results, (&runs, caption), plots.measured.len(), chart)?;
    figure.legend.insert(0, (MEASURED, MEASURED));
    Some(figure)
}

/// Measured less reconstructed torques of a case.
pub(super) fn residuals(results: &Results, case: &str) -> Option<Figure> {
    let runs = drawn(results, case, predicted);
    let plots = &results.plots;
    let chart = |joint: usize| {
        let residual = |r: &&RunResult| {
            let values = difference(&plots.time_s, r.plots.predicted.get(joint), &plots.measured[joint], -1.0);
            Curve::new(r.method.name(), values)
        };
        let curves: Vec<Curve> = runs.iter().map(residual).collect();
        Chart::over_time(
            format!("Joint {}, {}", joint + 1, units::torque(results, joint)),
            &curves,
            width(plots.measured.len()),
        )
    };
    let caption = format!("{case}: residual, measured less reconstructed torque, over time, s");
    per_joint(results, (&runs, caption), plots.measured.len(), chart)
}

/// Simulated less measured positions of a case.
pub(super) fn tracking(results: &Results, case: &str) -> Option<Figure> {
    let runs = drawn(results, case, simulated);
    let plots = &results.plots;
    let chart = |joint: usize| {
        let unit = units::thousandth_of_position(results, joint);
        let error = |r: &&RunResult| {
            let simulated = r.plots.simulated_position.get(joint);
            Curve::new(r.method.name(), difference(&plots.time_s, simulated, &plots.position[joint], 1e3))
        };
        let curves: Vec<Curve> = runs.iter().map(error).collect();
        Chart::over_time(format!("Joint {}, {unit}", joint + 1), &curves, width(plots.position.len()))
    };
    let caption = format!("{case}: simulated less measured position over time, s");
    per_joint(results, (&runs, caption), plots.position.len(), chart)
}

/// Estimates relative to the last ones for each run that iterates, and the relative errors, per iteration.
pub(super) fn convergence(results: &Results, case: &str) -> Option<Figure> {
    let runs: Vec<&RunResult> = runs_of(results, case).into_iter().filter(|r| !r.convergence.is_empty()).collect();
    let estimates = |r: &&RunResult| {
        let title = format!("{}: estimates / last estimates", r.method.name());
        Chart::over_iterations(title, &ratios(r))
    };
    let error = |r: &&RunResult| {
        let errors = numbered(r).map(|(k, i)| (k, i.relative_error_percent));
        Curve::new(r.method.name(), errors.collect())
    };
    let errors: Vec<Curve> = runs.iter().map(error).collect();
    let errors = Chart::over_iterations("Relative error, %".to_owned(), &errors);
    let charts: Vec<Chart> = runs.iter().map(estimates).chain([errors]).collect();
    let caption = format!("{case}: per iteration");
    (!runs.is_empty()).then(|| Figure { caption, legend: legend(&runs), charts })
}

fn numbered(run: &RunResult) -> impl Iterator<Item = (f64, &IterationResult)> {
    (1..).map(f64::from).zip(&run.convergence)
}

/// Each shown parameter's estimates relative to its last one.
fn ratios(run: &RunResult) -> Vec<Curve> {
    let last = run.convergence.last().map_or(&[][..], |i| i.estimates.as_slice());
    let shown = |p: &usize| run.parameters.get(*p).is_none_or(|p| p.shown);
    let ratio = |p: usize| {
        let at =
            |i: &IterationResult| i.estimates.get(p).map_or(f64::NAN, |e| (e / last[p]).clamp(RATIOS[0], RATIOS[1]));
        Curve::new(run.method.name(), numbered(run).map(|(k, i)| (k, at(i))).collect())
    };
    (0..last.len()).filter(|p| last[*p] != 0.0).filter(shown).map(ratio).collect()
}

/// Differences of estimates beyond these standard deviations are cut off.
const FARTHEST: f64 = 20.0;

/// The method whose estimates the others are shown against.
const CENTRE: &str = "idim-iv";

/// The shown estimates of a case with their 95 % intervals, as differences from the IV estimates (without IV, from the
/// first method's) in that method's standard deviations.
pub(super) fn coefficients(results: &Results, case: &str) -> Option<Figure> {
    let runs: Vec<&RunResult> = runs_of(results, case).into_iter().filter(|r| !r.parameters.is_empty()).collect();
    let centre = runs.iter().find(|r| r.method.name() == CENTRE).or(runs.first())?;
    let deviation = |p: &ParameterResult| p.standard_deviation.filter(|sd| *sd > 0.0);
    let shown: Vec<&ParameterResult> = centre.parameters.iter().filter(|p| p.shown && deviation(p).is_some()).collect();
    let bar = |run: &RunResult, from: &ParameterResult| {
        let (of_run, unit) = (run.parameter(&from.name)?, deviation(from)?);
        let [low, high] = of_run.interval_95.unwrap_or([of_run.estimate; 2]);
        Some([low, of_run.estimate, high].map(|value| ((value - from.estimate) / unit).clamp(-FARTHEST, FARTHEST)))
    };
    let bars: Vec<(&'static str, Vec<Option<[f64; 3]>>)> =
        runs.iter().map(|r| (r.method.name(), shown.iter().map(|p| bar(r, p)).collect())).collect();
    let names: Vec<&str> = shown.iter().map(|p| p.name.as_str()).collect();
    let title = format!("Estimates less those of {}, in its standard deviations", centre.method.name());
    let caption = format!("{case}: estimates with their 95 % intervals");
    (names.len() > 1).then(|| Figure::new(caption, legend(&runs), vec![Chart::of_intervals(title, &names, &bars)]))
}
