//! What samples near rest would change, where they are left out.

use crate::{
    preparation::{Case, FilteredRecording, ParameterChoice, PreparationError, Problem},
    run::{identification::Identification, prepared::filtered},
};
use thetahat_estimation::identification::{Divisor, Method, idim_ls};
use thetahat_report::results::{NOMINAL, ParameterResult, RunResult, UnmaskedComparison};

/// Most numbers of an observation matrix for which it is built a second time.
const MOST_NUMBERS: usize = 10_000_000;

impl Identification {
    /// IDIM-LS on every sample, compared with the nominal run, where samples near rest are left out; none if there is no such run,
    /// or where the recordings are so long that it would cost too much.
    pub(in crate::run) fn unmasked_comparison(
        &self,
        problem: &Problem,
        runs: &[RunResult],
    ) -> Result<Option<UnmaskedComparison>, PreparationError> {
        let is_ls = |run: &&RunResult| run.case == NOMINAL && run.method == Method::IDIM_LS;
        let (Some(run), true) = (runs.iter().find(is_ls), problem.regression.layout.is_masked()) else {
            return Ok(None);
        };
        if problem.regression.y.len() * problem.base.len() > MOST_NUMBERS {
            return Ok(None);
        }
        let every_sample = |r: &FilteredRecording| FilteredRecording { near_rest: None, ..r.clone() };
        let recordings: Vec<FilteredRecording> = filtered(&self.main).into_iter().map(every_sample).collect();
        let names = problem.estimated.parameters().iter().map(|p| p.name.clone()).collect();
        let basis = self.setup().basis(&Case::nominal())?;
        let choice = ParameterChoice::List(names);
        let all = self.setup().problem_on(basis, &recordings.iter().collect::<Vec<_>>(), &choice)?;
        let Ok(fit) = idim_ls(&all.regression.with_weights(None), Divisor::default()) else { return Ok(None) };
        let difference = |(p, with): (&ParameterResult, &f64)| {
            Some((p.name.clone(), (with - p.estimate) / p.standard_deviation_robust?))
        };
        let differences = run.parameters.iter().zip(&fit.theta).filter_map(difference);
        let largest = differences.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        Ok(largest.map(|(parameter, deviations)| UnmaskedComparison {
            relative_error_percent: fit.relative_error_percent,
            parameter,
            deviations,
        }))
    }
}
