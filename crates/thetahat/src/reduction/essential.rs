use super::compressed::Compressed;
use crate::{
    base_parameters::BaseParameters,
    experiment::{Experiment, NamedChoice, ParameterChoice},
    identification::{EliminationRule, EstimationError, Fit},
    results::EliminationResult,
    statistics::{FTest, f_test},
};

/// Columns that an elimination keeps and takes out.
pub(super) struct Kept {
    pub kept: Vec<usize>,
    eliminated: Vec<usize>,
    f_test: Option<FTest>,
}

impl Kept {
    pub(super) fn named(self, base: &BaseParameters) -> EliminationResult {
        let names = |columns: &[usize]| columns.iter().map(|&c| base.parameters()[c].name.clone()).collect();
        EliminationResult { kept: names(&self.kept), eliminated: names(&self.eliminated), f_test: self.f_test }
    }
}

/// The columns that are estimated.
pub(super) fn choose(
    experiment: &Experiment,
    base: &BaseParameters,
    problem: &Compressed,
) -> (Vec<usize>, Option<Kept>) {
    let all: Vec<usize> = (0..base.len()).collect();
    match &experiment.file.parameters.estimate {
        ParameterChoice::Base | ParameterChoice::Named(NamedChoice::Base) => (all, None),
        ParameterChoice::List(names) => {
            let listed = |c: &usize| names.contains(&base.parameters()[*c].name);
            (all.into_iter().filter(listed).collect(), None)
        }
        ParameterChoice::Named(NamedChoice::Essential) => {
            match eliminate(problem, experiment.file.parameters.elimination) {
                Ok(kept) => (kept.kept.clone(), Some(kept)),
                Err(_) => (all, None),
            }
        }
    }
}

/// As [`eliminate`](crate::identification::eliminate) on all rows.
fn eliminate(problem: &Compressed, rule: EliminationRule) -> Result<Kept, EstimationError> {
    let fit = |columns: &[usize]| problem.fit(&problem.x.select_columns(columns), None, Default::default());
    let mut kept: Vec<usize> = (0..problem.x.columns()).collect();
    let mut state = Kept { kept: kept.clone(), eliminated: Vec::new(), f_test: None };
    let mut current = fit(&kept)?;
    let full_squares = current.residual_sum_of_squares(&problem.y);
    while let Some(worst) = worst_parameter(&current, rule.relative_standard_deviation_percent) {
        if kept.len() == 1 {
            break;
        }
        let removed = kept.remove(worst);
        let next = fit(&kept)?;
        let squares = next.residual_sum_of_squares(&problem.y);
        let test = f_test(squares, kept.len(), full_squares, problem.x.columns(), problem.rows);
        if test.is_none_or(|t| t.p_value < rule.significance) {
            break;
        }
        state.eliminated.push(removed);
        (state.kept, state.f_test, current) = (kept.clone(), test, next);
    }
    Ok(state)
}

fn worst_parameter(fit: &Fit, limit_percent: f64) -> Option<usize> {
    let relative = |i: usize| 100.0 * fit.standard_deviation[i] / fit.theta[i].abs();
    (0..fit.theta.len()).filter(|&i| relative(i) > limit_percent).max_by(|&a, &b| relative(a).total_cmp(&relative(b)))
}
