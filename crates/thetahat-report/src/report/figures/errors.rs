//! Relative errors by joint and method.

use serde::Serialize;

use crate::{
    report::{
        number::{NONE, significant},
        units,
    },
    results::{Method, Results, RunResult, Verdict},
};

/// Relative error, percent, from which a cell has its full colour.
const FULL: f64 = 100.0;

/// A table whose cells are coloured by their numbers.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Heat {
    pub(in crate::report) conclusion: String,
    pub(in crate::report) title: String,
    /// Headings of the columns after the first.
    pub(in crate::report) head: Vec<String>,
    pub(in crate::report) rows: Vec<HeatRow>,
    pub(in crate::report) note: String,
}

#[derive(Debug, Serialize)]
pub(in crate::report) struct HeatRow {
    pub(in crate::report) name: String,
    /// Whether it is the recommended run.
    pub(in crate::report) is_recommended: bool,
    pub(in crate::report) cells: Vec<HeatCell>,
}

#[derive(Debug, Serialize)]
pub(in crate::report) struct HeatCell {
    pub(in crate::report) text: String,
    /// Share of the full colour, percent; none without a number.
    pub(in crate::report) percent: Option<u32>,
    /// Whether it is the worst joint of its run.
    pub(in crate::report) is_worst: bool,
}

/// The errors of every run; none for one joint and one run.
pub(in crate::report) fn errors(results: &Results) -> Option<Heat> {
    let runs: Vec<&RunResult> = results.runs.iter().filter(|r| r.relative_error_percent.is_some()).collect();
    let joints = runs.iter().map(|r| r.joint_relative_error_percent.len()).max()?;
    let recommended = results.recommended_run();
    let is_usable = results.verdict != Some(Verdict::DoNotUse);
    let row = |r: &&RunResult| HeatRow {
        name: if results.cases().len() > 1 { format!("{} {}", r.case, r.method) } else { r.method.to_string() },
        is_recommended: is_usable && recommended.is_some_and(|t| t.case == r.case && t.method == r.method),
        cells: cells(r, joints),
    };
    let of_joint = |j| format!("joint {}", j + 1);
    let of_positions = runs.iter().any(|r| r.method == Method::CLOE);
    (joints > 1 || runs.len() > 1).then(|| Heat {
        conclusion: recommended.and_then(|r| conclusion(results, r)).unwrap_or_default(),
        title: if of_positions { "Relative errors, %" } else { "Relative errors of the torque, %" }.to_owned(),
        head: ["all", "validation"].map(str::to_owned).into_iter().chain((0..joints).map(of_joint)).collect(),
        rows: runs.iter().map(row).collect(),
        note: format!(
            "Rms of the residual over rms of the measured signal{}; validation: on data not used for the estimate. The darker, \
             the larger; the full colour is 100 % or more.",
            if of_positions { ", of the positions for cloe, of the torque for the others" } else { "" }
        ),
    })
}

fn cells(run: &RunResult, joints: usize) -> Vec<HeatCell> {
    let errors = &run.joint_relative_error_percent;
    let worst = errors.iter().flatten().copied().fold(0.0, f64::max);
    let joint = |j: usize| {
        let error = errors.get(j).copied().flatten();
        HeatCell { is_worst: joints > 1 && error.is_some_and(|e| e == worst), ..cell(error) }
    };
    let ends = [run.relative_error_percent, run.cross_validation_relative_error_percent].map(cell);
    ends.into_iter().chain((0..joints).map(joint)).collect()
}

fn cell(error: Option<f64>) -> HeatCell {
    HeatCell {
        text: error.map_or_else(|| NONE.to_owned(), |e| significant(e, 3)),
        percent: error.filter(|e| e.is_finite()).map(|e| (100.0 * (e / FULL).clamp(0.0, 1.0).sqrt()) as u32),
        is_worst: false,
    }
}

fn conclusion(results: &Results, run: &RunResult) -> Option<String> {
    let errors = run.joint_relative_error_percent.iter().enumerate().filter_map(|(j, e)| Some((j, (*e)?)));
    let (joint, error) = errors.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let method = run.method.name();
    let [all, worst] = [run.relative_error_percent?, error].map(|e| significant(e, 3));
    let several = run.joint_relative_error_percent.len() > 1;
    let at =
        if several { format!("; {} is the worst with {worst} %", units::joint(results, joint)) } else { String::new() };
    let of = if run.method == Method::CLOE { "positions" } else { "torque" };
    Some(format!("{method} leaves {all} % of the {of} unexplained{at}."))
}
