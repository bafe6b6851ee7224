//! Box plots on a logarithmic axis.

use crate::{
    report::plot::{Axis, Chart, Panel, Path, Tick, UNITS, WIDE, pixel},
    results::Quantiles,
};

const HEIGHT: f64 = 190.0;
/// Width of the boxes over the width of their group, and of a box over its share of that.
const GROUP: f64 = 0.7;
const BOX: f64 = 0.6;

/// A box: the classes that colour it, and its numbers, all above zero.
pub(in crate::report) struct BoxOf {
    pub(in crate::report) class: String,
    pub(in crate::report) quantiles: Quantiles,
}

/// Boxes side by side under one label.
pub(in crate::report) struct BoxGroup {
    pub(in crate::report) label: String,
    pub(in crate::report) boxes: Vec<BoxOf>,
}

/// A chart of groups of boxes: whiskers to the extremes, a box over the middle half, a line at the median.
pub(in crate::report) fn box_chart(title: String, groups: &[BoxGroup]) -> Chart {
    Chart::new(title, "noise", WIDE).with(HEIGHT, |panel| {
        let ends = groups.iter().flat_map(|g| &g.boxes).flat_map(|b| [b.quantiles.smallest, b.quantiles.largest]);
        let panel = panel.up_by_powers(ends);
        let paths = outlines(&panel, groups);
        Panel { x_ticks: under_groups(groups.iter().map(|g| g.label.as_str()), panel.width), paths, ..panel }
    })
}

/// Labels under groups of equal width.
pub(in crate::report) fn under_groups<'a>(labels: impl ExactSizeIterator<Item = &'a str>, width: f64) -> Vec<Tick> {
    let each = width / labels.len().max(1) as f64;
    labels.enumerate().map(|(i, label)| Tick { at: pixel((i as f64 + 0.5) * each), label: label.to_owned() }).collect()
}

fn outlines(panel: &Panel, groups: &[BoxGroup]) -> Vec<Path> {
    let axis = panel.y_axis();
    let width = panel.width / groups.len().max(1) as f64;
    let mut paths = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let share = GROUP * width / group.boxes.len().max(1) as f64;
        for (k, of) in group.boxes.iter().enumerate() {
            let x = (i as f64 + 0.5) * width + (k as f64 - 0.5 * (group.boxes.len() - 1) as f64) * share;
            paths.push(Path { class: of.class.clone(), data: outline(&axis, &of.quantiles, x, 0.5 * BOX * share) });
        }
    }
    paths
}

/// Whisker, box and median about `x`.
fn outline(axis: &Axis, q: &Quantiles, x: f64, half: f64) -> String {
    let unit = |v: f64| (v * UNITS).round() as i64;
    let [smallest, lower, median, upper, largest] =
        [q.smallest, q.lower, q.median, q.upper, q.largest].map(|v| unit(axis.position(v).min(axis.from)));
    let (left, x, right) = (unit(x - half), unit(x), unit(x + half));
    format!(
        "M{x} {largest}V{upper}M{left} {upper}H{right}V{lower}H{left}ZM{left} {median}H{right}M{x} {lower}V{smallest}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_stands_between_its_quartiles() {
        let quantiles = Quantiles { smallest: 1.0, lower: 2.0, median: 3.0, upper: 4.0, largest: 10.0 };
        let group =
            BoxGroup { label: "low".to_owned(), boxes: vec![BoxOf { class: "box idim-ls".to_owned(), quantiles }] };
        let chart = box_chart("distance".to_owned(), &[group]);
        let panel = &chart.panels[0];
        let axis = panel.y_axis();
        let at = |value: f64| (UNITS * axis.position(value)).round();
        let [top, upper, bottom] = [10.0, 4.0, 1.0].map(at);
        assert!(top < upper && upper < bottom, "larger values stand higher");
        assert!(panel.paths[0].data.contains(&format!(" {top}V{upper}M")), "{}", panel.paths[0].data);
        assert!(panel.paths[0].data.ends_with(&format!("V{bottom}")), "{}", panel.paths[0].data);
        assert!(panel.y_ticks.iter().any(|t| t.label == "10" && (t.at - axis.position(10.0)).abs() < 0.06));
        assert_eq!((panel.x_ticks[0].label.as_str(), panel.x_ticks[0].at), ("low", pixel(0.5 * panel.width)));
    }
}
