//! A position filter that takes motion away.

use super::{
    Code, Severity,
    chain::Chain,
    examination::{Evidence, Examination},
};

/// Squared residual with the cut-off of the experiment, relative to that with twice the cut-off. The clean records have at
/// most 1.05.
const RATIO_LIMIT: f64 = 1.3;
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
    let value = narrow / wide;
    let evidence =
        Evidence { code: Code::CutoffLow, joint: None, value, unit: "times the squared residual", limit: RATIO_LIMIT };
    exam.judge(evidence, Severity::Warning, || {
        (
            format!(
                "with the position filter at {twice} Hz in place of {cutoff} Hz the squared residual is {value:.2} times \
                 smaller: the filter takes motion away"
            ),
            "raise [signal] cutoff_hz to some five times the motion's bandwidth".to_owned(),
        )
    });
}
