//! Box plots on a logarithmic axis.

use super::{
    number::significant,
    plot::{Chart, Marker, Path, Tick, WIDE},
};
use crate::results::Quantiles;

const HEIGHT: f64 = 230.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 8.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 22.0;
/// Units of a path in a pixel.
const UNITS: f64 = 10.0;
/// Part of a group's width that its boxes take, and of a box's place that the box takes.
const GROUP: f64 = 0.7;
const BOX: f64 = 0.6;
/// Smallest extent of the axis, in powers of ten.
const SMALLEST_EXTENT: f64 = 0.2;

/// A box: the classes that colour it, and its numbers, all above zero.
pub(super) struct BoxOf {
    pub(super) class: String,
    pub(super) quantiles: Quantiles,
}

/// Boxes side by side under one label.
pub(super) struct BoxGroup {
    pub(super) label: String,
    pub(super) boxes: Vec<BoxOf>,
}

/// A chart of groups of boxes: whiskers to the extremes, a box over the middle half, a line at the median.
pub(super) fn box_chart(title: String, groups: &[BoxGroup]) -> Chart {
    let axis = LogAxis::of(groups);
    let width = (WIDE - LEFT - RIGHT) / groups.len().max(1) as f64;
    let centre = |i: usize| LEFT + (i as f64 + 0.5) * width;
    let mut paths = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let place = GROUP * width / group.boxes.len().max(1) as f64;
        for (k, of) in group.boxes.iter().enumerate() {
            let x = centre(i) + (k as f64 - 0.5 * (group.boxes.len() - 1) as f64) * place;
            paths.push(Path { class: of.class.clone(), data: outline(&axis, &of.quantiles, x, 0.5 * BOX * place) });
        }
    }
    Chart {
        title,
        width: WIDE,
        height: HEIGHT,
        left: LEFT,
        right: WIDE - RIGHT,
        top: TOP,
        bottom: HEIGHT - BOTTOM,
        x_ticks: groups.iter().enumerate().map(|(i, g)| Tick { at: centre(i), label: g.label.clone() }).collect(),
        y_ticks: axis.ticks(),
        paths,
        markers: Vec::<Marker>::new(),
    }
}

/// Whisker, box and median about `x`.
fn outline(axis: &LogAxis, q: &Quantiles, x: f64, half: f64) -> String {
    let unit = |v: f64| (v * UNITS).round() as i64;
    let [smallest, lower, median, upper, largest] =
        [q.smallest, q.lower, q.median, q.upper, q.largest].map(|v| unit(axis.position(v)));
    let (left, x, right) = (unit(x - half), unit(x), unit(x + half));
    format!(
        "M{x} {largest}V{upper}M{left} {upper}H{right}V{lower}H{left}ZM{left} {median}H{right}M{x} {lower}V{smallest}"
    )
}

/// A logarithmic axis from the bottom to the top.
struct LogAxis {
    low: f64,
    high: f64,
}

impl LogAxis {
    fn of(groups: &[BoxGroup]) -> Self {
        let values = groups.iter().flat_map(|g| &g.boxes).flat_map(|b| [b.quantiles.smallest, b.quantiles.largest]);
        let logs = values.filter(|v| *v > 0.0).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if !low.is_finite() {
            return Self { low: 0.0, high: 1.0 };
        }
        let missing = 0.5 * (SMALLEST_EXTENT - (high - low)).max(0.0) + 0.04 * (high - low);
        Self { low: low - missing, high: high + missing }
    }

    fn position(&self, value: f64) -> f64 {
        let place = (value.max(f64::MIN_POSITIVE).log10() - self.low) / (self.high - self.low);
        HEIGHT - BOTTOM - place.max(0.0) * (HEIGHT - BOTTOM - TOP)
    }

    /// Powers of ten, with what is between them where there are few.
    fn ticks(&self) -> Vec<Tick> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let steps: &[i32] = match self.high - self.low {
            e if e > 3.0 => &[1],
            e if e > 1.0 => &[1, 2, 5],
            _ => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
        };
        let values = decades.flat_map(|d| steps.iter().map(move |s| f64::from(*s) * 10_f64.powi(d)));
        let inside = values.filter(|v| (self.low..=self.high).contains(&v.log10()));
        inside.map(|v| Tick { at: self.position(v), label: significant(v, 1) }).collect()
    }
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
        let axis = LogAxis { low: 0.0 - 0.04, high: 1.04 };
        let top = (UNITS * axis.position(10.0)).round();
        assert!(chart.paths[0].data.contains(&format!(" {top}V")), "{}", chart.paths[0].data);
        assert!(chart.y_ticks.iter().any(|t| t.label == "10" && (t.at - axis.position(10.0)).abs() < 1e-9));
        assert_eq!(chart.x_ticks[0].label, "low");
    }
}
