//! What the page says of a report.

use minijinja::{Value, context};
use thetahat::{
    Results,
    results::{RunResult, Verdict},
};

/// What `results` say, for the page; their report is in `folder`, with a picture or without.
pub fn entry(folder: &str, results: &Results, has_picture: bool) -> Value {
    let taken = results.recommended_run();
    let percent = |of: fn(&RunResult) -> Option<f64>| taken.and_then(of).map(|error| format!("{error:.2}"));
    let reasons: Vec<String> = results.verdict_reasons.iter().map(|reason| reason.text.clone()).collect();
    context! {
        folder => folder,
        title => results.title.as_str(),
        verdict => results.verdict.map_or("none", words),
        reasons => reasons,
        method => taken.map(|run| run.method.name()),
        error_percent => percent(|run| run.relative_error_percent),
        unseen_error_percent => percent(|run| run.cross_validation_relative_error_percent),
        has_picture => has_picture,
    }
}

fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "good",
        Verdict::Care => "care",
        Verdict::DoNotUse => "do not use",
    }
}
