//! The figures of a design.

use crate::{
    report::{
        figures::{Figure, Key, skeleton_of},
        number::significant,
        plot::{Chart, Curve, NARROW, Range, WIDE},
    },
    results::{CollisionResults, DesignResults, JointResult, Limited},
};
use thetahat_ground::visible::visible;

const HEIGHT: f64 = 80.0;
/// Smallest part of the largest density that is drawn.
const FLOOR: f64 = 1e-3;

/// Position, velocity, acceleration and torque of each joint, with its limits.
pub(in crate::report) fn motions(results: &DesignResults) -> Figure {
    let time: Vec<f64> = (0..results.q.len()).map(|k| k as f64 / results.sample_rate_hz).collect();
    let width = if results.joints.len() == 1 { WIDE } else { NARROW };
    let charts = results.joints.iter().enumerate().map(|(joint, named)| {
        let signals = [
            (Limited::Position, &results.q),
            (Limited::Velocity, &results.dq),
            (Limited::Acceleration, &results.ddq),
            (Limited::Torque, &results.torque),
        ];
        let chart = Chart::new(
            format!("{}: {}, s, {}", visible(&named.name), named.position_unit, named.torque_unit),
            "time, s",
            width,
        );
        signals.into_iter().fold(chart, |chart, (quantity, series)| {
            let curve = Curve::new("measured", time.iter().copied().zip(series.channel(joint)).collect());
            let limit = results.limits.iter().find(|l| l.coordinate == joint && l.quantity == quantity);
            chart.with(HEIGHT, |panel| {
                let limits: Vec<f64> = limit.into_iter().flat_map(|l| l.limit).collect();
                let values = curve.points.iter().map(|p| p.1).chain(limits.iter().copied());
                let panel = panel.around([&curve].into_iter(), 0.0).up(Range::of(values).padded(0.05));
                limits
                    .iter()
                    .fold(panel.line(&curve), |panel, limit| panel.level("zero", *limit))
                    .named(quantity.name())
            })
        })
    });
    Figure {
        caption: "motion of each joint between its limits".to_owned(),
        legend: vec![Key::new("measured", "motion"), Key::new("zero", "limits")],
        charts: charts.collect(),
        ..Figure::default()
    }
}

/// The robot at one instant with the path of its last joint.
pub(in crate::report) fn robot(results: &DesignResults) -> Option<Figure> {
    let nearest = results.collision.as_ref().and_then(|c| c.pairs.first()?.at_s);
    let caption = nearest.map_or_else(
        || "the robot at its start".to_owned(),
        |at_s| format!("the robot at {at_s:.3} s, where its shapes are closest"),
    );
    skeleton_of(results.skeleton.as_ref()?, &results.robot, &caption)
}

/// The spectrum of each joint's acceleration, and the bandwidths of filters and loops.
pub(in crate::report) fn spectrum(results: &DesignResults) -> Figure {
    let spectrum = &results.spectrum;
    let highest = spectrum.frequency_hz.last().copied().unwrap_or(1.0);
    let chart = |(joint, named): (usize, &JointResult)| {
        let all = spectrum.frequency_hz.iter().copied().zip(spectrum.of_joints[joint].iter().copied());
        let curve = Curve::new("measured", all.map(|(f, part)| (f, part.max(FLOOR))).collect());
        let title = format!("{}: 99 % below {} Hz", visible(&named.name), significant(spectrum.end_hz[joint], 3));
        Chart::new(title, "frequency, Hz", NARROW).with(HEIGHT, |panel| {
            let panel = panel.over(Range { low: 0.0, high: highest }, 0.0).up_by_powers([FLOOR, 1.0].into_iter());
            spectrum.bounds.iter().fold(panel.line(&curve), |panel, bound| {
                panel
                    .upright("cutoff", bound.frequency_hz.min(highest))
                    .word(bound.frequency_hz.min(highest), bound.name)
            })
        })
    };
    Figure {
        caption: "root of the spectral density of each joint's acceleration, over its maximum".to_owned(),
        legend: vec![Key::new("measured", "acceleration"), Key::new("cutoff", "bandwidths of filters and controller")],
        charts: results.joints.iter().enumerate().map(chart).collect(),
        ..Figure::default()
    }
}

/// The smallest distance of any two shapes over time.
pub(in crate::report) fn distance(collision: &CollisionResults) -> Figure {
    let curve = Curve::new("measured", collision.least.iter().map(|[t, d]| (*t, 1e3 * d)).collect());
    let chart = Chart::new("smallest distance, mm".to_owned(), "time, s", WIDE).with(HEIGHT, |panel| {
        let values = curve.points.iter().map(|p| p.1).chain([0.0, 1e3 * collision.margin]);
        let panel = panel.around([&curve].into_iter(), 0.0).up(Range::of(values).padded(0.05));
        panel.line(&curve).level("cutoff", 1e3 * collision.margin)
    });
    Figure {
        caption: "smallest distance between any two shapes over the motion".to_owned(),
        legend: vec![Key::new("measured", "smallest distance"), Key::new("cutoff", "margin")],
        charts: vec![chart],
        ..Figure::default()
    }
}

/// The criterion before and after each search.
pub(in crate::report) fn searches(results: &DesignResults) -> Figure {
    let points = |of: fn(&crate::results::SearchResult) -> f64| -> Vec<(f64, f64)> {
        results.starts.iter().enumerate().map(|(k, s)| (1.0 + k as f64, of(s))).collect()
    };
    let [first, found] = [Curve::new("measured", points(|s| s.first)), Curve::new("idim-ls", points(|s| s.found))];
    let chart = Chart::new("criterion, nats".to_owned(), "start, the best first", WIDE)
        .with(140.0, |panel| panel.around([&first, &found].into_iter(), 1.0).dots(&first).dots(&found));
    Figure {
        caption: "the criterion before and after each search".to_owned(),
        legend: vec![Key::new("measured", "random motion"), Key::new("idim-ls", "found")],
        charts: vec![chart],
        ..Figure::default()
    }
}
