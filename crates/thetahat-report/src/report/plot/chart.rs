//! Charts: panels above one another, each with its axes.

use serde::Serialize;

use super::{
    axis::{Axis, Range, Scale, Tick, pixel},
    curve::{Area, Curve, Path},
};
use crate::report::wrap::shortened;

/// Width of one of several charts, and of a single chart, pixels.
pub(in crate::report) const NARROW: f64 = 380.0;
pub(in crate::report) const WIDE: f64 = 760.0;

/// Margins around the panels, pixels.
const LEFT: f64 = 46.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 36.0;
const BOTTOM: f64 = 32.0;
/// Space between two panels.
const GAP: f64 = 17.0;
/// Distance of words above their panel, pixels: inside they would hide curves.
const ABOVE: f64 = 4.0;
/// Width of a letter of such words, pixels, rather too wide than too narrow.
const LETTER: f64 = 6.5;

/// Smallest range of values in a panel, relative to the largest one.
const SMALLEST_RANGE: f64 = 0.02;
/// Pixels for each tick.
const X_TICK: f64 = 55.0;
const Y_TICK: f64 = 24.0;
/// Fewest ticks from the lower to the upper end.
const FEWEST: f64 = 3.4;

/// A chart as the template draws it; coordinates in pixels.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Chart {
    pub(in crate::report) title: String,
    /// The quantity from left to right.
    pub(in crate::report) x_name: String,
    pub(in crate::report) width: f64,
    pub(in crate::report) height: f64,
    pub(in crate::report) panels: Vec<Panel>,
    /// Whether the script may stretch it from left to right.
    pub(in crate::report) zooms: bool,
}

/// A pair of axes with its curves; paths in tenths of a pixel from its corner.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Panel {
    pub(in crate::report) left: f64,
    pub(in crate::report) top: f64,
    pub(in crate::report) width: f64,
    pub(in crate::report) height: f64,
    /// Values at the left and right end, and at the lower and upper end.
    pub(in crate::report) x: [f64; 2],
    pub(in crate::report) y: [f64; 2],
    pub(in crate::report) x_scale: Scale,
    pub(in crate::report) y_scale: Scale,
    pub(in crate::report) x_ticks: Vec<Tick>,
    pub(in crate::report) y_ticks: Vec<Tick>,
    pub(in crate::report) paths: Vec<Path>,
    pub(in crate::report) texts: Vec<Text>,
}

/// A word at a panel, in pixels from the chart's corner.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Text {
    pub(in crate::report) x: f64,
    pub(in crate::report) y: f64,
    pub(in crate::report) anchor: &'static str,
    pub(in crate::report) text: String,
}

impl Chart {
    pub(in crate::report) fn new(title: String, x_name: &str, width: f64) -> Self {
        Self { title, x_name: x_name.to_owned(), width, height: TOP + BOTTOM, panels: Vec::new(), zooms: false }
    }

    /// The same for the script to stretch.
    pub(in crate::report) fn zooming(self) -> Self {
        Self { zooms: true, ..self }
    }

    /// Adds a panel below the others. It has the ticks of the first one.
    pub(in crate::report) fn with(mut self, height: f64, build: impl FnOnce(Panel) -> Panel) -> Self {
        let gap = if self.panels.is_empty() { 0.0 } else { GAP };
        let top = self.height - BOTTOM + gap;
        self.panels.push(build(Panel::at(top, self.width, height)));
        self.height = top + height + BOTTOM;
        self
    }
}

impl Panel {
    fn at(top: f64, width: f64, height: f64) -> Self {
        Self {
            left: LEFT,
            top,
            width: width - LEFT - RIGHT,
            height,
            x: [0.0, 1.0],
            y: [0.0, 1.0],
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            x_ticks: Vec::new(),
            y_ticks: Vec::new(),
            paths: Vec::new(),
            texts: Vec::new(),
        }
    }

    /// Axes that contain the curves; `step` is the smallest one between ticks from left to right.
    pub(in crate::report) fn around<'c>(self, curves: impl Iterator<Item = &'c Curve> + Clone, step: f64) -> Self {
        let points = curves.flat_map(Curve::finite);
        let x = Range::of(points.clone().map(|p| p.0));
        let y = Range::of(points.map(|p| p.1)).at_least(SMALLEST_RANGE).padded(0.05);
        self.over(x, step).up(y)
    }

    /// The axis from left to right.
    pub(in crate::report) fn over(mut self, x: Range, step: f64) -> Self {
        (self.x, self.x_scale) = ([x.low, x.high], Scale::Linear);
        self.x_ticks = self.x_axis().ticks(self.width / X_TICK, step);
        self
    }

    /// The same by powers of ten.
    pub(in crate::report) fn over_by_powers(mut self, values: impl Iterator<Item = f64>) -> Self {
        let Range { low, high } = Axis::logarithmic(values, 0.0, self.width).range;
        (self.x, self.x_scale) = ([low, high], Scale::Logarithmic);
        self.x_ticks = self.x_axis().ticks(self.width / X_TICK, 0.0);
        self
    }

    /// The axis from the lower to the upper end.
    pub(in crate::report) fn up(mut self, y: Range) -> Self {
        (self.y, self.y_scale) = ([y.low, y.high], Scale::Linear);
        self.y_ticks = self.y_axis().ticks((self.height / Y_TICK).max(FEWEST), 0.0);
        self
    }

    /// The same by powers of ten.
    pub(in crate::report) fn up_by_powers(mut self, values: impl Iterator<Item = f64>) -> Self {
        let Range { low, high } = Axis::logarithmic(values, self.height, 0.0).range;
        (self.y, self.y_scale) = ([low, high], Scale::Logarithmic);
        self.y_ticks = self.y_axis().ticks(self.height / Y_TICK, 0.0);
        self
    }

    /// The axes in pixels from the panel's corner.
    pub(in crate::report) fn x_axis(&self) -> Axis {
        Axis { range: Range { low: self.x[0], high: self.x[1] }, scale: self.x_scale, from: 0.0, to: self.width }
    }

    pub(in crate::report) fn y_axis(&self) -> Axis {
        Axis { range: Range { low: self.y[0], high: self.y[1] }, scale: self.y_scale, from: self.height, to: 0.0 }
    }

    pub(in crate::report) fn line(mut self, curve: &Curve) -> Self {
        self.paths.push(curve.path(&self.x_axis(), &self.y_axis()));
        self
    }

    pub(in crate::report) fn lines<'c>(self, curves: impl IntoIterator<Item = &'c Curve>) -> Self {
        curves.into_iter().fold(self, Self::line)
    }

    pub(in crate::report) fn dots(mut self, curve: &Curve) -> Self {
        self.paths.push(curve.dots(&self.x_axis(), &self.y_axis()));
        self
    }

    pub(in crate::report) fn area(mut self, area: &Area) -> Self {
        self.paths.push(area.path(&self.x_axis(), &self.y_axis()));
        self
    }

    /// A line from top to bottom at a value.
    pub(in crate::report) fn upright(mut self, class: &str, at: f64) -> Self {
        let unit = |v: f64| (v * super::axis::UNITS).round() as i64;
        let x = unit(self.x_axis().position(at));
        self.paths.push(Path { class: class.to_owned(), data: format!("M{x} 0v{}", unit(self.height)) });
        self
    }

    /// A word above the panel, next to a value of the axis from left to right.
    pub(in crate::report) fn word(mut self, at: f64, word: &str) -> Self {
        let x = self.x_axis().position(at);
        let (anchor, dx) = if x > 0.6 * self.width { ("end", -3.0) } else { ("start", 3.0) };
        let (x, y) = (pixel(self.left + x + dx), pixel(self.top - ABOVE));
        self.texts.push(Text { x, y, anchor, text: word.to_owned() });
        self
    }

    /// A name above the panel, starting at a value of the axis, shortened before another value.
    pub(in crate::report) fn name_between(mut self, [from, to]: [f64; 2], name: &str) -> Self {
        const GAP: f64 = 3.0;
        let [x, end] = [from, to].map(|at| self.x_axis().position(at).min(self.width));
        let letters = ((end - x - 2.0 * GAP) / LETTER).max(1.0) as usize;
        let (x, y) = (pixel(self.left + x + GAP), pixel(self.top - ABOVE));
        self.texts.push(Text { x, y, anchor: "start", text: shortened(name, letters) });
        self
    }

    /// A line from left to right at a value.
    pub(in crate::report) fn level(mut self, class: &str, at: f64) -> Self {
        let unit = |v: f64| (v * super::axis::UNITS).round() as i64;
        let y = unit(self.y_axis().position(at));
        self.paths.push(Path { class: class.to_owned(), data: format!("M0 {y}h{}", unit(self.width)) });
        self
    }

    /// A label above the upper right corner of the panel.
    pub(in crate::report) fn named(mut self, name: &str) -> Self {
        let (x, y) = (pixel(self.left + self.width), pixel(self.top - ABOVE));
        self.texts.push(Text { x, y, anchor: "end", text: name.to_owned() });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_stacked_over_the_same_axis() {
        let curve = Curve::new("didim", vec![(0.0, 0.0), (2.0, 1.0)]);
        let range = Range { low: 0.0, high: 2.0 };
        let chart = Chart::new("Joint 1".to_owned(), "time, s", NARROW)
            .with(100.0, |p| p.around([&curve].into_iter(), 0.0).line(&curve))
            .with(50.0, |p| p.over(range, 0.0).level("zero", 0.5));
        let [upper, lower] = &chart.panels[..] else { panic!("{chart:?}") };
        assert!((upper.left, upper.width, upper.x) == (lower.left, lower.width, lower.x));
        assert!(lower.top >= upper.top + upper.height && chart.height > lower.top + lower.height);
        let labels: Vec<&str> = upper.x_ticks.iter().map(|t| t.label.as_str()).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(lower.paths[0].data, "M0 250h3240");
    }

    #[test]
    fn a_name_ends_before_the_next_value() {
        let range = Range { low: 0.0, high: 10.0 };
        let long = "a recording with a long name";
        let chart = Chart::new(String::new(), "", NARROW)
            .with(50.0, |p| p.over(range, 0.0).name_between([8.0, 9.5], long).name_between([9.5, 10.0], "b"));
        let panel = &chart.panels[0];
        let [first, second] = &panel.texts[..] else { panic!("{panel:?}") };
        assert_eq!((first.anchor, second.anchor, second.text.as_str()), ("start", "start", "b"));
        assert!(first.text.starts_with("a rec") && first.text.ends_with('…'), "{}", first.text);
        assert!(first.x + LETTER * first.text.chars().count() as f64 <= second.x, "{first:?} {second:?}");
    }

    #[test]
    fn no_points_give_an_empty_panel() {
        let chart = Chart::new(String::new(), "", WIDE).with(50.0, |p| p.around([].into_iter(), 0.0));
        assert!(chart.panels[0].paths.is_empty() && chart.panels[0].y == [-0.05, 1.05]);
    }
}
