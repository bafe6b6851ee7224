//! Charts as the page's template draws them: panels with axes, and paths in tenths of a pixel.

mod axis;
mod chart;
mod curve;

pub(super) use axis::{Axis, Range, Tick, UNITS, pixel};
pub(super) use chart::{Chart, NARROW, Panel, Text, WIDE};
pub(super) use curve::{Area, Curve, Path};
