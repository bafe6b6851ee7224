//! Derivatives of moves by their unknowns, and constraints on the unknowns themselves.

use crate::design::motions::{
    fourier::ORDERS,
    moves::{MoveFamily, Point},
    sums::Slopes,
};
use thetahat_ground::quadratic_program::Row;

impl MoveFamily {
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

    /// Constraints on the unknowns themselves, as rows of a step: the range of each joint, `T1 >= T2 + T3`, `T2 >= T3`, and the time.
    pub(in crate::design) fn rows(&self, x: &[f64]) -> Vec<Row> {
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
}
