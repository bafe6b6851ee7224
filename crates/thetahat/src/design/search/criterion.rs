use serde::{Deserialize, Serialize};

use thetahat_ground::linear_algebra::{CholeskyFactor, Matrix};

/// What a design minimises, as a function of the information `M` of the parameters: `C = M^-1` is their covariance.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// `-log det M`: the volume of the joint confidence region.
    D,
    /// `log sum_i w_i C_ii`: the mean square of the errors, each in its unit.
    A {
        /// Weight of each parameter: one over its unit squared.
        weights: Vec<f64>,
    },
    /// `log (sum_i (w_i C_ii)^p)^(1/p)`: nearly the largest error in its unit.
    Worst {
        /// As for A.
        weights: Vec<f64>,
    },
    /// `log tr(W C)`: the mean square of the torque's error on a motion, with `W` the mean of `Phi^T Phi` on it.
    Torque {
        /// W.
        of_motion: Matrix,
    },
    /// `log det C` of some parameters: the volume of their confidence region.
    SelectedParameters {
        /// Their columns.
        columns: Vec<usize>,
    },
}

/// A criterion by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CriterionName {
    /// D-optimality.
    #[default]
    D,
    /// A-optimality.
    A,
    /// The worst interval.
    Worst,
    /// The torque's error on the motion of `[wanted] motion`.
    Torque,
    /// The intervals of selected parameters.
    #[serde(rename = "chosen")]
    SelectedParameters,
}

impl CriterionName {
    /// Its name, as in a design file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::D => "d",
            Self::A => "a",
            Self::Worst => "worst",
            Self::Torque => "torque",
            Self::SelectedParameters => "chosen",
        }
    }
}

/// Power of the sum that stands for the largest error.
const POWER: i32 = 8;

/// A value of a criterion, and its derivative by the information, symmetric.
#[derive(Debug, Clone)]
pub struct CriterionValue {
    /// The criterion.
    pub value: f64,
    /// `dJ / dM`.
    pub slope: Matrix,
}

impl Criterion {
    /// The criterion of an information matrix; `None` if a parameter is not identifiable from it.
    #[must_use]
    pub fn value(&self, information: &Matrix) -> Option<f64> {
        let factored = Factored::of(information)?;
        match self {
            Self::D => factored.volume(),
            Self::A { .. } | Self::Worst { .. } | Self::Torque { .. } | Self::SelectedParameters { .. } => {
                self.of_covariance(&factored.covariance()).map(|found| found.value)
            }
        }
    }

    /// The same with its derivative.
    #[must_use]
    pub fn value_and_slope(&self, information: &Matrix) -> Option<CriterionValue> {
        let factored = Factored::of(information)?;
        let c = factored.covariance();
        match self {
            Self::D => {
                let slope = Matrix::from_fn(c.rows(), c.columns(), |i, j| -c.at(i, j));
                Some(CriterionValue { value: factored.volume()?, slope })
            }
            Self::A { .. } | Self::Worst { .. } | Self::Torque { .. } | Self::SelectedParameters { .. } => {
                self.of_covariance(&c)
            }
        }
    }

    /// Value and derivative of a criterion that is a function of the covariance: with `H = dJ / dC`, `dJ / dM = -C H C`.
    fn of_covariance(&self, c: &Matrix) -> Option<CriterionValue> {
        let (value, h) = match self {
            Self::D => return None,
            Self::A { weights } => diagonal(c, weights, 1),
            Self::Worst { weights } => diagonal(c, weights, POWER),
            Self::Torque { of_motion } => {
                let square = product_trace(of_motion, c);
                let slope = |i: usize, j: usize| of_motion.at(i, j) / square;
                (square.ln(), Matrix::from_fn(c.rows(), c.rows(), slope))
            }
            Self::SelectedParameters { columns } => {
                let part = Matrix::from_fn(columns.len(), columns.len(), |i, j| c.at(columns[i], columns[j]));
                let lower = part.cholesky()?.lower();
                let inverse = part.inverse_times_matrix(&Matrix::identity(columns.len()))?;
                let mut h = Matrix::zeros(c.rows(), c.rows());
                for (i, &row) in columns.iter().enumerate() {
                    columns.iter().enumerate().for_each(|(j, &column)| *h.at_mut(row, column) = inverse.at(i, j));
                }
                ((0..columns.len()).map(|i| 2.0 * lower.at(i, i).ln()).sum(), h)
            }
        };
        let product = c.times_matrix(&h).times_matrix(c);
        let slope = Matrix::from_fn(c.rows(), c.rows(), |i, j| -product.at(i, j));
        value.is_finite().then_some(CriterionValue { value, slope })
    }
}

/// `tr(A B)` of symmetric matrices.
pub(in crate::design) fn product_trace(a: &Matrix, b: &Matrix) -> f64 {
    (0..a.rows()).flat_map(|i| (0..a.rows()).map(move |j| (i, j))).map(|(i, j)| a.at(i, j) * b.at(i, j)).sum()
}

/// `log (sum_i (w_i C_ii)^p) / p` and its derivative by C.
fn diagonal(c: &Matrix, weights: &[f64], power: i32) -> (f64, Matrix) {
    let terms: Vec<f64> = weights.iter().enumerate().map(|(i, w)| w * c.at(i, i)).collect();
    let largest = terms.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let sum: f64 = terms.iter().map(|t| (t / largest).powi(power)).sum();
    let value = largest.ln() + sum.ln() / f64::from(power);
    let mut h = Matrix::zeros(c.rows(), c.rows());
    for (i, (term, weight)) in terms.iter().zip(weights).enumerate() {
        *h.at_mut(i, i) = (term / largest).powi(power - 1) / sum * weight / largest;
    }
    (value, h)
}

/// The Cholesky factor of `S M S`, which has ones on its diagonal.
struct Factored {
    factor: CholeskyFactor,
    scale: Vec<f64>,
}

impl Factored {
    /// `None` if the matrix is singular: a parameter or a combination of parameters has no information.
    fn of(m: &Matrix) -> Option<Self> {
        let diagonal: Vec<f64> = (0..m.rows()).map(|i| m.at(i, i)).collect();
        if !diagonal.iter().all(|d| d.is_finite() && *d > 0.0) {
            return None;
        }
        let scale: Vec<f64> = diagonal.iter().map(|d| 1.0 / d.sqrt()).collect();
        let scaled = Matrix::from_fn(m.rows(), m.rows(), |i, j| m.at(i, j) * scale[i] * scale[j]);
        Some(Self { factor: scaled.cholesky()?, scale })
    }

    /// `-log det M`; `None` if it is not finite.
    fn volume(&self) -> Option<f64> {
        let lower = self.factor.lower();
        let logs = self.scale.iter().enumerate().map(|(i, scale)| scale.ln() - lower.at(i, i).ln());
        Some(2.0 * logs.sum::<f64>()).filter(|v| v.is_finite())
    }

    /// `M^-1`.
    fn covariance(&self) -> Matrix {
        let size = self.scale.len();
        let inverse = self.factor.solve_matrix(&Matrix::identity(size));
        Matrix::from_fn(size, size, |i, j| inverse.at(i, j) * self.scale[i] * self.scale[j])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn information(shift: f64) -> Matrix {
        let a = Matrix::from_fn(9, 4, |i, j| ((i * (j + 2)) as f64 * 0.7 + shift * (i + j) as f64).sin());
        a.transposed_times(&a)
    }

    #[test]
    fn slopes_are_those_of_finite_differences() {
        let weights = vec![1.0, 0.3, 4.0, 0.1];
        let all = [
            Criterion::D,
            Criterion::A { weights: weights.clone() },
            Criterion::Worst { weights },
            Criterion::Torque { of_motion: information(0.8) },
            Criterion::SelectedParameters { columns: vec![1, 3] },
        ];
        let (m, h) = (information(0.0), 1e-6);
        let direction = information(1.3);
        for criterion in all {
            let found = criterion.value_and_slope(&m).unwrap();
            assert!((found.value - criterion.value(&m).unwrap()).abs() < 1e-12);
            let at = |by: f64| criterion.value(&m.plus(&direction, by)).unwrap();
            let central = (at(h) - at(-h)) / (2.0 * h);
            let exact: f64 = (0..4)
                .flat_map(|i| (0..4).map(move |j| (i, j)))
                .map(|(i, j)| found.slope.at(i, j) * direction.at(i, j))
                .sum();
            assert!((central - exact).abs() < 1e-7 * exact.abs().max(1.0), "{criterion:?}: {central} {exact}");
        }
    }

    #[test]
    fn the_volume_is_that_of_the_diagonal() {
        let m = Matrix::from_fn(2, 2, |i, j| if i == j { [4.0, 1e-8][i] } else { 0.0 });
        assert!((Criterion::D.value(&m).unwrap() + (4.0_f64 * 1e-8).ln()).abs() < 1e-12);
        assert!(Criterion::D.value(&Matrix::zeros(2, 2)).is_none());
    }
}
