//! Curves and areas as paths.

use serde::Serialize;

use super::axis::{Axis, UNITS};

/// Points of a curve above which only the extremes of short stretches are drawn.
const MOST_POINTS: usize = 900;

/// A curve: the class that colours it, and its points. A value that is not a number makes a gap.
#[derive(Debug)]
pub(in crate::report) struct Curve {
    pub(in crate::report) class: String,
    pub(in crate::report) points: Vec<(f64, f64)>,
}

/// A drawn line or area, in tenths of a pixel from the corner of its panel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in crate::report) struct Path {
    pub(in crate::report) class: String,
    pub(in crate::report) data: String,
}

/// The area between two values at each position.
#[derive(Debug)]
pub(in crate::report) struct Area {
    pub(in crate::report) class: String,
    /// Position, low and high value.
    pub(in crate::report) points: Vec<(f64, [f64; 2])>,
}

impl Curve {
    pub(in crate::report) fn new(class: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { class: class.into(), points }
    }

    /// The points that can be drawn.
    pub(super) fn finite(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points.iter().copied().filter(is_finite)
    }

    /// The first point of each stretch without a gap, then the steps to the next ones.
    pub(super) fn path(&self, x: &Axis, y: &Axis) -> Path {
        let mut pen = Pen::default();
        for stretch in self.points.split(|p| !is_finite(p)) {
            let points: Vec<_> = thinned(stretch).iter().map(|p| (x.position(p.0), y.position(p.1))).collect();
            pen.line(&points);
        }
        Path { class: self.class.clone(), data: pen.data }
    }

    /// A dot at each point: lines of zero length, whose round ends keep their shape at any scale.
    pub(super) fn dots(&self, x: &Axis, y: &Axis) -> Path {
        let unit = |v: f64| (v * UNITS).round() as i64;
        let dot = |(a, b): (f64, f64)| format!("M{} {}h0", unit(x.position(a)), unit(y.position(b)));
        Path { class: format!("dots {}", self.class), data: self.finite().map(dot).collect() }
    }
}

impl Area {
    pub(super) fn path(&self, x: &Axis, y: &Axis) -> Path {
        let there = self.points.iter().map(|(at, [low, _])| (x.position(*at), y.position(*low)));
        let back = self.points.iter().rev().map(|(at, [_, high])| (x.position(*at), y.position(*high)));
        let mut pen = Pen::default();
        pen.line(&there.chain(back).collect::<Vec<_>>());
        Path { class: self.class.clone(), data: pen.data + if self.points.is_empty() { "" } else { "z" } }
    }
}

fn is_finite(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Writes lines: each starts at a position and continues in steps.
#[derive(Default)]
struct Pen {
    data: String,
}

impl Pen {
    fn line(&mut self, points: &[(f64, f64)]) {
        let unit = |position: f64| (position * UNITS).round() as i64;
        let mut last = (0, 0);
        for (k, point) in points.iter().enumerate() {
            let next = (unit(point.0), unit(point.1));
            let (dx, dy) = (next.0 - last.0, next.1 - last.1);
            let command = ["M", "l", " "][k.min(2)];
            let gap = if dy < 0 { "" } else { " " };
            self.data.push_str(&format!("{command}{dx}{gap}{dy}"));
            last = next;
        }
    }
}

/// The smallest and the largest point of each short stretch, where there are too many points.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(MOST_POINTS / 2);
    points.chunks(stretch).flat_map(extremes).collect()
}

fn extremes(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let index = |p: Option<(usize, &(f64, f64))>| p.map_or(0, |(k, _)| k);
    let low = index(points.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1)));
    let high = index(points.iter().enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1)));
    [low.min(high), low.max(high)].map(|k| points[k]).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::Range;

    fn axes() -> [Axis; 2] {
        let unit = Range { low: 0.0, high: 1.0 };
        [Axis::linear(unit, 0.0, 100.0), Axis::linear(unit, 50.0, 0.0)]
    }

    #[test]
    fn a_path_runs_from_corner_to_corner_and_breaks_at_a_gap() {
        let [x, y] = axes();
        let curve = Curve::new("didim", vec![(0.0, 0.0), (0.5, 1.0), (f64::NAN, 1.0), (0.6, 0.0), (1.0, 1.0)]);
        assert_eq!(curve.path(&x, &y).data, "M0 500l500-500M600 500l400-500");
        assert_eq!(curve.dots(&x, &y).data.matches('M').count(), 4);
    }

    #[test]
    fn an_area_returns_to_its_start() {
        let [x, y] = axes();
        let area = Area { class: "band".to_owned(), points: vec![(0.0, [0.0, 0.5]), (1.0, [0.0, 1.0])] };
        assert_eq!(area.path(&x, &y).data, "M0 500l1000 0 0-500 -1000 250z");
    }

    #[test]
    fn long_curves_keep_their_extremes() {
        let points: Vec<(f64, f64)> = (0..5000).map(|k| (f64::from(k), if k == 1234 { 9.0 } else { 0.0 })).collect();
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS && thin.contains(&(1234.0, 9.0)));
    }
}
