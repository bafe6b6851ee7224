//! One method on one record.

use super::CampaignMethod;
use crate::{
    experiment::{Experiment, Problem, Simulator, Weighting},
    identification::{Method, Outcome, idim_ls, iterate, joint_weights},
};

/// What a method works on.
pub(super) struct Attempt<'a> {
    /// The experiment with the start values.
    pub(super) experiment: &'a Experiment,
    pub(super) problem: &'a Problem,
    pub(super) simulator: Option<&'a Simulator<'a>>,
    pub(super) method: CampaignMethod,
}

pub(super) fn estimate(attempt: &Attempt<'_>) -> Outcome {
    let Attempt { experiment, problem, method, .. } = attempt;
    let estimation = &experiment.file.estimation;
    let weights = attempt.weights();
    match (method.estimator(), attempt.simulator) {
        (method @ (Method::IdimIv | Method::Didim), Some(simulator)) => iterate(
            method,
            (&problem.x, &problem.y),
            weights.as_deref(),
            (estimation.variance, estimation.convergence),
            &simulator.start(),
            &mut |theta| simulator.instruments(theta),
        ),
        _ => Outcome::direct(idim_ls(&problem.x, &problem.y, weights.as_deref(), estimation.variance)),
    }
}

impl Attempt<'_> {
    /// The weight of each row, where the method has any and LS has an estimate to take them from.
    fn weights(&self) -> Option<Vec<f64>> {
        let estimation = &self.experiment.file.estimation;
        let per_joint = match self.method {
            CampaignMethod::IdimLs => false,
            CampaignMethod::IdimWls => true,
            _ => estimation.weighting.get(&self.method.estimator()) == Some(&Weighting::PerJoint),
        };
        if !per_joint {
            return None;
        }
        let Problem { x, y, .. } = self.problem;
        let fit = idim_ls(x, y, None, estimation.variance).ok()?;
        Some(joint_weights(x, y, &fit, self.problem.joints()))
    }
}
