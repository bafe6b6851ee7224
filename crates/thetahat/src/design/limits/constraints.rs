use std::collections::BTreeSet;

use crate::design::{
    limits::joint_limits::JointLimits,
    motions::{
        family::{MotionPoint, Motions},
        sums::Derivatives,
    },
};
use thetahat_ground::quadratic_program::Row;
use thetahat_report::results::Limited;

/// The limits of positions and their derivatives along a motion.
#[derive(Debug, Clone)]
pub(in crate::design) struct Constraints {
    limits: Vec<JointLimits>,
    /// What is limited here: positions of moves are within their range where their ends are.
    limited: Vec<Limited>,
}

/// A limit at one instant: `side * value <= side * limit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::design) struct Place {
    joint: usize,
    order: usize,
    instant: usize,
    is_upper: bool,
}

/// A signal is watched where it comes nearer to a limit than this part of half the range.
const NEAR: f64 = 0.15;
/// Part of a range within which a motion is at rest: rounding.
const ROUNDING: f64 = 1e-12;
/// Part of half the range by which a step may violate a limit that was not watched.
const TOLERANCE: f64 = 1e-6;

impl Constraints {
    pub(in crate::design) fn new(limits: Vec<JointLimits>, motions: &Motions) -> Self {
        let has_rows = |limited: &Limited| motions.is_linear() || *limited != Limited::Position;
        Self { limits, limited: Limited::ALL.into_iter().filter(has_rows).collect() }
    }

    /// The limits of the joints.
    pub(in crate::design) fn limits(&self) -> &[JointLimits] {
        &self.limits
    }

    /// Makes every limit smaller by a part.
    pub(in crate::design) fn tighten(&mut self, part: f64) {
        self.limits = self.limits.iter().map(|limits| limits.less(part)).collect();
    }

    /// Extremes of every signal that are nearer to a limit than `slack`, in parts of half the range.
    fn extremes(&self, motion: &Derivatives, slack: f64, mut take: impl FnMut(Place)) {
        for &limited in &self.limited {
            let Some(order) = limited.order() else { continue };
            for (joint, limits) in self.limits.iter().enumerate() {
                let Some([lower, upper]) = limits.range(limited) else { continue };
                let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
                let values = motion[order].channel(joint);
                let used = |k: usize| (values[k] - middle) / half;
                for instant in 0..values.len() {
                    let here = used(instant);
                    let least = here.abs();
                    if least < 1.0 - slack {
                        continue;
                    }
                    let below = |k: usize| used(k) * here.signum() <= least;
                    if below(instant.saturating_sub(1)) && below((instant + 1).min(values.len() - 1)) {
                        take(Place { joint, order, instant, is_upper: here > 0.0 });
                    }
                }
            }
        }
    }

    /// The places at which a motion is near its limits.
    pub(in crate::design) fn near(&self, motion: &Derivatives) -> BTreeSet<Place> {
        let mut places = BTreeSet::new();
        self.extremes(motion, NEAR, |place| _ = places.insert(place));
        places
    }

    /// Adds the places at which a motion violates its limits; whether there was a new one.
    pub(in crate::design) fn add_violated(&self, motion: &Derivatives, places: &mut BTreeSet<Place>) -> bool {
        let before = places.len();
        self.extremes(motion, -TOLERANCE, |place| _ = places.insert(place));
        places.len() > before
    }

    /// The largest use of a limit: one where a motion touches it.
    pub(in crate::design) fn use_of(&self, motion: &Derivatives) -> f64 {
        let mut largest = 0.0_f64;
        for &limited in &self.limited {
            let Some(order) = limited.order() else { continue };
            for (joint, limits) in self.limits.iter().enumerate() {
                let Some([lower, upper]) = limits.range(limited) else { continue };
                let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
                let used = motion[order].channel(joint).into_iter().map(|v| ((v - middle) / half).abs());
                largest = used.fold(largest, f64::max);
            }
        }
        largest
    }

    /// The largest factor by which each joint's motion about a posture can be multiplied within its limits.
    pub(in crate::design) fn room(&self, motion: &Derivatives, about: &[f64]) -> Vec<f64> {
        let of_joint = |(joint, limits): (usize, &JointLimits)| {
            let mut room = f64::INFINITY;
            for &limited in &self.limited {
                let (Some(order), Some(range)) = (limited.order(), limits.range(limited)) else { continue };
                let centre = if order == 0 { about[joint] } else { 0.0 };
                let [lower, upper] = range.map(|end| end - centre);
                let rest = ROUNDING * (upper - lower);
                let of_value = |value: f64| match value - centre {
                    by if by > rest => upper / by,
                    by if by < -rest => lower / by,
                    _ => f64::INFINITY,
                };
                room = motion[order].channel(joint).into_iter().map(of_value).fold(room, f64::min);
            }
            room
        };
        self.limits.iter().enumerate().map(of_joint).collect()
    }

    /// The rows of a step from a motion at these places, over half the range of each.
    pub(in crate::design) fn rows(&self, at: MotionPoint<'_>, places: &BTreeSet<Place>) -> Vec<Row> {
        places.iter().map(|place| self.row(at, place)).collect()
    }

    /// A row that holds for the step where motions are linear, and is linearised where they are not.
    fn row(&self, at: MotionPoint<'_>, place: &Place) -> Row {
        let MotionPoint { motions, x, motion } = at;
        let Place { joint, order, instant, is_upper } = *place;
        let limited = Limited::ALL[order];
        let [lower, upper] = self.limits[joint].range(limited).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let (side, limit) = if is_upper { (1.0, upper) } else { (-1.0, lower) };
        let per = side / (0.5 * (upper - lower));
        let bound = per * (limit - motion[order].sample(instant)[joint]);
        let (start, slopes) = motions.signal(x, instant, joint, order);
        let soft = !motions.is_linear();
        let bound = if soft { bound } else { bound.max(0.0) };
        Row { start, entries: slopes.into_iter().map(|slope| per * slope).collect(), bound, soft }
    }
}
