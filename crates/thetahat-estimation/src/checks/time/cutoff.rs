//! A position filter that removes motion.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
    remedy_step::RemedyStep,
};

/// Rms torque, percent of the torques' standard deviation, that only the doubled cut-off explains, on stretches of time that
/// neither fit used. The clean recordings have at most 1.9, twins with other noise and moves at
/// most 4.0.
const LIMIT_PERCENT: f64 = 6.0;
/// Largest part of the squared error that a further doubling may leave.
const SMALLER: f64 = 0.8;
/// Smallest ratio of the squared errors with the experiment's and with the doubled cut-off: a smaller one depends on the stretches.
const WORTH_IT: f64 = 1.2;
/// Part of the time that a joint stands, from which its rests do not count.
const RESTS: f64 = 0.5;
/// Highest cut-off, part of the sample rate.
const HIGHEST: f64 = 0.4;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let cutoff = exam.subject.signal.cutoff_hz;
    let highest = HIGHEST * exam.subject.sample_rate_hz;
    if recording.is_corrected() || 2.0 * cutoff > highest {
        return;
    }
    // Where a joint stands, a wider filter makes the friction's sign sharper and moves no estimate.
    let squares = |recording: &ThinnedRecording<'_>| {
        recording.fit().ok()?.held_out_squares(&recording.rows_without_long_rests(RESTS))
    };
    let at = |cutoff_hz: f64| recording.with_cutoff(cutoff_hz).and_then(|wider| squares(&wider));
    let (Some(narrow), Some(wide)) = (squares(recording), at(2.0 * cutoff)) else { return };
    let value = if narrow > WORTH_IT * wide { 100.0 * (narrow - wide).sqrt() } else { 0.0 };
    let evidence =
        Evidence { code: Code::CutoffLow, coordinate: None, value, unit: "% of the torques", limit: LIMIT_PERCENT };
    exam.judge(evidence, Severity::Warning, || {
        let (best, squares) = raised(2.0 * cutoff, wide, highest, &at);
        FindingText::new(
            format!(
                "with the position filter at {best} Hz instead of {cutoff} Hz, the squared error on data not used is {:.2} \
                 times smaller (by {:.0} % of the torques): the filter removes motion",
                narrow / squares,
                100.0 * (narrow - squares).sqrt()
            ),
            format!("raise [signal] cutoff_hz to {best}"),
        )
        .with_step(RemedyStep::Cutoff { cutoff_hz: best })
    });
}

/// Doubles the cut-off for as long as the error becomes smaller; returns it with its squared error.
fn raised(cutoff_hz: f64, squares: f64, highest: f64, at: &dyn Fn(f64) -> Option<f64>) -> (f64, f64) {
    let twice = 2.0 * cutoff_hz;
    match at(twice).filter(|wider| twice <= highest && *wider < SMALLER * squares) {
        Some(wider) => raised(twice, wider, highest, at),
        None => (cutoff_hz, squares),
    }
}
