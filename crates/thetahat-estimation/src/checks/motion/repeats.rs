//! Missing or repeated samples, found in the motion itself.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{NORMAL_PER_MEDIAN, quantile_abs, step_of},
    signals::Signals,
};
use thetahat_ground::series::Series;

/// Repeated samples, percent of those at which the robot moves. The clean recordings have none.
const REPEATED_LIMIT_PERCENT: f64 = 0.05;
/// Expected quantisation steps of a joint between two samples above which an equal position is no coincidence.
const EXPECTED_STEPS: f64 = 4.0;
/// Factor by which repetitions must exceed the coincidences expected for quantised channels.
const BY_CHANCE: f64 = 1.5;
/// Samples over which rates of repetition are computed.
const STRETCH: usize = 64;
/// A jump ahead by this part of a sample is a dropped sample.
const JUMP: f64 = 0.5;
/// Standard deviations that a jump must exceed.
const SIGNIFICANT: f64 = 8.0;
/// Part of the unexpected step of all joints that a jump in time must explain: an outlier of one joint does not.
const EXPLAINED: f64 = 0.8;
/// Part of a jump that the steps before and after it may have: where a motion turns round, all of them deviate from its smoothed velocity.
const NEXT_TO: f64 = 0.5;
/// Part of the steps that are zero from which a joint that moves is quantised, whatever its steps are.
const MANY_ZEROS: f64 = 0.2;
/// Samples around a jump within which an outlier returns.
const AROUND: usize = 3;
/// Highest cut-off, part of the sample rate, of the velocities for comparison with steps.
const HIGHEST_CUTOFF: f64 = 0.1;
/// Relative rounding of a position.
const ROUNDING: f64 = 1e-9;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    // Velocities from a filter that passes noise are too noisy for a comparison.
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

/// Checks for samples equal to the one before in all channels, while a joint moves by several steps of its position.
fn repeated(exam: &mut Examination<'_>, signals: &Signals, series: &Series, what: &str) {
    let moving = moving_fast(exam.subject.sample_rate_hz, signals);
    let repeated: Vec<usize> = moving.iter().copied().filter(|&k| series.sample(k) == series.sample(k - 1)).collect();
    // Positions are compared only if they are expected to be several steps apart.
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
                "{} samples ({value:.2} %) repeat the {what} of the sample before, the first is sample {first}",
                repeated.len()
            ),
            format!(
                "the {what} are older than their times say: log at the rate at which they are new, or take the rows out that repeat them \
                 and keep the times of the others; positions that a logger repeats because it asks too often are interpolated when a file \
                 is read, and these are too few or too many in a row"
            ),
        )
    });
}

/// Expected number of samples at which all channels repeat by chance because they are quantised: from the product of their
/// rates of repetition over short stretches.
fn coincidences(series: &Series, moving: &[usize]) -> f64 {
    let rate = |stretch: &[usize], j: usize| {
        let same = stretch.iter().filter(|&&k| series.sample(k)[j] == series.sample(k - 1)[j]).count();
        same as f64 / stretch.len() as f64
    };
    let all = |stretch: &[usize]| (0..series.channels()).map(|j| rate(stretch, j)).product::<f64>();
    let is_quantised = (0..series.channels()).all(|j| step_of(&series.channel(j)).is_some());
    if is_quantised { moving.chunks(STRETCH).map(|s| s.len() as f64 * all(s)).sum() } else { 0.0 }
}

/// Samples at which some joint is expected to move by several steps of its position within one sample.
fn moving_fast(rate: f64, signals: &Signals) -> Vec<usize> {
    let coordinates = 0..signals.coordinates();
    let steps: Vec<f64> = coordinates.map(|j| step_of(&signals.raw.channel(j)).unwrap_or(0.0)).collect();
    let fast = |&k: &usize| {
        let v = signals.dq.sample(k);
        (0..v.len()).any(|j| v[j].abs() > 0.1 * signals.peak[j] && v[j].abs() / rate > EXPECTED_STEPS * steps[j])
    };
    (1..signals.raw.len()).filter(fast).collect()
}

/// Checks for missing samples: there, all moving joints make a step in proportion to their velocities.
fn dropped(exam: &mut Examination<'_>, signals: &Signals) {
    let errors = StepErrors::new(exam.subject.sample_rate_hz, signals);
    let jumps = errors.jumps();
    let missing = 0.0 + jumps.iter().map(|&k| errors.steps[k].samples.round().max(1.0)).sum::<f64>();
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
            "cut the recording at the jumps or record again; otherwise the filter turns them into accelerations",
        )
    });
}

/// The step of a quantised position: that of its grid, or of one whose grid does not show, its usual step; zero if it is not quantised.
fn count_of(position: &[f64]) -> f64 {
    let steps = || position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let zeros = steps().filter(|step| *step == 0.0).count();
    let usual = || quantile_abs(steps().filter(|step| *step > 0.0), 0.5);
    let is_coarse = zeros as f64 > MANY_ZEROS * position.len() as f64;
    step_of(position).unwrap_or_else(|| if is_coarse { usual() } else { 0.0 })
}

/// The difference of the motion from its velocity, step by step.
struct StepErrors {
    steps: Vec<Step>,
    /// Whether a step follows a repeated sample, where the motion catches up.
    follows_repeat: Vec<bool>,
}

/// The unexpected motion from one sample to the next.
struct Step {
    /// Samples by which the motion is ahead of its velocity.
    samples: f64,
    /// Standard deviation of `samples`.
    deviation: f64,
    /// Part of the unexpected motion that `samples` explains.
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
            // A joint at rest has no error, and at times one of its steps.
            let count = count_of(&signals.raw.channel(j));
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

    /// Steps with a jump ahead that the samples around them do not reverse.
    fn jumps(&self) -> Vec<usize> {
        let lasting = |k: usize| {
            let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(self.steps.len());
            self.steps[around].iter().map(|s| s.samples).sum::<f64>()
        };
        let next_to = |k: usize| {
            let next = [k.checked_sub(1), (k + 1 < self.steps.len()).then_some(k + 1)];
            next.into_iter().flatten().map(|k| self.steps[k].samples).fold(0.0, f64::max)
        };
        let jump = |&k: &usize| {
            let Step { samples, deviation, explained } = self.steps[k];
            samples > JUMP
                && samples > SIGNIFICANT * deviation
                && !self.follows_repeat[k]
                && explained > EXPLAINED
                && lasting(k) > JUMP
                && next_to(k) < NEXT_TO * samples
        };
        (0..self.steps.len()).filter(jump).collect()
    }
}
