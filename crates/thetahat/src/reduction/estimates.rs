use std::{collections::BTreeMap, path::Path};

use super::ReductionError;
use crate::{
    experiment::{NOMINAL, Results},
    identification::Method,
};

/// The nominal estimates of a `results.json` by name: those of IDIM-IV, or else of IDIM-LS.
///
/// # Errors
/// [`ReductionError`] for a file that cannot be read or holds no estimates.
pub fn estimates_of_results(path: &Path) -> Result<BTreeMap<String, f64>, ReductionError> {
    let refuse = |reason: String| ReductionError::NoEstimates { path: path.to_owned(), reason };
    let text = std::fs::read(path).map_err(|source| ReductionError::Unreadable { path: path.to_owned(), source })?;
    let results: Results = serde_json::from_slice(&text).map_err(|e| refuse(e.to_string()))?;
    let run = [Method::IdimIv, Method::IdimLs].into_iter().filter_map(|method| results.run(NOMINAL, method));
    let parameters = run.map(|run| &run.parameters).find(|parameters| !parameters.is_empty());
    let parameters =
        parameters.ok_or_else(|| refuse("it holds no nominal estimate of idim-iv or idim-ls".to_owned()))?;
    Ok(parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect())
}
