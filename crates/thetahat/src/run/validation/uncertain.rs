//! The note on parameters that the motion hardly excites: the numbers of the table, and what leaving them out would do.

use super::cross_validation::folds_by_part;
use crate::preparation::{NamedChoice, ParameterChoice, Problem, Setup, Simulable};
use thetahat_estimation::{
    checks::{Code, Finding, OrderedStep, RemedyStep, Severity},
    identification::{Method, Needs, eliminate},
    regression::{Regression, RowLayout},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr, dot, norm},
    number::significant,
};
use thetahat_report::results::{NOMINAL, ParameterResult, RunResult};

/// Relative standard deviation, percent, above which a parameter is named: that above which an elimination looks at it.
const LIMIT_PERCENT: f64 = 30.0;
/// Change of the error on parts left out, percent, that does not round to zero.
const VISIBLE_PERCENT: f64 = 0.5;
/// Relative tolerance of the rank, as for the estimate.
const RANK_TOLERANCE: f64 = 1e-10;

/// The note on the estimates of the first run of the nominal case that has any, those from the measured motion first.
pub(in crate::run) fn of_runs(setup: Setup<'_>, problem: &Problem, runs: &[RunResult]) -> Option<Finding> {
    let nominal = || runs.iter().filter(|r| r.case == NOMINAL && !r.parameters.is_empty());
    let measured = nominal().find(|r| r.method.needs() == Needs::Measurement);
    let run = measured.or_else(|| nominal().next())?;
    note(setup, problem, run.method, &run.parameters)
}

/// The note on estimates of a method; none if all are certain.
pub(in crate::run) fn note(
    setup: Setup<'_>,
    problem: &Problem,
    method: Method,
    parameters: &[ParameterResult],
) -> Option<Finding> {
    let percent = |p: &&ParameterResult| p.relative_standard_deviation_percent.is_some_and(|d| d > LIMIT_PERCENT);
    let names: Vec<String> = parameters.iter().filter(percent).map(|p| p.name.clone()).collect();
    if names.is_empty() {
        return None;
    }
    let (remedy, step) = remedy(setup, problem);
    Some(Finding {
        code: Code::NotExcited,
        severity: Severity::Note,
        joint: None,
        joint_name: None,
        value: names.len() as f64,
        unit: "parameters".to_owned(),
        limit: None,
        message: format!(
            "{} of {} parameters have a relative standard deviation above {LIMIT_PERCENT} % ({method}): {}",
            names.len(),
            parameters.len(),
            names.join(" ")
        ),
        remedy,
        parameters: names,
        // It is found after all others.
        step: step.map(|step| OrderedStep { order: usize::MAX, step }),
    })
}

/// What to do, and the change of the settings that makes the error on parts left out smaller.
fn remedy(setup: Setup<'_>, problem: &Problem) -> (String, Option<RemedyStep>) {
    let motion = "record faster and wider motion";
    let choice = &setup.settings.parameters.estimate;
    let whole = matches!(choice, ParameterChoice::Base | ParameterChoice::Named(NamedChoice::Base));
    let Some(trial) = whole.then(|| Trial::new(setup, problem)).flatten() else {
        return (motion.to_owned(), None);
    };
    let Trial { eliminated, whole, essential } = trial;
    let change = 100.0 * (essential / whole - 1.0).abs();
    if change < VISIBLE_PERCENT {
        let remedy = format!(
            "{motion}; for a smaller model with the same error on parts left out, set estimate = \"essential\" in [parameters] ({eliminated} fewer)"
        );
        return (remedy, None);
    }
    let errors = format!("cross-validated error from {} to {} %", significant(whole, 3), significant(essential, 3));
    if essential <= whole {
        let remedy =
            format!("{motion}, or set estimate = \"essential\" in [parameters] ({eliminated} fewer: {errors})");
        return (remedy, Some(RemedyStep::Essential { left_out: eliminated }));
    }
    (format!("{motion}; leave estimate as it is: \"essential\" predicts worse ({errors})"), None)
}

/// What leaving out the parameters that are not essential would do.
struct Trial {
    eliminated: usize,
    /// Relative errors of predicted fifths of the recording, percent: with all parameters, and with the essential ones.
    whole: f64,
    essential: f64,
}

impl Trial {
    /// None if nothing would be left out, or the fifths do not separate the parameters.
    fn new(setup: Setup<'_>, problem: &Problem) -> Option<Self> {
        let regression = &problem.regression;
        if norm(&regression.y) == 0.0 || !regression.is_in_time_order {
            return None;
        }
        let fifths = Fifths::new(regression);
        let few = fifths.all(regression.rows_represented());
        let whole: Vec<usize> = (0..regression.parameters()).collect();
        let simulable = Simulable::new(setup.robot, (&problem.model, &problem.estimated), &few, &whole);
        let rule = setup.settings.parameters.elimination;
        let found = eliminate(&few, rule, &|kept, theta| simulable.is_possible(kept, theta)).ok()?;
        let percent = |columns: &[usize]| Some(100.0 * fifths.error(columns)? / norm(&regression.y));
        let trial =
            Self { eliminated: found.eliminated.len(), whole: percent(&whole)?, essential: percent(&found.kept)? };
        (trial.eliminated > 0).then_some(trial)
    }
}

/// The triangular factor of `[X y]` of each fifth of every joint's rows.
struct Fifths(Vec<Matrix>);

impl Fifths {
    fn new(regression: &Regression) -> Self {
        let y = Matrix::from_fn(regression.y.len(), 1, |i, _| regression.y[i]);
        let all = Matrix::side_by_side(&[&regression.x, &y]);
        let fold = folds_by_part(all.rows() / regression.layout.joints().max(1));
        let count = fold.iter().max().map_or(0, |last| last + 1);
        let own = |f: usize| (0..all.rows()).map(|i| fold[i % fold.len()] == f).collect::<Vec<bool>>();
        Self((0..count).map(|f| all.select_rows(&own(f)).triangular_factor()).collect())
    }

    /// All rows, in a few.
    fn all(&self, rows_represented: usize) -> Regression {
        let rows = Matrix::stack(&self.0.iter().collect::<Vec<_>>()).triangular_factor();
        let columns = rows.columns() - 1;
        let x = rows.select_columns(&(0..columns).collect::<Vec<_>>());
        let layout = RowLayout::new(1, &[x.rows()]);
        Regression::of_factors(x, rows.column(columns).to_vec(), layout, vec![rows_represented as f64])
    }

    /// The length of the error of the fifths, each with the parameters of the others.
    fn error(&self, columns: &[usize]) -> Option<f64> {
        let squares = |own: usize| {
            let others: Vec<&Matrix> = (0..self.0.len()).filter(|f| *f != own).map(|f| &self.0[f]).collect();
            let rows = Matrix::stack(&others);
            let qr = PivotedQr::new(&rows.select_columns(columns));
            let separates = qr.rank(RANK_TOLERANCE) == columns.len();
            let theta = separates.then(|| qr.solve(rows.column(rows.columns() - 1)))?;
            let predicted = self.0[own].select_columns(columns).times(&theta);
            let measured = self.0[own].column(rows.columns() - 1);
            let error: Vec<f64> = measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
            Some(dot(&error, &error))
        };
        (0..self.0.len()).map(squares).sum::<Option<f64>>().map(f64::sqrt)
    }
}
