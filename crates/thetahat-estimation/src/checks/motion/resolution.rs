//! Quantisation and noise of the positions, after the filter.

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::{rms, step_of},
        signals::Signals,
        subject::Subject,
    },
    signal::{Derivative, band_pass},
};
use thetahat_ground::series::Series;

/// Noise of the acceleration by the position's steps, percent of the acceleration's rms. The clean recordings have at most
/// 0.3.
const STEP_LIMIT_PERCENT: f64 = 5.0;
/// Noise of the acceleration by white noise of the position, percent of the acceleration's rms. The clean recordings have at
/// most 0.4.
const NOISE_LIMIT_PERCENT: f64 = 10.0;
/// A sensible cut-off, relative to the band of the decimated rows: 5 times the dynamics' bandwidth if the rows keep twice it.
const BANDS: f64 = 2.5;
/// Periods of the cut-off over which the filter's impulse response is summed.
const PERIODS: f64 = 20.0;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let signal = &exam.subject.signal;
    let cutoff = signal.cutoff_hz;
    // Steps are coarse if they are so with a sensible filter; otherwise the filter is at fault.
    let sensible = BANDS * 0.4 * exam.subject.sample_rate_hz / signal.decimation as f64;
    let gains = (noise_gain(exam.subject, cutoff.min(sensible)), noise_gain(exam.subject, cutoff));
    let (Some(step_gain), Some(white_noise_gain)) = gains else { return };
    for j in (0..signals.coordinates()).filter(|&j| signals.moves(j)) {
        let acceleration = rms(&signals.ddq.channel(j));
        if !quantisation(exam, signals, j, step_gain / acceleration) {
            noise(exam, signals, j, white_noise_gain / acceleration);
        }
    }
}

fn quantisation(exam: &mut Examination<'_>, signals: &Signals, j: usize, relative_gain: f64) -> bool {
    let Some(step) = step_of(&signals.raw.channel(j)) else { return false };
    let value = 100.0 * relative_gain * step / 12.0_f64.sqrt();
    let evidence = Evidence {
        code: Code::PositionQuantised,
        coordinate: Some(j),
        value,
        unit: "% of the acceleration",
        limit: STEP_LIMIT_PERCENT,
    };
    let (cutoff, number) = (exam.subject.signal.cutoff_hz, exam.subject.joint_number(j));
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!(
                "joint {number}: the position has steps of {step:.3e} rad or m; after the filter they make {value:.1} % noise \
                 in the acceleration"
            ),
            format!("record the encoder's own counts, or lower the cut-off of {cutoff} Hz"),
        )
    })
}

fn noise(exam: &mut Examination<'_>, signals: &Signals, j: usize, relative_gain: f64) {
    let value = 100.0 * relative_gain * signals.noise[j];
    let evidence = Evidence {
        code: Code::CutoffHigh,
        coordinate: Some(j),
        value,
        unit: "% of the acceleration",
        limit: NOISE_LIMIT_PERCENT,
    };
    let (cutoff, number) = (exam.subject.signal.cutoff_hz, exam.subject.joint_number(j));
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!(
                "joint {number}: after the filter at {cutoff} Hz, {value:.0} % of the acceleration is noise of the position"
            ),
            "lower [signal] cutoff_hz to about five times the motion's bandwidth",
        )
    });
}

/// Rms acceleration after the filter per standard deviation of white noise of the position.
fn noise_gain(subject: &Subject<'_>, cutoff_hz: f64) -> Option<f64> {
    let half = (PERIODS * subject.sample_rate_hz / cutoff_hz).ceil() as usize + 50;
    let mut impulse = Series::zeros(2 * half + 1, 1);
    impulse.values_mut()[half] = 1.0;
    let motion =
        band_pass(&impulse, subject.sample_rate_hz, subject.signal.filter_order, cutoff_hz, Derivative::Central)
            .ok()?;
    Some(thetahat_ground::linear_algebra::norm(motion.ddq.values()))
}
