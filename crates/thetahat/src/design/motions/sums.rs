use std::ops::Range;

use crate::design::motions::{basis::Basis, fourier::ORDERS};
use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// Sums of functions of time: `q_j(t) = c_j + sum_m b_m(t) x_jm`, linear in the unknowns.
///
/// | letter | word | shape |
/// | --- | --- | --- |
/// | `x` | unknowns, joint by joint: in units in which 1 takes the joint to its limit | joints x unknowns of a joint |
/// | `b` | functions of time, the first a constant where the start posture is free | |
/// | `c` | the start posture where it is given, otherwise the middle of the range | joints |
#[derive(Debug, Clone)]
pub struct Sums {
    basis: Basis,
    /// Unit of each unknown, joint by joint.
    scale: Vec<Vec<f64>>,
    centre: Vec<f64>,
    has_free_start: bool,
    /// Times that the motion is made.
    periods: usize,
}

/// Values of the functions of a family at instants: order by order, instants x unknowns of a joint, without the joints' units.
#[derive(Debug, Clone)]
pub struct Sampled {
    /// Position, velocity, acceleration, jerk.
    pub orders: [Matrix; ORDERS],
}

/// Derivatives of a function of a motion, at every instant.
#[derive(Debug, Clone)]
pub struct Slopes {
    /// By positions, velocities and accelerations.
    pub by_motion: [Series; 3],
    /// By the time that the instant stands for, s; empty where there are none.
    pub by_seconds: Vec<f64>,
}

/// Position, velocity, acceleration and jerk: one channel for each joint.
pub type Derivatives = [Series; ORDERS];

impl Sums {
    /// Sums of a basis about `centre`, with a free start posture or without.
    /// `reach` is half the range, the velocity and the acceleration to which an unknown of one takes a joint.
    #[must_use]
    pub fn new(basis: Basis, centre: Vec<f64>, has_free_start: bool, reach: &[[f64; 3]]) -> Self {
        let peaks = peaks(&basis);
        let unit = |reach: &[f64; 3], peak: &[f64; 3]| {
            reach.iter().zip(peak).map(|(r, p)| r / p).fold(f64::INFINITY, f64::min)
        };
        let of_joint = |reach: &[f64; 3]| {
            let start = has_free_start.then_some(reach[0]);
            start.into_iter().chain(peaks.iter().map(|peak| unit(reach, peak))).collect()
        };
        Self { scale: reach.iter().map(of_joint).collect(), basis, centre, has_free_start, periods: 1 }
    }

    /// The same motions, made several times.
    #[must_use]
    pub fn repeated(self, periods: usize) -> Self {
        Self { periods, ..self }
    }

    /// Time of all periods, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.periods as f64 * self.basis.period_s()
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.centre.len()
    }

    /// Unknowns of one joint.
    #[must_use]
    pub fn unknowns_of_joint(&self) -> usize {
        self.basis.functions() + usize::from(self.has_free_start)
    }

    /// Unknowns in all.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.joints() * self.unknowns_of_joint()
    }

    /// The unknowns of a joint.
    #[must_use]
    pub fn own(&self, joint: usize) -> Range<usize> {
        let size = self.unknowns_of_joint();
        joint * size..(joint + 1) * size
    }

    /// Whether the first unknown of each joint is its start posture.
    #[must_use]
    pub fn has_free_start(&self) -> bool {
        self.has_free_start
    }

    /// Unit of an unknown of a joint.
    #[must_use]
    pub fn unit(&self, joint: usize, unknown: usize) -> f64 {
        self.scale[joint][unknown]
    }

    /// The posture about which motions are sums: the start where it is given, otherwise the middle of the range.
    #[must_use]
    pub fn centre(&self) -> &[f64] {
        &self.centre
    }

    /// Unknowns of one joint for a motion to one side and back by one rad or m.
    #[must_use]
    pub fn excursion(&self, joint: usize) -> Vec<f64> {
        let parts = self.basis.excursion();
        let of_start = self.has_free_start.then_some(0.0);
        of_start.into_iter().chain(parts).zip(&self.scale[joint]).map(|(part, unit)| part / unit).collect()
    }

    /// The unknowns of a joint for its motion backwards in time.
    #[must_use]
    pub fn reversed(&self, joint: usize, own: &[f64]) -> Vec<f64> {
        let (start, parts) = own.split_at(usize::from(self.has_free_start));
        let units = &self.scale[joint][start.len()..];
        let reversed = self.basis.reversed(parts.iter().zip(units).map(|(part, unit)| part * unit).collect());
        start.iter().copied().chain(reversed.iter().zip(units).map(|(part, unit)| part / unit)).collect()
    }

    /// The functions at instants from zero to the duration.
    #[must_use]
    pub fn sampled(&self, time_s: &[f64]) -> Sampled {
        let period_s = self.basis.period_s();
        let rows: Vec<_> = time_s.iter().map(|t| self.basis.at(t - period_s * (t / period_s).floor())).collect();
        let first = usize::from(self.has_free_start);
        let value = |order: usize, k: usize, m: usize| match m.checked_sub(first) {
            Some(m) => rows[k][order][m],
            None if order == 0 => 1.0,
            None => 0.0,
        };
        let matrix = |order| Matrix::from_fn(rows.len(), self.unknowns_of_joint(), |k, m| value(order, k, m));
        Sampled { orders: [0, 1, 2, 3].map(matrix) }
    }

    /// The motion with the unknowns `x` at the instants of `sampled`.
    #[must_use]
    pub fn motion(&self, sampled: &Sampled, x: &[f64]) -> Derivatives {
        let size = self.unknowns_of_joint();
        let unknowns = Matrix::from_fn(size, self.joints(), |m, j| self.scale[j][m] * x[j * size + m]);
        let of_order = |order: usize| {
            let values = sampled.orders[order].times_matrix(&unknowns);
            let centre = |j: usize| if order == 0 { self.centre[j] } else { 0.0 };
            let columns: Vec<Vec<f64>> =
                (0..self.joints()).map(|j| values.column(j).iter().map(|v| v + centre(j)).collect()).collect();
            Series::side_by_side(&columns)
        };
        [0, 1, 2, 3].map(of_order)
    }

    /// The derivative by the unknowns of a function whose derivatives by q, dq and ddq from the instant `first` on are given.
    #[must_use]
    pub fn chain(&self, sampled: &Sampled, first: usize, slopes: &[Series; 3]) -> Vec<f64> {
        let of_joint = |j: usize| {
            let mut sum = vec![0.0; self.unknowns_of_joint()];
            for (functions, slopes) in sampled.orders.iter().zip(slopes) {
                let part = functions.row_range(first..first + slopes.len()).transpose_times(&slopes.channel(j));
                sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
            }
            sum.into_iter().zip(&self.scale[j]).map(|(s, unit)| s * unit).collect::<Vec<_>>()
        };
        (0..self.joints()).flat_map(of_joint).collect()
    }
}

/// Largest position, velocity and acceleration of each function.
fn peaks(basis: &Basis) -> Vec<[f64; 3]> {
    let instants = 16 * basis.functions();
    let mut peaks = vec![[0.0_f64; 3]; basis.functions()];
    for k in 0..=instants {
        let orders = basis.at(basis.period_s() * k as f64 / instants as f64);
        for (m, peak) in peaks.iter_mut().enumerate() {
            (0..3).for_each(|order| peak[order] = peak[order].max(orders[order][m].abs()));
        }
    }
    peaks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_motion_runs_backwards() {
        let period_s = 4.0;
        let time: Vec<f64> = (0..=20).map(|k| 0.2 * f64::from(k)).collect();
        for basis in [Basis::fourier(period_s, 3), Basis::splines(period_s, 7)] {
            for has_free_start in [true, false] {
                let family = Sums::new(basis.clone(), vec![0.2], has_free_start, &[[1.0, 2.0, 5.0]]);
                let x: Vec<f64> = (0..family.unknowns()).map(|m| (1.3 * m as f64 + 0.4).sin()).collect();
                let sampled = family.sampled(&time);
                let [q, dq, ..] = family.motion(&sampled, &x);
                let [back, back_dq, ..] = family.motion(&sampled, &family.reversed(0, &x));
                for k in 0..=20 {
                    assert!((back.sample(k)[0] - q.sample(20 - k)[0]).abs() < 1e-12, "{k}");
                    assert!((back_dq.sample(k)[0] + dq.sample(20 - k)[0]).abs() < 1e-12, "{k}");
                }
            }
        }
    }
}
