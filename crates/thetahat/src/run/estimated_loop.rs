//! Quantities of the loop that are estimated where no torques are recorded and none are asked for: how late commands act, half a step if
//! they are held, and the velocity at which friction changes its sign. What they are wrong by goes into friction: a delay of 10 ms made a
//! viscous friction 6.7 times too large, with a narrow interval.

use super::{
    fitted_positions::PositionResidual,
    identification::{CaseProblem, Identification},
};
use crate::{
    diagnosis::MethodEstimate,
    preparation::{LoopParameter, PreparationError},
};
use thetahat_estimation::identification::{Method, Status};
use thetahat_report::results::{NOMINAL, RunResult};

/// Change of the information criterion below which they are estimated: very strong evidence (R. E. Kass, A. E. Raftery, "Bayes factors",
/// Journal of the American Statistical Association 90, 1995, p. 777).
const VERY_STRONG: f64 = -10.0;

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
        let mut assessed = with_loop.assess_all(&problems, &with_loop.setup().settings.all_cases(), &mut of_loop)?;
        let Some((run, estimate)) = nominal_mut(&mut assessed).filter(|other| with_loop.explains(as_described, other))
        else {
            return Ok(None);
        };
        let left =
            PositionResidual::of(&as_described.1).zip(PositionResidual::of(estimate)).map(|(described, other)| {
                100.0 * other.squares.iter().sum::<f64>() / described.squares.iter().sum::<f64>()
            });
        run.notes.extend(left.map(|percent| {
            format!(
                "of the loop are estimated how late commands act, half a step if they are held, and the velocity at which friction \
                 changes its sign: they leave {percent:.0} % of the squared error"
            )
        }));
        Ok(Some(LoopIdentification { identification: with_loop, problems, assessed }))
    }

    /// Whether what was estimated of the loop is possible and predicts better than what is described.
    fn explains(&self, (described, of_described): &MethodRun, (run, estimate): &MethodRun) -> bool {
        if run.status != Status::Converged || self.early_commands(run).is_some() {
            return false;
        }
        let unseen = |run: &RunResult| run.cross_validation_relative_error_percent;
        let predicts = unseen(described).zip(unseen(run)).is_none_or(|(before, after)| after <= before);
        let residuals = PositionResidual::of(of_described).zip(PositionResidual::of(estimate));
        let more = run.loop_parameters.len() as f64;
        let is_needed =
            |(before, after): (PositionResidual, PositionResidual)| before.criterion_change(&after, more) < VERY_STRONG;
        described.status != Status::Converged || predicts && residuals.is_some_and(is_needed)
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
