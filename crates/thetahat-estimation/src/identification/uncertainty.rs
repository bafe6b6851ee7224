use super::{
    estimators::{DesignMatrix, Method},
    fit::{EstimationError, Fit},
};
use crate::{
    regression::Regression,
    statistics::{EstimatedVariance, Sandwich},
};
use thetahat_ground::linear_algebra::Matrix;

/// The uncertainty of an estimate, with errors that are correlated in time and differ between joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Standard deviation of each parameter, by [`Sandwich::robust`].
    pub standard_deviation: Vec<f64>,
    /// Degrees of freedom of each standard deviation.
    pub freedom: Vec<f64>,
    /// Intervals that contain the true values with a probability of 95 %, if the method's assumptions hold.
    pub interval_95: Vec<[f64; 2]>,
}

/// Standard deviations and intervals of a method's fit; `z` is Z of its last iteration.
///
/// The interval uses Student's t with each parameter's own degrees of freedom. It relies on the assumptions of
/// [`Sandwich::robust`] and of the method: a filter's bias in X, or a wrong simulator in DIDIM, moves the whole
/// interval.
///
/// # Errors
/// As [`Method::influence`], and if there is no finite interval.
pub fn uncertainty(
    method: Method,
    regression: &Regression,
    z: Option<&Matrix>,
    fit: &Fit,
) -> Result<Uncertainty, EstimationError> {
    let influence = method.influence(regression, z)?;
    let design = match method.design() {
        DesignMatrix::Measured => &regression.x,
        DesignMatrix::Simulated => z.ok_or(EstimationError::NoInstruments)?,
    };
    let residual = regression.residual(&fit.prediction);
    let rows = &regression.layout;
    let variances = Sandwich { design, influence: &influence, residual: &residual, rows }.robust();
    Uncertainty::new(&fit.theta, &variances)
}

impl Uncertainty {
    /// The intervals of estimates from the variances of their errors.
    ///
    /// # Errors
    /// [`EstimationError::NotFinite`] if there is none.
    pub fn new(theta: &[f64], variances: &[EstimatedVariance]) -> Result<Self, EstimationError> {
        let interval = |(theta, v): (&f64, &EstimatedVariance)| {
            v.half_width_95().map(|h| [theta - h, theta + h]).ok_or(EstimationError::NotFinite)
        };
        Ok(Self {
            standard_deviation: variances.iter().map(|v| v.variance.sqrt()).collect(),
            freedom: variances.iter().map(|v| v.freedom).collect(),
            interval_95: theta.iter().zip(variances).map(interval).collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_lie_about_the_estimates_as_wide_as_students_t() {
        let variances = [EstimatedVariance { variance: 4.0, freedom: 5.0 }; 2];
        let found = Uncertainty::new(&[1.0, -3.0], &variances).unwrap();
        let half = 2.0 * 2.570_581_835_636_314;
        for ([low, high], theta) in found.interval_95.into_iter().zip([1.0, -3.0]) {
            assert!((low - theta + half).abs() < 1e-12 && (high - theta - half).abs() < 1e-12);
        }
    }
}
