//! Compares recorded velocities with the derivative of the positions.

use crate::{
    checks::{
        control::reference_fit::explanation,
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::{correlation, rms},
        signals::Signals,
        subject::Subject,
    },
    signal::{Padding, SecondOrderSections, zero_phase},
};

/// Rms difference, percent of the rms velocity. The recorded KUKA has 2.7 and the UR10 0.4 (clean).
const LIMIT_PERCENT: f64 = 6.0;
/// Correlation with another joint above which the velocities are exchanged, if that with the own joint is below it.
const OTHER: f64 = 0.95;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let Some(recorded) = exam.subject.velocity else { return };
    let subject = exam.subject;
    let signal = &subject.signal;
    let rate = exam.subject.sample_rate_hz;
    let filter = SecondOrderSections::butterworth_lowpass(signal.filter_order, signal.cutoff_hz, rate);
    let Ok(filtered) = filter.and_then(|f| zero_phase(&f, recorded, Padding::Matlab)) else { return };
    let filtered = filtered.window(signal.window.clone());
    let motion: Vec<Vec<f64>> = (0..signals.coordinates()).map(|j| signals.dq.channel(j)).collect();
    for j in (0..signals.coordinates()).filter(|&j| signals.moves(j)) {
        compare(exam, &filtered.channel(j), &motion, j);
    }
}

fn compare(exam: &mut Examination<'_>, recorded: &[f64], motion: &[Vec<f64>], j: usize) {
    let subject = exam.subject;
    let difference: Vec<f64> = recorded.iter().zip(&motion[j]).map(|(a, b)| a - b).collect();
    let value = 100.0 * rms(&difference) / rms(&motion[j]);
    let evidence = Evidence {
        code: Code::VelocityMismatch,
        coordinate: Some(j),
        value,
        unit: "% of the velocity",
        limit: LIMIT_PERCENT,
    };
    let cause = if value > LIMIT_PERCENT { cause(subject, recorded, motion, j) } else { None };
    let severity = if cause.is_some() { Severity::Warning } else { Severity::Note };
    exam.judge(evidence, severity, || {
        let seen = format!(
            "joint {}: the recorded velocity and the derivative of the position differ by {value:.0} % rms",
            subject.joint_number(j)
        );
        let why =
            |cause: String| (cause, "check the velocity's column, unit and sign; the estimate uses the position only");
        let (cause, remedy) = cause.map_or((UNEXPLAINED.to_owned(), USES_POSITION), why);
        FindingText::new(format!("{seen}: {cause}"), remedy)
    });
}

/// The text if no cause is known.
const UNEXPLAINED: &str = "no gain, delay or other joint explains it; noise or another filter may";
const USES_POSITION: &str = "nothing to do: the estimate uses the position only";

/// The text of the cause; `None` if no cause explains most of the difference.
fn cause(subject: &Subject<'_>, recorded: &[f64], motion: &[Vec<f64>], j: usize) -> Option<String> {
    let own = correlation(recorded, &motion[j]);
    let others = (0..motion.len()).filter(|&i| i != j).map(|i| (i, correlation(recorded, &motion[i])));
    if let Some((i, r)) = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).filter(|o| o.1.abs() > OTHER)
        && own.abs() < OTHER
    {
        return Some(format!("it is the velocity of joint {} (correlation {r:.3})", subject.joint_number(i)));
    }
    explanation(recorded, &motion[j], subject.sample_rate_hz)
}
