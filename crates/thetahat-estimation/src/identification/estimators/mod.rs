//! The estimators, one file each, and the table that names them for files, command line and report.
//!
//! An estimator is a value: its needs, its estimate, and its influence `A` with `theta_hat - theta = A^T e`, from which every covariance
//! follows as the sandwich `A^T cov(e) A`. A new estimator takes its own file and an entry of [`ESTIMATORS`].

mod clie;
mod cloe;
mod didim;
mod estimator;
mod iv;
mod ls;
mod piv;
mod wls;

use std::{cmp::Ordering, fmt, str::FromStr, sync::LazyLock};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

pub use didim::didim;
pub use estimator::{DesignMatrix, Needs, Response, Weighting};
pub use iv::idim_iv;
pub use ls::idim_ls;

use estimator::Estimator;

use super::fit::{Divisor, EstimationError, Fit};
use crate::regression::Regression;
use thetahat_ground::linear_algebra::Matrix;

/// Every estimator, in the order of tables.
static ESTIMATORS: [&Estimator; 7] =
    [&ls::IDIM_LS, &wls::IDIM_WLS, &iv::IDIM_IV, &piv::IDIM_PIV, &didim::DIDIM, &clie::CLIE, &cloe::CLOE];
static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| ESTIMATORS.iter().map(|e| e.name).collect());

/// An estimator of the table.
///
/// ```
/// use thetahat_estimation::identification::{Method, Needs};
///
/// let method: Method = "idim-iv".parse()?;
/// assert_eq!((method, method.needs()), (Method::IDIM_IV, Needs::Instruments));
/// # Ok::<(), thetahat_estimation::identification::UnknownMethod>(())
/// ```
#[derive(Clone, Copy)]
pub struct Method(&'static Estimator);

impl Method {
    /// Least squares on the measured motion (8).
    pub const IDIM_LS: Self = Self(&ls::IDIM_LS);
    /// Least squares weighted by the noise of each joint.
    pub const IDIM_WLS: Self = Self(&wls::IDIM_WLS);
    /// Instrumental variables from a simulated motion (10).
    pub const IDIM_IV: Self = Self(&iv::IDIM_IV);
    /// Instrumental variables of rows whose noise is made white.
    pub const IDIM_PIV: Self = Self(&piv::IDIM_PIV);
    /// Least squares on the simulated motion (19).
    pub const DIDIM: Self = Self(&didim::DIDIM);
    /// Least squares between measured and simulated torques (11) to (15).
    pub const CLIE: Self = Self(&clie::CLIE);
    /// Least squares between measured and simulated positions (11) to (15).
    pub const CLOE: Self = Self(&cloe::CLOE);

    /// Every method, in the order of tables.
    pub fn all() -> impl Iterator<Item = Self> {
        ESTIMATORS.into_iter().map(Self)
    }

    /// Its name, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// The number of its equation in the paper.
    #[must_use]
    pub fn equation(self) -> &'static str {
        self.0.equation
    }

    /// What it needs in addition to the regression.
    #[must_use]
    pub fn needs(self) -> Needs {
        self.0.needs
    }

    /// The matrix that the parameters multiply in its prediction.
    #[must_use]
    pub fn design(self) -> DesignMatrix {
        self.0.design
    }

    /// The signal of the loop that it predicts.
    #[must_use]
    pub fn response(self) -> Response {
        self.0.response
    }

    /// The weighting that it implies, whatever the settings.
    #[must_use]
    pub fn weighting(self) -> Option<Weighting> {
        self.0.weighting
    }

    /// The estimate. `z` is Z with the rows of the regression.
    ///
    /// # Errors
    /// [`EstimationError`] where the parameters are not identifiable, or Z is needed and missing.
    pub fn estimate(
        self,
        regression: &Regression,
        z: Option<&Matrix>,
        divisor: Divisor,
    ) -> Result<Fit, EstimationError> {
        (self.0.estimate)(regression, z, divisor)
    }

    /// The influence A, rows by parameters: `theta_hat - theta = A^T e`, for errors e of the rows of y.
    ///
    /// # Errors
    /// As [`Method::estimate`].
    pub fn influence(self, regression: &Regression, z: Option<&Matrix>) -> Result<Matrix, EstimationError> {
        (self.0.influence)(regression, z)
    }

    fn place(self) -> usize {
        ESTIMATORS.iter().position(|e| e.name == self.0.name).unwrap_or(ESTIMATORS.len())
    }
}

/// The name of no known estimator.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown method `{name}`, expected one of {}", NAMES.join(", "))]
pub struct UnknownMethod {
    /// The name.
    pub name: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        Self::all().find(|m| m.name() == name).ok_or_else(|| UnknownMethod { name: name.to_owned() })
    }
}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for Method {}

impl PartialOrd for Method {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Method {
    fn cmp(&self, other: &Self) -> Ordering {
        self.place().cmp(&other.place())
    }
}

impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Method {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        name.parse().map_err(|_| de::Error::unknown_variant(&name, &NAMES))
    }
}

#[cfg(test)]
mod tests;
