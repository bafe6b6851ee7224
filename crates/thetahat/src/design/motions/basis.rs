use crate::design::motions::{
    fourier::{self, ORDERS},
    splines,
};
use thetahat_ground::linear_algebra::Matrix;

/// The functions of time whose sums are the joints' motions: at rest at zero at both ends.
///
/// The functions of a kind are nearly collinear. The basis therefore uses combinations of them whose accelerations are orthogonal and
/// have a mean square of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    period_s: f64,
    kind: Kind,
    /// R of the accelerations of the functions F of the kind, upper triangular: the basis is `F R^-1`.
    triangle: Matrix,
}

/// Kinds of functions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Two of each harmonic, with quintics.
    Fourier { harmonics: usize },
    /// B-splines of degree five on equal intervals.
    Splines { splines: usize },
}

impl Kind {
    fn functions(self) -> usize {
        match self {
            Self::Fourier { harmonics } => 2 * harmonics,
            Self::Splines { splines } => splines,
        }
    }

    /// Values and derivatives at a time, order by order.
    fn at(self, period_s: f64, t: f64) -> [Vec<f64>; ORDERS] {
        match self {
            Self::Fourier { harmonics } => fourier::raw(period_s, harmonics, t),
            Self::Splines { splines } => splines::raw(period_s, splines, t),
        }
    }

    /// Reverses the coefficients in time: sines change their sign, splines their order.
    fn reversed(self, parts: &mut [f64]) {
        match self {
            Self::Fourier { .. } => parts.iter_mut().step_by(2).for_each(|sine| *sine = -*sine),
            Self::Splines { .. } => parts.reverse(),
        }
    }

    /// Coefficient of a function in a motion to one side and back: the first harmonic's cosine, or all splines.
    fn excursion(self, function: usize) -> f64 {
        match self {
            Self::Fourier { .. } => f64::from(u8::from(function == 1)),
            Self::Splines { .. } => 1.0,
        }
    }
}

/// Instants per two functions on which accelerations are made orthogonal.
const INSTANTS: usize = 16;

impl Basis {
    /// Harmonics of a period in s with their quintics, both above zero.
    #[must_use]
    pub fn fourier(period_s: f64, harmonics: usize) -> Self {
        Self::new(period_s, Kind::Fourier { harmonics })
    }

    /// B-splines on a period in s, two at least.
    #[must_use]
    pub fn splines(period_s: f64, splines: usize) -> Self {
        Self::new(period_s, Kind::Splines { splines })
    }

    fn new(period_s: f64, kind: Kind) -> Self {
        let functions = kind.functions();
        let instants = INSTANTS * functions.div_ceil(2);
        let time: Vec<f64> = (0..instants).map(|k| (k as f64 + 0.5) / instants as f64 * period_s).collect();
        let rows: Vec<Vec<f64>> = time.iter().map(|t| kind.at(period_s, *t)[2].clone()).collect();
        let scale = 1.0 / (instants as f64).sqrt();
        let accelerations = Matrix::from_fn(instants, functions, |k, m| scale * rows[k][m]);
        Self { period_s, kind, triangle: accelerations.triangular_factor() }
    }

    /// Number of functions.
    #[must_use]
    pub fn functions(&self) -> usize {
        self.kind.functions()
    }

    /// T, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Values and derivatives of all functions at a time from 0 to T, order by order.
    #[must_use]
    pub fn at(&self, t: f64) -> [Vec<f64>; ORDERS] {
        self.kind.at(self.period_s, t).map(|row| self.solve(row))
    }

    /// The coefficient of each function for a motion to one side and back, with a position of one in the middle of the period.
    #[must_use]
    pub fn excursion(&self) -> Vec<f64> {
        let parts: Vec<f64> = (0..self.functions()).map(|m| self.kind.excursion(m)).collect();
        let middle = &self.kind.at(self.period_s, 0.5 * self.period_s)[0];
        let peak: f64 = middle.iter().zip(&parts).map(|(f, part)| f * part).sum();
        self.of_kind(&parts).into_iter().map(|part| part / peak).collect()
    }

    /// The coefficients of the motion backwards in time: `R^-1` undone, the coefficients of the kind reversed, and R applied again.
    #[must_use]
    pub fn reversed(&self, mut parts: Vec<f64>) -> Vec<f64> {
        let size = parts.len();
        for m in (0..size).rev() {
            let known: f64 = (m + 1..size).map(|i| self.triangle.at(m, i) * parts[i]).sum();
            parts[m] = (parts[m] - known) / self.triangle.at(m, m);
        }
        self.kind.reversed(&mut parts);
        self.of_kind(&parts)
    }

    /// `R p`: the coefficients of the orthogonal functions, from those of the functions of the kind.
    fn of_kind(&self, parts: &[f64]) -> Vec<f64> {
        (0..parts.len()).map(|m| (m..parts.len()).map(|i| self.triangle.at(m, i) * parts[i]).sum()).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn both(period_s: f64, harmonics: usize) -> [Basis; 2] {
        [Basis::fourier(period_s, harmonics), Basis::splines(period_s, 2 * harmonics)]
    }

    #[test]
    fn functions_rest_at_both_ends() {
        for basis in both(7.0, 6) {
            for t in [0.0, 7.0] {
                let [q, dq, ddq, _] = basis.at(t);
                for (order, values) in [q, dq, ddq].into_iter().enumerate() {
                    assert!(values.iter().all(|v| v.abs() < 1e-10), "order {order} at {t}: {values:?}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let h = 1e-5;
        for basis in both(4.0, 3) {
            for t in [0.3, 1.7, 3.9] {
                let (before, here, after) = (basis.at(t - h), basis.at(t), basis.at(t + h));
                for order in 0..3 {
                    for m in 0..basis.functions() {
                        let central = (after[order][m] - before[order][m]) / (2.0 * h);
                        let exact = here[order + 1][m];
                        assert!(
                            (central - exact).abs() < 1e-7 * exact.abs().max(10.0),
                            "{order} {m} at {t}: {central} {exact}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn an_excursion_is_to_one_side() {
        for basis in both(7.0, 6) {
            let parts = basis.excursion();
            let at = |t: f64| basis.at(t)[0].iter().zip(&parts).map(|(f, part)| f * part).sum::<f64>();
            assert!((at(3.5) - 1.0).abs() < 1e-9);
            for k in 1..70 {
                let q = at(0.1 * f64::from(k));
                assert!(q > 0.0 && q < 1.0 + 1e-9, "{q}");
            }
        }
    }

    #[test]
    fn accelerations_are_orthogonal() {
        for basis in both(4.0, 10) {
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
}
