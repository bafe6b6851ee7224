//! The step of the positions and their noise, and what the filter makes of both.

use super::{
    Code, Severity, Subject,
    examination::{Evidence, Examination},
    numbers::{rms, span},
    signals::{Signals, band_pass},
};
use crate::series::Series;

/// Noise of the acceleration by the position's steps, percent of the acceleration's rms. The clean records have at most
/// 0.3.
const STEP_LIMIT_PERCENT: f64 = 5.0;
/// Noise of the acceleration by white noise of the position, percent of the acceleration's rms. The clean records have at
/// most 0.4.
const NOISE_LIMIT_PERCENT: f64 = 10.0;
/// A sensible cut-off, in bands of the decimated rows: 5 times the dynamics' bandwidth where the rows hold twice of it.
const BANDS: f64 = 2.5;
/// Differences smaller than this part of the span are rounding.
const ROUNDING: f64 = 1e-12;
/// Deviation of a difference from a whole number of steps, in steps.
const OFF_GRID: f64 = 0.02;
/// Part of the differences that must be whole numbers of steps.
const ON_GRID: f64 = 0.9;
/// Periods of the cut-off over which the filter's response to an impulse is summed.
const PERIODS: f64 = 20.0;

pub(super) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let signal = &exam.subject.signal;
    let cutoff = signal.cutoff_hz;
    // Steps are coarse if they are so with a sensible filter; else it is the filter.
    let sensible = BANDS * 0.4 * exam.subject.sample_rate_hz / signal.decimation as f64;
    let gains = (noise_gain(exam.subject, cutoff.min(sensible)), noise_gain(exam.subject, cutoff));
    let (Some(of_steps), Some(of_noise)) = gains else { return };
    for j in (0..signals.joints()).filter(|&j| signals.moves(j)) {
        let acceleration = rms(&signals.ddq.channel(j));
        if !quantisation(exam, signals, j, of_steps / acceleration) {
            noise(exam, signals, j, of_noise / acceleration);
        }
    }
}

fn quantisation(exam: &mut Examination<'_>, signals: &Signals, j: usize, relative_gain: f64) -> bool {
    let Some(step) = step_of(&signals.raw.channel(j)) else { return false };
    let value = 100.0 * relative_gain * step / 12.0_f64.sqrt();
    let evidence = Evidence {
        code: Code::PositionQuantised,
        joint: Some(j),
        value,
        unit: "% of the acceleration",
        limit: STEP_LIMIT_PERCENT,
    };
    let cutoff = exam.subject.signal.cutoff_hz;
    exam.judge(evidence, Severity::Warning, || {
        (
            format!(
                "joint {}: the position comes in steps of {step:.3e} rad or m, which behind the filter are noise of \
                 {value:.1} % of the acceleration",
                j + 1
            ),
            format!("record the encoder's own counts, or lower the cut-off of {cutoff} Hz"),
        )
    })
}

fn noise(exam: &mut Examination<'_>, signals: &Signals, j: usize, relative_gain: f64) {
    let value = 100.0 * relative_gain * signals.noise[j];
    let evidence = Evidence {
        code: Code::CutoffHigh,
        joint: Some(j),
        value,
        unit: "% of the acceleration",
        limit: NOISE_LIMIT_PERCENT,
    };
    let cutoff = exam.subject.signal.cutoff_hz;
    exam.judge(evidence, Severity::Warning, || {
        (
            format!(
                "joint {}: behind the filter at {cutoff} Hz, {value:.0} % of the acceleration is noise of the position",
                j + 1
            ),
            "lower [signal] cutoff_hz to some five times the motion's bandwidth".to_owned(),
        )
    });
}

/// Rms acceleration behind the filter per standard deviation of white noise of the position.
fn noise_gain(subject: &Subject<'_>, cutoff_hz: f64) -> Option<f64> {
    let half = (PERIODS * subject.sample_rate_hz / cutoff_hz).ceil() as usize + 50;
    let mut impulse = Series::zeros(2 * half + 1, 1);
    impulse.values_mut()[half] = 1.0;
    let (_, _, ddq) = band_pass(subject, &impulse, cutoff_hz).ok()?;
    Some(crate::linear_algebra::norm(ddq.values()))
}

/// The step of a signal that is a whole number of steps throughout; none where it is not.
pub(super) fn step_of(x: &[f64]) -> Option<f64> {
    let smallest = ROUNDING * span(x);
    let differences = || x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > smallest);
    let step = differences().fold(f64::INFINITY, f64::min);
    let off = |d: &f64| (d / step - (d / step).round()).abs() < OFF_GRID;
    let (all, on) = (differences().count(), differences().filter(off).count());
    (all > 0 && on as f64 >= ON_GRID * all as f64).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_of_a_rounded_signal_is_found_and_a_smooth_one_has_none() {
        let wave: Vec<f64> = (0..2000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let rounded: Vec<f64> = wave.iter().map(|v| (v / 0.003).round() * 0.003).collect();
        assert!((step_of(&rounded).unwrap() - 0.003).abs() < 1e-12);
        assert_eq!(step_of(&wave), None);
        assert_eq!(step_of(&[1.0; 10]), None);
    }
}
