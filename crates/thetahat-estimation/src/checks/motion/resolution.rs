//! Quantisation and noise of the positions in the rows: after the filter and the decimation.

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::{rms, step_of},
        signals::Signals,
        subject::Subject,
    },
    signal::{Decimator, Derivative, SignalError, band_pass},
};
use thetahat_ground::{linear_algebra::norm, series::Series};

/// Noise of the rows' acceleration by the position's steps, percent of the acceleration's rms. A part r of noise in a column takes the
/// part r^2 off its estimate: 0.04 % here.
const STEP_LIMIT_PERCENT: f64 = 2.0;
/// Noise of the rows' acceleration by white noise of the position, percent of the acceleration's rms: 0.16 % of an estimate.
const NOISE_LIMIT_PERCENT: f64 = 4.0;
/// A sensible cut-off, relative to the band of the decimated rows: 5 times the dynamics' bandwidth if the rows keep twice it.
const BANDS: f64 = 2.5;
/// Periods of the cut-off, and rows, over which the filters' impulse response is summed.
const PERIODS: f64 = 20.0;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let signal = &exam.subject.signal;
    let cutoff = signal.cutoff_hz;
    // Steps are coarse if they are so with a sensible filter; otherwise the filter is at fault.
    let sensible = BANDS * 0.4 * exam.subject.sample_rate_hz / signal.decimation as f64;
    let gains = (noise_gain(exam.subject, cutoff.min(sensible)), noise_gain(exam.subject, cutoff));
    let (Ok(step_gain), Ok(white_noise_gain)) = gains else { return };
    let rows = Decimator::new(signal.decimation, signals.ddq.len()).and_then(|d| d.decimate(&signals.ddq));
    let Ok(accelerations) = rows else { return };
    for j in (0..signals.coordinates()).filter(|&j| signals.moves(j)) {
        let acceleration = rms(&accelerations.channel(j));
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
                "joint {number}: the position has steps of {step:.3e} rad or m; after the filters they make {value:.1} % noise \
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
                "joint {number}: after the filter at {cutoff} Hz and the decimation, {value:.0} % of the acceleration is noise of \
                 the position"
            ),
            "lower [signal] cutoff_hz to about five times the motion's bandwidth",
        )
    });
}

/// Rms acceleration of the rows for each standard deviation of white noise of the position.
///
/// The parallel filter leaves nothing above half the rows' frequency, so that the rows hold the energy of all samples, divided by the factor.
fn noise_gain(subject: &Subject<'_>, cutoff_hz: f64) -> Result<f64, SignalError> {
    let (rate, factor) = (subject.sample_rate_hz, subject.signal.decimation);
    let half = (PERIODS * (rate / cutoff_hz).max(factor as f64)).ceil() as usize + 50;
    let mut impulse = Series::zeros(2 * half + 1, 1);
    impulse.values_mut()[half] = 1.0;
    let motion = band_pass(&impulse, rate, subject.signal.filter_order, cutoff_hz, Derivative::Central)?;
    let rows = Decimator::new(factor, motion.ddq.len())?.decimate(&motion.ddq)?;
    Ok((factor as f64).sqrt() * norm(rows.values()))
}
