//! Recordings that are explained one by one and not together: another payload, other zeros, another robot.
//!
//! Each recording becomes the triangle of `[X y]`; the fit of any of them together is a fit of few rows. What it leaves is
//! compared with what the fits one by one leave, each per degree of freedom, every joint in units of what those leave of it,
//! with rows counted by how independent their residuals are.

use super::{
    companion::Companion,
    finding::{Code, Finding, Severity},
    numbers::autocorrelation,
    subject::Subject,
    thinned_recording::ThinnedRecording,
};
use crate::regression::Regression;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot};

/// How many times larger the residual of the common fit is than that of the fits one by one. Clean: the two recordings of the
/// KUKA 1.35, halves of records and the two of EMPS less than 1.3, or no more than chance.
const LIMIT: f64 = 1.5;
/// F statistic of the common parameters with the effective number of rows, from which chance is no explanation.
const SURE: f64 = 4.0;
/// Relative size of the last diagonal entries of R below which a column counts as dependent, as for the estimate.
const RANK_TOLERANCE: f64 = 1e-10;
/// Parameters that are named.
const NAMED: usize = 4;

/// A recording, reduced.
struct ReducedRecording<'a> {
    name: &'a str,
    held_back: bool,
    /// The rows without weights.
    regression: Regression,
    /// The triangle of `[X y]`, every joint's rows divided by what the fits one by one leave of it.
    triangle: Matrix,
    rows: f64,
    /// Rows that count as independent.
    effective: f64,
}

/// Residual of recordings that are fitted together.
struct CommonFit {
    squares: f64,
    rank: f64,
    /// Zero where a parameter depends on others.
    theta: Vec<f64>,
}

/// Fits together beside fits one by one.
struct FitComparison {
    /// Relative errors, percent of the torques.
    together: f64,
    apart: f64,
    /// How many times larger the first is, of the whole or joint by joint and per degree of freedom; zero where chance
    /// explains it.
    ratio: f64,
}

/// The finding, where there is one. Held-back recordings are compared with the others once those agree.
pub(super) fn check(companions: &[Companion<'_>]) -> Vec<Finding> {
    let all = reduced(companions);
    let (held_back, main): (Vec<&ReducedRecording<'_>>, Vec<&ReducedRecording<'_>>) =
        all.iter().partition(|r| r.held_back);
    let names = parameter_names(companions);
    if main.len() > 1 && compare(&main).ratio > LIMIT {
        return vec![finding(&main, &names)];
    }
    let beside_main = |other: &&ReducedRecording<'_>| {
        let both: Vec<&ReducedRecording<'_>> = main.iter().copied().chain([*other]).collect();
        (!main.is_empty() && compare(&both).ratio > LIMIT).then(|| of_held_back(&both, other, &names))
    };
    held_back.iter().filter_map(beside_main).collect()
}

/// The ratio of the main recordings, and of each that is held back beside them.
pub(super) fn measure(companions: &[Companion<'_>]) -> Vec<(Code, f64, f64)> {
    let all = reduced(companions);
    let main: Vec<&ReducedRecording<'_>> = all.iter().filter(|r| !r.held_back).collect();
    let beside = |other| main.iter().copied().chain([other]).collect::<Vec<_>>();
    let groups = std::iter::once(main.clone()).chain(all.iter().filter(|r| r.held_back).map(beside));
    let several = groups.filter(|g| g.len() > 1);
    several.map(|g| (Code::RecordingsContradict, compare(&g).ratio, LIMIT)).collect()
}

fn parameter_names(companions: &[Companion<'_>]) -> Vec<String> {
    let names = |subject: &Subject<'_>| subject.base.parameters().iter().map(|p| p.name.clone()).collect();
    companions.first().map(|c| names(&c.subject)).unwrap_or_default()
}

/// A recording's rows, and what its own fit leaves of each joint.
struct FittedRecording<'a> {
    name: &'a str,
    held_back: bool,
    regression: Regression,
    /// Squared residuals, joint by joint, N m or N.
    squares: Vec<f64>,
    /// Part of the rows that counts as independent.
    independent: f64,
}

fn reduced<'a>(companions: &[Companion<'a>]) -> Vec<ReducedRecording<'a>> {
    let all: Vec<FittedRecording<'a>> = companions.iter().filter_map(fitted).collect();
    if all.len() < 2 {
        return Vec::new();
    }
    let weights = joint_weights(&all);
    all.into_iter().map(|fitted| reduce(fitted, &weights)).collect()
}

fn fitted<'a>(companion: &Companion<'a>) -> Option<FittedRecording<'a>> {
    let recording = ThinnedRecording::new(&companion.subject, companion.subject.signal.cutoff_hz)?;
    if !recording.is_long_enough() {
        return None;
    }
    let (fit, regression) = (recording.fit().ok()?, recording.regression().ok()?);
    let joints = recording.coordinates();
    let neighbours = |j: usize| autocorrelation(recording.rows_of(&fit.residual, j));
    let alike = ((0..joints).map(neighbours).sum::<f64>() / joints as f64).clamp(0.0, 0.99);
    let prediction = regression.x.times(&fit.theta());
    let squares = regression.layout.squares(&regression.residual(&prediction));
    let independent = (1.0 - alike) / (1.0 + alike);
    Some(FittedRecording { name: companion.name, held_back: companion.held_back, regression, squares, independent })
}

/// One over the rms of what the fits one by one leave of each joint.
fn joint_weights(all: &[FittedRecording<'_>]) -> Vec<f64> {
    let joints = all.first().map_or(0, |f| f.squares.len());
    let rows: f64 = all.iter().map(|f| f.regression.y.len() as f64 / joints as f64).sum();
    let left = |j: usize| (all.iter().map(|f| f.squares[j]).sum::<f64>() / rows).sqrt();
    (0..joints).map(|j| Some(left(j)).filter(|s| *s > 0.0).map_or(1.0, f64::recip)).collect()
}

fn reduce<'a>(fitted: FittedRecording<'a>, weights: &[f64]) -> ReducedRecording<'a> {
    let FittedRecording { name, held_back, regression, independent, .. } = fitted;
    let weighted = regression.with_weights(Some(regression.layout.spread(|block| weights[block.joint])));
    let y = weighted.whiten(&weighted.y);
    let column = Matrix::from_fn(y.len(), 1, |i, _| y[i]);
    let triangle = Matrix::side_by_side(&[&weighted.whiten_matrix(&weighted.x), &column]).triangular_factor();
    let rows = y.len() as f64;
    ReducedRecording { name, held_back, regression, triangle, rows, effective: rows * independent }
}

/// The fit of recordings with common parameters.
fn common(recordings: &[&ReducedRecording<'_>]) -> CommonFit {
    let stacked = Matrix::stack(&recordings.iter().map(|r| &r.triangle).collect::<Vec<_>>());
    let columns = stacked.columns() - 1;
    let qr = PivotedQr::new(&stacked.select_columns(&(0..columns).collect::<Vec<_>>()));
    let independent = &qr.pivots()[..qr.rank(RANK_TOLERANCE)];
    let x = stacked.select_columns(independent);
    let solution = PivotedQr::new(&x).solve(stacked.column(columns));
    let mut theta = vec![0.0; columns];
    independent.iter().zip(&solution).for_each(|(&c, v)| theta[c] = *v);
    let residual = residual(&x, stacked.column(columns));
    CommonFit { squares: dot(&residual, &residual), rank: independent.len() as f64, theta }
}

/// Squared residual and squares of the torques, without weights.
fn unweighted(recordings: &[&ReducedRecording<'_>], theta: &[f64]) -> [f64; 2] {
    let of = |r: &&ReducedRecording<'_>| {
        let y = &r.regression.y;
        let rest: f64 = y.iter().zip(r.regression.x.times(theta)).map(|(y, p)| (y - p).powi(2)).sum();
        [rest, dot(y, y)]
    };
    recordings.iter().map(of).fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
}

fn residual(x: &Matrix, y: &[f64]) -> Vec<f64> {
    let fitted = x.times(&PivotedQr::new(x).solve(y));
    y.iter().zip(fitted).map(|(y, f)| y - f).collect()
}

fn compare(recordings: &[&ReducedRecording<'_>]) -> FitComparison {
    let together = common(recordings);
    let apart: Vec<CommonFit> = recordings.iter().map(|r| common(&[r])).collect();
    let (squares, rank) = (apart.iter().map(|c| c.squares).sum::<f64>(), apart.iter().map(|c| c.rank).sum::<f64>());
    let rows: f64 = recordings.iter().map(|r| r.rows).sum();
    let effective = recordings.iter().map(|r| r.effective).sum::<f64>();
    let freedom = |rows: f64, rank: f64| (rows - rank).max(1.0);
    let ratio = (together.squares / freedom(rows, together.rank)) / (squares / freedom(rows, rank));
    let f = (together.squares - squares) / freedom(rank, together.rank) / (squares / freedom(effective, rank));
    let ratio = ratio.max(0.0).sqrt();
    let percent = |[rest, all]: [f64; 2]| 100.0 * (rest / all.max(f64::MIN_POSITIVE)).sqrt();
    let parts = recordings.iter().zip(&apart).map(|(r, own)| unweighted(&[r], &own.theta));
    let whole = [
        percent(unweighted(recordings, &together.theta)),
        percent(parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])),
    ];
    let ratio = ratio.max(whole[0] / whole[1].max(f64::MIN_POSITIVE));
    FitComparison { together: whole[0], apart: whole[1], ratio: if f > SURE { ratio } else { 0.0 } }
}

/// Recordings that are left out one after the other, the one that disturbs most first, until the others agree.
fn outliers<'r, 'a>(recordings: &[&'r ReducedRecording<'a>]) -> Vec<&'r ReducedRecording<'a>> {
    let mut left: Vec<&ReducedRecording<'a>> = recordings.to_vec();
    let mut out = Vec::new();
    while left.len() > 2 && compare(&left).ratio > LIMIT {
        let without = |i: usize| -> f64 {
            let others: Vec<&ReducedRecording<'a>> =
                left.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, r)| *r).collect();
            common(&others).squares + common(&[left[i]]).squares
        };
        let Some(worst) = (0..left.len()).min_by(|a, b| without(*a).total_cmp(&without(*b))) else { break };
        out.push(left.remove(worst));
    }
    if compare(&left).ratio > LIMIT { recordings.to_vec() } else { out }
}

fn finding(main: &[&ReducedRecording<'_>], names: &[String]) -> Finding {
    let comparison = compare(main);
    let out = outliers(main);
    let list = |r: &[&ReducedRecording<'_>]| r.iter().map(|r| r.name).collect::<Vec<_>>().join(", ");
    let (who, apart) = if out.len() == main.len() {
        (format!("{} differ from one another", list(main)), main[main.len() - 1])
    } else {
        let others: Vec<&ReducedRecording<'_>> =
            main.iter().copied().filter(|r| !out.iter().any(|o| std::ptr::eq(*o, *r))).collect();
        let differ = if out.len() == 1 { "differs" } else { "differ" };
        (format!("{} {differ} from {}, which agree", list(&out), list(&others)), out[0])
    };
    build(&comparison, &who, &changed(main, apart, names), Severity::Problem)
}

fn of_held_back(both: &[&ReducedRecording<'_>], other: &ReducedRecording<'_>, names: &[String]) -> Finding {
    let who = format!("{}, which is held back, differs from the others", other.name);
    build(&compare(both), &who, &changed(both, other, names), Severity::Warning)
}

fn build(comparison: &FitComparison, who: &str, parameters: &[String], severity: Severity) -> Finding {
    let FitComparison { together, apart, ratio } = comparison;
    Finding {
        code: Code::RecordingsContradict,
        severity,
        joint: None,
        joint_name: None,
        value: *ratio,
        unit: "times the residual of fits one by one".to_owned(),
        limit: Some(LIMIT),
        message: format!(
            "the recordings contradict each other: one by one their fits leave {apart:.1} % of the torques, together \
             {together:.1} %; {who}, most in {}",
            parameters.join(" ")
        ),
        remedy: "look for another payload, tool, zero, drive or temperature in the recording that differs, and identify it in \
                 an experiment of its own"
            .to_owned(),
        parameters: parameters.to_vec(),
    }
}

/// The parameters whose own value in one of the recordings explains most of what the common fit leaves.
fn changed(all: &[&ReducedRecording<'_>], apart: &ReducedRecording<'_>, names: &[String]) -> Vec<String> {
    let stacked = Matrix::stack(&all.iter().map(|r| &r.triangle).collect::<Vec<_>>());
    let columns = stacked.columns() - 1;
    let x = stacked.select_columns(&(0..columns).collect::<Vec<_>>());
    let qr = PivotedQr::new(&x);
    let x = x.select_columns(&qr.pivots()[..qr.rank(RANK_TOLERANCE)]);
    let rest = residual(&x, stacked.column(columns));
    let mut own = Vec::new();
    for r in all {
        own.extend(std::iter::repeat_n(std::ptr::eq(*r, apart), r.triangle.rows()));
    }
    let explained = |c: usize| {
        let column: Vec<f64> = stacked.column(c).iter().zip(&own).map(|(v, own)| if *own { *v } else { 0.0 }).collect();
        let direction = residual(&x, &column);
        let size = dot(&direction, &direction);
        if size > f64::EPSILON * dot(&column, &column) { dot(&direction, &rest).powi(2) / size } else { 0.0 }
    };
    let mut order: Vec<(f64, usize)> = (0..columns).map(|c| (explained(c), c)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    order.iter().take(NAMED).map(|&(_, c)| names[c].clone()).collect()
}
