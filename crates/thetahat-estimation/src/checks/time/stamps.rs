//! Time stamps: gaps and jitter.

use super::late_stamps::{StampMeaning, stamp_meaning};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{quantile_abs, rms},
    remedy_step::RemedyStep,
};

/// Rms deviation of a step from the median step, percent of the median, without the gaps. The recorded KUKA has 1.4 (clean).
const JITTER_LIMIT_PERCENT: f64 = 5.0;
/// Time that is missing around a gap, in steps: less is a late stamp, for which the next steps compensate. The clean recordings
/// stay below 0.36.
const GAP: f64 = 0.75;
/// Excess of a step, in steps, below which it is no gap.
const HALF_A_STEP: f64 = 0.5;
/// Percent of missing samples that are harmless, since their rows are left out.
const FEW_MISSING_PERCENT: f64 = 1.0;
/// Difference of a stated rate from that of the times, percent.
const RATE_LIMIT_PERCENT: f64 = 1.0;
/// Steps around a gap over which late stamps compensate each other.
const AROUND: usize = 2;

pub(in crate::checks) fn check(exam: &mut Examination<'_>) {
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
    check_gaps(exam, time, &gaps, missing);
    let regular: Vec<f64> = late.iter().enumerate().filter(|(k, _)| !gaps.contains(k)).map(|(_, l)| *l).collect();
    check_jitter(exam, time, &Steps { regular, median, has_gaps: !gaps.is_empty() });
}

/// Reports the gaps, given by the sample before each, and the total of missing samples.
fn check_gaps(exam: &mut Examination<'_>, time: &[f64], gaps: &[usize], missing: f64) {
    let evidence =
        Evidence { code: Code::DroppedSamples, coordinate: None, value: missing, unit: "samples", limit: 0.5 };
    let is_much = 100.0 * missing > FEW_MISSING_PERCENT * time.len() as f64;
    let severity = if is_much { Severity::Warning } else { Severity::Note };
    exam.judge(evidence, severity, || {
        let first = gaps.first().map_or(0.0, |&k| time[k]);
        FindingText::new(
            format!(
                "the time stamps have {} gaps with {missing:.0} missing samples in all, the first after {first:.4} s; rows in and \
                 next to the gaps are left out",
                gaps.len()
            ),
            if is_much { "record again, with a logger that keeps up" } else { "nothing to do: little is left out" },
        )
    });
}

/// The steps between time stamps.
struct Steps {
    /// Deviations from the median step without the gaps, as parts of the median.
    regular: Vec<f64>,
    /// The median step, s.
    median: f64,
    has_gaps: bool,
}

impl Steps {
    /// The rate to state instead of times that are those of arrival.
    fn equal_steps(&self, meaning: StampMeaning, sample_rate_hz: f64) -> Option<RemedyStep> {
        (meaning == StampMeaning::Arrival && !self.has_gaps).then_some(RemedyStep::EqualSteps { sample_rate_hz })
    }
}

/// Checks the variation of the steps between time stamps.
fn check_jitter(exam: &mut Examination<'_>, time: &[f64], steps: &Steps) {
    let Steps { regular, median, has_gaps } = steps;
    let value = 100.0 * rms(regular);
    let evidence =
        Evidence { code: Code::ClockJitter, coordinate: None, value, unit: "% of a step", limit: JITTER_LIMIT_PERCENT };
    if value <= JITTER_LIMIT_PERCENT {
        exam.note_measure(evidence);
        return;
    }
    let meaning = stamp_meaning(exam.subject, time);
    let severity = if meaning == StampMeaning::Sampling { Severity::Note } else { Severity::Warning };
    let rate = exam.subject.sample_rate_hz;
    exam.judge(evidence, severity, || {
        let largest = 100.0 * quantile_abs(regular.iter().copied(), 1.0);
        let (seen, remedy) = match meaning {
            StampMeaning::Sampling => ("the positions show that the stamps are times of sampling", "nothing to do".to_owned()),
            StampMeaning::Arrival => (
                "the positions show that the samples were taken at equal steps and stamped on arrival",
                if !has_gaps {
                    format!("state sample_rate_hz = {rate:.6} in [recording] instead of time, or log by the controller's clock")
                } else {
                    "log by the controller's clock".to_owned()
                },
            ),
            StampMeaning::Unknown => (
                "the positions do not show whether the stamps are times of sampling or of arrival",
                "nothing to do if they are times of sampling; if they are times of arrival, log by the controller's clock"
                    .to_owned(),
            ),
        };
        FindingText::new(
            format!(
                "the time between samples varies by {value:.1} % rms (at most {largest:.0} %) about {median:.6} s; the \
                 recording is resampled to equal steps by its stamps; {seen}"
            ),
            remedy,
        )
        .with_step(steps.equal_steps(meaning, rate))
    });
}

/// Compares a stated rate with the times in the file.
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
        FindingText::new(
            format!("sample_rate_hz is {stated} Hz, but the times in column {column:?} give {rate:.6} Hz"),
            "name that column as time instead of stating the rate, or rename it if it is not a time",
        )
    });
}

/// The gaps: long steps for which the next steps do not compensate.
fn gaps(late: &[f64]) -> Vec<usize> {
    let lasting = |k: usize| late[k.saturating_sub(AROUND)..(k + AROUND + 1).min(late.len())].iter().sum::<f64>();
    (0..late.len()).filter(|&k| late[k] > HALF_A_STEP && lasting(k) > GAP).collect()
}
