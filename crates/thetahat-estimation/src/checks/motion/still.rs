//! Joints that do not move, and times at which no joint moves.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{mean, span},
    remedy_step::RemedyStep,
    signals::{STILL, Signals},
};
use thetahat_ground::number::significant;
use thetahat_model::robot::JointKind;

/// Part of its peak velocity below which a joint counts as at rest.
const AT_REST: f64 = 0.01;
/// Evidence of a joint that does not move at all.
const SLOWEST: f64 = 1e6;
/// Shortest rest, in periods of the position filter's cut-off: shorter ones are reversals.
const REST_PERIODS: f64 = 10.0;
/// Rest, percent of the window; the clean recordings have none.
const REST_LIMIT_PERCENT: f64 = 6.0;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    (0..signals.coordinates()).for_each(|j| still_joint(exam, signals, j));
    still_periods(exam, signals);
}

/// Checks whether a joint is slower than [`STILL`]; the evidence is how many times slower.
fn still_joint(exam: &mut Examination<'_>, signals: &Signals, j: usize) {
    let value = (STILL / signals.peak[j]).min(SLOWEST);
    let evidence = Evidence { code: Code::JointStill, coordinate: Some(j), value, unit: "times too slow", limit: 1.0 };
    let parameters = exam.subject.parameter_names_of(j);
    let number = exam.subject.joint_number(j);
    let joint = exam.subject.robot.coordinates().nth(j);
    let name = joint.map_or("", |joint| joint.name.as_str());
    let unit = match joint.map_or(JointKind::Revolute, |joint| joint.kind) {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    };
    // A joint that is held on purpose does no harm if none of its parameters is estimated.
    let severity = if parameters.is_empty() { Severity::Note } else { Severity::Problem };
    let at = (1e6 * mean(&signals.raw.channel(j))).round() / 1e6;
    exam.judge(evidence, severity, || {
        let text = FindingText::new(
            format!(
                "joint {number} does not move: it spans {} {unit}, and its velocity stays below {} {unit}/s",
                significant(span(&signals.raw.channel(j)), 3),
                significant(signals.peak[j], 2)
            ),
            format!(
                "move it, or lock it: {name:?} = {at} in [locked] of the experiment, without its columns; if it did move, check \
                 the position channel",
            ),
        );
        text.about(parameters).with_step(RemedyStep::LockJoint { joint: j + 1, name: name.to_owned(), value: at })
    });
}

fn still_periods(exam: &mut Examination<'_>, signals: &Signals) {
    let shortest = (REST_PERIODS * exam.subject.sample_rate_hz / exam.subject.signal.cutoff_hz).ceil() as usize;
    let rests = rests(signals, shortest);
    let still: usize = rests.iter().map(|r| r.len()).sum();
    let value = 100.0 * still as f64 / signals.raw.len() as f64;
    let evidence = Evidence {
        code: Code::StillPeriod,
        coordinate: None,
        value,
        unit: "% of the window",
        limit: REST_LIMIT_PERCENT,
    };
    let (rate, start) = (exam.subject.sample_rate_hz, exam.subject.signal.window.start);
    let left_out = exam.subject.rests_left_out;
    exam.judge(evidence, if left_out { Severity::Note } else { Severity::Warning }, || {
        let at = |k: usize| (start + k) as f64 / rate;
        let (consequence, remedy) = if left_out {
            ("these samples are not used", "nothing to do: [signal] mask leaves them out")
        } else {
            (
                "there the sign of the velocity is noise",
                "leave them out by mask = \"near-rest\" in [signal], or set window_start_s and window_end_s there to the moving part",
            )
        };
        let longest = rests.iter().max_by_key(|r| r.len()).cloned().unwrap_or(0..0);
        FindingText::new(
            format!(
                "no joint moves for {value:.0} % of the window, the longest time from {:.3} s to {:.3} s; {consequence}",
                at(longest.start),
                at(longest.end)
            ),
            remedy,
        )
        .with_step((!left_out).then_some(RemedyStep::LeaveOutRests))
    });
}

/// Stretches of at least `shortest` samples in which no joint moves.
fn rests(signals: &Signals, shortest: usize) -> Vec<std::ops::Range<usize>> {
    let at_rest = |k: usize| {
        let v = signals.dq.sample(k);
        (0..v.len()).all(|j| !signals.moves(j) || v[j].abs() < AT_REST * signals.peak[j])
    };
    let mut rests = Vec::new();
    let mut start = 0;
    for k in 0..=signals.dq.len() {
        if k < signals.dq.len() && at_rest(k) {
            continue;
        }
        if k - start >= shortest {
            rests.push(start..k);
        }
        start = k + 1;
    }
    rests
}
