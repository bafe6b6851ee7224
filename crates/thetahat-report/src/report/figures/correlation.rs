//! Parameters that the motion cannot separate.

use super::figure::{Figure, Key, main_run, named};
use crate::{
    report::{
        number::fixed,
        plot::{Chart, Panel, Path, Text, UNITS, WIDE, pixel},
    },
    results::{Results, RunResult},
};

/// Correlations that are drawn, in ascending order, with the class of their colour.
const LEVELS: [(f64, &str); 4] = [(0.3, "r1"), (0.5, "r2"), (0.7, "r3"), (0.9, "r4")];
/// Correlation from which a pair is named, and the largest number of named pairs.
const CONFOUNDED: f64 = 0.9;
const NAMED: usize = 5;
/// Side of the picture, and longest side of a cell, pixels.
const SIDE: f64 = 630.0;
const CELL: f64 = 24.0;
/// Space for the names, pixels.
const NAMES: f64 = 74.0;

/// The correlation map of a case; none with a single parameter.
pub(in crate::report) fn correlation(results: &Results, case: &str) -> Option<Figure> {
    let run = main_run(results, case).filter(|r| r.plots.correlation.len() > 1)?;
    let conclusion = match confounded(run) {
        pairs if pairs.is_empty() => {
            format!("No two parameters are correlated by {CONFOUNDED} or more: the motion separates them.")
        }
        pairs => pairs.join(" "),
    };
    let key = |(level, class): (f64, &'static str)| Key::new(class, format!("from {level}"));
    Some(Figure {
        conclusion,
        caption: format!("correlations of the estimation errors ({})", named(results, run)),
        legend: LEVELS.map(key).into_iter().chain([Key::new("negative", "negative")]).collect(),
        charts: vec![map(run)],
        notes: vec!["By the classical covariance. A pair is correlated where the torque hardly changes when one grows and the other \
                     shrinks (a negative correlation) or grows too (a positive one): their sum or their difference is known better \
                     than each of them."
            .to_owned()],
    })
}

/// The most correlated pairs, in words.
pub(in crate::report) fn confounded(run: &RunResult) -> Vec<String> {
    let rows = run.plots.correlation.iter().enumerate();
    let pairs = rows.flat_map(|(i, row)| row.iter().take(i).enumerate().map(move |(j, r)| (i, j, *r)));
    let mut pairs: Vec<(usize, usize, f64)> = pairs.filter(|(_, _, r)| r.abs() >= CONFOUNDED).collect();
    pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    let name = |i: usize| run.parameters.get(i).map_or("?", |p| p.name.as_str());
    let in_words = |(i, j, r): &(usize, usize, f64)| {
        let known = if *r < 0.0 { "sum" } else { "difference" };
        format!(
            "{} and {} are confounded (correlation {}): only their weighted {known} is known well.",
            name(*j),
            name(*i),
            fixed(*r, 2)
        )
    };
    let more = match pairs.len().saturating_sub(NAMED) {
        0 => None,
        1 => Some(format!("One more pair is correlated by {CONFOUNDED} or more.")),
        more => Some(format!("{more} more pairs are correlated by {CONFOUNDED} or more.")),
    };
    pairs.iter().take(NAMED).map(in_words).chain(more).collect()
}

/// The lower triangle, a square for each pair.
fn map(run: &RunResult) -> Chart {
    let count = run.plots.correlation.len();
    let side = (SIDE / count as f64).min(CELL);
    let mut chart = Chart::new("Correlations of pairs of parameters".to_owned(), "", WIDE);
    chart = chart.with(side * count as f64 + NAMES, |panel| Panel {
        paths: squares(&run.plots.correlation, side),
        texts: names(run, (panel.left, panel.top), side),
        left: panel.left + NAMES,
        width: panel.width - NAMES,
        ..panel
    });
    chart
}

/// One path for each level and sign.
fn squares(correlation: &[Vec<f64>], side: f64) -> Vec<Path> {
    let unit = |v: f64| (v * UNITS).round() as i64;
    let width = unit(0.92 * side);
    let of = |class: String, is_level: &dyn Fn(f64) -> bool| {
        let mut data = String::new();
        for (i, row) in correlation.iter().enumerate() {
            for (j, _) in row.iter().take(i).enumerate().filter(|(_, r)| is_level(**r)) {
                let (x, y) = (unit(j as f64 * side), unit(i as f64 * side));
                data.push_str(&format!("M{x} {y}h{width}v{width}h-{width}z"));
            }
        }
        Path { class, data }
    };
    let bounds = LEVELS.iter().map(|(level, _)| *level).skip(1).chain([f64::INFINITY]);
    let levels = LEVELS.iter().zip(bounds).flat_map(|((low, class), high)| {
        let inside = move |r: f64| (*low..high).contains(&r.abs());
        [
            of(format!("cell {class}"), &move |r| r >= 0.0 && inside(r)),
            of(format!("cell {class} negative"), &move |r| r < 0.0 && inside(r)),
        ]
    });
    levels.filter(|path| !path.data.is_empty()).collect()
}

/// Each parameter's name next to its row, at the end of which its column begins.
fn names(run: &RunResult, (left, top): (f64, f64), side: f64) -> Vec<Text> {
    let text = |(i, p): (usize, &crate::results::ParameterResult)| {
        let y = pixel(top + (i as f64 + 0.5) * side + 3.5);
        [
            Text { x: left + NAMES - 6.0, y, anchor: "end", text: p.name.clone() },
            Text { x: pixel(left + NAMES + i as f64 * side + 2.0), y, anchor: "start", text: p.name.clone() },
        ]
    };
    run.parameters.iter().take(run.plots.correlation.len()).enumerate().flat_map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lower_triangle_is_drawn_by_level_and_sign() {
        let correlation = vec![vec![1.0, 0.95, 0.1], vec![0.95, 1.0, -0.6], vec![0.1, -0.6, 1.0]];
        let paths = squares(&correlation, 20.0);
        let drawn: Vec<(&str, &str)> = paths.iter().map(|p| (p.class.as_str(), p.data.as_str())).collect();
        assert_eq!(drawn, [("cell r2 negative", "M200 400h184v184h-184z"), ("cell r4", "M0 200h184v184h-184z")]);
    }
}
