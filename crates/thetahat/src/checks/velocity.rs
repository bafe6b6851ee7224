//! Recorded velocities against the derivative of the positions.

use super::{
    Code, Severity,
    examination::{Evidence, Examination},
    numbers::{correlation, delay, rms},
    signals::Signals,
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
    let signal = &exam.subject.signal;
    let rate = exam.subject.sample_rate_hz;
    let filter = SecondOrderSections::butterworth_lowpass(signal.filter_order, signal.cutoff_hz, rate);
    let Ok(filtered) = filter.and_then(|f| zero_phase(&f, recorded, Padding::Matlab)) else { return };
    let filtered = filtered.window(signal.window.clone());
    let motion: Vec<Vec<f64>> = (0..signals.joints()).map(|j| signals.dq.channel(j)).collect();
    let reach = (PERIODS * rate / signal.cutoff_hz).ceil() as usize;
    for j in (0..signals.joints()).filter(|&j| signals.moves(j)) {
        compare(exam, &filtered.channel(j), &motion, (j, reach));
    }
}

fn compare(exam: &mut Examination<'_>, recorded: &[f64], motion: &[Vec<f64>], (j, reach): (usize, usize)) {
    let difference: Vec<f64> = recorded.iter().zip(&motion[j]).map(|(a, b)| a - b).collect();
    let value = 100.0 * rms(&difference) / rms(&motion[j]);
    let evidence = Evidence {
        code: Code::VelocityMismatch,
        joint: Some(j),
        value,
        unit: "% of the velocity",
        limit: LIMIT_PERCENT,
    };
    exam.judge(evidence, Severity::Warning, || {
        let cause = cause(recorded, motion, (j, reach));
        (
            format!(
                "joint {}: recorded velocity and derivative of the position differ by {value:.0} % rms: {cause}",
                j + 1
            ),
            "check the velocity's column, unit and sign; the estimate itself uses the position only".to_owned(),
        )
    });
}

/// The most likely cause in words.
fn cause(recorded: &[f64], motion: &[Vec<f64>], (j, reach): (usize, usize)) -> String {
    let own = correlation(recorded, &motion[j]);
    let others = (0..motion.len()).filter(|&i| i != j).map(|i| (i, correlation(recorded, &motion[i])));
    if let Some((i, r)) = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).filter(|o| o.1.abs() > OTHER)
        && own.abs() < OTHER
    {
        return format!("it is that of joint {} (correlation {r:.3})", i + 1);
    }
    let lag = delay(recorded, &motion[j], reach);
    let gain = dot(recorded, &motion[j]) / dot(&motion[j], &motion[j]) / own.abs().max(f64::MIN_POSITIVE);
    if own.abs() > OTHER && (gain - 1.0).abs() > GAIN {
        return format!("it is {gain:.4} times as large");
    }
    format!("it is {lag:.1} samples late (correlation {own:.3})")
}
