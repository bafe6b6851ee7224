use std::collections::BTreeSet;

use super::{
    family::{Derivatives, Family, Sampled},
    limits::{JointLimits, Limited},
    quadratic::Row,
};

/// The limits of positions and their derivatives along a motion: linear in the unknowns.
#[derive(Debug, Clone)]
pub(super) struct Constraints {
    limits: Vec<JointLimits>,
    /// Where they are looked at.
    pub(super) sampled: Sampled,
}

/// A limit at one instant: `side * value <= side * limit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    joint: usize,
    order: usize,
    instant: usize,
    is_upper: bool,
}

/// A signal is watched where it comes nearer to a limit than this part of half the range.
const NEAR: f64 = 0.15;
/// Part of half the range by which a step may violate a limit that was not watched.
const TOLERANCE: f64 = 1e-6;

impl Constraints {
    pub(super) fn new(limits: Vec<JointLimits>, sampled: Sampled) -> Self {
        Self { limits, sampled }
    }

    /// Extremes of every signal that are nearer to a limit than `slack`, in parts of half the range.
    fn extremes(&self, motion: &Derivatives, slack: f64, mut take: impl FnMut(Place)) {
        for limited in Limited::ALL {
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
    pub(super) fn near(&self, motion: &Derivatives) -> BTreeSet<Place> {
        let mut places = BTreeSet::new();
        self.extremes(motion, NEAR, |place| _ = places.insert(place));
        places
    }

    /// Adds the places at which a motion violates its limits; whether there was a new one.
    pub(super) fn add_violated(&self, motion: &Derivatives, places: &mut BTreeSet<Place>) -> bool {
        let before = places.len();
        self.extremes(motion, -TOLERANCE, |place| _ = places.insert(place));
        places.len() > before
    }

    /// The largest use of a limit: one where a motion touches it.
    pub(super) fn use_of(&self, motion: &Derivatives) -> f64 {
        let mut largest = 0.0_f64;
        for limited in Limited::ALL {
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

    /// The rows of a step from a motion at these places, over half the range of each.
    pub(super) fn rows(&self, family: &Family, motion: &Derivatives, places: &BTreeSet<Place>) -> Vec<Row> {
        places.iter().map(|place| self.row(family, motion, place)).collect()
    }

    fn row(&self, family: &Family, motion: &Derivatives, place: &Place) -> Row {
        let Place { joint, order, instant, is_upper } = *place;
        let limited = Limited::ALL[order];
        let [lower, upper] = self.limits[joint].range(limited).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let (side, limit) = if is_upper { (1.0, upper) } else { (-1.0, lower) };
        let per = side / (0.5 * (upper - lower));
        let functions = &self.sampled.orders[order];
        let size = family.unknowns_of_joint();
        Row {
            start: joint * size,
            entries: (0..size).map(|m| per * functions.at(instant, m) * family.unit(joint, m)).collect(),
            bound: (per * (limit - motion[order].sample(instant)[joint])).max(0.0),
            soft: false,
        }
    }
}
