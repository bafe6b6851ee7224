//! Sequences of point-to-point moves that return to their first posture.

use crate::design::{limits::joint_limits::JointLimits, motions::sums::Derivatives};
use thetahat_estimation::trajectory::{Move, Moves, PHASES, TimeLaw};
use thetahat_ground::series::Series;

/// Moves through postures with time laws that the joints share; the last ends in the first posture.
///
/// | letter | word | unit of the unknown |
/// | --- | --- | --- |
/// | `P_k` | where move k starts; not unknown where it is given | half the range, from its middle |
/// | `T1 T2 T3` | widths of move k; T3 where the jerk is limited | a part of the duration |
#[derive(Debug, Clone)]
pub struct MoveFamily {
    /// Limits of the joints, less their margin.
    pub(in crate::design) limits: Vec<JointLimits>,
    /// The first posture where it is given.
    pub(in crate::design) start: Option<Vec<f64>>,
    pub(in crate::design) moves: usize,
    /// Time of the moves.
    pub(in crate::design) duration_s: f64,
    /// T3 where the jerk is not limited, and its least value.
    pub(in crate::design) smoothing_s: f64,
    /// Rest after each move.
    pub(in crate::design) rest_s: f64,
    /// Sweeps after the moves, in time of their own.
    pub(in crate::design) sweeps: Vec<Sweep>,
}

/// One way of a sweep: a joint moves alone.
#[derive(Debug, Clone)]
pub(in crate::design) struct Sweep {
    pub(in crate::design) joint: usize,
    /// Where it ends.
    pub(in crate::design) end: Vec<f64>,
    /// T1, T2 and T3.
    pub(in crate::design) widths: [f64; 3],
}

impl Sweep {
    pub(in crate::design) fn seconds(&self) -> f64 {
        self.widths.iter().sum()
    }
}

/// A point in a phase of a move.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Number of the move.
    pub(in crate::design) number: usize,
    pub(in crate::design) phase: usize,
    /// Part of the phase that has passed.
    pub(in crate::design) part: f64,
    /// Part of the phase that the point stands for.
    pub(in crate::design) share: f64,
}

/// Points and weights of Gauss and Legendre on the interval from 0 to 1.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Parts of a phase at which limits are checked.
const WATCHED: [f64; 7] = [0.001, 0.17, 0.33, 0.5, 0.67, 0.83, 0.999];
/// Units of T1, T2 and T3, parts of the time of a move.
const UNITS: [f64; 3] = [0.5, 0.25, 0.1];

impl MoveFamily {
    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.limits.len()
    }

    pub(in crate::design) fn widths(&self) -> usize {
        if self.limits.iter().any(|l| l.jerk.is_some()) { 3 } else { 2 }
    }

    pub(in crate::design) fn free_points(&self) -> usize {
        self.moves - usize::from(self.start.is_some())
    }

    /// Unknowns in all.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.free_points() * self.joints() + self.moves * self.widths()
    }

    /// The first unknown of a posture, where it is not given.
    pub(in crate::design) fn of_point(&self, number: usize) -> Option<usize> {
        let number = number % self.moves;
        match &self.start {
            None => Some(number * self.joints()),
            Some(_) => number.checked_sub(1).map(|number| number * self.joints()),
        }
    }

    /// The first unknown width of a move.
    pub(in crate::design) fn of_widths(&self, number: usize) -> usize {
        self.free_points() * self.joints() + number * self.widths()
    }

    pub(in crate::design) fn half(&self, joint: usize) -> f64 {
        0.5 * (self.limits[joint].upper - self.limits[joint].lower)
    }

    pub(in crate::design) fn unit(&self, width: usize) -> f64 {
        UNITS[width] * self.duration_s / self.moves as f64
    }

    pub(in crate::design) fn point(&self, x: &[f64], number: usize) -> Vec<f64> {
        let own = |first: usize| {
            let value = |j: usize| self.limits[j].middle() + self.half(j) * x[first + j];
            (0..self.joints()).map(value).collect()
        };
        self.of_point(number).map(own).or_else(|| self.start.clone()).unwrap_or_default()
    }

    /// The first posture in units of the ranges, where it is given.
    #[must_use]
    pub fn start_in_units(&self) -> Option<Vec<f64>> {
        let in_units = |(j, q): (usize, &f64)| (q - self.limits[j].middle()) / self.half(j);
        self.start.as_ref().map(|start| start.iter().enumerate().map(in_units).collect())
    }

    /// The law of a move that starts at a time.
    pub(in crate::design) fn law(&self, x: &[f64], number: usize, start_s: f64) -> TimeLaw {
        let first = self.of_widths(number);
        let width = |i: usize| if i < self.widths() { self.unit(i) * x[first + i] } else { self.smoothing_s };
        TimeLaw { start_s, t1_s: width(0), t2_s: width(1), t3_s: width(2) }
    }

    /// The moves with the unknowns `x`, from time zero; `None` if the unknowns give no valid moves.
    #[must_use]
    pub fn moves(&self, x: &[f64]) -> Option<Moves> {
        let (mut moves, mut time_s) = (Vec::with_capacity(self.moves), 0.0);
        for number in 0..self.moves {
            let law = self.law(x, number, time_s);
            let t2_s = law.t2_s.max(law.t3_s);
            let law = TimeLaw { t1_s: law.t1_s.max(t2_s), t2_s, ..law };
            time_s = law.end_s() + self.rest_s;
            moves.push(Move { law, end: self.point(x, number + 1) });
        }
        moves.extend(self.swept_from(time_s.max(self.duration_s)));
        Moves::new(self.point(x, 0), moves).ok()
    }

    /// Points at which sums over time are taken.
    #[must_use]
    pub fn summed(&self) -> Vec<Point> {
        self.points(&|_| GAUSS.to_vec())
    }

    /// Points at which limits are checked: the middle of a phase in which the jerk acts.
    #[must_use]
    pub fn watched(&self) -> Vec<Point> {
        self.points(&|phase| {
            let all = if phase % 2 == 0 { &WATCHED[3..4] } else { &WATCHED[..] };
            all.iter().map(|part| (*part, 0.0)).collect()
        })
    }

    fn points(&self, of_phase: &dyn Fn(usize) -> Vec<(f64, f64)>) -> Vec<Point> {
        let phases = (0..self.moves).flat_map(|number| (0..PHASES).map(move |phase| (number, phase)));
        let point = |(number, phase)| {
            of_phase(phase).into_iter().map(move |(part, share)| Point { number, phase, part, share })
        };
        phases.flat_map(point).collect()
    }

    /// The motion at points.
    #[must_use]
    pub fn motion(&self, points: &[Point], x: &[f64]) -> Derivatives {
        let mut motion = [(); 4].map(|()| Series::zeros(points.len(), self.joints()));
        for (k, point) in points.iter().enumerate() {
            let law = self.law(x, point.number, 0.0).in_phase(point.phase, point.part);
            let (from, to) = (self.point(x, point.number), self.point(x, point.number + 1));
            for (order, series) in motion.iter_mut().enumerate() {
                for (j, value) in series.sample_mut(k).iter_mut().enumerate() {
                    let start = if order == 0 { from[j] } else { 0.0 };
                    *value = start + (to[j] - from[j]) * law.values[order];
                }
            }
        }
        motion
    }

    /// The time that each point stands for, s.
    #[must_use]
    pub fn seconds(&self, points: &[Point], x: &[f64]) -> Vec<f64> {
        let of = |point: &Point| {
            let law = self.law(x, point.number, 0.0);
            let by_width = law.in_phase(point.phase, point.part).seconds_by_width;
            let widths = [law.t1_s, law.t2_s, law.t3_s];
            point.share * by_width.iter().zip(widths).map(|(b, w)| b * w).sum::<f64>().max(0.0)
        };
        points.iter().map(of).collect()
    }

    /// How long the moves take with their rests, s.
    pub(in crate::design) fn time_s(&self, x: &[f64]) -> f64 {
        (0..self.moves).map(|number| self.law(x, number, 0.0).end_s() + self.rest_s).sum()
    }
}
