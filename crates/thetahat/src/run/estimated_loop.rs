//! Quantities of the loop that are estimated where no torques are recorded and none are asked for: how late commands act, half a step if
//! they are held, and the velocity at which friction changes its sign. What they are wrong by goes into friction: a delay of 10 ms made a
//! viscous friction 6.7 times too large, with a narrow interval.

use super::{
    fitted_positions::PositionResidual,
    identification::{CaseProblem, Identification},
    terms::comparison::VERY_STRONG,
};
use crate::{
    diagnosis::MethodEstimate,
    preparation::{Case, LoopParameter, PreparationError},
};
use thetahat_estimation::identification::{Method, Status, idim_ls};
use thetahat_report::results::{NOMINAL, RunResult};

/// A run, and its estimate.
type MethodRun = (RunResult, MethodEstimate);

/// An identification that estimates quantities of the loop, its problems, and every method of every case.
pub(super) struct LoopIdentification {
    pub(super) identification: Identification,
    pub(super) problems: Vec<CaseProblem>,
    pub(super) assessed: Vec<Vec<MethodRun>>,
}

impl Identification {
    /// The same with quantities of the loop estimated; none if they do not explain the positions better.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    pub(super) fn with_loop_estimated(
        &self,
        described: &[Vec<MethodRun>],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Option<LoopIdentification>, PreparationError> {
        let mut settings = self.setup().settings.clone();
        let is_asked = !settings.estimation.loop_parameters.is_empty() || !self.estimators.is_empty();
        if is_asked || self.records_torques() {
            return Ok(None);
        }
        let Some(as_described) = nominal(described) else { return Ok(None) };
        settings.estimation.loop_parameters = vec![LoopParameter::Delay, LoopParameter::FrictionTransition];
        let with_loop = self.with_settings(settings);
        let mut of_loop = |line: &str| progress(&format!("with a delay: {line}"));
        let problems = with_loop.problems(&mut of_loop)?;
        if !with_loop.may_explain(&problems, as_described) {
            return Ok(None);
        }
        let mut assessed = with_loop.assess_all(&problems, &with_loop.setup().settings.all_cases(), &mut of_loop)?;
        let Some(estimated) = nominal_mut(&mut assessed) else { return Ok(None) };
        let Some(left) = with_loop.left_by_loop(as_described, estimated) else { return Ok(None) };
        estimated.0.notes.push(format!(
            "of the loop are estimated how late commands act, half a step if they are held, and the velocity at which friction changes its \
             sign: they leave {:.0} % of the squared error",
            100.0 * left
        ));
        Ok(Some(LoopIdentification { identification: with_loop, problems, assessed }))
    }

    /// Whether the quantities of the loop would explain the positions better if these were linear in them, where the fit of the loop as it is
    /// described ends (the score test of C. R. Rao, 1948): one simulation instead of another fit.
    fn may_explain(&self, problems: &[CaseProblem], (described, of_described): &MethodRun) -> bool {
        let Some(fit) = of_described.outcome.fit.as_ref().filter(|_| described.status == Status::Converged) else {
            return true;
        };
        let case = Case::nominal();
        let job = self.job(self.problem_of(problems, &case), &case, Method::CLOE);
        let Some(at_estimate) = job.linearised(&fit.theta, self.threads) else { return true };
        let residual = job.regression.residual(&at_estimate.response);
        let linear = job.regression.with_matrix(at_estimate.sensitivities).with_measured(residual.clone());
        let Ok(step) = idim_ls(&linear, self.setup().settings.estimation.variance) else { return true };
        let residuals = [&residual, &linear.residual(&step.prediction)];
        let [before, after] = residuals.map(|residual| PositionResidual::new(&linear.layout, residual));
        before.criterion_change(&after, job.names_of_loop().len() as f64) < VERY_STRONG
    }

    /// The part of the squared error that an estimated loop leaves; none if it is not possible, or predicts no better than what is described.
    fn left_by_loop(&self, (described, of_described): &MethodRun, (run, estimate): &MethodRun) -> Option<f64> {
        let is_possible = run.status == Status::Converged && self.early_commands(run).is_none();
        let after = PositionResidual::of(estimate).filter(|_| is_possible)?;
        let before = PositionResidual::of(of_described)?;
        let unseen = |run: &RunResult| run.cross_validation_relative_error_percent;
        let predicts = unseen(described).zip(unseen(run)).is_none_or(|(before, after)| after <= before);
        let is_needed = before.criterion_change(&after, run.loop_parameters.len() as f64) < VERY_STRONG;
        let is_better = described.status != Status::Converged || predicts && is_needed;
        is_better.then(|| after.squares.iter().sum::<f64>() / before.squares.iter().sum::<f64>())
    }
}

fn is_nominal((run, _): &MethodRun) -> bool {
    run.case == NOMINAL && run.method == Method::CLOE
}

fn nominal(assessed: &[Vec<MethodRun>]) -> Option<&MethodRun> {
    assessed.iter().flatten().find(|estimated| is_nominal(estimated))
}

fn nominal_mut(assessed: &mut [Vec<MethodRun>]) -> Option<&mut MethodRun> {
    assessed.iter_mut().flatten().find(|estimated| is_nominal(estimated))
}
