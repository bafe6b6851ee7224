//! Charts with one caption and one legend.

use serde::Serialize;

use crate::{
    report::plot::Chart,
    results::{Method, Results, RunResult},
};

/// Charts with one legend.
#[derive(Debug, Default, Serialize)]
pub(in crate::report) struct Figure {
    /// The conclusion from the charts, as a sentence.
    pub(in crate::report) conclusion: String,
    pub(in crate::report) caption: String,
    pub(in crate::report) legend: Vec<Key>,
    pub(in crate::report) charts: Vec<Chart>,
    /// The meaning of the marks.
    pub(in crate::report) notes: Vec<String>,
}

/// An entry of a legend.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Key {
    /// The class that colours it.
    pub(in crate::report) class: &'static str,
    pub(in crate::report) name: String,
    /// Whether it is shown at first, if a switch shows and hides it.
    pub(in crate::report) switch: Option<bool>,
}

impl Key {
    pub(in crate::report) fn new(class: &'static str, name: impl Into<String>) -> Self {
        Self { class, name: name.into(), switch: None }
    }

    /// The same with a switch.
    pub(in crate::report) fn switched(self, on: bool) -> Self {
        Self { switch: Some(on), ..self }
    }
}

/// The legend of some methods.
pub(in crate::report) fn keys_of(methods: impl IntoIterator<Item = Method>) -> Vec<Key> {
    methods.into_iter().map(|m| Key::new(m.name(), m.name())).collect()
}

/// The recommended run of a case, or otherwise the first run with estimates.
pub(super) fn main_run<'a>(results: &'a Results, case: &str) -> Option<&'a RunResult> {
    let recommended = results.recommended_run_in(case).filter(|r| !r.parameters.is_empty());
    recommended.or_else(|| results.runs.iter().find(|r| r.case == case && !r.parameters.is_empty()))
}

/// The case in brackets after a caption; empty if there is only one.
pub(super) fn in_case(results: &Results, case: &str) -> String {
    if results.cases().len() > 1 { format!(" ({case})") } else { String::new() }
}

/// The name of a run in a figure of one run.
pub(super) fn named(results: &Results, run: &RunResult) -> String {
    if results.cases().len() > 1 {
        format!("{}, {}", run.case, run.method.name())
    } else {
        run.method.name().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::results::EstimateSource;

    fn run(method: &str, status: &str) -> String {
        format!(
            r#"{{ "case": "nominal", "method": "{method}", "status": "{status}", "iterations": 0, "simulations": 0,
                "relative_error_percent": 4.0, "joint_relative_error_percent": [3.0], "seconds": 0.1, "convergence": [],
                "parameters": [{{ "name": "a", "estimate": 1.0, "interval_95": [0.9, 1.1], "unit": "", "expression": "a", "shown": true }}] }}"#
        )
    }

    /// Results of a reduction, which have no advice.
    fn without_advice(runs: &[String]) -> Results {
        let text = format!(
            r#"{{ "schema": 2, "thetahat": "0.1.0", "robot": "A", "title": "T", "samples_used": 100, "decimated_rows": 10,
                "recordings": [], "validation_recordings": [], "seed": null, "elimination": null, "verdict": "good",
                "robot_joints": [], "bandwidth": {{ "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 }},
                "experiment_description": "", "robot_description": "", "advice": [], "runs": [{}] }}"#,
            runs.join(", ")
        );
        Results::from_json(Path::new("results.json"), &text).unwrap()
    }

    #[test]
    fn figures_show_the_run_that_the_card_recommends() {
        let results = without_advice(&[run("idim-ls", "converged"), run("idim-iv", "converged")]);
        let main = main_run(&results, "nominal").map(|run| run.method);
        assert_eq!((main, results.card().source), (Some(Method::IDIM_IV), Some(EstimateSource::Run(Method::IDIM_IV))));
        let results = without_advice(&[run("idim-wls", "converged"), run("didim", "converged")]);
        assert_eq!(results.card().source, None);
        assert_eq!(
            main_run(&results, "nominal").map(|run| run.method.name()),
            Some("idim-wls"),
            "the first with numbers"
        );
    }
}
