//! Possible bias of the estimates by errors that the intervals do not include.

use crate::{
    report::{
        number::{signed, significant},
        table::{Table, strings},
        units,
    },
    results::{HiddenBias, HiddenError, Results, RunResult},
};

/// For each run the delay of the torques, and the joint whose friction near rest shifts a parameter most.
pub(in crate::report) fn table(results: &Results) -> Option<Table> {
    let of_run = |run: &RunResult| -> Vec<Vec<String>> {
        let furthest = |error: HiddenError| {
            let biases = run.hidden_bias.iter().filter(move |b| b.error == error);
            biases.max_by(|a, b| a.deviations.abs().total_cmp(&b.deviations.abs()))
        };
        let errors = [HiddenError::LateTorque, HiddenError::FrictionNearRest];
        errors.into_iter().filter_map(furthest).map(|bias| row(results, run, bias)).collect()
    };
    let rows: Vec<Vec<String>> = results.runs.iter().flat_map(of_run).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Possible bias outside the intervals".to_owned(),
        lead: 3,
        head: strings(&["method", "error", "unit", "from", "to", "shifts", "by, sd"]),
        rows,
        notes: strings(&[
            "rest friction: friction at rest minus Coulomb friction. from, to: 95 % interval of the error's size; if it excludes zero, the \
             residual shows the error. shifts, by: the parameter with the largest shift at the end with the larger shift, in its robust standard deviations.",
        ]),
        ..Table::default()
    })
}

fn row(results: &Results, run: &RunResult, bias: &HiddenBias) -> Vec<String> {
    let joint = bias.joint.unwrap_or(1);
    let (what, unit, scale) = match bias.error {
        HiddenError::LateTorque => ("torque delay".to_owned(), "ms", 1e3),
        HiddenError::FrictionNearRest => {
            (format!("rest friction, joint {joint}"), units::torque(results, joint - 1), 1.0)
        }
    };
    let [from, to] = bias.size_interval_95.map(|size| significant(scale * size, 2));
    let moves = [bias.parameter.clone(), signed(bias.deviations)];
    [run.method.name().to_owned(), what, unit.to_owned(), from, to].into_iter().chain(moves).collect()
}
