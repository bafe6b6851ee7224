//! An estimation as a linear regression at its estimate.

use std::borrow::Cow;

use crate::scheduling::EstimationJob;
use thetahat_estimation::{
    identification::{Fit, Outcome},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;

/// The regression of the robot's parameters alone: what a simulated response adds to `J theta`, and what was estimated of the
/// loop, is taken off y.
pub(super) struct Linear<'a> {
    pub(super) regression: Regression,
    /// Z, or J of the robot's parameters.
    pub(super) instruments: Option<Cow<'a, Matrix>>,
    pub(super) fit: Cow<'a, Fit>,
    /// What was measured.
    pub(super) measured: &'a [f64],
}

impl<'a> Linear<'a> {
    pub(super) fn of(job: &'a EstimationJob<'_>, outcome: &'a Outcome, fit: &'a Fit) -> Self {
        let measured = &job.regression.y[..];
        let (Some(offset), Some(j)) = (&outcome.offset, &outcome.instruments) else {
            let instruments = outcome.instruments.as_ref().map(Cow::Borrowed);
            return Self { regression: job.regression.clone(), instruments, fit: Cow::Borrowed(fit), measured };
        };
        let of_robot: Vec<usize> = (0..job.problem.estimated.len()).collect();
        let of_loop: Vec<usize> = (of_robot.len()..j.columns()).collect();
        let by_loop = j.select_columns(&of_loop).times(&fit.theta[of_robot.len()..]);
        let taken: Vec<f64> = offset.iter().zip(by_loop).map(|(offset, by_loop)| offset + by_loop).collect();
        let fit = Fit {
            theta: fit.theta[..of_robot.len()].to_vec(),
            covariance: Matrix::from_fn(of_robot.len(), of_robot.len(), |i, k| fit.covariance.at(i, k)),
            standard_deviation: fit.standard_deviation[..of_robot.len()].to_vec(),
            prediction: fit.prediction.iter().zip(&taken).map(|(p, t)| p - t).collect(),
            ..*fit
        };
        let instruments = Some(Cow::Owned(j.select_columns(&of_robot)));
        Self { regression: job.regression.less(Some(&taken)), instruments, fit: Cow::Owned(fit), measured }
    }
}
