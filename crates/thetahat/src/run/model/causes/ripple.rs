//! Torques that repeat with the position of a joint: `a sin(n q) + b cos(n q)` with an n that is searched for.

use super::{
    cause::Cause,
    residual::{Residual, log10_tail},
    torques::Torques,
};
use std::f64::consts::TAU;
use thetahat_ground::{number::significant, pool::in_parallel};
use thetahat_model::robot::JointKind;
use thetahat_report::results::CauseKind;

/// Least periods in a turn: links and springs have some themselves.
const LEAST: f64 = 4.0;
/// Steps of the search in the width of a peak, `2 pi` over the span of the motion.
const STEPS: f64 = 4.0;
/// Most steps.
const MOST_STEPS: usize = 3000;
/// Least part of the rows in which the filter passes a ripple.
const PASSED: f64 = 0.25;
/// log10 of the probability above which nothing is looked at more closely.
const LOOKED_AT: f64 = -4.0;
/// Neighbours of a step on either side that are tried, in one step.
const NEIGHBOURS: i32 = 8;
/// Determinant over the product of the squares of sine and cosine below which the rows hold one phase alone.
const SINGULAR: f64 = 1e-6;

/// Position, speed and whitened residual in a row of a joint.
struct Row {
    position: f64,
    speed: f64,
    rest: f64,
}

/// The strongest ripple of a joint.
struct Ripple {
    /// `n`.
    per_unit: f64,
    searched: usize,
}

impl Torques<'_> {
    /// The strongest ripple of each joint whose residual shows one.
    pub(super) fn ripples(&self, residual: &Residual, threads: usize) -> Vec<Cause> {
        let found = in_parallel(self.joints(), threads, |j| self.ripple(residual, j));
        found.into_iter().flatten().collect()
    }

    fn ripple(&self, residual: &Residual, joint: usize) -> Option<Cause> {
        let cutoff_hz = self.identification.setup().settings.signal.cutoff_hz;
        let Ripple { per_unit, searched } = strongest(&self.rows(residual, joint), TAU * cutoff_hz)?;
        let column = |of: fn(f64) -> f64| {
            self.each(|r, k, j| if j == joint { of(per_unit * r.motion.q.sample(k)[joint]) } else { 0.0 })
        };
        let columns = vec![column(f64::sin)?, column(f64::cos)?];
        let periods = match self.kind(joint) {
            JointKind::Revolute => format!("{} periods a turn", significant(per_unit, 3)),
            JointKind::Prismatic => format!("{} periods a metre", significant(per_unit / TAU, 3)),
        };
        let subject = format!("joint {}, {periods}", joint + 1);
        let (kind, members) = (CauseKind::TorqueRipple, Vec::new());
        Some(Cause { kind, subject, unit: "", columns, instrument: None, members, searched })
    }

    fn rows(&self, residual: &Residual, joint: usize) -> Vec<Row> {
        let recordings = self.recordings().zip(&self.tested.all.decimators).enumerate();
        let of_recording = recordings.flat_map(|(index, (recording, decimator))| {
            let rest = &residual.rest[residual.layout.block(joint, index)];
            let samples = decimator.kept().step_by(self.tested.step);
            let motion = &recording.motion;
            samples.zip(rest).map(move |(k, rest)| Row {
                position: motion.q.sample(k)[joint],
                speed: motion.dq.sample(k)[joint].abs(),
                rest: *rest,
            })
        });
        of_recording.filter(|row| row.rest != 0.0).collect()
    }
}

/// The ripple that explains most of the residual; none if chance explains it, or the filter leaves none.
fn strongest(rows: &[Row], cutoff: f64) -> Option<Ripple> {
    let positions = || rows.iter().map(|row| row.position);
    let span = positions().fold(f64::NEG_INFINITY, f64::max) - positions().fold(f64::INFINITY, f64::min);
    let mut speeds: Vec<f64> = rows.iter().map(|row| row.speed).collect();
    speeds.sort_by(f64::total_cmp);
    let passed_speed = speeds.get((PASSED * speeds.len() as f64) as usize)?;
    let step = TAU / (STEPS * span);
    let least = LEAST.max(TAU / span);
    let searched = (((cutoff / passed_speed - least) / step) as usize).min(MOST_STEPS);
    let explained = explained_on_grid(rows, cutoff, least, step, searched);
    let (best, most) = explained.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_seen = log10_tail(most, 2)? + (searched as f64).log10() < LOOKED_AT;
    is_seen.then(|| Ripple { per_unit: refined(rows, cutoff, least + best as f64 * step, step), searched })
}

/// What each of the ripples `least + i step` explains of the squared residual.
fn explained_on_grid(rows: &[Row], cutoff: f64, least: f64, step: f64, count: usize) -> Vec<f64> {
    // Sine and cosine of a phase grow from step to step by a rotation.
    let of = |per_unit: f64| rows.iter().map(|row| (per_unit * row.position).sin_cos()).collect::<Vec<_>>();
    let (mut phases, turns) = (of(least), of(step));
    let explained = (0..count).map(|i| {
        let per_unit = least + i as f64 * step;
        let mut sums = Sums::default();
        for ((row, phase), turn) in rows.iter().zip(&mut phases).zip(&turns) {
            if per_unit * row.speed < cutoff {
                sums.add(row.rest, *phase);
            }
            *phase = (phase.0 * turn.1 + phase.1 * turn.0, phase.1 * turn.1 - phase.0 * turn.0);
        }
        sums.explained()
    });
    explained.collect()
}

/// The best of the neighbours of a step of the grid.
fn refined(rows: &[Row], cutoff: f64, per_unit: f64, step: f64) -> f64 {
    let explained = |n: f64| {
        let mut sums = Sums::default();
        let passed = rows.iter().filter(|row| n * row.speed < cutoff);
        passed.for_each(|row| sums.add(row.rest, (n * row.position).sin_cos()));
        sums.explained()
    };
    let neighbours = (-NEIGHBOURS..=NEIGHBOURS).map(|i| per_unit + f64::from(i) / f64::from(NEIGHBOURS) * step);
    neighbours.map(|n| (n, explained(n))).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(per_unit, |best| best.0)
}

/// The normal equations of a sine and a cosine.
#[derive(Default)]
struct Sums {
    sine: f64,
    cosine: f64,
    sine_sine: f64,
    sine_cosine: f64,
    cosine_cosine: f64,
}

impl Sums {
    fn add(&mut self, rest: f64, (sine, cosine): (f64, f64)) {
        self.sine += rest * sine;
        self.cosine += rest * cosine;
        self.sine_sine += sine * sine;
        self.sine_cosine += sine * cosine;
        self.cosine_cosine += cosine * cosine;
    }

    fn explained(&self) -> f64 {
        let determinant = self.sine_sine * self.cosine_cosine - self.sine_cosine.powi(2);
        let square = self.cosine_cosine * self.sine.powi(2) - 2.0 * self.sine_cosine * self.sine * self.cosine
            + self.sine_sine * self.cosine.powi(2);
        if determinant > SINGULAR * self.sine_sine * self.cosine_cosine { square / determinant } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two radians back and forth in 4000 rows, with a residual of unit deviation.
    fn rows(ripple: impl Fn(f64) -> f64) -> Vec<Row> {
        let row = |k: usize| {
            let t = k as f64 / 4000.0;
            let position = (40.0 * t).sin() + 0.3 * (97.0 * t).sin();
            let noise = 3.4 * (((k as f64 + 0.5) * 12.9898).sin() * 43758.5453).fract();
            Row { position, speed: 1.0, rest: 0.5 * noise + ripple(position) }
        };
        (0..4000).map(row).collect()
    }

    #[test]
    fn a_ripple_is_found_with_its_periods() {
        let found = strongest(&rows(|q| 0.3 * (37.3 * q + 0.5).sin()), 100.0).unwrap();
        assert!((found.per_unit / 37.3 - 1.0).abs() < 0.01, "{}", found.per_unit);
    }

    /// 150 periods in a unit of the position are above the cut-off of 100.
    #[test]
    fn noise_and_what_the_filter_stops_are_no_ripple() {
        assert!(strongest(&rows(|_| 0.0), 100.0).is_none());
        assert!(strongest(&rows(|q| 0.3 * (150.0 * q).sin()), 100.0).is_none());
    }

    /// The sums are those of least squares.
    #[test]
    fn a_ripple_alone_is_explained_whole() {
        let rows: Vec<Row> =
            rows(|_| 0.0).into_iter().map(|r| Row { rest: 2.0 * (9.0 * r.position).cos(), ..r }).collect();
        let explained = explained_on_grid(&rows, 100.0, 8.0, 0.5, 5);
        let square: f64 = rows.iter().map(|r| r.rest * r.rest).sum();
        assert!((explained[2] / square - 1.0).abs() < 1e-9 && explained.iter().all(|e| *e <= square * (1.0 + 1e-9)));
    }
}
