//! User-defined estimators, in addition to those of the table; the advice never recommends them.

use std::{error::Error, fmt};

use super::estimators::Method;
use thetahat_ground::linear_algebra::Matrix;

/// Longest name of an estimator.
const LONGEST_NAME: usize = 40;

/// The input of a user-defined estimator: rows of `y = X theta + e`.
#[derive(Debug, Clone, PartialEq)]
pub struct UserRegression {
    /// Observation matrix X, rows by parameters: each row times the weight of its recording.
    pub x: Matrix,
    /// Torques y, weighted alike.
    pub y: Vec<f64>,
    /// Z of the last iteration of IDIM-IV with the rows of X, weighted alike; none if IDIM-IV was not requested or has not converged.
    pub z: Option<Matrix>,
    /// The joint of each row, from zero.
    pub joint: Vec<usize>,
    /// The recording of each row, from zero.
    pub recording: Vec<usize>,
    /// The fraction of each row that is left where samples near rest are left out; one elsewhere. The sum of their squares, less the number
    /// of parameters, is the divisor of the residual's variance.
    pub share: Vec<f64>,
    /// Names of the parameters, in the order of the columns.
    pub names: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
}

impl UserRegression {
    /// The regression with only the rows to keep.
    #[must_use]
    pub fn select_rows(&self, keep: &[bool]) -> Self {
        fn kept<T: Copy>(rows: &[T], keep: &[bool]) -> Vec<T> {
            rows.iter().zip(keep).filter(|(_, keep)| **keep).map(|(row, _)| *row).collect()
        }
        Self {
            x: self.x.select_rows(keep),
            y: kept(&self.y, keep),
            z: self.z.as_ref().map(|z| z.select_rows(keep)),
            joint: kept(&self.joint, keep),
            recording: kept(&self.recording, keep),
            share: kept(&self.share, keep),
            names: self.names.clone(),
            units: self.units.clone(),
        }
    }
}

/// The result of a user-defined estimator.
#[derive(Debug, Clone, PartialEq)]
pub struct UserEstimate {
    /// The parameters, in the order of the columns.
    pub theta: Vec<f64>,
    /// Their covariance; without it they have no standard deviations and no intervals.
    pub covariance: Option<Matrix>,
}

/// Why a user-defined estimator has no estimate.
pub type UserError = Box<dyn Error + Send + Sync>;

/// The function of a user-defined estimator.
type Estimate = Box<dyn Fn(&UserRegression) -> Result<UserEstimate, UserError> + Send + Sync>;

/// A user-defined estimator: a name and a function of the regression.
pub struct UserEstimator {
    name: String,
    estimate: Estimate,
}

/// A name that a user-defined estimator cannot have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "an estimator of your own cannot be called `{name}`: take a name of at most {LONGEST_NAME} ASCII letters, digits, `-`, `_` \
     and `.` that no method of thetahat has"
)]
pub struct UserEstimatorName {
    /// The name.
    pub name: String,
}

impl UserEstimator {
    /// Builds an estimator. Its function is called once with all rows, and in cross-validation once for each part left out.
    ///
    /// # Errors
    /// [`UserEstimatorName`] for the name of a built-in method, or an invalid one.
    pub fn new(
        name: &str,
        estimate: impl Fn(&UserRegression) -> Result<UserEstimate, UserError> + Send + Sync + 'static,
    ) -> Result<Self, UserEstimatorName> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let is_taken = Method::all().any(|method| method.name().eq_ignore_ascii_case(name));
        if is_taken || name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(is_plain) {
            return Err(UserEstimatorName { name: name.to_owned() });
        }
        Ok(Self { name: name.to_owned(), estimate: Box::new(estimate) })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its estimate: a finite number for each parameter, and a covariance of the same size or none.
    ///
    /// # Errors
    /// The error of its function, or what is wrong with its result.
    pub fn estimate(&self, regression: &UserRegression) -> Result<UserEstimate, UserError> {
        let estimate = (self.estimate)(regression)?;
        estimate.refuse_misfits(&regression.names)?;
        Ok(estimate)
    }
}

impl fmt::Debug for UserEstimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "UserEstimator({})", self.name)
    }
}

impl UserEstimate {
    fn refuse_misfits(&self, names: &[String]) -> Result<(), UserError> {
        let size = names.len();
        if self.theta.len() != size {
            return Err(format!("it returned {} estimates for {size} parameters", self.theta.len()).into());
        }
        if let Some((name, theta)) = names.iter().zip(&self.theta).find(|(_, theta)| !theta.is_finite()) {
            return Err(format!("its estimate of {name} is {theta}").into());
        }
        self.covariance.as_ref().map_or(Ok(()), |covariance| refuse_no_covariance(covariance, names))
    }
}

/// Relative rounding, in units of two standard deviations, by which covariances may be asymmetric or exceed their product.
const ROUNDING: f64 = 1e-6;

/// Refuses an invalid covariance: wrong shape, negative variance, asymmetric entries or entries larger than the variances allow.
fn refuse_no_covariance(covariance: &Matrix, names: &[String]) -> Result<(), UserError> {
    let size = names.len();
    if (covariance.rows(), covariance.columns()) != (size, size) {
        let (rows, columns) = (covariance.rows(), covariance.columns());
        return Err(format!("its covariance is {rows} by {columns} for {size} parameters").into());
    }
    for (i, name) in names.iter().enumerate() {
        let variance = covariance.at(i, i);
        if !variance.is_finite() || variance < 0.0 {
            return Err(format!("its variance of {name} is {variance}").into());
        }
        for (j, other) in names.iter().enumerate().take(i) {
            let [a, b] = [covariance.at(i, j), covariance.at(j, i)];
            let largest = (variance * covariance.at(j, j)).sqrt();
            let is_possible = (a - b).abs() <= ROUNDING * largest && a.abs() <= (1.0 + ROUNDING) * largest;
            if !is_possible {
                return Err(
                    format!("its covariance of {other} and {name} is {a} and {b}: no covariance has that").into()
                );
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regression() -> UserRegression {
        UserRegression {
            x: Matrix::from_fn(3, 2, |i, j| (i + 2 * j) as f64),
            y: vec![1.0, 2.0, 3.0],
            z: None,
            joint: vec![0, 0, 1],
            recording: vec![0, 1, 0],
            share: vec![1.0, 0.5, 1.0],
            names: vec!["fv1".to_owned(), "fc1".to_owned()],
            units: vec!["N m s/rad".to_owned(), "N m".to_owned()],
        }
    }

    fn refusal(theta: &[f64], covariance: Option<Matrix>) -> String {
        let found = UserEstimate { theta: theta.to_vec(), covariance };
        let estimator = UserEstimator::new("ridge", move |_| Ok(found.clone())).unwrap();
        estimator.estimate(&regression()).map_or_else(|e| e.to_string(), |_| String::new())
    }

    #[test]
    fn what_is_no_estimate_is_refused_by_name() {
        assert_eq!(refusal(&[1.0, 2.0], Some(Matrix::identity(2))), "");
        assert_eq!(refusal(&[1.0], None), "it returned 1 estimates for 2 parameters");
        assert_eq!(refusal(&[1.0, f64::NAN], None), "its estimate of fc1 is NaN");
        assert_eq!(refusal(&[1.0, 2.0], Some(Matrix::zeros(2, 3))), "its covariance is 2 by 3 for 2 parameters");
        let negative = Matrix::from_fn(2, 2, |i, j| if i == j { -1.0 } else { 0.0 });
        assert_eq!(refusal(&[1.0, 2.0], Some(negative)), "its variance of fv1 is -1");
        let lopsided = Matrix::from_fn(2, 2, |i, j| if i >= j { 1.0 } else { 0.5 });
        assert!(refusal(&[1.0, 2.0], Some(lopsided)).starts_with("its covariance of fv1 and fc1 is 1 and 0.5"));
        let beyond = Matrix::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 2.0 });
        assert!(refusal(&[1.0, 2.0], Some(beyond)).contains("no covariance has that"));
    }

    #[test]
    fn names_of_methods_and_what_a_terminal_would_obey_are_no_names() {
        for name in ["idim-ls", "IDIM-LS", "", "a b", "a\u{1b}[2J", "<b>", &"a".repeat(41)] {
            assert!(UserEstimator::new(name, |_| Err("never called".into())).is_err(), "{name}");
        }
        assert!(UserEstimator::new("Ridge_0.1", |_| Err("never called".into())).is_ok());
    }

    #[test]
    fn rows_are_kept_together() {
        let kept = regression().select_rows(&[false, true, true]);
        assert_eq!((kept.x.rows(), kept.y, kept.joint, kept.recording), (2, vec![2.0, 3.0], vec![0, 1], vec![1, 0]));
        assert_eq!(kept.share, vec![0.5, 1.0]);
    }
}
