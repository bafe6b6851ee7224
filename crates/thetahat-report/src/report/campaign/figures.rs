//! Coverage of the intervals and bias of the estimates, for each noise level.

use super::box_plot::under_groups;
use crate::{
    report::{
        figures::{Figure, Key},
        number::{fixed, significant},
        plot::{Area, Chart, Curve, Panel, Range, WIDE},
    },
    results::{Method, MethodSummary},
};

const HEIGHT: f64 = 150.0;
/// Nominal coverage of a 95 % interval, percent.
const PREDICTED: f64 = 95.0;
/// Standard deviations on both sides that hold 95 % of a normal distribution.
const NORMAL_95: f64 = 1.96;
/// Share of a position's width that its methods use.
const PART: f64 = 0.6;

/// A number of each method at each position: a case and a noise level.
struct Positions<'a> {
    summaries: &'a [MethodSummary],
    labels: Vec<String>,
    methods: Vec<Method>,
}

impl<'a> Positions<'a> {
    fn of(summaries: &'a [MethodSummary]) -> Self {
        let several = summaries.iter().any(|s| s.case != summaries[0].case);
        let mut positions = Self { summaries, labels: Vec::new(), methods: Vec::new() };
        for summary in summaries {
            let label = label(summary, several);
            if !positions.labels.contains(&label) {
                positions.labels.push(label);
            }
        }
        positions.methods = Method::all().filter(|m| summaries.iter().any(|s| s.method == m.name())).collect();
        positions
    }

    /// The values of a method, next to those of the others at each position.
    fn curve(&self, method: Method, value: fn(&MethodSummary) -> Option<f64>) -> Curve {
        let several = self.summaries.iter().any(|s| s.case != self.summaries[0].case);
        let lane = self.methods.iter().position(|m| *m == method).unwrap_or(0) as f64 + 0.5;
        let offset = PART * (lane / self.methods.len().max(1) as f64 - 0.5);
        let point = |s: &MethodSummary| {
            let position = self.labels.iter().position(|l| *l == label(s, several))?;
            Some((position as f64 + 0.5 + offset, value(s)?))
        };
        let of_method = self.summaries.iter().filter(|s| s.method == method.name());
        Curve::new(method.name(), of_method.filter_map(point).collect())
    }

    fn keys(&self) -> Vec<Key> {
        self.methods.iter().map(|m| Key::new(m.name(), m.name())).collect()
    }

    fn panel(&self, panel: Panel) -> Panel {
        let width = panel.width;
        let panel = panel.over(Range { low: 0.0, high: self.labels.len() as f64 }, 0.0);
        Panel { x_ticks: under_groups(self.labels.iter().map(String::as_str), width), ..panel }
    }
}

fn label(summary: &MethodSummary, several_cases: bool) -> String {
    if several_cases { format!("{} {}", summary.case, summary.noise) } else { summary.noise.clone() }
}

/// How often intervals contain the true value; none without coverages.
pub(in crate::report) fn coverage(summaries: &[MethodSummary]) -> Option<Figure> {
    let runs = summaries.iter().filter(|s| s.coverage_percent.is_some()).map(|s| s.converged).min()?;
    let positions = Positions::of(summaries);
    let half = 100.0 * NORMAL_95 * (0.95 * 0.05 / runs.max(1) as f64).sqrt();
    let curves: Vec<Curve> = positions.methods.iter().map(|m| positions.curve(*m, |s| s.coverage_percent)).collect();
    let found = Range::of(curves.iter().flat_map(|c| c.points.iter().map(|p| p.1)));
    let shown = found.with(PREDICTED - 1.2 * half).with(100.0).padded(0.04);
    let ends = [0.0, positions.labels.len() as f64];
    let band = Area {
        class: "band".to_owned(),
        points: ends.map(|x| (x, [PREDICTED - half, (PREDICTED + half).min(100.0)])).into(),
    };
    let chart =
        Chart::new("95 % intervals that contain the true value, %".to_owned(), "noise", WIDE).with(HEIGHT, |p| {
            let panel = positions.panel(p).up(shown).area(&band).level("nominal", PREDICTED);
            curves.iter().fold(panel, Panel::dots)
        });
    Some(Figure {
        conclusion: conclusion(summaries, &positions.methods, half),
        caption: "coverage of the 95 % intervals".to_owned(),
        legend: positions.keys().into_iter().chain([Key::new("band", "expected from chance alone")]).collect(),
        charts: vec![chart],
        notes: vec![format!(
            "The band contains 95 % of the coverages of {runs} runs with independent errors; parameters of one run are not \
                             independent, so that it is wide rather than narrow."
        )],
    })
}

fn conclusion(summaries: &[MethodSummary], methods: &[Method], half: f64) -> String {
    let worst = |method: &Method| {
        let of_method = summaries.iter().filter(|s| s.method == method.name());
        let all = of_method.filter_map(|s| Some((s.coverage_percent?, s)));
        let (coverage, at) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((format!("{method} {} % ({}, {})", fixed(coverage, 1), at.case, at.noise), coverage >= PREDICTED - half))
    };
    let (keep, miss): (Vec<_>, Vec<_>) = methods.iter().filter_map(worst).partition(|(_, keeps)| *keeps);
    let listed = |what: &str, of: Vec<(String, bool)>| {
        let texts: Vec<String> = of.into_iter().map(|(text, _)| text).collect();
        (!texts.is_empty()).then(|| format!("{what}, at worst: {}.", texts.join(", ")))
    };
    let miss = listed("95 % intervals contain the true value less often than predicted", miss);
    let keep = listed("95 % intervals contain the true value as often as predicted", keep);
    miss.into_iter().chain(keep).collect::<Vec<_>>().join(" ")
}

/// Rms of the bias in standard deviations; none without biases.
pub(in crate::report) fn bias(summaries: &[MethodSummary]) -> Option<Figure> {
    summaries.iter().find_map(|s| s.bias)?;
    let positions = Positions::of(summaries);
    let curves: Vec<Curve> =
        positions.methods.iter().map(|m| positions.curve(*m, |s| s.bias.filter(|b| *b > 0.0))).collect();
    let chart = Chart::new("Bias, classical standard deviations".to_owned(), "noise", WIDE).with(HEIGHT, |p| {
        let biases = curves.iter().flat_map(|c| c.points.iter().map(|p| p.1));
        let panel = positions.panel(p).up_by_powers(biases.chain([1.0])).level("nominal", 1.0);
        curves.iter().fold(panel, Panel::dots)
    });
    let largest = |method: &Method| {
        let of_method = summaries.iter().filter(|s| s.method == method.name());
        let bias = of_method.filter_map(|s| s.bias).max_by(f64::total_cmp)?;
        Some(format!("{method} {}", significant(bias, 2)))
    };
    let all: Vec<String> = positions.methods.iter().filter_map(largest).collect();
    Some(Figure {
        conclusion: format!("Largest bias of the mean estimates, in standard deviations: {}.", all.join(", ")),
        caption: "bias of the estimates over the noise, logarithmic".to_owned(),
        legend: positions.keys(),
        charts: vec![chart],
        notes: vec![
            "Above the line at one standard deviation the bias exceeds the stated standard deviation.".to_owned(),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::MethodSummary;

    fn summary(method: &str, noise: &str, coverage: f64) -> MethodSummary {
        MethodSummary {
            case: "nominal".to_owned(),
            noise: noise.to_owned(),
            method: method.to_owned(),
            runs: 100,
            converged: 100,
            bias: Some(0.1),
            spread: None,
            coverage_percent: Some(coverage),
            classical_coverage_percent: None,
            iterations: None,
            simulations: None,
            seconds: None,
            distance_percent: None,
            position_error_percent: None,
            torque_error_percent: None,
            parameters: Vec::new(),
            failures: Vec::new(),
        }
    }

    #[test]
    fn the_conclusion_names_the_method_whose_intervals_are_too_narrow() {
        let summaries =
            [summary("idim-ls", "low", 94.0), summary("idim-ls", "high", 40.0), summary("idim-iv", "low", 95.5)];
        let figure = coverage(&summaries).unwrap();
        assert!(
            figure.conclusion.contains("less often than predicted, at worst: idim-ls 40.0 % (nominal, high)."),
            "{}",
            figure.conclusion
        );
        assert!(
            figure.conclusion.contains("as predicted, at worst: idim-iv 95.5 % (nominal, low)."),
            "{}",
            figure.conclusion
        );
        let panel = &figure.charts[0].panels[0];
        assert_eq!(panel.x_ticks.len(), 2);
        let nominal = panel.paths.iter().find(|p| p.class == "nominal").unwrap();
        let line = (10.0 * panel.y_axis().position(95.0)).round();
        assert!(nominal.data.starts_with(&format!("M0 {line}h")), "{}", nominal.data);
    }
}
