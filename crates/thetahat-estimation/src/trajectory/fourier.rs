use std::f64::consts::TAU;

use crate::signal::Motion;
use thetahat_ground::series::Series;

/// A periodic motion in closed form, plus a polynomial for a drift:
/// `q_j(t) = sum_i p_ij s^i + sum_h a_hj cos(h w u) + b_hj sin(h w u)`, with `u = t - t_0`, `s = u / l`.
///
/// (J. Swevers and others, "Optimal robot excitation and identification", IEEE Trans. Robotics and Automation 13(5), 1997.)
#[derive(Debug, Clone, PartialEq)]
pub struct FourierSeries {
    /// `w / 2 pi`, Hz.
    base_frequency_hz: f64,
    /// `t_0`, s.
    centre_s: f64,
    /// `l`, s.
    half_length_s: f64,
    /// Highest power of s.
    degree: usize,
    /// The coefficients of each term: powers, then a cosine and a sine for each harmonic; one number for each joint.
    coefficients: Vec<Vec<f64>>,
}

/// The terms of a series, shared by all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Terms {
    pub(super) base_frequency_hz: f64,
    pub(super) centre_s: f64,
    pub(super) half_length_s: f64,
    pub(super) degree: usize,
    pub(super) harmonics: usize,
}

impl Terms {
    pub(super) fn count(&self) -> usize {
        1 + self.degree + 2 * self.harmonics
    }

    /// Value and three derivatives of every term at time `t`, in order.
    #[inline]
    pub(super) fn each(&self, t: f64, mut take: impl FnMut(usize, [f64; 4])) {
        let u = t - self.centre_s;
        let (s, per) = (u / self.half_length_s, 1.0 / self.half_length_s);
        for i in 0..=self.degree {
            take(i, power(s, per, i as i32));
        }
        let w = TAU * self.base_frequency_hz;
        let (sin, cos) = (w * u).sin_cos();
        let (mut c, mut d) = (1.0, 0.0);
        for h in 1..=self.harmonics {
            (c, d) = (c * cos - d * sin, d * cos + c * sin);
            let v = w * h as f64;
            let first = self.degree + 2 * h - 1;
            take(first, [c, -v * d, -v * v * c, v * v * v * d]);
            take(first + 1, [d, v * c, -v * v * d, -v * v * v * c]);
        }
    }
}

/// `s^n` with three derivatives in time, where `ds/dt = per`.
fn power(s: f64, per: f64, n: i32) -> [f64; 4] {
    let derivative = |k: i32| {
        let factor: i32 = (0..k).map(|m| n - m).product();
        if k > n { 0.0 } else { f64::from(factor) * s.powi(n - k) * per.powi(k) }
    };
    [0, 1, 2, 3].map(derivative)
}

impl FourierSeries {
    pub(super) fn new(terms: Terms, coefficients: Vec<Vec<f64>>) -> Self {
        let Terms { base_frequency_hz, centre_s, half_length_s, degree, .. } = terms;
        Self { base_frequency_hz, centre_s, half_length_s, degree, coefficients }
    }

    fn terms(&self) -> Terms {
        let Self { base_frequency_hz, centre_s, half_length_s, degree, .. } = *self;
        Terms { base_frequency_hz, centre_s, half_length_s, degree, harmonics: self.harmonics() }
    }

    /// Base frequency, Hz.
    #[must_use]
    pub fn base_frequency_hz(&self) -> f64 {
        self.base_frequency_hz
    }

    /// Number of harmonics, including the base frequency.
    #[must_use]
    pub fn harmonics(&self) -> usize {
        (self.coefficients.len() - 1 - self.degree) / 2
    }

    /// Degree of the polynomial.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.coefficients[0].len()
    }

    /// Positions, velocities and accelerations at time `t`, in s. Does not allocate.
    pub fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        [&mut *q, &mut *dq, &mut *ddq].into_iter().for_each(|out| out.fill(0.0));
        self.add_derivatives(t, [0, 1, 2], [q, dq, ddq]);
    }

    /// Adds three of the motion's derivatives, of orders zero to three, at time `t`.
    pub(crate) fn add_derivatives(&self, t: f64, orders: [usize; 3], [a, b, c]: [&mut [f64]; 3]) {
        self.terms().each(t, |i, of_term| {
            for (j, coefficient) in self.coefficients[i].iter().enumerate() {
                a[j] += coefficient * of_term[orders[0]];
                b[j] += coefficient * of_term[orders[1]];
                c[j] += coefficient * of_term[orders[2]];
            }
        });
    }

    /// `samples` samples of positions, velocities and accelerations, the first at time zero.
    #[must_use]
    pub fn sample(&self, sample_rate_hz: f64, samples: usize) -> Motion {
        let zeros = || Series::zeros(samples, self.joints());
        let (mut q, mut dq, mut ddq) = (zeros(), zeros(), zeros());
        for k in 0..samples {
            self.evaluate(k as f64 / sample_rate_hz, q.sample_mut(k), dq.sample_mut(k), ddq.sample_mut(k));
        }
        Motion { q, dq, ddq }
    }

    /// The same motion in other coordinates: `position` maps points, and its linear part `rate` the derivatives.
    pub(crate) fn mapped(&self, position: &dyn Fn(&[f64]) -> Vec<f64>, rate: &dyn Fn(&[f64]) -> Vec<f64>) -> Self {
        let mut coefficients: Vec<Vec<f64>> = self.coefficients.iter().map(|c| rate(c)).collect();
        coefficients[0] = position(&self.coefficients[0]);
        Self { coefficients, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series() -> FourierSeries {
        let terms = Terms { base_frequency_hz: 0.3, centre_s: 2.0, half_length_s: 4.0, degree: 2, harmonics: 3 };
        let coefficients = (0..9).map(|i| vec![0.3 + 0.1 * f64::from(i), (1.7 * f64::from(i)).sin()]).collect();
        FourierSeries::new(terms, coefficients)
    }

    #[test]
    fn derivatives_are_those_of_the_motion() {
        let series = series();
        assert_eq!((series.harmonics(), series.joints(), series.degree()), (3, 2, 2));
        let at = |t: f64, order: usize| {
            let [mut a, mut b, mut c] = [[0.0; 2]; 3];
            series.add_derivatives(t, [order; 3], [&mut a, &mut b, &mut c]);
            a
        };
        let h = 1e-5;
        for (order, t) in [(0, 0.3), (1, 1.1), (2, 3.7)] {
            let (before, after, slope) = (at(t - h, order), at(t + h, order), at(t, order + 1));
            for j in 0..2 {
                let central = (after[j] - before[j]) / (2.0 * h);
                assert!((central - slope[j]).abs() < 1e-6 * slope[j].abs().max(1.0), "{order}: {central} {}", slope[j]);
            }
        }
    }

    #[test]
    fn a_map_acts_on_points_and_rates() {
        let (series, mut q, mut dq, mut ddq) = (series(), [0.0; 2], [0.0; 2], [0.0; 2]);
        let mapped = series.mapped(&|q| vec![2.0 * q[0] + q[1] - 0.5, q[1] + 1.0], &|v| vec![2.0 * v[0] + v[1], v[1]]);
        series.evaluate(0.7, &mut q, &mut dq, &mut ddq);
        let (expected_q, expected_ddq) = (2.0 * q[0] + q[1] - 0.5, 2.0 * ddq[0] + ddq[1]);
        mapped.evaluate(0.7, &mut q, &mut dq, &mut ddq);
        assert!((q[0] - expected_q).abs() < 1e-12 && (ddq[0] - expected_ddq).abs() < 1e-12);
    }
}
