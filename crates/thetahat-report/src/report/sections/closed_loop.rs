//! Results of CLIE and CLOE beyond the estimates: quantities of the loop, and DIDIM's approximation.

use crate::{
    report::{
        number::{NONE, estimate, significant},
        table::{Table, strings},
    },
    results::{ApproximatedParameter, LoopParameterResult, Results, RunResult},
};

/// Parameters that a table lists.
const LISTED: usize = 6;

/// Estimated quantities of the simulated loop, one row for each.
pub(in crate::report) fn loop_parameters(results: &Results) -> Option<Table> {
    let rows: Vec<Vec<String>> =
        results.runs.iter().flat_map(|r| r.loop_parameters.iter().map(|p| loop_row(r, p))).collect();
    (!rows.is_empty()).then(|| Table {
        title: "The simulated loop, as estimated".to_owned(),
        lead: 3,
        head: strings(&["case", "method", "quantity", "unit", "estimate", "sd", "95 % from", "to"]),
        rows,
        notes: strings(&[
            "Factors on the values in the experiment file, an added delay, the velocity at which friction changes its sign. sd: classical; the \
             interval allows for correlated errors.",
        ]),
        ..Table::default()
    })
}

fn loop_row(run: &RunResult, p: &LoopParameterResult) -> Vec<String> {
    let end = |i: usize| p.interval_95.map_or_else(|| NONE.to_owned(), |ends| significant(ends[i], 4));
    vec![
        run.case.clone(),
        run.method.name().to_owned(),
        p.name.clone(),
        if p.unit.is_empty() { "factor".to_owned() } else { p.unit.clone() },
        estimate(p.estimate, Some(p.standard_deviation)),
        significant(p.standard_deviation, 2),
        end(0),
        end(1),
    ]
}

/// DIDIM against CLIE, the parameters that differ most in each case.
pub(in crate::report) fn approximation(results: &Results) -> Option<Table> {
    approximation_with(results, LISTED)
}

/// The same with every parameter.
pub(in crate::report) fn whole_approximation(results: &Results) -> Option<Table> {
    approximation_with(results, usize::MAX)
}

fn approximation_with(results: &Results, listed: usize) -> Option<Table> {
    let mut rows = Vec::new();
    for diagnosis in &results.diagnostics {
        let Some(found) = &diagnosis.approximation else { continue };
        let mut parameters: Vec<&ApproximatedParameter> = found.parameters.iter().collect();
        parameters.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        rows.extend(parameters.into_iter().take(listed).map(|p| approximation_row(&diagnosis.case, p)));
    }
    (!rows.is_empty()).then(|| Table {
        title: "Error of didim's approximated sensitivities".to_owned(),
        lead: 2,
        head: strings(&["case", "parameter", "column %", "didim - clie", "sd"]),
        rows,
        notes: strings(&[
            "column: |Z - J| / |J|, the approximated against the exact sensitivity of the torques. sd: the difference in \
             standard deviations of clie with correlated errors; above 1 the approximation matters.",
        ]),
        ..Table::default()
    })
}

fn approximation_row(case: &str, p: &ApproximatedParameter) -> Vec<String> {
    vec![
        case.to_owned(),
        p.name.clone(),
        significant(p.column_percent, 3),
        significant(p.difference, 3),
        significant(p.deviations, 2),
    ]
}

/// Which methods have errors of positions, and whether DIDIM's approximation matters.
pub(in crate::report) fn notes(results: &Results) -> Vec<String> {
    let of_positions = results.runs.iter().find(|r| r.is_of_positions());
    let positions =
        of_positions.map(|r| format!("{}: its errors are errors of positions, not of torques.", r.method.name()));
    let matters = results.diagnostics.iter().filter_map(|d| {
        let approximation = d.approximation.as_ref().filter(|a| a.matters)?;
        let many = approximation.parameters.iter().filter(|p| p.deviations.abs() > 1.0).count();
        let (count, case) = (approximation.parameters.len(), &d.case);
        Some(format!(
            "{case}: didim differs from clie by more than the standard deviation in {many} of {count} parameters: it is least \
             squares with approximated sensitivities, equations (16) and (17), clie with exact ones."
        ))
    });
    positions.into_iter().chain(matters).collect()
}
