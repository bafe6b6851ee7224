//! The intervals of a recording next to those that its design predicted: for the terminal, and a page.

use std::{ops::RangeInclusive, path::Path};

use super::{
    comparison::GENERATOR,
    error::ReportError,
    number::significant,
    page::{Page, render},
    section::Section,
    table::{Table, strings},
    wrap::{TextWidth, wrap},
};
use crate::results::{ComparedInterval, IntervalsAgainstPrediction};
use thetahat_ground::{output::replace_file, visible::visible};

/// Intervals that are as wide as predicted: within this factor, either way.
const AS_PREDICTED: f64 = 1.2;
/// Neighbouring rows of a residual that correlate more are no white noise.
const CORRELATED: f64 = 0.35;

/// Ratios of what is as predicted.
fn as_predicted() -> RangeInclusive<f64> {
    1.0 / AS_PREDICTED..=AS_PREDICTED
}

/// The comparison for the terminal.
#[must_use]
pub fn predicted_intervals_text(compared: &IntervalsAgainstPrediction, width: TextWidth) -> String {
    let lines: String = conclusions(compared).iter().map(|line| wrap(line, "", width)).collect();
    format!("{}\n{lines}", table(compared).to_text(width))
}

/// Writes the comparisons as a page, whole or not at all.
///
/// # Errors
/// [`ReportError`] where the page cannot be rendered or written.
pub fn write_predicted_intervals(compared: &[IntervalsAgainstPrediction], path: &Path) -> Result<(), ReportError> {
    let section = Section {
        id: "comparison",
        title: "Predicted and recorded intervals",
        lines: compared.iter().flat_map(conclusions).collect(),
        tables: compared.iter().map(table).collect(),
        ..Section::default()
    };
    let page =
        Page { title: "Comparison with a design", generator: GENERATOR, sections: vec![section], ..Page::default() };
    replace_file(path, render(&page)?.as_bytes()).map_err(|source| ReportError::Write { path: path.to_owned(), source })
}

fn table(compared: &IntervalsAgainstPrediction) -> Table {
    let row = |interval: &ComparedInterval| {
        vec![
            visible(&interval.name).into_owned(),
            visible(&interval.unit).into_owned(),
            significant(interval.predicted, 3),
            significant(interval.found, 3),
            significant(interval.times_wider(), 3),
        ]
    };
    Table {
        title: "Half of the 95 % intervals".to_owned(),
        lead: 2,
        head: strings(&["name", "unit", "predicted", "recorded", "times wider"]),
        rows: compared.parameters.iter().map(row).collect(),
        notes: vec![format!("predicted: by {}; recorded: by {}.", compared.predicted_method, compared.method)],
        ..Table::default()
    }
}

/// Whether the intervals are as predicted, and what differs if they are not.
fn conclusions(compared: &IntervalsAgainstPrediction) -> Vec<String> {
    let times = compared.parameters.iter().map(ComparedInterval::times_wider).filter(|times| *times > 0.0);
    let logs: Vec<f64> = times.map(f64::ln).collect();
    let mean = (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp();
    let widest = compared.parameters.iter().max_by(|a, b| a.times_wider().total_cmp(&b.times_wider()));
    let widest = widest.map_or_else(String::new, |widest| {
        format!("; the widest is that of {}, {} times", visible(&widest.name), significant(widest.times_wider(), 3))
    });
    let summary = format!(
        "{} intervals are {} times as wide as predicted in the geometric mean{widest}.",
        compared.parameters.len(),
        significant(mean, 3)
    );
    let mut lines = vec![summary];
    if !as_predicted().contains(&mean) {
        lines.extend(reasons(compared));
    }
    lines
}

fn reasons(compared: &IntervalsAgainstPrediction) -> Vec<String> {
    let mut reasons = Vec::new();
    if compared.method.name() != compared.predicted_method {
        reasons.push(format!(
            "The results are those of {}: add \"{}\" to [estimation] methods and identify again.",
            compared.method, compared.predicted_method
        ));
    }
    reasons.extend(largest(&compared.residuals).map(|(joint, times)| {
        format!(
            "The residual of {} is {} times the predicted noise: the noise is larger than [noise] says, or the model lacks a torque. \
             [noise] results = \"results.json\" designs with the noise of this recording.",
            visible(joint),
            significant(times, 3)
        )
    }));
    reasons.extend(compared.most_correlated.iter().filter(|(_, correlation)| *correlation > CORRELATED).map(
        |(joint, correlation)| {
            format!(
                "Neighbouring rows of the residual of {} correlate by {}, those of the prediction do not: correlated errors widen the \
                 intervals.",
                visible(joint),
                significant(*correlation, 2)
            )
        },
    ));
    reasons.extend(smallest(&compared.torques).map(|(joint, times)| {
        format!(
            "The torques of {} are {} times the predicted ones: the motion was slower or smaller than designed.",
            visible(joint),
            significant(times, 2)
        )
    }));
    let [predicted, found] = compared.rows.map(|rows| rows as f64);
    if !as_predicted().contains(&(found / predicted)) {
        reasons.push(format!(
            "There are {found} rows after the decimation, {predicted} were predicted: another duration, window, rate or decimation."
        ));
    }
    if reasons.is_empty() {
        reasons.push(
            "Noise, torques and number of rows are as predicted: the parameters may be far from their a-priori values."
                .into(),
        );
    }
    reasons
}

/// The joint whose figure is above its prediction most.
fn largest(ratios: &[(String, f64)]) -> Option<(&str, f64)> {
    let most = ratios.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most.1 > AS_PREDICTED).then_some((most.0.as_str(), most.1))
}

/// The joint whose figure is below its prediction most.
fn smallest(ratios: &[(String, f64)]) -> Option<(&str, f64)> {
    let least = ratios.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 < 1.0 / AS_PREDICTED).then_some((least.0.as_str(), least.1))
}
