//! The rows that estimates are made of, for estimators outside.

use super::{
    identification::{CaseProblem, Identification},
    prepared::filtered,
};
use crate::{
    diagnosis::MethodEstimate,
    preparation::{Case, PreparationError},
};
use thetahat_estimation::identification::{Method, Status, UserRegression};

impl Identification {
    /// The rows of the nominal case that [`Identification::run`] estimates from: X and y without the samples near rest, and Z where
    /// IDIM-IV is among the methods and converges. An estimator of the user's own is given the same.
    ///
    /// # Errors
    /// [`PreparationError`] where the recordings make no rows, or have no torques.
    pub fn regression(&self) -> Result<UserRegression, PreparationError> {
        if let Some(without) = self.main.iter().find(|p| p.filtered.recording.torque.is_none()) {
            let place = format!("recording {}", without.filtered.recording.name);
            return Err(PreparationError::value(&place, "torques", "positions alone"));
        }
        let problem = self.setup().problem(&Case::nominal(), &filtered(&self.main))?;
        let problem = CaseProblem::new(self.setup().robot.friction, problem);
        let iv = self.nominal_iv(&problem)?;
        Ok(self.user_regression(&problem.problem, iv.as_ref().and_then(|e| e.outcome.instruments.as_ref())))
    }

    /// IDIM-IV of the nominal case, where it is asked for and converges.
    fn nominal_iv(&self, problem: &CaseProblem) -> Result<Option<MethodEstimate>, PreparationError> {
        if !self.setup().settings.estimation.methods.contains(&Method::IDIM_IV) {
            return Ok(None);
        }
        let case = Case { methods: Some(vec![Method::IDIM_IV]), ..Case::nominal() };
        let runs = self.assess_all(std::slice::from_ref(problem), &[case], &mut |_| {})?;
        let estimates = runs.into_iter().flatten().map(|(_, estimate)| estimate);
        Ok(estimates.into_iter().find(|estimate| estimate.outcome.status == Status::Converged))
    }
}
