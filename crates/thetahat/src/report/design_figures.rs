//! The figures of a design.

use super::{
    figures::{Figure, Key},
    plot::{Chart, Curve, NARROW, Range, WIDE},
};
use crate::{
    results::{DesignResults, Limited},
    visible::visible,
};

const HEIGHT: f64 = 80.0;

/// Position, velocity, acceleration and torque of each joint, with its limits.
pub(super) fn motions(results: &DesignResults) -> Figure {
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

/// The criterion before and behind each search.
pub(super) fn searches(results: &DesignResults) -> Figure {
    let points = |of: fn(&crate::results::SearchResult) -> f64| -> Vec<(f64, f64)> {
        results.starts.iter().enumerate().map(|(k, s)| (1.0 + k as f64, of(s))).collect()
    };
    let [first, found] = [Curve::new("measured", points(|s| s.first)), Curve::new("idim-ls", points(|s| s.found))];
    let chart = Chart::new("criterion, nats".to_owned(), "start, the best first", WIDE)
        .with(140.0, |panel| panel.around([&first, &found].into_iter(), 1.0).dots(&first).dots(&found));
    Figure {
        caption: "the criterion of the random motions and of what the searches made of them".to_owned(),
        legend: vec![Key::new("measured", "random motion"), Key::new("idim-ls", "found")],
        charts: vec![chart],
        ..Figure::default()
    }
}
