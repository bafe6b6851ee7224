//! One method on one record.

use super::CampaignMethod;
use crate::{
    experiment::{Experiment, Problem, Simulator, Weighting},
    identification::{Fit, Method, Outcome, Uncertainty, idim_ls, iterate, joint_weights, uncertainty},
    linear_algebra::Matrix,
};

/// What a method works on.
pub(super) struct Attempt<'a> {
    /// The experiment with the start values.
    pub(super) experiment: &'a Experiment,
    pub(super) problem: &'a Problem,
    pub(super) simulator: Option<&'a Simulator<'a>>,
    pub(super) method: CampaignMethod,
    /// The weight of each row, where the method has any.
    pub(super) weights: Option<Vec<f64>>,
}

pub(super) fn estimate(attempt: &Attempt<'_>) -> Outcome {
    let Attempt { experiment, problem, method, .. } = attempt;
    let estimation = &experiment.file.estimation;
    let weights = &attempt.weights;
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

impl<'a> Attempt<'a> {
    /// A method with its weights.
    pub(super) fn new(
        experiment: &'a Experiment,
        problem: &'a Problem,
        simulator: Option<&'a Simulator<'a>>,
        method: CampaignMethod,
    ) -> Self {
        Self { experiment, problem, simulator, method, weights: weights(experiment, problem, method) }
    }

    /// How far an estimate may be off; none where that has no finite answer.
    pub(super) fn uncertainty(&self, fit: &Fit, instruments: Option<&Matrix>) -> Option<Uncertainty> {
        let Problem { x, y, .. } = self.problem;
        let weights = self.weights.as_deref();
        uncertainty(self.method.estimator(), (x, instruments, y), weights, fit, &self.problem.rows.blocks()).ok()
    }
}

/// The weight of each row, where the method has any and LS has an estimate to take them from.
fn weights(experiment: &Experiment, problem: &Problem, method: CampaignMethod) -> Option<Vec<f64>> {
    let estimation = &experiment.file.estimation;
    let per_joint = match method {
        CampaignMethod::IdimLs => false,
        CampaignMethod::IdimWls => true,
        _ => estimation.weighting.get(&method.estimator()) == Some(&Weighting::PerJoint),
    };
    if !per_joint {
        return None;
    }
    let fit = idim_ls(&problem.x, &problem.y, None, estimation.variance).ok()?;
    Some(joint_weights(&problem.x, &problem.y, &fit, problem.joints()))
}
