//! A position filter that takes motion away.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    thinned_record::ThinnedRecord,
};

/// Rms torque that twice the cut-off explains and the experiment's does not, percent of the torques' deviation. The clean
/// records have at most 1.9, twins with other noise and moves at most 4.0.
const LIMIT_PERCENT: f64 = 6.0;
/// Highest cut-off, part of the sample rate.
const HIGHEST: f64 = 0.4;

pub(super) fn check(exam: &mut Examination<'_>, record: &ThinnedRecord<'_>) {
    let cutoff = exam.subject.signal.cutoff_hz;
    let twice = 2.0 * cutoff;
    if record.is_corrected() || twice > HIGHEST * exam.subject.sample_rate_hz {
        return;
    }
    let squares = |record: &ThinnedRecord<'_>| record.fit().map(|r| r.squares).ok();
    let wider = ThinnedRecord::new(record.subject, twice).and_then(|c| squares(&c));
    let (Some(narrow), Some(wide)) = (squares(record), wider) else { return };
    let value = 100.0 * ((narrow - wide).max(0.0) / (record.rows() * record.coordinates()) as f64).sqrt();
    let evidence =
        Evidence { code: Code::CutoffLow, coordinate: None, value, unit: "% of the torques", limit: LIMIT_PERCENT };
    exam.judge(evidence, Severity::Warning, || {
        Words::new(
            format!(
                "with the position filter at {twice} Hz in place of {cutoff} Hz the squared residual is {:.2} times \
                 smaller, by {value:.0} % of the torques: the filter takes motion away",
                narrow / wide
            ),
            "raise [signal] cutoff_hz to some five times the motion's bandwidth",
        )
    });
}
