//! Advice and diagnosis: the recommended method, and the tests for it.

use super::{closed_loop, hidden_bias};
use crate::{
    report::{
        number::{NONE, optional, significant},
        section::Section,
        table::{Table, strings},
    },
    results::{
        BiasExplanation, BiasedSimulatorResult, CaseDiagnosis, ChiSquaredTest, Comparison, EndogeneityResult,
        InstrumentResult, JointResidual, ParameterDifference, ResidualResult, Results, RunResult,
    },
};

/// Probability below which a test of a residual rejects.
const SIGNIFICANCE: f64 = 0.05;

/// The advice of each case, as a label and a text.
pub(in crate::report) fn advice(results: &Results) -> impl Iterator<Item = (&'static str, String)> {
    let several = results.advice.len() > 1;
    results.advice.iter().map(move |a| {
        let text = if several { format!("{}: {}", a.case, a.text) } else { a.text.clone() };
        ("advice", text)
    })
}

pub(in crate::report) fn section(results: &Results) -> Section {
    let tables = [
        comparisons(results),
        explanations(results),
        closed_loop::approximation(results),
        closed_loop::loop_parameters(results),
        residuals(results),
        hidden_bias::table(results),
    ];
    let folded = [closed_loop::whole_approximation(results), joint_residuals(results)];
    Section {
        id: "diagnosis",
        title: "Diagnosis",
        lines: notes(results),
        tables: tables.into_iter().flatten().collect(),
        folded: folded.into_iter().flatten().collect(),
        ..Section::default()
    }
}

fn verdict(verdict: Comparison) -> &'static str {
    match verdict {
        Comparison::Agree => "agree",
        Comparison::SmallDifference => "small",
        Comparison::Alarm => "* alarm",
        Comparison::Unclear => "* unclear",
        Comparison::Undecided => "* undecided",
    }
}

fn probability(p: f64) -> String {
    if p < 1e-4 { "< 1e-4".to_owned() } else { significant(p, 2) }
}

/// The bootstrap has no probability below that of one draw plus the recording itself.
fn bootstrap_probability(b: &BiasedSimulatorResult) -> String {
    let least = 1.0 / (b.draws + 1) as f64;
    if b.p_value > least { probability(b.p_value) } else { format!("<= {}", significant(least, 2)) }
}

fn differing(parameters: &[ParameterDifference]) -> String {
    let most = parameters.first();
    most.map_or_else(|| NONE.to_owned(), |p| format!("{} {}", p.name, significant(p.deviations, 2)))
}

/// LS and DIDIM against IV, one row for each comparison.
pub(in crate::report) fn comparisons(results: &Results) -> Option<Table> {
    let rows: Vec<Vec<String>> = results.diagnostics.iter().flat_map(comparisons_of).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Methods against idim-iv".to_owned(),
        lead: 2,
        head: strings(&["case", "method", "statistic", "limit", "p", "mean, sd", "verdict", "most, sd"]),
        rows,
        notes: strings(&[
            "idim-ls: Durbin-Wu-Hausman test. didim: biased simulator test, same instruments and weights.",
            "limit: 5 % of the statistics of a correct simulator exceed it. mean, sd: average difference in standard deviations (sd) of \
             idim-iv; most, sd: the parameter that differs most, with its difference. A mean below 0.5 is small, above it an alarm where \
             p <= 0.05; undecided if the simulated motion explains the torques much better than the measured one; \
             unclear if it explains them too badly for a conclusion.",
        ]),
        ..Table::default()
    })
}

fn comparisons_of(diagnosis: &CaseDiagnosis) -> Vec<Vec<String>> {
    let ls = diagnosis.endogeneity.as_ref().map(|e| endogeneity_row(&diagnosis.case, e));
    let didim = diagnosis.biased_simulator.as_ref().map(|b| simulator_row(&diagnosis.case, b));
    ls.into_iter().chain(didim).collect()
}

fn endogeneity_row(case: &str, e: &EndogeneityResult) -> Vec<String> {
    vec![
        case.to_owned(),
        "idim-ls".to_owned(),
        significant(e.robust.statistic, 3),
        NONE.to_owned(),
        probability(e.robust.p_value),
        significant(e.average_difference, 2),
        verdict(e.verdict).to_owned(),
        differing(&e.parameters),
    ]
}

fn simulator_row(case: &str, b: &BiasedSimulatorResult) -> Vec<String> {
    vec![
        case.to_owned(),
        "didim".to_owned(),
        significant(b.statistic, 3),
        significant(b.threshold, 3),
        bootstrap_probability(b),
        significant(b.average_difference, 2),
        verdict(b.verdict).to_owned(),
        differing(&b.parameters),
    ]
}

/// How large an error of the simulator would explain an alarm.
pub(in crate::report) fn explanations(results: &Results) -> Option<Table> {
    let of_case = |d: &CaseDiagnosis| -> Vec<Vec<String>> {
        let all = d.biased_simulator.iter().flat_map(|b| &b.explanations);
        all.map(|e| explanation_row(&d.case, e)).collect()
    };
    let rows: Vec<Vec<String>> = results.diagnostics.iter().flat_map(of_case).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Errors of the simulator that would explain the difference of didim".to_owned(),
        lead: 2,
        head: strings(&["case", "error in", "simulator / true", "sd", "explained %"]),
        rows,
        notes: strings(&[
            "delay: simulator minus true, ms; -: the factor would have to be below zero. An error that explains little is not the \
             cause.",
        ]),
        ..Table::default()
    })
}

fn explanation_row(case: &str, e: &BiasExplanation) -> Vec<String> {
    let scale = if e.kind.is_factor() { 1.0 } else { 1e3 };
    vec![
        case.to_owned(),
        e.kind.name().to_owned(),
        optional(e.simulator_to_true.map(|v| scale * v), 4),
        optional(e.standard_deviation.map(|v| scale * v), 2),
        significant(e.explained_percent, 3),
    ]
}

/// The residual of each run in one row.
pub(in crate::report) fn residuals(results: &Results) -> Option<Table> {
    let row = |r: &RunResult| Some(residual_row(r, r.residual.as_ref()?));
    let rows: Vec<Vec<String>> = results.runs.iter().filter_map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Residuals, validation errors and influence".to_owned(),
        lead: 2,
        head: strings(&["case", "method", "r1", "white", "normal", "Levene p", "cv 95 %", "left out", "shifts", "by, sd"]),
        rows,
        notes: strings(&[
            "r1: largest correlation of adjacent rows of a joint; white, normal: joints that pass Ljung-Box and \
             Jarque-Bera at 5 %; Levene: equal variances of the joints, as weighted; cv 95 %: interval of the \
             cross-validation error, %; left out, shifts: the part of the recording whose removal shifts an estimate most, and that estimate, \
             in its standard deviations with correlated errors.",
        ]),
        ..Table::default()
    })
}

fn residual_row(run: &RunResult, residual: &ResidualResult) -> Vec<String> {
    let largest = residual.joints.iter().map(|j| j.autocorrelation).max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let passing = |test: fn(&JointResidual) -> Option<ChiSquaredTest>| {
        let passed = residual.joints.iter().filter_map(test).filter(|t| t.p_value >= SIGNIFICANCE).count();
        format!("{passed}/{}", residual.joints.len())
    };
    let interval = run.cross_validation_interval_95_percent;
    let influence = run.influence.as_ref();
    vec![
        run.case.clone(),
        run.method.name().to_owned(),
        optional(largest, 2),
        passing(|j| j.whiteness),
        passing(|j| j.normality),
        residual.homoscedasticity.map_or_else(|| NONE.to_owned(), |t| probability(t.p_value)),
        interval.map_or_else(|| NONE.to_owned(), |[l, h]| format!("{}-{}", significant(l, 2), significant(h, 2))),
        influence.map_or_else(|| NONE.to_owned(), |i| i.part.clone()),
        influence.map_or_else(|| NONE.to_owned(), |i| i.parameter.clone()),
        optional(influence.map(|i| i.change), 2),
    ]
}

/// The residual of each joint.
fn joint_residuals(results: &Results) -> Option<Table> {
    let of_run = |r: &RunResult| -> Vec<Vec<String>> {
        r.residual.iter().flat_map(|d| &d.joints).map(|j| joint_row(r, j)).collect()
    };
    let rows: Vec<Vec<String>> = results.runs.iter().flat_map(of_run).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Residuals of each joint".to_owned(),
        lead: 3,
        head: strings(&["case", "method", "joint", "rms", "r1", "Ljung-Box", "p", "Jarque-Bera", "p"]),
        rows,
        ..Table::default()
    })
}

fn joint_row(run: &RunResult, joint: &JointResidual) -> Vec<String> {
    let test = |t: Option<ChiSquaredTest>| {
        [optional(t.map(|t| t.statistic), 3), t.map_or_else(|| NONE.to_owned(), |t| probability(t.p_value))]
    };
    let lead = [run.case.clone(), run.method.name().to_owned(), joint.joint.to_string()];
    let figures = [significant(joint.rms, 3), significant(joint.autocorrelation, 2)];
    lead.into_iter().chain(figures).chain(test(joint.whiteness)).chain(test(joint.normality)).collect()
}

/// Instruments and joints in words.
pub(in crate::report) fn notes(results: &Results) -> Vec<String> {
    let of_case = |d: &CaseDiagnosis| {
        let instruments = d.instruments.as_ref().map(|i| instrument_note(&d.case, i));
        let joints = d.biased_simulator.as_ref().filter(|b| b.joint_percent.len() > 1).map(|b| joint_note(&d.case, b));
        [instruments, joints].into_iter().flatten().collect::<Vec<_>>()
    };
    results.diagnostics.iter().flat_map(of_case).chain(closed_loop::notes(results)).collect()
}

fn instrument_note(case: &str, i: &InstrumentResult) -> String {
    format!(
        "{case}: the weakest instrument belongs to {} with a first-stage F of {} (weak below 10); Z^T X has rank {} and, \
         in columns of length one, condition number {}.",
        i.weakest,
        significant(i.smallest_f, 3),
        i.rank,
        significant(i.condition_number, 3)
    )
}

fn joint_note(case: &str, b: &BiasedSimulatorResult) -> String {
    let joints = b.joint_percent.iter().enumerate().map(|(j, p)| format!("joint {}: {} %", j + 1, significant(*p, 2)));
    let joints: Vec<String> = joints.collect();
    format!("{case}: share of the torque by which didim and idim-iv differ: {}.", joints.join(", "))
}
