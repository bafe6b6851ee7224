//! The estimate with the parameters that a motion separates.

use thetahat_estimation::{
    identification::{Divisor, EstimationError, idim_ls},
    regression::Regression,
};

/// The columns that the motion separates, and the estimate with them.
pub(super) fn separated(regression: &Regression) -> Result<(Vec<usize>, Vec<f64>), EstimationError> {
    let all = 0..regression.x.columns();
    match idim_ls(regression, Divisor::default()) {
        Ok(fit) => Ok((all.collect(), fit.theta)),
        Err(EstimationError::NotIdentifiable { dependent, .. }) => {
            let columns: Vec<usize> = all.filter(|c| !dependent.contains(c)).collect();
            let fit = idim_ls(&regression.with_columns(&columns), Divisor::default())?;
            Ok((columns, fit.theta))
        }
        Err(error) => Err(error),
    }
}
