//! One method on one record.

use super::CampaignMethod;
use crate::{
    experiment::{Attempt, Experiment, Problem, Simulator, Weighting},
    identification::{Fit, Outcome, Uncertainty, idim_ls, joint_weights, uncertainty},
};

/// A method with its weights and start values, which are those of the experiment.
pub(super) fn attempt<'a>(
    experiment: &Experiment,
    problem: &'a Problem,
    simulator: Option<Simulator<'a>>,
    method: CampaignMethod,
) -> Attempt<'a> {
    let start = simulator.as_ref().map(Simulator::start).unwrap_or_default();
    let weights = weights(experiment, problem, method);
    Attempt { problem, method: method.estimator(), weights, simulator, start }
}

/// How far an estimate may be off; none where that has no finite answer.
pub(super) fn uncertainty_of(attempt: &Attempt<'_>, fit: &Fit, outcome: &Outcome) -> Option<Uncertainty> {
    let Problem { x, y, rows, .. } = attempt.problem;
    let matrices = (x, outcome.instruments.as_ref(), &y[..]);
    uncertainty(attempt.method, matrices, attempt.weights.as_deref(), fit, &rows.blocks()).ok()
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
