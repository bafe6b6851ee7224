//! Line charts: coordinates, ticks and paths of an SVG picture that the page's template draws.

use serde::Serialize;

/// Width of one of several charts, and of a chart that stands alone, pixels.
pub(super) const NARROW: f64 = 340.0;
pub(super) const WIDE: f64 = 1060.0;

/// Height of a chart and the margins around its axes, pixels.
const HEIGHT: f64 = 170.0;
const LEFT: f64 = 44.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 22.0;

/// Units of a path in a pixel: paths hold whole numbers.
const UNITS: f64 = 10.0;

/// Points of a curve above which only the extremes of short stretches are drawn.
const MOST_POINTS: usize = 1200;

/// Smallest range of values in a chart, relative to the largest one.
const SMALLEST_RANGE: f64 = 0.02;

/// A curve: the class that colours it, and its points.
#[derive(Debug)]
pub(super) struct Curve {
    class: &'static str,
    points: Vec<(f64, f64)>,
}

impl Curve {
    pub(super) fn new(class: &'static str, points: Vec<(f64, f64)>) -> Self {
        Self { class, points: points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).collect() }
    }
}

/// A chart as the template draws it; coordinates in pixels, paths in tenths of pixels.
#[derive(Debug, Serialize)]
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x_ticks: Vec<Tick>,
    pub(super) y_ticks: Vec<Tick>,
    pub(super) paths: Vec<Path>,
    pub(super) markers: Vec<Marker>,
}

#[derive(Debug, Serialize)]
pub(super) struct Tick {
    pub(super) at: f64,
    pub(super) label: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Path {
    pub(super) class: String,
    pub(super) data: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Marker {
    pub(super) class: &'static str,
    pub(super) x: f64,
    pub(super) y: f64,
}

impl Chart {
    pub(super) fn over_time(title: String, curves: &[Curve], width: f64) -> Self {
        Self::new(title, curves, width, 0.0)
    }

    /// With ticks at whole numbers, and a dot at each point.
    pub(super) fn over_iterations(title: String, curves: &[Curve]) -> Self {
        Self { markers: dots(curves, NARROW), ..Self::new(title, curves, NARROW, 1.0) }
    }

    /// With a dot at each point.
    pub(super) fn over_values(title: String, curves: &[Curve]) -> Self {
        Self { markers: dots(curves, NARROW), ..Self::new(title, curves, NARROW, 0.0) }
    }

    /// Intervals side by side above the names they belong to: low end, centre and high end of each.
    pub(super) fn of_intervals(title: String, names: &[&str], bars: &[(&'static str, Vec<Option<[f64; 3]>>)]) -> Self {
        let place = |name: usize, bar: usize| name as f64 + 0.6 * ((bar as f64 + 0.5) / bars.len().max(1) as f64 - 0.5);
        let drawn = bars.iter().enumerate().flat_map(|(b, (class, of_names))| {
            let some = of_names.iter().enumerate().filter_map(|(n, i)| Some((n, (*i)?)));
            some.map(move |(n, interval)| (*class, place(n, b), interval))
        });
        let drawn: Vec<(&'static str, f64, [f64; 3])> = drawn.collect();
        let line = |(class, x, [low, _, high]): &(&'static str, f64, [f64; 3])| {
            Curve::new(class, vec![(*x, *low), (*x, *high)])
        };
        let curves: Vec<Curve> = drawn.iter().map(line).collect();
        let axes = Axes::of(&curves, WIDE);
        let dot = |(class, x, [_, centre, _]): &(&'static str, f64, [f64; 3])| Marker {
            class,
            x: pixel(axes.x.position(*x)),
            y: pixel(axes.y.position(*centre)),
        };
        let named =
            |(n, name): (usize, &&str)| Tick { at: pixel(axes.x.position(n as f64)), label: (*name).to_owned() };
        Self {
            x_ticks: names.iter().enumerate().map(named).collect(),
            markers: drawn.iter().map(dot).collect(),
            ..Self::new(title, &curves, WIDE, 0.0)
        }
    }

    fn new(title: String, curves: &[Curve], width: f64, smallest_x_step: f64) -> Self {
        let axes = Axes::of(curves, width);
        Self {
            title,
            width,
            height: HEIGHT,
            left: LEFT,
            right: width - RIGHT,
            top: TOP,
            bottom: HEIGHT - BOTTOM,
            x_ticks: axes.x.ticks(8.0, smallest_x_step),
            y_ticks: axes.y.ticks(5.5, 0.0),
            paths: curves.iter().map(|c| axes.path(c)).collect(),
            markers: Vec::new(),
        }
    }
}

fn dots(curves: &[Curve], width: f64) -> Vec<Marker> {
    let axes = Axes::of(curves, width);
    let dot = |class, p: &(f64, f64)| Marker { class, x: pixel(axes.x.position(p.0)), y: pixel(axes.y.position(p.1)) };
    curves.iter().flat_map(|c| c.points.iter().map(move |p| (c.class, p))).map(|(c, p)| dot(c, p)).collect()
}

/// To a tenth of a pixel.
fn pixel(position: f64) -> f64 {
    (position * UNITS).round() / UNITS
}

struct Axes {
    x: Axis,
    y: Axis,
}

impl Axes {
    fn of(curves: &[Curve], width: f64) -> Self {
        let points = || curves.iter().flat_map(|c| &c.points);
        let x = Range::of(points().map(|p| p.0));
        let y = Range::of(points().map(|p| p.1)).at_least(SMALLEST_RANGE).padded(0.05);
        Self {
            x: Axis { range: x, from: LEFT, to: width - RIGHT },
            y: Axis { range: y, from: HEIGHT - BOTTOM, to: TOP },
        }
    }

    /// The first point, then the steps to the next ones.
    fn path(&self, curve: &Curve) -> Path {
        let unit = |position: f64| (position * UNITS).round() as i64;
        let mut data = String::new();
        let mut last = (0, 0);
        for (k, point) in thinned(&curve.points).iter().enumerate() {
            let next = (unit(self.x.position(point.0)), unit(self.y.position(point.1)));
            let (dx, dy) = (next.0 - last.0, next.1 - last.1);
            let command = ["M", "l", " "][k.min(2)];
            let gap = if dy < 0 { "" } else { " " };
            data.push_str(&format!("{command}{dx}{gap}{dy}"));
            last = next;
        }
        Path { class: curve.class.to_owned(), data }
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

#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// The smallest range around the values that is not a point.
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let around = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), around);
        match (low <= high, low < high) {
            (false, _) => Self { low: 0.0, high: 1.0 },
            (true, true) => Self { low, high },
            (true, false) => Self { low, high }.padded_by(if low == 0.0 { 1.0 } else { 0.1 * low.abs() }),
        }
    }

    fn padded_by(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Not below a fraction of the largest value: a curve that hardly changes looks so.
    fn at_least(self, fraction: f64) -> Self {
        let smallest = fraction * self.low.abs().max(self.high.abs());
        self.padded_by(0.5 * (smallest - (self.high - self.low)).max(0.0))
    }

    fn padded(self, fraction: f64) -> Self {
        self.padded_by(fraction * (self.high - self.low))
    }
}

/// A range of values and the pixels that it spans.
struct Axis {
    range: Range,
    from: f64,
    to: f64,
}

impl Axis {
    fn position(&self, value: f64) -> f64 {
        self.from + (value - self.range.low) / (self.range.high - self.range.low) * (self.to - self.from)
    }

    /// Round values, about as many as asked for.
    fn ticks(&self, wanted: f64, smallest_step: f64) -> Vec<Tick> {
        let step = round_step((self.range.high - self.range.low) / wanted).max(smallest_step);
        let decimals = usize::try_from(-(step.log10() + 1e-9).floor() as i32).unwrap_or(0);
        let first = (self.range.low / step).ceil() as i64;
        let last = (self.range.high / step).floor() as i64;
        let tick = |k: i64| {
            let value = k as f64 * step;
            Tick { at: pixel(self.position(value)), label: super::number::fixed(value, decimals) }
        };
        (first..=last).map(tick).collect()
    }
}

/// 1, 2 or 5 times a power of ten, not below the step asked for.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|s| *s >= step).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!([0.03, 0.7, 1.0, 3.0].map(round_step), [0.05, 1.0, 1.0, 5.0]);
    }

    #[test]
    fn a_path_starts_at_a_corner_and_ends_at_the_other() {
        let curve = Curve::new("didim", vec![(0.0, 0.0), (f64::NAN, 1.0), (2.0, 1.0)]);
        let chart = Chart::over_time(String::new(), &[curve], NARROW);
        let labels: Vec<&str> = chart.x_ticks.iter().map(|t| t.label.as_str()).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert!(chart.paths[0].data.starts_with("M440 ") && chart.paths[0].data.contains("l2820-"));
    }

    #[test]
    fn long_curves_keep_their_extremes() {
        let points: Vec<(f64, f64)> = (0..5000).map(|k| (f64::from(k), if k == 1234 { 9.0 } else { 0.0 })).collect();
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS && thin.contains(&(1234.0, 9.0)));
    }

    #[test]
    fn no_points_give_an_empty_chart() {
        assert!(Chart::over_time(String::new(), &[], WIDE).paths.is_empty());
    }
}
