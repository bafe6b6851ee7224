//! What the user has already: reductions as known before, and results to compare with.

use super::{description::Design, error::DesignError, optimiser::Problem};
use crate::{
    base_parameters::BaseParameters,
    linear_algebra::Matrix,
    reduction::Reduction,
    results::{ParameterResult, Results, RunResult},
};

/// Estimates to compare with.
pub(super) struct Compared {
    pub(super) title: String,
    pub(super) method: String,
    pub(super) parameters: Vec<ParameterResult>,
}

impl Design {
    /// What the recordings at hand tell of the base parameters.
    pub(super) fn prior(&self, base: &BaseParameters, noise: &[f64]) -> Result<Option<Matrix>, DesignError> {
        if self.file.prior.is_empty() {
            return Ok(None);
        }
        let reduction = Reduction::read_all(&self.prior_files())?;
        if !reduction.identity.is_of(&self.robot, base) {
            return Err(DesignError::OtherRobot { path: self.path.clone() });
        }
        Ok(Some(reduction.information(noise)?))
    }

    /// The criterion if the last of the recordings at hand were repeated instead, for as long as the motion takes.
    pub(super) fn repeated(&self, problem: &Problem) -> Result<Option<f64>, DesignError> {
        let files = self.prior_files();
        let (Some(last), Some(prior)) = (files.last(), problem.information.prior()) else { return Ok(None) };
        let reduction = Reduction::read_all(std::slice::from_ref(last))?;
        let seconds: f64 = reduction.recordings.iter().map(|r| r.window_s[1] - r.window_s[0]).sum();
        let again = prior.plus(&reduction.information(&self.noise.deviations)?, self.file.duration_s / seconds);
        Ok(problem.criterion.value(&again))
    }

    /// The results to compare with, of the method that they advise to take.
    pub(super) fn compared(&self) -> Result<Option<Compared>, DesignError> {
        let Some(file) = self.compared_file() else { return Ok(None) };
        let results = Results::read(&file)?;
        let taken = |run: &&RunResult| results.advice.iter().any(|a| a.case == run.case && a.take == Some(run.method));
        let of = |run: &&RunResult| !run.parameters.is_empty();
        let run = results.runs.iter().filter(of).find(taken).or_else(|| results.runs.iter().find(of));
        let run = run.ok_or_else(|| DesignError::NothingToCompare { path: self.path.clone(), file: file.clone() })?;
        Ok(Some(Compared {
            title: results.title.clone(),
            method: run.method.name().to_owned(),
            parameters: run.parameters.clone(),
        }))
    }
}
