//! Two recordings that hold the same samples.
//!
//! Positions and torques of all joints at one time are a fingerprint: a robot that repeats a motion repeats its positions,
//! but not the noise of its torques.

use std::collections::HashSet;

use super::companion::Companion;
use crate::checks::{
    finding::{Code, Finding, Measure, Severity},
    numbers::span,
};
use thetahat_ground::series::Series;

/// Percent of the moving samples of the shorter recording that the other one contains. Clean pairs share none: the two of the
/// KUKA, the two of EMPS, whose motion is the same, and twins that repeat a motion with other noise.
const LIMIT_PERCENT: f64 = 5.0;
/// Fewest numbers of a fingerprint: for a robot with few joints it spans several samples.
const NUMBERS: usize = 12;
/// Most samples of a fingerprint.
const MOST_SAMPLES: usize = 6;
/// Numbers count as equal within this part of a channel's span: a copy may be rounded.
const EQUAL: f64 = 1e-3;
/// Most fingerprints that are compared.
const ENOUGH: usize = 20_000;

/// The findings, pair by pair.
pub(in crate::checks) fn check(companions: &[Companion<'_>]) -> Vec<Finding> {
    let shared = pairs(companions).filter_map(|(a, b)| Some((a, b, shared_percent(a, b)?)));
    shared.filter(|s| s.2 > LIMIT_PERCENT).map(|(a, b, percent)| finding(a, b, percent)).collect()
}

/// The largest share of each pair.
pub(in crate::checks) fn measure(companions: &[Companion<'_>]) -> Vec<Measure> {
    let shared = pairs(companions).filter_map(|(a, b)| shared_percent(a, b));
    let measure = |value| Measure { code: Code::SameRecording, joint: None, value, limit: LIMIT_PERCENT };
    shared.map(measure).collect()
}

fn pairs<'c, 'a>(companions: &'c [Companion<'a>]) -> impl Iterator<Item = (&'c Companion<'a>, &'c Companion<'a>)> {
    companions.iter().enumerate().flat_map(move |(i, a)| companions[i + 1..].iter().map(move |b| (a, b)))
}

fn finding(a: &Companion<'_>, b: &Companion<'_>, percent: f64) -> Finding {
    let (why, remedy) = if a.held_back == b.held_back {
        (
            "the same rows count twice, so the intervals are too narrow",
            "remove one of them, or give them windows that do not overlap (window_start_s, window_end_s in [[recording]])",
        )
    } else {
        (
            "the validation uses data of the estimate",
            "validate on another recording, or give the two recordings windows that do not overlap (window_start_s, window_end_s in [[recording]])",
        )
    };
    Finding {
        code: Code::SameRecording,
        severity: Severity::Problem,
        joint: None,
        joint_name: None,
        value: percent,
        unit: "% of the samples".to_owned(),
        limit: Some(LIMIT_PERCENT),
        message: format!(
            "recordings {} and {} share {percent:.0} % of their moving samples: {why}",
            a.label(),
            b.label()
        ),
        remedy: remedy.to_owned(),
        parameters: Vec::new(),
        step: None,
    }
}

/// Percent of the moving samples of the shorter one that the other contains; `None` if one lacks torques or motion.
fn shared_percent(a: &Companion<'_>, b: &Companion<'_>) -> Option<f64> {
    let (a, b) = (Samples::of(a)?, Samples::of(b)?);
    let (short, long) = if a.position.len() < b.position.len() { (a, b) } else { (b, a) };
    let equal: Vec<f64> = short.spans().iter().zip(long.spans()).map(|(a, b)| EQUAL * a.max(b)).collect();
    let known: HashSet<Vec<i64>> = long.fingerprints(&equal, 1).collect();
    let stride = (short.position.len() / ENOUGH).max(1);
    let (mut all, mut found) = (0_usize, 0_usize);
    for print in short.fingerprints(&equal, stride) {
        all += 1;
        found += usize::from(known.contains(&print));
    }
    (all > 0).then(|| 100.0 * found as f64 / all as f64)
}

/// Positions and torques in the window of a recording.
struct Samples {
    position: Series,
    torque: Series,
}

impl Samples {
    fn of(companion: &Companion<'_>) -> Option<Self> {
        let position = companion.subject.position.window(companion.subject.signal.window.clone());
        Some(Self { position, torque: companion.subject.torque_in_window()? })
    }

    fn spans(&self) -> Vec<f64> {
        let of = |series: &Series| (0..series.channels()).map(|j| span(&series.channel(j))).collect::<Vec<_>>();
        [of(&self.position), of(&self.torque)].concat()
    }

    /// The fingerprints of the samples at which a joint moves.
    fn fingerprints<'s>(&'s self, equal: &'s [f64], stride: usize) -> impl Iterator<Item = Vec<i64>> + 's {
        let samples = NUMBERS.div_ceil(equal.len()).min(MOST_SAMPLES);
        let last = self.position.len().saturating_sub(samples);
        let moves = |k: &usize| self.position.sample(*k) != self.position.sample(*k + 1);
        let print = move |k: usize| {
            let rows = (k..k + samples).flat_map(|k| self.position.sample(k).iter().chain(self.torque.sample(k)));
            rows.zip(equal.iter().cycle()).map(|(v, e)| (v / e.max(f64::MIN_POSITIVE)).round() as i64).collect()
        };
        (0..last).step_by(stride).filter(moves).map(print)
    }
}
