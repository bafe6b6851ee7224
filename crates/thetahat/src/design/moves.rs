//! Rows of point-to-point moves that return to their first posture.

use super::{
    fourier::ORDERS,
    limits::JointLimits,
    quadratic::Row,
    sums::{Derivatives, Slopes},
};
use crate::{
    series::Series,
    trajectory::{Move, Moves, PHASES, TimeLaw},
};

/// Moves through postures with time laws that the joints share; the last ends in the first posture.
///
/// | letter | word | unit of the unknown |
/// | --- | --- | --- |
/// | `P_k` | where move k starts; not unknown where it is given | half the range, from its middle |
/// | `T1 T2 T3` | widths of move k; T3 where the jerk is limited | a part of the duration |
#[derive(Debug, Clone)]
pub struct MoveFamily {
    /// Limits of the joints, less their margin.
    pub(super) limits: Vec<JointLimits>,
    /// The first posture where it is given.
    pub(super) start: Option<Vec<f64>>,
    pub(super) moves: usize,
    pub(super) duration_s: f64,
    /// T3 where the jerk is not limited, and its least value.
    pub(super) smoothing_s: f64,
    /// Rest after each move.
    pub(super) rest_s: f64,
}

/// A point in a phase of a move.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Number of the move.
    number: usize,
    phase: usize,
    /// Part of the phase that has passed.
    part: f64,
    /// Part of the phase that the point stands for.
    share: f64,
}

/// Points and weights of Gauss and Legendre on the interval from 0 to 1.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Parts of a phase at which limits are looked at.
const WATCHED: [f64; 7] = [0.001, 0.17, 0.33, 0.5, 0.67, 0.83, 0.999];
/// Units of T1, T2 and T3, parts of the time of a move.
const UNITS: [f64; 3] = [0.5, 0.25, 0.1];

impl MoveFamily {
    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.limits.len()
    }

    pub(super) fn widths(&self) -> usize {
        if self.limits.iter().any(|l| l.jerk.is_some()) { 3 } else { 2 }
    }

    fn free_points(&self) -> usize {
        self.moves - usize::from(self.start.is_some())
    }

    /// Unknowns in all.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.free_points() * self.joints() + self.moves * self.widths()
    }

    /// The first unknown of a posture, where it is not given.
    fn of_point(&self, number: usize) -> Option<usize> {
        let number = number % self.moves;
        match &self.start {
            None => Some(number * self.joints()),
            Some(_) => number.checked_sub(1).map(|number| number * self.joints()),
        }
    }

    /// The first unknown width of a move.
    pub(super) fn of_widths(&self, number: usize) -> usize {
        self.free_points() * self.joints() + number * self.widths()
    }

    pub(super) fn half(&self, joint: usize) -> f64 {
        0.5 * (self.limits[joint].upper - self.limits[joint].lower)
    }

    pub(super) fn unit(&self, width: usize) -> f64 {
        UNITS[width] * self.duration_s / self.moves as f64
    }

    pub(super) fn point(&self, x: &[f64], number: usize) -> Vec<f64> {
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
    fn law(&self, x: &[f64], number: usize, start_s: f64) -> TimeLaw {
        let first = self.of_widths(number);
        let width = |i: usize| if i < self.widths() { self.unit(i) * x[first + i] } else { self.smoothing_s };
        TimeLaw { start_s, t1_s: width(0), t2_s: width(1), t3_s: width(2) }
    }

    /// The moves with the unknowns `x`, from time zero; none where they are no moves.
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
        Moves::new(self.point(x, 0), moves).ok()
    }

    /// Points at which sums over time are taken.
    #[must_use]
    pub fn summed(&self) -> Vec<Point> {
        self.points(&|_| GAUSS.to_vec())
    }

    /// Points at which limits are looked at: of a phase in which the jerk acts the middle.
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

    /// The derivative by the unknowns of a function with these derivatives at points.
    #[must_use]
    pub fn chain(&self, points: &[Point], x: &[f64], slopes: &Slopes) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        for (k, point) in points.iter().enumerate() {
            let by_motion: Vec<&[f64]> = slopes.by_motion.iter().map(|series| series.sample(k)).collect();
            self.add(&mut sum, point, x, &by_motion, slopes.by_seconds.get(k).copied().unwrap_or(0.0));
        }
        sum
    }

    fn add(&self, sum: &mut [f64], point: &Point, x: &[f64], by_motion: &[&[f64]], by_seconds: f64) {
        let law = self.law(x, point.number, 0.0).in_phase(point.phase, point.part);
        let ends = [point.number, point.number + 1].map(|number| (self.of_point(number), self.point(x, number)));
        let [(at_from, from), (at_to, to)] = ends;
        let mut by_width = law.seconds_by_width.map(|b| b * by_seconds * point.share);
        for j in 0..self.joints() {
            let by_end: f64 = by_motion.iter().zip(law.values).map(|(slope, value)| slope[j] * value).sum();
            if let Some(first) = at_from {
                sum[first + j] += self.half(j) * (by_motion[0][j] - by_end);
            }
            if let Some(first) = at_to {
                sum[first + j] += self.half(j) * by_end;
            }
            for (slope, by_widths) in by_motion.iter().zip(law.slopes) {
                by_width.iter_mut().zip(by_widths).for_each(|(b, width)| *b += slope[j] * (to[j] - from[j]) * width);
            }
        }
        let first = self.of_widths(point.number);
        (0..self.widths()).for_each(|i| sum[first + i] += self.unit(i) * by_width[i]);
    }

    /// The derivatives by the unknowns of one derivative of one joint's position at a point.
    #[must_use]
    pub fn signal(&self, point: &Point, x: &[f64], joint: usize, order: usize) -> Vec<f64> {
        let (mut sum, zeros) = (vec![0.0; self.unknowns()], vec![0.0; self.joints()]);
        let mut one = zeros.clone();
        one[joint] = 1.0;
        let by_motion: Vec<&[f64]> = (0..ORDERS).map(|o| if o == order { &one[..] } else { &zeros[..] }).collect();
        self.add(&mut sum, point, x, &by_motion, 0.0);
        sum
    }

    /// What holds of the unknowns alone, as rows of a step: the range of each joint, `T1 >= T2 + T3`, `T2 >= T3`, and the time.
    pub(super) fn rows(&self, x: &[f64]) -> Vec<Row> {
        let hard = |start, entries, bound: f64| Row { start, entries, bound: bound.max(0.0), soft: false };
        let points = 0..self.of_widths(0);
        let ranges = points.flat_map(|i| [hard(i, vec![1.0], 1.0 - x[i]), hard(i, vec![-1.0], 1.0 + x[i])]);
        let orders = (0..self.moves).flat_map(|number| {
            let (first, law) = (self.of_widths(number), self.law(x, number, 0.0));
            let row = |factors: [f64; 3], bound: f64| {
                hard(first, (0..self.widths()).map(|i| self.unit(i) * factors[i]).collect(), bound)
            };
            [
                row([-1.0, 1.0, 1.0], law.t1_s - law.t2_s - law.t3_s),
                row([0.0, -1.0, 1.0], law.t2_s - law.t3_s),
                row([0.0, 0.0, -1.0], law.t3_s - self.smoothing_s),
            ]
        });
        let units: Vec<f64> = (0..self.moves).flat_map(|_| (0..self.widths()).map(|i| self.unit(i))).collect();
        let time = hard(self.of_widths(0), units, self.duration_s - self.time_s(x));
        ranges.chain(orders).chain([time]).collect()
    }

    /// How long the moves take with their rests, s.
    pub(super) fn time_s(&self, x: &[f64]) -> f64 {
        (0..self.moves).map(|number| self.law(x, number, 0.0).end_s() + self.rest_s).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(jerk: Option<f64>) -> Vec<JointLimits> {
        let of = |joint: &str, upper: f64, velocity: f64| JointLimits {
            joint: joint.to_owned(),
            lower: -0.5,
            upper,
            velocity,
            acceleration: 20.0,
            jerk,
            torque: None,
            power: None,
        };
        vec![of("a", 1.5, 3.0), of("b", 2.0, 5.0)]
    }

    fn families() -> Vec<MoveFamily> {
        let of = |jerk, start| MoveFamily {
            limits: limits(jerk),
            start,
            moves: 3,
            duration_s: 4.0,
            smoothing_s: 0.01,
            rest_s: 0.05,
        };
        vec![of(None, None), of(Some(200.0), None), of(Some(200.0), Some(vec![0.3, 0.1]))]
    }

    /// Unknowns of moves at some postures, slower than the limits allow.
    fn unknowns(family: &MoveFamily) -> Vec<f64> {
        let postures: Vec<f64> = (0..family.posture_unknowns()).map(|i| (1.7 * i as f64).sin()).collect();
        let mut x = family.through(&postures);
        x[family.posture_unknowns()..].chunks_exact_mut(family.widths()).for_each(|widths| {
            widths[0] += 0.1;
        });
        x
    }

    /// Of sums of positions, velocities, accelerations and times at the points, each times a number.
    #[test]
    fn the_chain_is_that_of_finite_differences() {
        for family in families() {
            let (x, points) = (unknowns(&family), family.summed());
            let number = |k: usize, j: usize, order: usize| ((3 * k + 5 * j + 7 * order) as f64).cos();
            let value = |x: &[f64]| {
                let (motion, seconds) = (family.motion(&points, x), family.seconds(&points, x));
                let mut sum: f64 = seconds.iter().enumerate().map(|(k, s)| number(k, 0, 9) * s).sum();
                for (order, series) in motion[..3].iter().enumerate() {
                    for k in 0..points.len() {
                        sum += series.sample(k).iter().enumerate().map(|(j, v)| number(k, j, order) * v).sum::<f64>();
                    }
                }
                sum
            };
            let by_motion = [0, 1, 2].map(|order| {
                Series::from_values(2, (0..2 * points.len()).map(|i| number(i / 2, i % 2, order)).collect())
            });
            let by_seconds = (0..points.len()).map(|k| number(k, 0, 9)).collect();
            let exact = family.chain(&points, &x, &Slopes { by_motion, by_seconds });
            for (i, exact) in exact.iter().enumerate() {
                let h = 1e-6;
                let moved = |h: f64| {
                    value(&x.iter().enumerate().map(|(k, v)| if k == i { v + h } else { *v }).collect::<Vec<_>>())
                };
                let central = (moved(h) - moved(-h)) / (2.0 * h);
                assert!((central - exact).abs() < 1e-6 * exact.abs().max(100.0), "{i}: {central} {exact}");
            }
        }
    }

    /// The points of the phases lie on the moves, and their times add up to the moves' own.
    #[test]
    fn points_are_of_the_moves() {
        for family in families() {
            let (x, points) = (unknowns(&family), family.summed());
            let moves = family.moves(&x).unwrap();
            let sum: f64 = family.seconds(&points, &x).iter().sum();
            assert!((sum - (moves.end_s() - 2.0 * family.rest_s)).abs() < 1e-12);
            assert_eq!(moves.start(), moves.moves()[2].end);
            // The middle of the cruise of the second move.
            let law = moves.moves()[1].law;
            let cruise = points.iter().position(|p| p.number == 1 && p.phase == 3 && p.part == 0.5).unwrap();
            let (mut q, mut dq, mut ddq) = ([0.0; 2], [0.0; 2], [0.0; 2]);
            moves.evaluate(law.start_s + 0.5 * (law.t2_s + law.t3_s + law.t1_s), &mut q, &mut dq, &mut ddq);
            let motion = family.motion(&points, &x);
            for (found, expected) in motion.iter().zip([q, dq, ddq]) {
                assert!(found.sample(cruise).iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9));
            }
        }
    }

    /// Moves through postures hold the limits of velocity, acceleration and jerk.
    #[test]
    fn the_fastest_moves_hold_their_limits() {
        for family in families() {
            let postures: Vec<f64> = (0..family.posture_unknowns()).map(|i| (1.7 * i as f64).sin()).collect();
            let x = family.through(&postures);
            let motion = family.motion(&family.watched(), &x);
            for (j, limits) in family.limits.iter().enumerate() {
                let largest = |order: usize| motion[order].channel(j).into_iter().fold(0.0, |a: f64, v| a.max(v.abs()));
                assert!(largest(1) <= limits.velocity * (1.0 + 1e-9));
                assert!(largest(2) <= limits.acceleration * (1.0 + 1e-9));
                assert!(limits.jerk.is_none_or(|jerk| largest(3) <= jerk * (1.0 + 1e-9)));
            }
            assert!(family.time_s(&x) <= family.duration_s);
        }
    }
}
