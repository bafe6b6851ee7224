//! A picture of the robot: its frames in the mean pose, and the path of the last frame.

use super::figure::{Figure, Key};
use crate::{
    report::plot::{Axis, Chart, Curve, Panel, Range, Text, pixel},
    results::{Results, Skeleton},
};

const WIDTH: f64 = 260.0;
const HEIGHT: f64 = 220.0;
/// Length of the axis marks, of the size of the picture.
const AXIS: f64 = 0.07;
/// View direction: azimuth from the horizontal x axis and elevation above the horizon, rad.
const AZIMUTH: f64 = 0.9;
const ELEVATION: f64 = 0.35;

/// The robot of an identification.
pub(in crate::report) fn skeleton(results: &Results) -> Option<Figure> {
    skeleton_of(results.plots.skeleton.as_ref()?, &results.robot, "the robot in its mean pose")
}

/// None if the robot has no extent.
pub(in crate::report) fn skeleton_of(skeleton: &Skeleton, robot: &str, caption: &str) -> Option<Figure> {
    let view = View::onto(skeleton.gravity);
    let points: Vec<[f64; 3]> = [[0.0; 3]]
        .into_iter()
        .chain(skeleton.frames.iter().map(|f| f.origin))
        .chain(skeleton.tool_path.iter().copied())
        .collect();
    let size = extent(&points);
    (size > 0.0).then(|| Figure {
        caption: caption.to_owned(),
        legend: vec![
            Key::new("link", "links"),
            Key::new("joint-axis", "joint axes"),
            Key::new("tool", "path of the last joint"),
        ],
        charts: vec![Chart::new(robot.to_owned(), "", WIDTH).with(HEIGHT, |p| draw(p, skeleton, (&view, size)))],
        notes: vec![
            "Joints in the frames of the description, straight lines between them; down is the direction of gravity."
                .to_owned(),
        ],
        ..Figure::default()
    })
}

/// The largest side of a box around points.
fn extent(points: &[[f64; 3]]) -> f64 {
    let side = |i: usize| {
        let range = Range::of(points.iter().map(|p| p[i]));
        if points.iter().all(|p| p[i] == points[0][i]) { 0.0 } else { range.high - range.low }
    };
    [0, 1, 2].map(side).into_iter().fold(0.0, f64::max)
}

fn draw(panel: Panel, skeleton: &Skeleton, (view, size): (&View, f64)) -> Panel {
    let seen = |p: [f64; 3]| view.of(p);
    let gap = (f64::NAN, f64::NAN);
    let link = |f: &crate::results::Frame| {
        let from = f.parent.map_or([0.0; 3], |p| skeleton.frames[p].origin);
        [seen(from), seen(f.origin), gap]
    };
    let along =
        |f: &crate::results::Frame, way: f64| [0, 1, 2].map(|i: usize| f.origin[i] + way * AXIS * size * f.axis[i]);
    let links = Curve::new("link", skeleton.frames.iter().flat_map(link).collect());
    let axes = skeleton.frames.iter().flat_map(|f| [seen(along(f, -1.0)), seen(along(f, 1.0)), gap]);
    let axes = Curve::new("joint-axis", axes.collect());
    let joints = Curve::new("joint", skeleton.frames.iter().map(|f| seen(f.origin)).collect());
    let base = Curve::new("base", vec![seen([0.0; 3])]);
    let way = Curve::new("tool", skeleton.tool_path.iter().map(|p| seen(*p)).collect());
    let all = [&links, &axes, &way, &base];
    let panel = square(panel, &all);
    let numbers = numbers(&panel, &joints);
    let panel = panel.line(&way).line(&links).line(&axes).dots(&base).dots(&joints);
    Panel { texts: numbers, ..panel }
}

/// Axes of one scale about the middle of the curves.
fn square(panel: Panel, curves: &[&Curve]) -> Panel {
    let points = || curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite());
    let [x, y] = [Range::of(points().map(|p| p.0)), Range::of(points().map(|p| p.1))];
    let scale = 1.1 * ((x.high - x.low) / panel.width).max((y.high - y.low) / panel.height);
    let about = |r: Range, pixels: f64| {
        let (middle, half) = (0.5 * (r.low + r.high), 0.5 * scale * pixels);
        [middle - half, middle + half]
    };
    let (left, width) = (8.0, WIDTH - 16.0);
    Panel { x: about(x, width), y: about(y, panel.height), left, width, ..panel }
}

/// The numbers of the joints; joints at the same position share a label.
fn numbers(panel: &Panel, joints: &Curve) -> Vec<Text> {
    let (x_axis, y_axis): (Axis, Axis) = (panel.x_axis(), panel.y_axis());
    let mut texts: Vec<Text> = Vec::new();
    for (k, (x, y)) in joints.points.iter().enumerate() {
        let (x, y) = (pixel(panel.left + x_axis.position(*x) + 7.0), pixel(panel.top + y_axis.position(*y) - 4.0));
        let number = (k + 1).to_string();
        match texts.iter_mut().find(|t| (t.x - x).abs() < 9.0 && (t.y - y).abs() < 9.0) {
            Some(text) => text.text = format!("{} {number}", text.text),
            None => texts.push(Text { x, y, anchor: "start", text: number }),
        }
    }
    texts
}

/// The directions of a view: to the right, and up.
struct View {
    right: [f64; 3],
    up: [f64; 3],
}

impl View {
    /// With gravity down, or z up without gravity.
    fn onto(gravity: [f64; 3]) -> Self {
        let size = dot(gravity, gravity).sqrt();
        let up = if size > 0.0 { gravity.map(|g| -g / size) } else { [0.0, 0.0, 1.0] };
        let helper = if up[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let along = dot(helper, up);
        let flat = [0, 1, 2].map(|i: usize| helper[i] - along * up[i]);
        let x = flat.map(|v| v / dot(flat, flat).sqrt());
        let y = cross(up, x);
        let mix = |a: f64, b: f64| [0, 1, 2].map(|i: usize| a * x[i] + b * y[i]);
        let towards = mix(AZIMUTH.cos(), AZIMUTH.sin());
        let lifted = [0, 1, 2].map(|i: usize| ELEVATION.cos() * up[i] - ELEVATION.sin() * towards[i]);
        Self { right: mix(-AZIMUTH.sin(), AZIMUTH.cos()), up: lifted }
    }

    fn of(&self, p: [f64; 3]) -> (f64, f64) {
        (dot(self.right, p), dot(self.up, p))
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_above_is_drawn_above_whatever_way_gravity_points() {
        for gravity in [[0.0, 0.0, -9.81], [9.81, 0.0, 0.0], [0.0, 0.0, 0.0]] {
            let view = View::onto(gravity);
            let size = dot(gravity, gravity).sqrt();
            let up = if size > 0.0 { gravity.map(|g| -g / size) } else { [0.0, 0.0, 1.0] };
            let (right, above) = view.of(up);
            assert!(right.abs() < 1e-12 && (above - ELEVATION.cos()).abs() < 1e-12, "{gravity:?}");
            assert!((dot(view.right, view.right) - 1.0).abs() < 1e-12 && dot(view.right, view.up).abs() < 1e-12);
        }
    }
}
