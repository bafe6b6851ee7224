use crate::{
    dynamics::{Model, Sign},
    linear_algebra::Matrix,
    regressor::Regressor,
    series::Series,
};

use super::criterion::Criterion;

/// The information of motions on parameters: `M = M_0 + s sum_k Phi_k^T diag(1 / sd^2) Phi_k`.
#[derive(Debug, Clone)]
pub struct Information {
    model: Model,
    regressor: Regressor,
    /// `1 / sd` of each joint.
    weights: Vec<f64>,
    /// M_0: what is known before.
    prior: Option<Matrix>,
}

impl Information {
    /// Of the standard parameters at `columns` from rows with a standard deviation for each joint.
    #[must_use]
    pub fn new(model: &Model, columns: &[usize], noise: &[f64]) -> Self {
        Self {
            regressor: Regressor::new(model, columns),
            model: model.clone(),
            weights: noise.iter().map(|sd| 1.0 / sd).collect(),
            prior: None,
        }
    }

    /// The same on top of what is known before.
    #[must_use]
    pub fn with_prior(self, prior: Option<Matrix>) -> Self {
        Self { prior, ..self }
    }

    /// The rows of `Phi` over a motion, each over its standard deviation: one column for each row.
    fn rows(&self, motion: [&Series; 3], sign: Sign) -> Matrix {
        let (joints, columns) = (self.model.coordinate_count(), self.regressor.columns());
        let mut values = vec![0.0; motion[0].len() * joints * columns];
        self.regressor.evaluate_rows(&self.model, motion, 0..motion[0].len(), sign, &mut values);
        for (row, values) in values.chunks_exact_mut(columns).enumerate() {
            let weight = self.weights[row % joints];
            values.iter_mut().for_each(|v| *v *= weight);
        }
        Matrix::from_columns(columns, values)
    }

    /// M of a motion whose every sample stands for `share` of them.
    #[must_use]
    pub fn of(&self, motion: [&Series; 3], share: f64, sign: Sign) -> Matrix {
        self.sum(&self.rows(motion, sign), share)
    }

    fn sum(&self, rows: &Matrix, share: f64) -> Matrix {
        let own = rows.times_transposed(rows);
        match &self.prior {
            Some(prior) => prior.plus(&own, share),
            None => Matrix::from_fn(own.rows(), own.rows(), |i, j| share * own.at(i, j)),
        }
    }

    /// The criterion of a motion with its derivatives by q, dq and ddq; none where the motion does not show every parameter.
    #[must_use]
    pub fn judge(
        &self,
        criterion: &Criterion,
        motion: [&Series; 3],
        share: f64,
        sign: Sign,
    ) -> Option<(f64, [Series; 3])> {
        let rows = self.rows(motion, sign);
        let judged = criterion.judge(&self.sum(&rows, share))?;
        // dJ = <dJ/dM, dM> = 2 s sum_k <dJ/dM Phi_k^T W, dPhi_k^T>.
        let mut weights = judged.slope.times_matrix(&rows).into_values();
        let (joints, columns) = (self.model.coordinate_count(), self.regressor.columns());
        for (row, values) in weights.chunks_exact_mut(columns).enumerate() {
            let weight = 2.0 * share * self.weights[row % joints];
            values.iter_mut().for_each(|v| *v *= weight);
        }
        Some((judged.value, self.regressor.weighted_slopes(&self.model, motion, &weights, sign)))
    }
}
