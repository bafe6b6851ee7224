//! Convergence of the iterations.

use super::figure::{Figure, in_case, keys_of};
use crate::{
    report::{
        number::significant,
        plot::{Chart, Curve, NARROW, Range},
        tables::runs_of,
    },
    results::{IterationResult, Results, RunResult},
};

const HEIGHT: f64 = 130.0;

/// Range of the ratios to the last estimate that a chart shows.
const RATIOS: Range = Range { low: -1.0, high: 3.0 };

/// The relative errors, the largest changes, and each run's estimates over its last ones.
pub(in crate::report) fn convergence(results: &Results, case: &str) -> Option<Figure> {
    let runs: Vec<&RunResult> = runs_of(results, case).into_iter().filter(|r| !r.convergence.is_empty()).collect();
    let of_runs = |value: fn(&IterationResult) -> Option<f64>| -> Vec<Curve> {
        let curve = |r: &&RunResult| {
            Curve::new(r.method.name(), numbered(r).filter_map(|(k, i)| Some((k, value(i)?))).collect())
        };
        runs.iter().map(curve).collect()
    };
    let errors = of_runs(|i| Some(i.relative_error_percent));
    let changes = of_runs(|i| i.parameter_change.filter(|c| *c > 0.0));
    let mut charts = vec![
        over_iterations("Relative error, %", &errors, false),
        over_iterations("Largest change of an estimate, in its deviations", &changes, true),
    ];
    charts.extend(runs.iter().map(|r| ratio_chart(r)));
    (!runs.is_empty()).then(|| Figure {
        conclusion: conclusion(&runs),
        caption: format!("results of each iteration{}", in_case(results, case)),
        legend: keys_of(runs.iter().map(|r| r.method)),
        charts,
        ..Figure::default()
    })
}

fn conclusion(runs: &[&RunResult]) -> String {
    let of_run = |r: &&RunResult| {
        let last = r.convergence.last().and_then(|i| i.parameter_change);
        let change = last.map_or_else(String::new, |c| {
            format!(", the last changes an estimate by {} deviations", significant(c, 2))
        });
        let plural = if r.convergence.len() == 1 { "" } else { "s" };
        format!("{}: {} iteration{plural}{change}", r.method.name(), r.convergence.len())
    };
    runs.iter().map(of_run).collect::<Vec<_>>().join("; ") + "."
}

fn numbered(run: &RunResult) -> impl Iterator<Item = (f64, &IterationResult)> {
    (1..).map(f64::from).zip(&run.convergence)
}

fn over_iterations(title: &str, curves: &[Curve], by_powers: bool) -> Chart {
    Chart::new(title.to_owned(), "iteration", NARROW).with(HEIGHT, |panel| {
        let panel = panel.around(curves.iter(), 1.0);
        let values = curves.iter().flat_map(|c| c.points.iter().map(|p| p.1));
        let panel = if by_powers { panel.up_by_powers(values) } else { panel };
        curves.iter().fold(panel, |panel, curve| panel.line(curve).dots(curve))
    })
}

/// Each shown parameter's estimates over its last estimate.
fn ratio_chart(run: &RunResult) -> Chart {
    let curves = ratios(run);
    let is_outside = |c: &&Curve| c.points.iter().any(|p| p.1 < RATIOS.low || p.1 > RATIOS.high);
    let outside = match curves.iter().filter(is_outside).count() {
        0 => String::new(),
        count => format!(" ({count} leave the chart)"),
    };
    let found = Range::of(curves.iter().flat_map(|c| c.points.iter().map(|p| p.1)));
    let shown = Range { low: found.low.clamp(RATIOS.low, 0.9), high: found.high.clamp(1.1, RATIOS.high) };
    let title = format!("{}: estimates over the last ones{outside}", run.method.name());
    Chart::new(title, "iteration", NARROW)
        .with(HEIGHT, |panel| panel.around(curves.iter(), 1.0).up(shown.padded(0.05)).level("zero", 1.0).lines(&curves))
}

fn ratios(run: &RunResult) -> Vec<Curve> {
    let last = run.convergence.last().map_or(&[][..], |i| i.estimates.as_slice());
    let shown = |p: &usize| run.parameters.get(*p).is_none_or(|p| p.shown);
    let ratio = |p: usize| {
        let at = |i: &IterationResult| i.estimates.get(p).map_or(f64::NAN, |e| e / last[p]);
        Curve::new(run.method.name(), numbered(run).map(|(k, i)| (k, at(i))).collect())
    };
    (0..last.len()).filter(|p| last[*p] != 0.0).filter(shown).map(ratio).collect()
}
