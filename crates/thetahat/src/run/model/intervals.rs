//! The intervals of the model's parameters: what the recordings alone say.

use super::rows::ModelRows;
use thetahat_estimation::{
    identification::{
        Divisor, Fit, Method, SeparatedColumns, Status, Uncertainty, idim_ls, uncertainty, uncertainty_of_stretches,
    },
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_report::results::{ModelCause, NOMINAL, RunResult};

/// Half of a 95 % interval in deviations.
const NORMAL_QUANTILE: f64 = 1.96;

/// The intervals of free estimates.
pub(super) struct Intervals<'a> {
    /// By the rows of the model, of each base parameter that the recordings separate from the others.
    of_rows: Vec<Option<[f64; 2]>>,
    run: Option<&'a RunResult>,
}

impl<'a> Intervals<'a> {
    /// Weighted least squares in rows of the model where the friction has its sign: near rest its errors depend on the motion.
    /// What else is estimated, as a delay of the torques, has columns of its own.
    pub(super) fn new(rows: &ModelRows, deviations: &[f64], others: &[Vec<f64>], runs: &'a [RunResult]) -> Self {
        Self { of_rows: of_rows(rows, deviations, others).unwrap_or_default(), run: free_run(runs) }
    }

    /// The same from triangular factors of these rows, by the scores of the stretches of time.
    pub(super) fn of_stretches(settled: &Regression, runs: &'a [RunResult]) -> Self {
        let with_rows = (!settled.y.is_empty()).then(|| settled.clone());
        let of_rows = with_rows.and_then(|settled| {
            intervals_of(settled, |regression, fit| uncertainty_of_stretches(regression, None, &fit.theta).ok())
        });
        Self { of_rows: of_rows.unwrap_or_default(), run: free_run(runs) }
    }

    /// The interval of a base parameter: that of the rows together with that of the weighted run. These treat friction near
    /// rest and delays otherwise, and nothing says which is right.
    pub(super) fn of(&self, index: usize, name: &str) -> Option<[f64; 2]> {
        let of_rows = self.of_rows.get(index).copied().flatten();
        let of_run = self.run.and_then(|run| run.parameter(name)?.interval_95);
        let both = of_rows.zip(of_run).map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])]);
        both.or(of_rows).or(of_run)
    }
}

fn of_rows(rows: &ModelRows, deviations: &[f64], others: &[Vec<f64>]) -> Option<Vec<Option<[f64; 2]>>> {
    let whitening = rows.layout.spread(|block| 1.0 / deviations[block.joint]);
    let weights = whitening.iter().zip(&rows.weights).map(|(a, b)| a * b).collect();
    let others = Matrix::from_columns(rows.y.len(), others.concat());
    let x = Matrix::side_by_side(&[&rows.x, &others.scale_rows(&rows.kept())]);
    let regression = Regression::new(x, rows.y.clone(), rows.layout.clone()).with_weights(Some(weights));
    intervals_of(regression, |regression, fit| uncertainty(Method::IDIM_LS, regression, None, fit).ok())
}

/// The interval of each column that is separated from the others, by the uncertainty of a least squares fit of these.
fn intervals_of(
    all: Regression,
    uncertainty: impl Fn(&Regression, &Fit) -> Option<Uncertainty>,
) -> Option<Vec<Option<[f64; 2]>>> {
    let separated = SeparatedColumns::of(&all.x);
    let regression = all.with_columns(&separated.kept);
    let fit = idim_ls(&regression, Divisor::default()).ok()?;
    let found = uncertainty(&regression, &fit)?.interval_95;
    let mut intervals = vec![None; all.parameters()];
    separated.kept.iter().zip(found).for_each(|(&column, interval)| intervals[column] = Some(interval));
    separated.including().for_each(|column| intervals[column] = None);
    Some(intervals)
}

/// The run whose intervals are those of the recordings alone: weighted least squares, or else plain.
fn free_run(runs: &[RunResult]) -> Option<&RunResult> {
    let of = |method: Method| {
        let converged = |r: &&RunResult| r.status == Status::Converged && r.case == NOMINAL && r.method == method;
        runs.iter().find(converged)
    };
    of(Method::IDIM_WLS).or_else(|| of(Method::IDIM_LS))
}

/// An interval that holds the value wherever one of the causes has moved it.
pub(super) fn widened([low, high]: [f64; 2], name: &str, causes: &[ModelCause]) -> [f64; 2] {
    let moved = causes.iter().flat_map(|c| &c.moved).filter(|m| m.parameter == name).map(|m| m.deviations.abs());
    let shift = moved.fold(0.0, f64::max) * 0.5 * (high - low) / NORMAL_QUANTILE;
    [low - shift, high + shift]
}
