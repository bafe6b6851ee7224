//! The residual over lag, frequency, velocity, position and load.

use super::figure::{Figure, Key, main_run, named};
use crate::{
    report::{
        number::significant,
        plot::{Area, Chart, Curve, NARROW, Range},
        units,
    },
    results::{Bin, JointKind, ResidualCurves, Results, RunResult},
};

const HEIGHT: f64 = 110.0;

/// Spread of a residual's mean over another quantity, relative to half of its 80 % range, above which it is reported.
const NOTABLE: f64 = 0.2;

/// Five figures of the recommended run; none without a residual or measurement.
pub(in crate::report) fn misfit(results: &Results, case: &str) -> Vec<Figure> {
    let Some(run) = main_run(results, case).filter(|r| !r.plots.residual.is_empty()) else { return Vec::new() };
    let velocity: [Over; 3] = [
        Over {
            what: "velocity",
            caption: "residual over velocity: a step or an S is friction that the model lacks",
            of: |c| &c.over_velocity,
            unit: velocity_unit,
        },
        Over {
            what: "position",
            caption: "residual over position: a wave is gravity, a spring or a cable that the model lacks",
            of: |c| &c.over_position,
            unit: position_unit,
        },
        Over {
            what: "load",
            caption: "residual over predicted torque: a slope is friction that grows with the load, or a wrong drive gain",
            of: |c| &c.over_torque,
            unit: torque_unit,
        },
    ];
    let over = velocity.iter().map(|o| o.figure(results, run));
    let all = [autocorrelation(results, run), spectrum(results, run)].into_iter().chain(over);
    all.filter(|figure| !figure.charts.is_empty()).collect()
}

fn charts(results: &Results, run: &RunResult, chart: impl Fn(usize, &ResidualCurves) -> Chart) -> Vec<Chart> {
    let curves = run.plots.residual.iter().enumerate();
    curves.filter(|(j, _)| units::has_joint(results, *j)).map(|(j, c)| chart(j, c)).collect()
}

fn autocorrelation(results: &Results, run: &RunResult) -> Figure {
    let chart = |j: usize, c: &ResidualCurves| {
        let lags = (1..).map(f64::from).zip(c.autocorrelation.iter().copied());
        let stems = lags.clone().flat_map(|(lag, r)| [(lag, 0.0), (lag, r), (f64::NAN, r)]);
        let range = Range { low: 0.0, high: c.autocorrelation.len() as f64 + 1.0 };
        let values = Range::of(c.autocorrelation.iter().copied()).with(-0.25).with(1.0);
        let band =
            Area { class: "band".to_owned(), points: [range.low, range.high].map(|x| (x, [-c.band, c.band])).into() };
        let curve = Curve::new(run.method.name(), stems.collect());
        Chart::new(units::joint(results, j), "rows apart", NARROW)
            .with(HEIGHT, |p| p.over(range, 1.0).up(values).area(&band).level("zero", 0.0).line(&curve))
    };
    let outside =
        run.plots.residual.iter().filter(|c| c.autocorrelation.first().is_some_and(|r| r.abs() > c.band)).count();
    let largest =
        run.plots.residual.iter().filter_map(|c| c.autocorrelation.first()).fold(0.0, |a: f64, r| a.max(r.abs()));
    let conclusion = match outside {
        0 => "Adjacent rows of the residual are not correlated at any joint: it looks like noise.".to_owned(),
        count => format!(
            "Adjacent rows of the residual are correlated at {count} of {} joints (up to {}): the residual is more than white noise.",
            run.plots.residual.len(),
            significant(largest, 2)
        ),
    };
    Figure {
        conclusion,
        caption: format!("autocorrelation of the residual ({})", named(results, run)),
        legend: vec![Key::new("band", "95 % of the correlations of white noise")],
        charts: charts(results, run, chart),
        ..Figure::default()
    }
}

fn spectrum(results: &Results, run: &RunResult) -> Figure {
    let cutoffs = [
        ("decimation", results.bandwidth.decimation_cutoff_hz),
        ("position filter", results.bandwidth.position_cutoff_hz),
    ];
    let end = run.plots.residual.iter().filter_map(|c| c.spectrum.last()).map(|p| p[0]).fold(0.0, f64::max);
    let chart = |j: usize, c: &ResidualCurves| {
        let curve = Curve::new(
            run.method.name(),
            c.spectrum.iter().map(|[f, d]| (*f, if *d > 0.0 { *d } else { f64::NAN })).collect(),
        );
        let title = format!("{}, ({})\u{b2}/Hz", units::joint(results, j), units::torque(results, j));
        Chart::new(title, "frequency, Hz", NARROW).with(HEIGHT, |p| {
            let panel =
                p.over(Range { low: 0.0, high: end.max(1e-9) }, 0.0).up_by_powers(c.spectrum.iter().map(|p| p[1]));
            let inside = cutoffs.iter().filter(|(_, hz)| *hz <= end);
            inside.fold(panel.line(&curve), |panel, (name, hz)| {
                panel.upright("cutoff", *hz).word(*hz, &format!("{name} {} Hz", significant(*hz, 3)))
            })
        })
    };
    let outside = cutoffs
        .iter()
        .filter(|(_, hz)| *hz > end)
        .map(|(name, hz)| format!("The cut-off of the {name}, {} Hz, is beyond the chart.", significant(*hz, 3)));
    Figure {
        caption: format!("spectral density of the residual ({})", named(results, run)),
        charts: charts(results, run, chart),
        notes: outside.collect(),
        ..Figure::default()
    }
}

/// The residual over another quantity.
struct Over {
    what: &'static str,
    caption: &'static str,
    of: fn(&ResidualCurves) -> &Vec<Bin>,
    unit: fn(&Results, usize) -> String,
}

impl Over {
    fn figure(&self, results: &Results, run: &RunResult) -> Figure {
        let method = run.method.name();
        let chart = |j: usize, c: &ResidualCurves| {
            let bins = (self.of)(c);
            let mean = Curve::new(method, bins.iter().map(|b| (b.at, b.mean)).collect());
            let spread = Area { class: "spread".to_owned(), points: bins.iter().map(|b| (b.at, b.spread)).collect() };
            let values = Range::of(bins.iter().flat_map(|b| b.spread)).symmetric().padded(0.05);
            let unit = (self.unit)(results, j);
            let title = format!("{}, {}", units::joint(results, j), units::torque(results, j));
            Chart::new(title, &format!("{}, {unit}", self.what), NARROW).with(HEIGHT, |p| {
                let x = Range::of(bins.iter().map(|b| b.at));
                p.over(x, 0.0).up(values).area(&spread).level("zero", 0.0).line(&mean).dots(&mean)
            })
        };
        Figure {
            conclusion: self.conclusion(results, run),
            caption: format!("{} ({})", self.caption, named(results, run)),
            legend: vec![Key::new(method, "mean of the residual"), Key::new("spread", "range of 80 % of the residual")],
            charts: charts(results, run, chart),
            ..Figure::default()
        }
    }

    /// The joint with the strongest dependence on this quantity, if it is strong.
    fn conclusion(&self, results: &Results, run: &RunResult) -> String {
        let parts = run.plots.residual.iter().enumerate().map(|(j, c)| (j, explained((self.of)(c))));
        match parts.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((j, part)) if part > NOTABLE => format!(
                "The residual depends most on {} at {}: its mean varies {} times as much as it scatters.",
                self.what,
                units::joint(results, j),
                significant(part, 2)
            ),
            Some(_) | None => format!("The residual depends little on the {} at every joint.", self.what),
        }
    }
}

/// The rms of the means about their own mean, over the half of the mean spread.
fn explained(bins: &[Bin]) -> f64 {
    let count = bins.len().max(1) as f64;
    let centre = bins.iter().map(|b| b.mean).sum::<f64>() / count;
    let rms = (bins.iter().map(|b| (b.mean - centre).powi(2)).sum::<f64>() / count).sqrt();
    let scatter = bins.iter().map(|b| 0.5 * (b.spread[1] - b.spread[0])).sum::<f64>() / count;
    if scatter > 0.0 { rms / scatter } else { 0.0 }
}

fn position_unit(results: &Results, joint: usize) -> String {
    match units::kind(results, joint) {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    }
    .to_owned()
}

fn velocity_unit(results: &Results, joint: usize) -> String {
    position_unit(results, joint) + "/s"
}

fn torque_unit(results: &Results, joint: usize) -> String {
    units::torque(results, joint).to_owned()
}
