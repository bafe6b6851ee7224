use std::f64::consts::TAU;

use crate::linear_algebra::Matrix;

/// Derivatives of a motion that are computed: position, velocity, acceleration, jerk.
pub(super) const ORDERS: usize = 4;

/// Functions of time of which the joints' motions are sums: they rest at zero at both ends.
///
/// Of each harmonic `w = 2 pi l / T` there are two, each with a quintic that brings it to rest at both ends:
/// `sin w t - w T P1(t / T)` and `1 - cos w t - (w T)^2 P2(t / T)`. The harmonics' quintics are nearly the same motion, so
/// that sums of them are taken which have accelerations of mean square one and are orthogonal.
#[derive(Debug, Clone, PartialEq)]
pub struct FourierBasis {
    period_s: f64,
    harmonics: usize,
    /// R of the accelerations of the harmonics, upper triangular: the functions are `F R^-1`.
    triangle: Matrix,
}

/// Instants per harmonic on which accelerations are made orthogonal.
const INSTANTS: usize = 16;

impl FourierBasis {
    /// The functions of a period in s and a number of harmonics, both above zero.
    #[must_use]
    pub fn new(period_s: f64, harmonics: usize) -> Self {
        let instants = INSTANTS * harmonics;
        let time: Vec<f64> = (0..instants).map(|k| (k as f64 + 0.5) / instants as f64 * period_s).collect();
        let rows: Vec<Vec<f64>> = time.iter().map(|t| raw(period_s, harmonics, *t)[2].clone()).collect();
        let scale = 1.0 / (instants as f64).sqrt();
        let accelerations = Matrix::from_fn(instants, 2 * harmonics, |k, m| scale * rows[k][m]);
        Self { period_s, harmonics, triangle: accelerations.triangular_factor() }
    }

    /// Number of functions: two for each harmonic.
    #[must_use]
    pub fn functions(&self) -> usize {
        2 * self.harmonics
    }

    /// T, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Values and derivatives of all functions at a time from 0 to T, order by order.
    #[must_use]
    pub fn at(&self, t: f64) -> [Vec<f64>; ORDERS] {
        raw(self.period_s, self.harmonics, t).map(|row| self.solve(row))
    }

    /// What to take of each function for a motion to one side and back, the first harmonic's cosine, with a largest position
    /// of one.
    #[must_use]
    pub fn excursion(&self) -> Vec<f64> {
        let peak = raw(self.period_s, self.harmonics, 0.5 * self.period_s)[0][1];
        (0..self.functions()).map(|m| if m <= 1 { self.triangle.at(m, 1) / peak } else { 0.0 }).collect()
    }

    /// `f R^-1`.
    fn solve(&self, mut row: Vec<f64>) -> Vec<f64> {
        for m in 0..row.len() {
            let known: f64 = (0..m).map(|i| row[i] * self.triangle.at(i, m)).sum();
            row[m] = (row[m] - known) / self.triangle.at(m, m);
        }
        row
    }
}

/// The harmonics with their quintics, order by order: sine and cosine of the first, of the second ...
pub(super) fn raw(period_s: f64, harmonics: usize, t: f64) -> [Vec<f64>; ORDERS] {
    let (first, second) = quintics(t / period_s);
    let mut orders = [(); ORDERS].map(|()| Vec::with_capacity(2 * harmonics));
    for l in 1..=harmonics {
        let w = TAU * l as f64 / period_s;
        let (sin, cos) = (w * t).sin_cos();
        let sine = [sin, w * cos, -w * w * sin, -w * w * w * cos];
        let cosine = [1.0 - cos, w * sin, w * w * cos, -w * w * w * sin];
        for (order, values) in orders.iter_mut().enumerate() {
            let rate = period_s.powi(-(order as i32));
            let turns = w * period_s;
            values.push(sine[order] - turns * rate * first[order]);
            values.push(cosine[order] - turns * turns * rate * second[order]);
        }
    }
    orders
}

/// `P1 = s - 10 s^3 + 15 s^4 - 6 s^5` and `P2 = (s^2 - 2 s^3 + s^4) / 2` with their derivatives: both are zero at 0 and 1,
/// where P1 has the slope one and P2 the second derivative one, and their other derivatives up to the second are zero.
fn quintics(s: f64) -> ([f64; ORDERS], [f64; ORDERS]) {
    let u = 1.0 - s;
    let first = [
        s - s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
        1.0 - 30.0 * s * s * u * u,
        -60.0 * s * u * (u - s),
        -60.0 * (1.0 - 6.0 * s * u),
    ];
    let second = [0.5 * s * s * u * u, s * u * (u - s), 1.0 - 6.0 * s * u, 6.0 * (s - u)];
    (first, second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_rest_at_both_ends() {
        let basis = FourierBasis::new(7.0, 6);
        for t in [0.0, 7.0] {
            let [q, dq, ddq, _] = basis.at(t);
            for (order, values) in [q, dq, ddq].into_iter().enumerate() {
                assert!(values.iter().all(|v| v.abs() < 1e-10), "order {order} at {t}: {values:?}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let (basis, h) = (FourierBasis::new(4.0, 3), 1e-5);
        for t in [0.3, 1.7, 3.9] {
            let (before, here, behind) = (basis.at(t - h), basis.at(t), basis.at(t + h));
            for order in 0..3 {
                for m in 0..basis.functions() {
                    let central = (behind[order][m] - before[order][m]) / (2.0 * h);
                    let exact = here[order + 1][m];
                    assert!(
                        (central - exact).abs() < 1e-7 * exact.abs().max(10.0),
                        "{order} {m} at {t}: {central} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn an_excursion_is_to_one_side() {
        let basis = FourierBasis::new(7.0, 6);
        let parts = basis.excursion();
        let at = |t: f64| basis.at(t)[0].iter().zip(&parts).map(|(f, part)| f * part).sum::<f64>();
        assert!((at(3.5) - 1.0).abs() < 1e-9);
        for k in 1..70 {
            let q = at(0.1 * f64::from(k));
            assert!(q > 0.0 && q < 1.0 + 1e-9, "{q}");
        }
    }

    #[test]
    fn accelerations_are_orthogonal() {
        let basis = FourierBasis::new(4.0, 10);
        let instants = INSTANTS * 10;
        let rows: Vec<Vec<f64>> =
            (0..instants).map(|k| basis.at((k as f64 + 0.5) / instants as f64 * 4.0)[2].clone()).collect();
        for m in 0..basis.functions() {
            for n in 0..basis.functions() {
                let mean = rows.iter().map(|row| row[m] * row[n]).sum::<f64>() / instants as f64;
                assert!((mean - f64::from(u8::from(m == n))).abs() < 1e-9, "{m} {n}: {mean}");
            }
        }
    }
}
