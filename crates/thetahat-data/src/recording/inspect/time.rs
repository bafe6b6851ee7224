//! Times: which columns are times, their unit, rate, jitter and gaps.

use serde::Serialize;

use super::super::checks::is_restart;
use super::super::clock::CoarseTimes;
use super::super::table::Column;
use super::super::unit::Unit;

/// A step longer than this many usual steps is a gap.
const GAP: f64 = 1.5;
/// Jitter (root mean square) below which a rising column counts as a time whatever its name.
const EVEN: f64 = 0.05;
/// Sample rates of recordings in Hz, for guessing the unit of a time.
const RATES: std::ops::Range<f64> = 10.0..20_000.0;
/// Sample rates in Hz that a unit in a name may give: by others the name is wrong.
const POSSIBLE_RATES: std::ops::Range<f64> = 1.0..1e5;
const SECONDS_PER_DAY: f64 = 86_400.0;
/// Units of time, in the order in which they are tried.
const UNITS: [Unit; 4] = [Unit::Second, Unit::Millisecond, Unit::Microsecond, Unit::Nanosecond];

/// A column of times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TimeSummary {
    /// The column.
    pub column: String,
    /// Whether its name is that of a time, or it was requested.
    pub is_named: bool,
    /// The unit, by its name or otherwise such that the rate is between 10 Hz and 20 kHz. For a bag it is the second.
    pub unit: Unit,
    /// The unit in its name, where the rate by it is that of no recording of a motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contradicted_unit: Option<Unit>,
    /// Whether they count by one and their name has no unit: a clock of that unit, or a counter of samples.
    #[serde(skip)]
    pub is_count: bool,
    /// Samples per second: one divided by the usual step, which is the time without gaps divided by its steps.
    pub rate_hz: f64,
    /// Root mean square of the deviations of steps from the usual step, without gaps, relative to it.
    pub jitter_rms: f64,
    /// Largest deviation of a step from the usual step, without gaps, relative to it.
    pub jitter_max: f64,
    /// Steps of more than one and a half usual steps.
    pub gaps: Vec<Gap>,
    /// Number of times equal to the previous one.
    pub repeated: usize,
    /// Number of times earlier than the previous one.
    pub backwards: usize,
    /// The first sample of a second recording in the file, counted from 0, at which the times start again.
    #[doc(hidden)]
    #[serde(skip)]
    pub restart: Option<usize>,
}

/// A step that is too long.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gap {
    /// The sample after the gap, counted from 0.
    pub sample: usize,
    /// The length of the step in seconds.
    pub length_s: f64,
    /// Number of missing samples: the number of usual steps in it, less one.
    pub missing: u64,
}

/// The columns that are times: the requested one first, then those with a name of a time. `asked` is `NAME` or
/// `FILE:NAME`.
pub(super) fn times(columns: &[Column], in_seconds: bool, asked: Option<&str>) -> Vec<TimeSummary> {
    let is_asked = |c: &Column| asked.is_some_and(|asked| asked == c.name || asked.ends_with(&format!(":{}", c.name)));
    let is_named = |c: &Column| c.in_seconds || is_named(&c.name);
    let rank = |c: &Column| if is_asked(c) { 0 } else { 2 - usize::from(is_named(c)) };
    let mut summaries: Vec<(usize, TimeSummary)> =
        columns.iter().filter_map(|c| Some((rank(c), time(c, in_seconds, rank(c) < 2)?))).collect();
    summaries.sort_by_key(|(rank, _)| *rank);
    summaries.into_iter().map(|(_, summary)| summary).collect()
}

/// Whether a name is that of a time: `t`, `time`, `stamp` and similar, with or without a unit, alone or at the end of a path.
pub(super) fn is_named(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let last = |sign| name.rsplit(sign).next().unwrap_or_default();
    is_word_of_time(last('.')) || is_word_of_time(last('/'))
}

/// Whether a column is the time of messages, and not a number in them.
fn is_of_message(name: &str) -> bool {
    matches!(name.rsplit('.').next(), Some("stamp" | "log_time"))
}

fn is_word_of_time(name: &str) -> bool {
    const WORDS: [&str; 10] =
        ["t", "time", "times", "stamp", "stamps", "timestamp", "timestamps", "clock", "zeit", "zeitstempel"];
    let word = name.trim_start_matches(['_', '%', '#']).split(['_', ' ', '[', '(', '/']).next().unwrap_or_default();
    WORDS.contains(&word) || matches!(name, "log_time" | "sample_time" | "sim_time" | "elapsed_time")
}

fn time(column: &Column, in_seconds: bool, is_named: bool) -> Option<TimeSummary> {
    if column.channels != 1 || column.samples() < 3 || column.values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    // Dates whose times of day are in another column.
    if column.in_seconds && column.values.iter().all(|value| value % SECONDS_PER_DAY == 0.0) {
        return None;
    }
    let steps: Vec<f64> = column.values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let coarse = CoarseTimes::of(&column.values);
    let step = coarse.map_or_else(|| period(&steps), |coarse| Some(coarse.step))?;
    let restart = (1..column.values.len()).find(|&k| steps[k - 1] < 0.0 && is_restart(&column.values, k));
    let backwards = steps.iter().filter(|step| **step < 0.0).count();
    let (jitter_rms, jitter_max) = jitter(&steps, step);
    let is_even = steps.iter().all(|step| *step > 0.0) && jitter_rms < EVEN && steps.iter().all(|s| *s <= GAP * step);
    if !is_named && !is_even {
        return None;
    }
    let is_in_seconds = (in_seconds && is_of_message(&column.name)) || column.in_seconds;
    let (unit, contradicted_unit) = if is_in_seconds { (Unit::Second, None) } else { unit(&column.name, step) };
    let is_count = unit != Unit::Second && step == 1.0 && unit_in_name(&column.name) != Some(unit);
    Some(TimeSummary {
        column: column.name.clone(),
        is_named,
        unit,
        contradicted_unit,
        is_count,
        rate_hz: 1.0 / (step * unit.to_si()),
        jitter_rms,
        jitter_max,
        gaps: if coarse.is_some() { Vec::new() } else { gaps(&steps, step, unit) },
        repeated: steps.iter().filter(|step| **step == 0.0).count(),
        backwards,
        restart,
    })
}

/// The step between samples: the total time divided by the number of steps, with several in each gap. The median step alone would contain
/// the rounding of the times.
fn period(steps: &[f64]) -> Option<f64> {
    let median = median(steps)?;
    let count: f64 = steps.iter().map(|step| (step / median).round()).sum();
    let mean = steps.iter().sum::<f64>() / count;
    Some(if (mean / median - 1.0).abs() < 0.5 { mean } else { median })
}

/// The median of the positive steps.
fn median(steps: &[f64]) -> Option<f64> {
    let mut forward: Vec<f64> = steps.iter().copied().filter(|step| *step > 0.0 && step.is_finite()).collect();
    let middle = forward.len() / 2;
    if forward.is_empty() {
        return None;
    }
    Some(*forward.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Root mean square and largest deviation from the usual step, relative to it, over steps that are not gaps.
fn jitter(steps: &[f64], period: f64) -> (f64, f64) {
    let deviations = || steps.iter().filter(|step| **step <= GAP * period).map(|step| (step / period - 1.0).abs());
    let squares: f64 = deviations().map(|deviation| deviation * deviation).sum();
    ((squares / deviations().count().max(1) as f64).sqrt(), deviations().fold(0.0, f64::max))
}

fn gaps(steps: &[f64], period: f64, unit: Unit) -> Vec<Gap> {
    let long = steps.iter().enumerate().filter(|(_, step)| **step > GAP * period);
    let gap = |(k, step): (usize, &f64)| Gap {
        sample: k + 1,
        length_s: step * unit.to_si(),
        missing: (step / period).round() as u64 - 1,
    };
    long.map(gap).collect()
}

/// The unit at the end of a name.
fn unit_in_name(name: &str) -> Option<Unit> {
    let word = name.trim_end_matches([']', ')']).rsplit(['_', ' ', '[', '(', '/']).next().unwrap_or_default();
    UNITS.into_iter().find(|unit| name != word && unit.symbol() == word)
}

/// The unit in a name such as `t_ms` or `time [us]`; otherwise, and where the rate by it is that of no recording, the first that
/// gives the rate of one. Then the unit in the name, which is contradicted.
fn unit(name: &str, period: f64) -> (Unit, Option<Unit>) {
    let rate = |unit: &Unit| 1.0 / (period * unit.to_si());
    let named = unit_in_name(name);
    let likely = UNITS.into_iter().find(|unit| RATES.contains(&rate(unit)));
    match (named, likely) {
        (Some(named), Some(likely)) if !POSSIBLE_RATES.contains(&rate(&named)) => (likely, Some(named)),
        (Some(unit), _) | (None, Some(unit)) => (unit, None),
        (None, None) => (Unit::Second, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_known_by_their_names() {
        for name in
            ["t", "Time/s", "Zeitstempel [ms]", "Zeit", "%time", "/joint_states/header/stamp", "header.stamp", "stamp"]
        {
            assert!(is_named(name), "{name}");
        }
        for name in ["q1", "stampede", "Temperatur [C]", "/joint_states/a/position"] {
            assert!(!is_named(name), "{name}");
        }
        assert_eq!(unit("Zeitstempel [ms]", 2.0), (Unit::Millisecond, None));
        assert_eq!(unit("time_s", 2.0), (Unit::Millisecond, Some(Unit::Second)));
        assert_eq!(unit("time_s", 0.5), (Unit::Second, None));
        assert_eq!(unit("time_ms", 0.002), (Unit::Second, Some(Unit::Millisecond)));
    }
}
