//! A position filter that takes motion away.

use super::{
    Code, Severity,
    chain::Chain,
    examination::{Evidence, Examination},
};

/// Rms torque that twice the cut-off explains and the experiment's does not, percent of the torques' deviation. The clean
/// records have at most 1.9, twins with other noise and moves at most 4.0.
const LIMIT_PERCENT: f64 = 6.0;
/// Highest cut-off, part of the sample rate.
const HIGHEST: f64 = 0.4;

pub(super) fn check(exam: &mut Examination<'_>, chain: &Chain<'_>) {
    let cutoff = exam.subject.signal.cutoff_hz;
    let twice = 2.0 * cutoff;
    if chain.is_corrected() || twice > HIGHEST * exam.subject.sample_rate_hz {
        return;
    }
    let squares = |chain: &Chain<'_>| chain.regression().map(|r| r.squares);
    let wider = Chain::new(chain.subject, twice).and_then(|c| squares(&c));
    let (Ok(narrow), Ok(wide)) = (squares(chain), wider) else { return };
    let value = 100.0 * ((narrow - wide).max(0.0) / (chain.rows() * chain.joints()) as f64).sqrt();
    let evidence =
        Evidence { code: Code::CutoffLow, joint: None, value, unit: "% of the torques", limit: LIMIT_PERCENT };
    exam.judge(evidence, Severity::Warning, || {
        (
            format!(
                "with the position filter at {twice} Hz in place of {cutoff} Hz the squared residual is {:.2} times \
                 smaller, by {value:.0} % of the torques: the filter takes motion away",
                narrow / wide
            ),
            "raise [signal] cutoff_hz to some five times the motion's bandwidth".to_owned(),
        )
    });
}
