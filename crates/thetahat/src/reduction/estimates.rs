use std::{collections::BTreeMap, path::Path};

use super::error::ReductionError;
use crate::{
    experiment::Experiment,
    preparation::{Basis, Case},
};
use thetahat_estimation::identification::Method;
use thetahat_report::results::{NOMINAL, Results};

/// The nominal estimates of a `results.json` by name: from IDIM-IV, or else from IDIM-LS.
///
/// # Errors
/// [`ReductionError`] for a file that cannot be read or holds no estimates, and for estimates of parameters that the
/// experiment's robot does not have.
pub fn estimates_of_results(path: &Path, experiment: &Experiment) -> Result<BTreeMap<String, f64>, ReductionError> {
    let refuse = |reason: String| ReductionError::NoEstimates { path: path.to_owned(), reason };
    let results = Results::read(path)?;
    let run = [Method::IDIM_IV, Method::IDIM_LS].into_iter().filter_map(|method| results.run(NOMINAL, method));
    let parameters = run.map(|run| &run.parameters).find(|parameters| !parameters.is_empty());
    let parameters =
        parameters.ok_or_else(|| refuse("it holds no nominal estimate of idim-iv or idim-ls".to_owned()))?;
    let Basis { model, base } = experiment.setup().basis(&Case::nominal()).map_err(|e| experiment.refuse(e))?;
    let names: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    base.select(model.parameter_table(), &names).map_err(|e| refuse(e.to_string()))?;
    Ok(parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect())
}
