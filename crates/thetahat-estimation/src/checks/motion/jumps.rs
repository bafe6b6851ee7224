//! Positions that jump and stay: an encoder that slipped, or recordings that were joined.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{span, step_of},
    signals::Signals,
};
use thetahat_ground::series::Series;

/// Smallest jump, percent of the joint's span, that is found, and the largest that leaves estimates usable.
const FOUND_PERCENT: f64 = 0.5;
const USABLE_PERCENT: f64 = 3.0;
/// A jump in the largest of the steps around it: a start, a stop or a slip has steps of its size next to it.
const TIMES: f64 = 6.0;
/// Samples to each side whose steps are compared.
const AROUND: usize = 8;
/// Steps of a quantised position in a jump: a joint that hardly moves has single ones.
const COUNTS: f64 = 4.0;
/// Samples to each side over which the motion continues as before: positions that are held and then catch up do not jump.
const ACROSS: usize = 32;
/// Part of a jump by which the motion across it must be longer than on its sides.
const LASTING: f64 = 0.5;
/// Most jumps of a joint: more are the logger's or the encoder's way.
const MOST: usize = 5;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let Jumps { of_joints, of_most } = Jumps::of(&signals.raw);
    report(exam, None, &of_most);
    of_joints.iter().enumerate().for_each(|(j, jumps)| report(exam, Some(j), jumps));
}

/// Reports jumps of a joint, or of most joints at a time.
fn report(exam: &mut Examination<'_>, coordinate: Option<usize>, jumps: &[Jump]) {
    let Some(largest) = jumps.iter().copied().max_by(|a, b| a.percent.total_cmp(&b.percent)) else { return };
    let (code, value, unit) = (Code::PositionJump, largest.percent, "% of the joint's span");
    let severity = if value > USABLE_PERCENT { Severity::Problem } else { Severity::Warning };
    let sample = largest.sample + exam.subject.signal.window.start;
    let at_s = sample as f64 / exam.subject.sample_rate_hz;
    let between = format!("between samples {} and {sample} ({at_s:.3} s)", sample - 1);
    let text = match coordinate.map(|j| exam.subject.joint_number(j)) {
        Some(number) => FindingText::new(
            format!(
                "joint {number}: the position jumps by {:.3} rad or m {between}, and stays there: its encoder slipped, or two \
                 recordings were joined",
                largest.size
            ),
            "cut the file there and run thetahat init with one part: the joint has another zero in the other, and the filter was \
             chosen with the jump",
        ),
        None => FindingText::new(
            format!(
                "most joints jump {between}, by up to {:.3} rad or m: two recordings were joined, or samples are missing",
                largest.size
            ),
            "cut the file there and run thetahat init with both parts as recordings of their own: the filter was chosen with the jump",
        ),
    };
    exam.judge(Evidence { code, coordinate, value, unit, limit: FOUND_PERCENT }, severity, || text);
}

/// A step of a joint that does not return.
#[derive(Debug, Clone, Copy)]
struct Jump {
    /// The first sample after it.
    sample: usize,
    size: f64,
    percent: f64,
}

/// The jumps of a recording.
struct Jumps {
    /// Of each joint alone.
    of_joints: Vec<Vec<Jump>>,
    /// The largest at each sample at which most joints jump.
    of_most: Vec<Jump>,
}

impl Jumps {
    fn of(position: &Series) -> Self {
        let joints = position.channels();
        let all: Vec<Vec<Jump>> = (0..joints).map(|j| jumps_of(&position.channel(j))).collect();
        let at = |sample: usize| all.iter().flatten().filter(move |jump| jump.sample == sample);
        let is_of_most = |jump: &Jump| joints > 1 && 2 * at(jump.sample).count() > joints;
        let is_largest = |jump: &Jump| at(jump.sample).all(|other| other.percent <= jump.percent);
        let of_most = all.iter().flatten().filter(|jump| is_of_most(jump) && is_largest(jump)).copied().collect();
        let alone = |jumps: &Vec<Jump>| jumps.iter().filter(|jump| !is_of_most(jump)).copied().collect();
        Self { of_joints: all.iter().map(alone).collect(), of_most }
    }
}

fn jumps_of(x: &[f64]) -> Vec<Jump> {
    let span = span(x);
    let least = (FOUND_PERCENT / 100.0 * span).max(COUNTS * step_of(x).unwrap_or(0.0));
    let step = |k: usize| x[k] - x[k - 1];
    let largest_around = |k: usize| {
        let around = (k - AROUND..k).chain(k + 1..k + 1 + AROUND);
        around.map(|i| step(i).abs()).fold(0.0, f64::max)
    };
    let excess = |k: usize| {
        let over = |from: usize, to: usize| x[to] - x[from];
        over(k - 1 - ACROSS, k + ACROSS)
            - over(k - 2 - 3 * ACROSS, k - 1 - ACROSS) / 2.0
            - over(k + ACROSS, k + 1 + 3 * ACROSS) / 2.0
    };
    let reach = 2 + 3 * ACROSS;
    let is_jump = |&k: &usize| {
        let size = step(k).abs();
        size > least && size > TIMES * largest_around(k) && excess(k) * step(k).signum() > LASTING * size
    };
    let found: Vec<usize> = (reach..x.len().saturating_sub(reach)).filter(is_jump).collect();
    if found.len() > MOST {
        return Vec::new();
    }
    let jump = |k: usize| Jump { sample: k, size: step(k).abs(), percent: 100.0 * step(k).abs() / span };
    found.into_iter().map(jump).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swing(samples: usize) -> Vec<f64> {
        (0..samples).map(|k| (0.01 * k as f64).sin() + 0.3 * (0.023 * k as f64).cos()).collect()
    }

    fn places(x: &[f64]) -> Vec<usize> {
        jumps_of(x).iter().map(|jump| jump.sample).collect()
    }

    #[test]
    fn a_step_that_stays_is_a_jump_and_one_that_returns_is_none() {
        let mut x = swing(3000);
        assert_eq!(places(&x), [0; 0]);
        x[700] += 0.5;
        assert_eq!(places(&x), [0; 0]);
        x[1500..].iter_mut().for_each(|v| *v += 0.3);
        assert_eq!(places(&x), [1500]);
    }

    #[test]
    fn positions_that_are_held_and_catch_up_do_not_jump() {
        let mut x = swing(3000);
        let held = x[1200];
        x[1201..1220].iter_mut().for_each(|v| *v = held);
        assert_eq!(places(&x), [0; 0]);
    }

    #[test]
    fn single_counts_of_a_joint_that_hardly_moves_are_no_jumps() {
        let x: Vec<f64> = (0..2000).map(|k| if k < 1000 { 0.0 } else { 0.01 }).collect();
        assert_eq!(places(&x), [0; 0]);
    }

    #[test]
    fn where_most_joints_jump_a_recording_was_joined() {
        let cut = |x: Vec<f64>| [&x[..1000], &x[1300..]].concat();
        let of = |phase: usize| cut(swing(4000 + phase)[phase..].to_vec());
        let Jumps { of_joints, of_most } = Jumps::of(&Series::side_by_side(&[of(0), of(100), of(250)]));
        assert!(of_joints.iter().all(Vec::is_empty));
        assert_eq!(of_most.iter().map(|jump| jump.sample).collect::<Vec<_>>(), [1000]);
    }
}
