//! The report of a campaign: `campaign.html`, and tables for the terminal.

pub(in crate::report) mod box_plot;
pub(in crate::report) mod figures;
pub(in crate::report) mod power;
pub(in crate::report) mod tables;

use std::path::{Path, PathBuf};

use super::{
    error::ReportError,
    figures::{Figure, Key},
    files::write_one,
    number::{given, significant},
    page::{Page, render},
    section::Section,
    wrap::{TextWidth, wrap},
};
use crate::results::{CampaignResults, Extent, Method, MethodSummary, Quantiles};
use box_plot::{BoxGroup, BoxOf, box_chart};
use figures::{bias, coverage};
use power::power;
use tables::{LEGEND, comparison, parameters};
use thetahat_ground::output::FileKind;

/// The tables for the terminal.
#[must_use]
pub fn campaign_text(results: &CampaignResults, width: TextWidth) -> String {
    let facts = facts(results).into_iter().map(|(label, text)| wrap(&format!("{label}: {text}"), "  ", width));
    let head = [wrap(&results.title, "", width)].into_iter().chain(facts).collect::<String>();
    let tables = comparison(&results.summaries);
    let claims: String = claims(results).iter().map(|line| wrap(line, "  ", width)).collect();
    let mut parts = vec![head];
    parts.extend(tables.iter().map(|table| table.to_text(width)));
    parts.push(wrap(LEGEND, "", width));
    if !claims.is_empty() {
        parts.push(format!("Published statements:\n{claims}"));
    }
    parts.join("\n")
}

/// The page of a campaign.
pub const CAMPAIGN_PAGE: (&str, FileKind) = ("campaign.html", FileKind::Page(GENERATOR));

const GENERATOR: &str = "thetahat campaign";

/// Writes `campaign.html` into an existing folder. Returns its path.
///
/// # Errors
/// [`ReportError`] where the page cannot be rendered or written.
pub fn write_campaign(results: &CampaignResults, directory: &Path) -> Result<PathBuf, ReportError> {
    let sections = vec![
        Section {
            id: "coverage",
            title: "Coverage, bias and power",
            figures: [coverage, bias, power].into_iter().filter_map(|figure| figure(&results.summaries)).collect(),
            ..Section::default()
        },
        Section { id: "boxes", title: "Distributions", figures: figures(results), ..Section::default() },
        Section {
            id: "comparison",
            title: "Comparison",
            lines: vec![LEGEND.to_owned()],
            tables: comparison(&results.summaries),
            ..Section::default()
        },
        Section { id: "claims", title: "Published statements", lines: claims(results), ..Section::default() },
        Section {
            id: "parameters",
            title: "Every parameter",
            folded: parameters(&results.summaries),
            ..Section::default()
        },
        Section { id: "files", title: "Campaign, experiment and robot", files: files(results), ..Section::default() }
            .folded("campaign, experiment and robot files"),
    ];
    let page = Page {
        title: &results.title,
        generator: GENERATOR,
        facts: facts(results),
        sections: sections.into_iter().filter(|s| !s.is_empty()).collect(),
        footer: "All figures except the counts of runs are from runs that converged.",
        ..Page::default()
    };
    write_one(directory, CAMPAIGN_PAGE.0, render(&page)?.as_bytes())
}

fn facts(results: &CampaignResults) -> Vec<(&'static str, String)> {
    let deviation = results.start_deviation;
    let starts = match deviation {
        0.0 => "the a-priori parameters".to_owned(),
        _ => format!("{}, a-priori parameters times N(1, {}^2)", extent(results.starts), given(deviation)),
    };
    vec![
        ("robot", results.robot.clone()),
        ("experiment", results.experiment_title.clone()),
        ("parameters", results.parameters.to_string()),
        ("starts", starts),
        ("seeds", extent(results.seeds)),
        ("runs", results.runs.to_string()),
    ]
}

fn extent(Extent { run, described }: Extent) -> String {
    if run == described { run.to_string() } else { format!("{run} of {described}") }
}

fn claims(results: &CampaignResults) -> Vec<String> {
    results.statements.iter().map(|c| format!("{} ({})", c.says, c.source)).collect()
}

fn files(results: &CampaignResults) -> Vec<(&'static str, String)> {
    let texts = [
        ("Campaign", &results.campaign_description),
        ("Experiment", &results.experiment_description),
        ("Robot", &results.robot_description),
    ];
    texts.map(|(title, text)| (title, text.clone())).into()
}

type Metric = fn(&MethodSummary) -> Option<Quantiles>;

/// Distance and errors of the motion, a figure for each case.
fn figures(results: &CampaignResults) -> Vec<Figure> {
    let metrics: [(&str, Metric); 3] = [
        ("|theta - theta_true| / |theta_true|, %", |s| s.distance_percent),
        ("error of the simulated torques, %", |s| s.torque_error_percent),
        ("error of the simulated positions, %", |s| s.position_error_percent),
    ];
    let mut cases: Vec<&str> = Vec::new();
    for summary in &results.summaries {
        if !cases.contains(&summary.case.as_str()) {
            cases.push(&summary.case);
        }
    }
    let figure = |case: &&str| {
        let of_case: Vec<&MethodSummary> = results.summaries.iter().filter(|s| s.case == *case).collect();
        let chart = |(title, metric): &(&str, Metric)| box_chart((*title).to_owned(), &groups(&of_case, *metric));
        Figure {
            conclusion: closest(case, &of_case),
            caption: format!(
                "converged runs of {case}; whiskers to the extremes, boxes from the lower to the upper quartile"
            ),
            legend: legend_of(&of_case),
            charts: metrics.iter().map(chart).collect(),
            ..Figure::default()
        }
    };
    cases.iter().map(figure).collect()
}

/// The method with the smallest median distance to the truth, at each noise.
fn closest(case: &str, summaries: &[&MethodSummary]) -> String {
    let mut noises: Vec<&str> = Vec::new();
    for summary in summaries {
        if !noises.contains(&summary.noise.as_str()) {
            noises.push(&summary.noise);
        }
    }
    let best = |noise: &&str| {
        let distances =
            summaries.iter().filter(|s| s.noise == **noise).filter_map(|s| Some((s.distance_percent?.median, s)));
        let (distance, best) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!("{} with {} % at {noise}", best.method, significant(distance, 3)))
    };
    let best: Vec<String> = noises.iter().filter_map(best).collect();
    if best.is_empty() {
        String::new()
    } else {
        format!("{case}: closest to the true parameters: {}.", best.join("; "))
    }
}

/// The methods of the summaries.
fn legend_of(summaries: &[&MethodSummary]) -> Vec<Key> {
    let shown = Method::all().map(Method::name).filter(|name| summaries.iter().any(|s| s.method == *name));
    shown.map(|name| Key::new(name, name)).collect()
}

/// A group for each noise level, a box for each method.
fn groups(summaries: &[&MethodSummary], metric: Metric) -> Vec<BoxGroup> {
    let mut groups: Vec<BoxGroup> = Vec::new();
    for summary in summaries {
        let of = metric(summary).map(|quantiles| BoxOf { class: format!("box {}", summary.method), quantiles });
        match groups.iter_mut().find(|g| g.label == summary.noise) {
            Some(group) => group.boxes.extend(of),
            None => groups.push(BoxGroup { label: summary.noise.clone(), boxes: of.into_iter().collect() }),
        }
    }
    groups
}
