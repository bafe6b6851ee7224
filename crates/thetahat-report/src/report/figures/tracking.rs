//! The simulated closed loop compared with the recording.

use super::{
    figure::{Figure, in_case, keys_of},
    recording_curves::RecordingCurves,
};
use crate::{
    report::{
        plot::{Chart, Curve, NARROW, Range, WIDE},
        tables::runs_of,
        units,
    },
    results::{Plots, Results, RunResult},
};

const HEIGHT: f64 = 110.0;

/// Simulated minus measured positions of a case.
pub(in crate::report) fn tracking(results: &Results, case: &str) -> Option<Figure> {
    let runs: Vec<&RunResult> =
        runs_of(results, case).into_iter().filter(|r| !r.plots.simulated_position.is_empty()).collect();
    let Plots { time_s, position, recordings, .. } = &results.plots;
    let records = RecordingCurves { time_s, measured: position, starts: recordings };
    let width = if position.len() == 1 { WIDE } else { NARROW };
    let chart = |joint: usize| {
        let error = |r: &&RunResult| {
            let simulated = r.plots.simulated_position.get(joint).map_or(&[][..], Vec::as_slice);
            records.difference(r.method.name(), [simulated, &position[joint]], 1e3)
        };
        let curves: Vec<Curve> = runs.iter().map(error).collect();
        let unit = units::thousandth_of_position(results, joint);
        Chart::new(format!("{}, {unit}", units::joint(results, joint)), "time, s", width)
            .with(HEIGHT, |p| {
                let panel = p.around(curves.iter(), 0.0).over(Range::of(time_s.iter().copied()), 0.0);
                records.borders(panel.level("zero", 0.0).lines(&curves), true)
            })
            .zooming()
    };
    (!runs.is_empty() && !time_s.is_empty()).then(|| Figure {
        caption: format!("simulated minus measured position{}", in_case(results, case)),
        legend: keys_of(runs.iter().map(|r| r.method)).into_iter().map(|k| k.switched(true)).collect(),
        charts: (0..position.len()).map(chart).collect(),
        ..Figure::default()
    })
}
