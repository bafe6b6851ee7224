//! The report of a campaign: `campaign.html`, and tables for the terminal.

use std::path::{Path, PathBuf};

use super::{
    ReportError, Table,
    box_plot::{BoxGroup, BoxOf, box_chart},
    campaign_tables::{LEGEND, comparison, parameters},
    figures::Figure,
    files::write_one,
    html,
    number::given,
    sections::Section,
    text::wrap,
};
use crate::{
    campaign::{Campaign, CampaignRuns, Quantiles, Summary, summarise},
    identification::Method,
};

/// The tables for the terminal.
#[must_use]
pub fn campaign_text(campaign: &Campaign, runs: &CampaignRuns) -> String {
    let facts = facts(campaign, runs).into_iter().map(|(label, text)| wrap(&format!("{label}: {text}"), "  "));
    let head = [wrap(&campaign.file.title, "")].into_iter().chain(facts).collect::<String>();
    let tables = comparison(&summarise(runs));
    let claims: String = claims(campaign).iter().map(|line| wrap(line, "  ")).collect();
    let mut parts = vec![head];
    parts.extend(tables.iter().map(Table::to_text));
    parts.push(wrap(LEGEND, ""));
    if !claims.is_empty() {
        parts.push(format!("Published statements:\n{claims}"));
    }
    parts.join("\n")
}

/// Writes `campaign.html` into a folder that is there. Returns its path.
///
/// # Errors
/// [`ReportError`] where the page cannot be rendered or written.
pub fn write_campaign(campaign: &Campaign, runs: &CampaignRuns, directory: &Path) -> Result<PathBuf, ReportError> {
    let summaries = summarise(runs);
    let sections = [
        Section {
            id: "comparison",
            title: "Comparison",
            lines: vec![LEGEND.to_owned()],
            tables: comparison(&summaries),
            ..Section::default()
        },
        Section { id: "boxes", title: "Distributions", figures: figures(&summaries), ..Section::default() },
        Section { id: "claims", title: "Published statements", lines: claims(campaign), ..Section::default() },
        Section {
            id: "parameters",
            title: "Every parameter",
            folded: parameters(runs, &summaries),
            ..Section::default()
        },
        Section { id: "files", title: "What was done", files: files(campaign), ..Section::default() },
    ];
    let shown: Vec<Section> = sections.into_iter().filter(|s| !s.is_empty()).collect();
    let page = html::page_of(&campaign.file.title, &facts(campaign, runs), &shown)?;
    write_one(directory, "campaign.html", page.into_bytes())
}

fn facts(campaign: &Campaign, runs: &CampaignRuns) -> Vec<(&'static str, String)> {
    let file = &campaign.file;
    let of = |what: fn(&crate::campaign::Row) -> u32| runs.rows.iter().map(what).max().unwrap_or_default();
    let starts = format!(
        "{} of {}, a-priori parameters times N(1, {}^2)",
        of(|r| r.start),
        file.starts.count,
        given(file.starts.relative_deviation)
    );
    let starts = if file.starts.relative_deviation == 0.0 { "the a-priori parameters".to_owned() } else { starts };
    vec![
        ("robot", campaign.experiment.robot.name.clone()),
        ("record", campaign.experiment.file.title.clone()),
        ("parameters", runs.facts.parameters.len().to_string()),
        ("starts", starts),
        ("seeds", format!("{} of {}", of(|r| r.seed), file.seeds)),
        ("runs", runs.rows.len().to_string()),
    ]
}

fn claims(campaign: &Campaign) -> Vec<String> {
    campaign.file.claim.iter().map(|c| format!("{} ({})", c.says, c.source)).collect()
}

fn files(campaign: &Campaign) -> Vec<(&'static str, String)> {
    let experiment = &campaign.experiment;
    let texts = [("Campaign", &campaign.text), ("Experiment", &experiment.text), ("Robot", &experiment.robot_text)];
    texts.map(|(title, text)| (title, text.clone())).into()
}

type Metric = fn(&Summary) -> Option<Quantiles>;

/// Distance and errors of the motion, a figure for each case.
fn figures(summaries: &[Summary]) -> Vec<Figure> {
    let metrics: [(&str, Metric); 3] = [
        ("|theta - theta_true| / |theta_true|, %", |s| s.distance_percent),
        ("error of the simulated torques, %", |s| s.torque_error_percent),
        ("error of the simulated positions, %", |s| s.position_error_percent),
    ];
    let mut cases: Vec<&str> = Vec::new();
    for summary in summaries {
        if !cases.contains(&summary.case.as_str()) {
            cases.push(&summary.case);
        }
    }
    let figure = |case: &&str| {
        let of_case: Vec<&Summary> = summaries.iter().filter(|s| s.case == *case).collect();
        let chart = |(title, metric): &(&str, Metric)| box_chart((*title).to_owned(), &groups(&of_case, *metric));
        Figure {
            caption: format!("{case}: converged runs; whiskers to the extremes, boxes over the middle half"),
            legend: Method::all()
                .filter(|m| of_case.iter().any(|s| s.method == m.name()))
                .map(|m| (m.name(), m.name()))
                .collect(),
            charts: metrics.iter().map(chart).collect(),
        }
    };
    cases.iter().map(figure).collect()
}

/// A group for each noise level, a box for each method.
fn groups(summaries: &[&Summary], metric: Metric) -> Vec<BoxGroup> {
    let mut groups: Vec<BoxGroup> = Vec::new();
    for summary in summaries {
        let of = metric(summary).map(|quantiles| BoxOf { class: box_class(&summary.method), quantiles });
        match groups.iter_mut().find(|g| g.label == summary.noise) {
            Some(group) => group.boxes.extend(of),
            None => groups.push(BoxGroup { label: summary.noise.clone(), boxes: of.into_iter().collect() }),
        }
    }
    groups
}

/// Class of the boxes of each method.
const BOX_CLASSES: [(Method, &str); 4] = [
    (Method::IDIM_LS, "box idim-ls"),
    (Method::IDIM_WLS, "box idim-wls"),
    (Method::IDIM_IV, "box idim-iv"),
    (Method::DIDIM, "box didim"),
];

fn box_class(method: &str) -> &'static str {
    let method = method.parse().unwrap_or(Method::IDIM_LS);
    BOX_CLASSES.iter().find(|(of, _)| *of == method).map_or("box", |(_, class)| class)
}
