//! Measured and predicted torques, with the residual below.

use super::{
    figure::{Figure, Key, main_run, named},
    recording_curves::RecordingCurves,
};
use crate::{
    report::{
        number::significant,
        plot::{Chart, Curve, NARROW, Panel, Range, WIDE},
        units,
    },
    results::{Plots, Results, RunResult},
};

/// Class of the measured curve.
const MEASURED: &str = "measured";

/// Heights of the panels, pixels.
const TORQUE: f64 = 124.0;
const RESIDUAL: f64 = 58.0;

/// Relative difference up to which two curves count as equal.
const SAME: f64 = 1e-9;

/// The predictions of a run that a figure shows.
type Prediction = fn(&RunResult) -> &[Vec<f64>];

/// Torques of the recordings used for a case.
pub(in crate::report) fn torques(results: &Results, case: &str) -> Option<Figure> {
    let Plots { time_s, measured, recordings, .. } = &results.plots;
    figure(results, case, (&RecordingCurves { time_s, measured, starts: recordings }, |r| &r.plots.predicted), "")
}

/// The same for the recordings held back.
pub(in crate::report) fn held_back(results: &Results, case: &str) -> Option<Figure> {
    let plots = &results.plots.held_back;
    let records = RecordingCurves { time_s: &plots.time_s, measured: &plots.measured, starts: &plots.recordings };
    figure(results, case, (&records, |r| &r.plots.held_back), "held back, not used for the estimate: ")
}

fn figure(
    results: &Results,
    case: &str,
    (records, prediction): (&RecordingCurves<'_>, Prediction),
    which: &str,
) -> Option<Figure> {
    let of_case = results.runs.iter().filter(|r| r.case == case && !prediction(r).is_empty());
    let main = main_run(results, case).filter(|r| !prediction(r).is_empty())?;
    let runs: Vec<&RunResult> =
        of_case.filter(|r| r.method == main.method || !repeats_nominal(results, r, prediction)).collect();
    if records.time_s.is_empty() || records.measured.iter().flatten().all(|v| *v == 0.0) {
        return None;
    }
    let charts = (0..records.measured.len()).map(|j| chart(results, records, j, (main, &runs, prediction)));
    let key = |r: &&RunResult| Key::new(r.method.name(), r.method.name()).switched(r.method == main.method);
    Some(Figure {
        caption: format!("{which}measured and predicted torque, residual below ({})", named(results, main)),
        legend: [Key::new(MEASURED, MEASURED).switched(true)].into_iter().chain(runs.iter().map(key)).collect(),
        charts: charts.collect(),
        notes: notes(results, case, (main, &runs, prediction)),
        ..Figure::default()
    })
}

/// Whether a run has the prediction of its method in the first case: it does not use the simulator.
fn repeats_nominal(results: &Results, run: &RunResult, prediction: Prediction) -> bool {
    let first = results.cases().first().and_then(|case| results.run(case, run.method)).filter(|r| r.case != run.case);
    let Some(first) = first else { return false };
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME * (a.abs() + b.abs());
    let [ours, theirs] = [prediction(run), prediction(first)];
    ours.len() == theirs.len() && ours.iter().flatten().zip(theirs.iter().flatten()).all(same)
}

fn notes(
    results: &Results,
    case: &str,
    (main, runs, prediction): (&RunResult, &[&RunResult], Prediction),
) -> Vec<String> {
    let residual = format!("Residual: measured minus predicted. Titles: errors of {}.", main.method.name());
    let all = results.runs.iter().filter(|r| r.case == case && !prediction(r).is_empty());
    let left_out: Vec<&str> =
        all.filter(|r| runs.iter().all(|s| s.method != r.method)).map(|r| r.method.name()).collect();
    let same = (!left_out.is_empty()).then(|| format!("Same as in the first case: {}.", left_out.join(", ")));
    [Some(residual), same].into_iter().flatten().collect()
}

fn chart(
    results: &Results,
    records: &RecordingCurves<'_>,
    joint: usize,
    (main, runs, prediction): (&RunResult, &[&RunResult], Prediction),
) -> Chart {
    let measured = records.measured[joint].as_slice();
    let values = |r: &RunResult| prediction(r).get(joint).map_or(&[][..], Vec::as_slice).to_vec();
    let residuals: Vec<Curve> =
        runs.iter().map(|r| records.difference(r.method.name(), [&values(r), measured], -1.0)).collect();
    let predicted = runs.iter().map(|r| records.curve(r.method.name(), values(r).into_iter()));
    let torques: Vec<Curve> =
        [records.curve(MEASURED, measured.iter().copied())].into_iter().chain(predicted).collect();
    let width = if records.measured.len() == 1 { WIDE } else { NARROW };
    let time = Range::of(records.time_s.iter().copied());
    let over_time = |panel: Panel, curves: &[Curve]| panel.around(curves.iter(), 0.0).over(time, 0.0).lines(curves);
    let unit = units::torque(results, joint);
    let title = title(results, joint, [&values(main), measured]);
    Chart::new(title, "time, s", width)
        .with(TORQUE, |p| records.borders(over_time(p, &torques), true).named(unit))
        .with(RESIDUAL, |p| records.borders(over_time(p, &residuals), false).level("zero", 0.0).named("residual"))
        .zooming()
}

/// The joint with the rms and the relative error of its residual.
fn title(results: &Results, joint: usize, [predicted, measured]: [&[f64]; 2]) -> String {
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let of_residual = squares(&mut predicted.iter().zip(measured).map(|(p, m)| p - m));
    let of_torque = squares(&mut measured.iter().copied());
    let rms = (of_residual / measured.len().max(1) as f64).sqrt();
    let unit = units::torque(results, joint);
    let rms = format!("{}: rms {} {unit}", units::joint(results, joint), significant(rms, 3));
    let percent = 100.0 * (of_residual / of_torque).sqrt();
    if percent.is_finite() { format!("{rms}, {} %", significant(percent, 3)) } else { rms }
}
