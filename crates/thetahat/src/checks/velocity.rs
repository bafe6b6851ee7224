//! Recorded velocities against the derivative of the positions.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{correlation, delay, rms},
    signals::Signals,
    subject::Subject,
};
use crate::linear_algebra::dot;
use crate::signal::{Padding, SecondOrderSections, zero_phase};

/// Rms difference, percent of the rms velocity. The recorded KUKA has 2.7 and the UR10 0.4 (clean).
const LIMIT_PERCENT: f64 = 6.0;
/// A gain further from one than this is named as the cause.
const GAIN: f64 = 0.05;
/// A correlation with another joint that explains what the own joint does not.
const OTHER: f64 = 0.95;
/// Largest delay that is looked for, periods of the cut-off.
const PERIODS: f64 = 2.0;

pub(super) fn check(exam: &mut Examination<'_>, signals: &Signals) {
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
    exam.judge(evidence, Severity::Warning, || {
        let cause = cause(subject, recorded, motion, j);
        Words::new(
            format!(
                "joint {}: recorded velocity and derivative of the position differ by {value:.0} % rms: {cause}",
                subject.joint_number(j)
            ),
            "check the velocity's column, unit and sign; the estimate itself uses the position only",
        )
    });
}

/// The most likely cause in words.
fn cause(subject: &Subject<'_>, recorded: &[f64], motion: &[Vec<f64>], j: usize) -> String {
    let own = correlation(recorded, &motion[j]);
    let others = (0..motion.len()).filter(|&i| i != j).map(|i| (i, correlation(recorded, &motion[i])));
    if let Some((i, r)) = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).filter(|o| o.1.abs() > OTHER)
        && own.abs() < OTHER
    {
        return format!("it is that of joint {} (correlation {r:.3})", subject.joint_number(i));
    }
    let reach = (PERIODS * subject.sample_rate_hz / subject.signal.cutoff_hz).ceil() as usize;
    let lag = delay(recorded, &motion[j], reach);
    let gain = dot(recorded, &motion[j]) / dot(&motion[j], &motion[j]) / own.abs().max(f64::MIN_POSITIVE);
    if own.abs() > OTHER && (gain - 1.0).abs() > GAIN {
        return format!("it is {gain:.4} times as large");
    }
    format!("it is {lag:.1} samples late (correlation {own:.3})")
}
