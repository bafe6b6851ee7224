//! Time stamps: gaps and jitter.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{quantile_abs, rms},
};

/// Rms deviation of a step from the median step, percent of it, without the gaps. The recorded KUKA has 1.4 (clean).
const JITTER_LIMIT_PERCENT: f64 = 5.0;
/// Time that is missing around a step, in steps: less is a late stamp that the next steps make up for. The clean records
/// stay below 0.36.
const GAP: f64 = 0.75;
/// A step that is later by less is no gap.
const HALF_A_STEP: f64 = 0.5;
/// Deviation of a stated rate from that of the times, percent.
const RATE_LIMIT_PERCENT: f64 = 1.0;
/// Steps around a gap over which late stamps make up for one another.
const AROUND: usize = 2;

pub(super) fn check(exam: &mut Examination<'_>) {
    check_rate(exam);
    let Some(time) = exam.subject.time_s.filter(|t| t.len() > 2 * AROUND + 2) else { return };
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let median = quantile_abs(steps.iter().copied(), 0.5);
    if median <= 0.0 {
        return;
    }
    let late: Vec<f64> = steps.iter().map(|s| s / median - 1.0).collect();
    let gaps = gaps(&late);
    let missing = 0.0 + gaps.iter().map(|&k| late[k].round().max(1.0)).sum::<f64>();
    let evidence =
        Evidence { code: Code::DroppedSamples, coordinate: None, value: missing, unit: "samples", limit: 0.5 };
    exam.judge(evidence, Severity::Warning, || {
        let first = gaps.first().map_or(0.0, |&k| time[k]);
        Words::new(
            format!(
                "the time stamps have {} gaps, the first after {first:.4} s, where {missing:.0} samples are missing in all; \
                 rows in and beside them are left out",
                gaps.len()
            ),
            "where much is left out, record again, with a logger that keeps up",
        )
    });
    let regular: Vec<f64> = late.iter().enumerate().filter(|(k, _)| !gaps.contains(k)).map(|(_, l)| *l).collect();
    let value = 100.0 * rms(&regular);
    let evidence =
        Evidence { code: Code::ClockJitter, coordinate: None, value, unit: "% of a step", limit: JITTER_LIMIT_PERCENT };
    exam.judge(evidence, Severity::Warning, || {
        let largest = 100.0 * quantile_abs(regular.iter().copied(), 1.0);
        Words::new(
            format!(
                "the time between samples varies by {value:.1} % rms (at most {largest:.0} %) about {median:.6} s; the \
                 record is brought to equal steps by its stamps"
            ),
            "nothing where the stamps are those of the samples; where they are of the arrival, log by the controller's \
             clock",
        )
    });
}

/// A stated rate against the times in the file.
fn check_rate(exam: &mut Examination<'_>) {
    let Some((column, rate)) = exam.subject.contradicting_times else { return };
    let stated = exam.subject.sample_rate_hz;
    let value = 100.0 * (rate / stated - 1.0).abs();
    let evidence = Evidence {
        code: Code::RateContradicted,
        coordinate: None,
        value,
        unit: "% of the rate",
        limit: RATE_LIMIT_PERCENT,
    };
    exam.judge(evidence, Severity::Problem, || {
        Words::new(
            format!("sample_rate_hz states {stated} Hz, but the times in column {column:?} say {rate:.6} Hz"),
            "name that column as time instead of stating the rate, or rename it where it is no time",
        )
    });
}

/// Steps behind which time is missing for good.
fn gaps(late: &[f64]) -> Vec<usize> {
    let lasting = |k: usize| late[k.saturating_sub(AROUND)..(k + AROUND + 1).min(late.len())].iter().sum::<f64>();
    (0..late.len()).filter(|&k| late[k] > HALF_A_STEP && lasting(k) > GAP).collect()
}
