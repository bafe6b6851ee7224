//! The estimate with the parameters that a motion separates.

use thetahat_estimation::{
    identification::{Divisor, EstimationError, idim_ls},
    regression::Regression,
};

/// The columns that the motion separates, and the estimate with them; what is nearly a sum of others can turn out as one when those
/// that are sums are gone.
pub(super) fn separated(regression: &Regression) -> Result<(Vec<usize>, Vec<f64>), EstimationError> {
    let mut columns: Vec<usize> = (0..regression.x.columns()).collect();
    loop {
        match idim_ls(&regression.with_columns(&columns), Divisor::default()) {
            Ok(fit) => return Ok((columns, fit.theta)),
            Err(EstimationError::NotIdentifiable { dependent, .. }) => {
                columns = (0..columns.len()).filter(|c| !dependent.contains(c)).map(|c| columns[c]).collect();
            }
            Err(error) => return Err(error),
        }
    }
}
