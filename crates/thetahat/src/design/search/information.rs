use thetahat_ground::{
    linear_algebra::{Matrix, dot},
    series::Series,
};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
};

use crate::design::{motions::sums::Derivatives, search::criterion::Criterion};

/// The information of motions on parameters: `M = M_0 + s sum_k Phi_k^T diag(1 / sd^2) Phi_k`, with that of sweeps.
#[derive(Debug, Clone)]
pub struct Information {
    model: Model,
    regressor: Regressor,
    /// `1 / sd` of each joint.
    weights: Vec<f64>,
    /// M_0: prior information.
    prior: Option<Matrix>,
    /// Information from the fixed part of the motion: the sweeps.
    sweeps: Option<Matrix>,
}

/// The criterion of a motion and its derivatives.
#[derive(Debug, Clone)]
pub struct MotionCriterion {
    /// The criterion, nats.
    pub value: f64,
    /// Its derivatives by q, dq and ddq.
    pub by_motion: [Series; 3],
    /// Its derivatives by the share of each sample.
    pub by_share: Vec<f64>,
}

impl Information {
    /// The information on the standard parameters at `columns`, from rows with a standard deviation for each joint.
    #[must_use]
    pub fn new(model: &Model, columns: &[usize], noise: &[f64]) -> Self {
        Self {
            regressor: Regressor::new(model, columns),
            model: model.clone(),
            weights: noise.iter().map(|sd| 1.0 / sd).collect(),
            prior: None,
            sweeps: None,
        }
    }

    /// The same with prior information.
    #[must_use]
    pub fn with_prior(self, prior: Option<Matrix>) -> Self {
        Self { prior, ..self }
    }

    /// The same with sweeps that are part of every motion.
    #[must_use]
    pub fn with_sweeps(self, sweeps: Option<Matrix>) -> Self {
        Self { sweeps, ..self }
    }

    /// Number of parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.regressor.columns()
    }

    /// M_0: prior information.
    #[must_use]
    pub fn prior(&self) -> Option<&Matrix> {
        self.prior.as_ref()
    }

    /// The information of a whole motion at its own rate, sweeps included, without what is known before.
    pub(in crate::design) fn of_motion_alone(&self, [q, dq, ddq, _]: &Derivatives) -> Matrix {
        let alone = Self { prior: None, sweeps: None, ..self.clone() };
        alone.of([q, dq, ddq], 1.0, Sign::Exact)
    }

    /// The rows of `Phi` over a motion, each over its standard deviation and times the root of its share: one column for each row.
    fn rows(&self, motion: [&Series; 3], shares: &[f64], sign: Sign) -> Matrix {
        let (joints, columns) = (self.model.coordinate_count(), self.regressor.columns());
        let mut values = vec![0.0; motion[0].len() * joints * columns];
        self.regressor.evaluate_rows(&self.model, motion, 0..motion[0].len(), sign, &mut values);
        for (row, values) in values.chunks_exact_mut(columns).enumerate() {
            let weight = self.weights[row % joints] * shares[row / joints].sqrt();
            values.iter_mut().for_each(|v| *v *= weight);
        }
        Matrix::from_columns(columns, values)
    }

    /// M of a motion, each of whose samples counts `share` times.
    #[must_use]
    pub fn of(&self, motion: [&Series; 3], share: f64, sign: Sign) -> Matrix {
        self.of_shares(motion, &vec![share; motion[0].len()], sign)
    }

    /// M of a motion, each of whose samples counts as many times as its share.
    #[must_use]
    pub fn of_shares(&self, motion: [&Series; 3], shares: &[f64], sign: Sign) -> Matrix {
        self.sum(&self.rows(motion, shares, sign))
    }

    fn sum(&self, rows: &Matrix) -> Matrix {
        let own = rows.times_transposed(rows);
        let known = self.prior.iter().chain(&self.sweeps);
        known.fold(own, |sum, known| sum.plus(known, 1.0))
    }

    /// The criterion of a motion with its derivatives by q, dq and ddq and by the shares; `None` if a parameter is not identifiable from
    /// the motion.
    #[must_use]
    pub fn criterion_and_slopes(
        &self,
        criterion: &Criterion,
        motion: [&Series; 3],
        shares: &[f64],
        sign: Sign,
    ) -> Option<MotionCriterion> {
        let rows = self.rows(motion, shares, sign);
        let found = criterion.value_and_slope(&self.sum(&rows))?;
        // dJ = <dJ/dM, dM> = sum_k s_k 2 <dJ/dM Phi_k^T W, dPhi_k^T> + ds_k <dJ/dM Phi_k^T W, Phi_k^T>.
        let product = found.slope.times_matrix(&rows);
        let (joints, columns) = (self.model.coordinate_count(), self.regressor.columns());
        let mut by_share = vec![0.0; shares.len()];
        let mut weights = product.into_values();
        for (row, values) in weights.chunks_exact_mut(columns).enumerate() {
            let share = shares[row / joints];
            by_share[row / joints] += dot(values, rows.column(row)) / share.max(f64::MIN_POSITIVE);
            let weight = 2.0 * share.sqrt() * self.weights[row % joints];
            values.iter_mut().for_each(|v| *v *= weight);
        }
        let by_motion = self.regressor.weighted_slopes(&self.model, motion, &weights, sign);
        Some(MotionCriterion { value: found.value, by_motion, by_share })
    }
}
