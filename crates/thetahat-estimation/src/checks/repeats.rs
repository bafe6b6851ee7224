//! Samples that are missing or repeated, seen in the motion itself.

use super::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{NORMAL_PER_MEDIAN, quantile_abs, step_of},
    signals::Signals,
};
use thetahat_ground::series::Series;

/// Repeated samples, percent of those at which the robot moves. None of the clean recordings has one.
const REPEATED_LIMIT_PERCENT: f64 = 0.05;
/// Expected steps of a joint between two samples, from which on an equal position is no coincidence.
const EXPECTED_STEPS: f64 = 4.0;
/// Times the expected coincidences of channels that count in steps that repetitions must be.
const BY_CHANCE: f64 = 1.5;
/// Samples over which rates of repetition are taken.
const STRETCH: usize = 64;
/// A jump ahead by this part of a sample is a dropped sample.
const JUMP: f64 = 0.5;
/// Times the standard deviation that a jump must be.
const SURE: f64 = 8.0;
/// Part of the unexpected step of all joints that one jump in time must explain: an outlier of one joint does not.
const EXPLAINED: f64 = 0.8;
/// Samples around a jump over which an outlier comes back.
const AROUND: usize = 3;
/// Highest cut-off, part of the sample rate, of the velocities that steps are compared with.
const HIGHEST_CUTOFF: f64 = 0.1;
/// Relative rounding of a position.
const ROUNDING: f64 = 1e-9;

pub(super) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    // A filter that lets noise through gives no velocity to expect anything from.
    let highest = HIGHEST_CUTOFF * exam.subject.sample_rate_hz;
    let smoother =
        (exam.subject.signal.cutoff_hz > highest).then(|| Signals::new(exam.subject, highest).ok()).flatten();
    let signals = smoother.as_ref().unwrap_or(signals);
    repeated(exam, signals, &signals.raw, "positions");
    if let Some(torque) = exam.subject.torque_in_window() {
        repeated(exam, signals, &torque, "torques");
    }
    dropped(exam, signals);
}

/// All channels of a signal exactly as one sample before, while a joint moves by several steps of its position.
fn repeated(exam: &mut Examination<'_>, signals: &Signals, series: &Series, what: &str) {
    let moving = moving_fast(exam.subject.sample_rate_hz, signals);
    let repeated: Vec<usize> = moving.iter().copied().filter(|&k| series.sample(k) == series.sample(k - 1)).collect();
    // Positions are looked at where they are several steps apart.
    let chance = if what == "torques" { BY_CHANCE * coincidences(series, &moving) } else { 0.0 };
    let value = 100.0 * (repeated.len() as f64 - chance).max(0.0) / moving.len().max(1) as f64;
    let evidence = Evidence {
        code: Code::RepeatedSamples,
        coordinate: None,
        value,
        unit: "% of the moving samples",
        limit: REPEATED_LIMIT_PERCENT,
    };
    let start = exam.subject.signal.window.start;
    exam.judge(evidence, Severity::Warning, || {
        let first = repeated.first().map_or(0, |k| k + start);
        FindingText::new(
            format!(
                "{} samples ({value:.2} %) repeat the {what} of the one before, the first is sample {first}",
                repeated.len()
            ),
            "the logger holds old values: record at the rate at which they are new, or drop the repeats and resample",
        )
    });
}

/// Samples at which all channels repeat by chance, each for itself, since they count in steps: the product of their own
/// rates of repetition over short stretches.
fn coincidences(series: &Series, moving: &[usize]) -> f64 {
    let own = |stretch: &[usize], j: usize| {
        let same = stretch.iter().filter(|&&k| series.sample(k)[j] == series.sample(k - 1)[j]).count();
        same as f64 / stretch.len() as f64
    };
    let all = |stretch: &[usize]| (0..series.channels()).map(|j| own(stretch, j)).product::<f64>();
    let counts = (0..series.channels()).all(|j| step_of(&series.channel(j)).is_some());
    if counts { moving.chunks(STRETCH).map(|s| s.len() as f64 * all(s)).sum() } else { 0.0 }
}

/// Samples at which some joint is expected to be several steps of its position further than one sample before.
fn moving_fast(rate: f64, signals: &Signals) -> Vec<usize> {
    let coordinates = 0..signals.coordinates();
    let steps: Vec<f64> = coordinates.map(|j| step_of(&signals.raw.channel(j)).unwrap_or(0.0)).collect();
    let fast = |&k: &usize| {
        let v = signals.dq.sample(k);
        (0..v.len()).any(|j| v[j].abs() > 0.1 * signals.peak[j] && v[j].abs() / rate > EXPECTED_STEPS * steps[j])
    };
    (1..signals.raw.len()).filter(fast).collect()
}

/// A sample that is missing shows as a step of all moving joints that is as long as their velocities say.
fn dropped(exam: &mut Examination<'_>, signals: &Signals) {
    let ahead = StepErrors::new(exam.subject.sample_rate_hz, signals);
    let jumps = ahead.jumps();
    let missing = 0.0 + jumps.iter().map(|&k| ahead.steps[k].samples.round().max(1.0)).sum::<f64>();
    let evidence =
        Evidence { code: Code::DroppedSamples, coordinate: None, value: missing, unit: "samples", limit: 0.5 };
    let (start, rate) = (exam.subject.signal.window.start, exam.subject.sample_rate_hz);
    exam.judge(evidence, Severity::Warning, || {
        let first = jumps.first().map_or(0, |k| k + start);
        FindingText::new(
            format!(
                "the joints jump ahead at {} places, as if {missing:.0} samples were missing, the first at sample \
                 {first} ({:.4} s)",
                jumps.len(),
                first as f64 / rate
            ),
            "cut the recording at the jumps or record again; a filter takes them for accelerations",
        )
    });
}

/// The motion against its velocity, step by step.
struct StepErrors {
    steps: Vec<Step>,
    /// Whether a step follows a repeated sample: there, the motion catches up.
    follows_repeat: Vec<bool>,
}

/// The unexpected motion from one sample to the next.
struct Step {
    /// Samples by which the motion is ahead of its velocity.
    samples: f64,
    /// Their standard deviation.
    deviation: f64,
    /// Part of the unexpected motion that being ahead explains.
    explained: f64,
}

impl StepErrors {
    fn new(rate: f64, signals: &Signals) -> Self {
        let joints: Vec<usize> = (0..signals.coordinates()).filter(|&j| signals.moves(j)).collect();
        let step = |k: usize, j: usize| {
            let expected = 0.5 * (signals.dq.sample(k)[j] + signals.dq.sample(k + 1)[j]) / rate;
            (expected, signals.raw.sample(k + 1)[j] - signals.raw.sample(k)[j] - expected)
        };
        let samples = signals.raw.len().saturating_sub(1);
        let weight = |&j: &usize| {
            // A joint at rest is off by nothing, and at times by one of its steps.
            let count = step_of(&signals.raw.channel(j)).unwrap_or(0.0);
            let size = (quantile_abs((0..samples).map(|k| step(k, j).1), 0.5) * NORMAL_PER_MEDIAN).max(count);
            1.0 / (size + ROUNDING * quantile_abs((0..samples).map(|k| signals.raw.sample(k)[j]), 1.0)).powi(2)
        };
        let weights: Vec<f64> = joints.iter().map(weight).collect();
        let ahead = |k: usize| {
            let (mut information, mut score, mut total) = (f64::MIN_POSITIVE, 0.0, f64::MIN_POSITIVE);
            for (&j, w) in joints.iter().zip(&weights) {
                let (expected, unexpected) = step(k, j);
                information += w * expected * expected;
                score += w * expected * unexpected;
                total += w * unexpected * unexpected;
            }
            Step {
                samples: score / information,
                deviation: 1.0 / information.sqrt(),
                explained: score * score / information / total,
            }
        };
        let repeat = |k: usize| k > 0 && signals.raw.sample(k) == signals.raw.sample(k - 1);
        Self { steps: (0..samples).map(ahead).collect(), follows_repeat: (0..samples).map(repeat).collect() }
    }

    /// Steps with a jump ahead that the samples around do not take back.
    fn jumps(&self) -> Vec<usize> {
        let lasting = |k: usize| {
            let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(self.steps.len());
            self.steps[around].iter().map(|s| s.samples).sum::<f64>()
        };
        let jump = |&k: &usize| {
            let Step { samples, deviation, explained } = self.steps[k];
            samples > JUMP
                && samples > SURE * deviation
                && !self.follows_repeat[k]
                && explained > EXPLAINED
                && lasting(k) > JUMP
        };
        (0..self.steps.len()).filter(jump).collect()
    }
}
