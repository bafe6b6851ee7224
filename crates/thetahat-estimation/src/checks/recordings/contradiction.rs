//! Recordings that separate fits explain but a common fit does not: another payload, other zeros, another robot.
//!
//! Each recording is reduced to the triangular factor of `[X y]`, so that a common fit has few rows. The residual of the
//! common fit is compared with that of the separate fits, each per degree of freedom. Each joint is scaled by its residual in
//! the separate fits, and the autocorrelation of the residuals reduces the number of rows that count as independent.

use super::companion::Companion;
use crate::{
    checks::{
        finding::{Code, Finding, Measure, Severity},
        fit::thinned_recording::ThinnedRecording,
        numbers::autocorrelation,
        subject::Subject,
    },
    regression::Regression,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot};

/// Largest ratio of the residual of the common fit to that of the separate fits. Clean: the two recordings of the KUKA 1.35,
/// halves of recordings and the two of EMPS less than 1.3, or not significant.
const LIMIT: f64 = 1.5;
/// F statistic of the common parameters, with the effective number of rows, above which a contradiction is significant.
const SIGNIFICANT: f64 = 4.0;
/// Relative size of the last diagonal entries of R below which a column counts as dependent, as for the estimate.
const RANK_TOLERANCE: f64 = 1e-10;
/// Most parameters that a finding names.
const NAMED: usize = 4;

/// A recording, reduced to a triangular factor.
struct ReducedRecording<'a> {
    name: &'a str,
    held_back: bool,
    /// The rows without weights.
    regression: Regression,
    /// The triangular factor of `[X y]`, each joint's rows divided by its residual in the separate fits.
    triangle: Matrix,
    rows: f64,
    /// Effective number of independent rows.
    effective: f64,
}

/// The fit of several recordings with common parameters.
struct CommonFit {
    squares: f64,
    rank: f64,
    /// Zero for a parameter that depends on others.
    theta: Vec<f64>,
}

/// The common fit compared with separate fits.
struct FitComparison {
    /// Relative errors, percent of the torques.
    common: f64,
    separate: f64,
    /// How many times larger the first is, in all or joint by joint and per degree of freedom; zero if the difference is not
    /// significant.
    ratio: f64,
}

/// The findings. Held-back recordings are compared with the others only if those agree.
pub(in crate::checks) fn check(companions: &[Companion<'_>]) -> Vec<Finding> {
    let all = reduced(companions);
    let (held_back, main): (Vec<&ReducedRecording<'_>>, Vec<&ReducedRecording<'_>>) =
        all.iter().partition(|r| r.held_back);
    let names = parameter_names(companions);
    if main.len() > 1 && compare(&main).ratio > LIMIT {
        return vec![finding(&main, &names)];
    }
    let against_main = |other: &&ReducedRecording<'_>| {
        let both: Vec<&ReducedRecording<'_>> = main.iter().copied().chain([*other]).collect();
        (!main.is_empty() && compare(&both).ratio > LIMIT).then(|| held_back_finding(&both, other, &names))
    };
    held_back.iter().filter_map(against_main).collect()
}

/// The ratio of the main recordings, and of each held-back recording added to them.
pub(in crate::checks) fn measure(companions: &[Companion<'_>]) -> Vec<Measure> {
    let all = reduced(companions);
    let main: Vec<&ReducedRecording<'_>> = all.iter().filter(|r| !r.held_back).collect();
    let with_main = |other| main.iter().copied().chain([other]).collect::<Vec<_>>();
    let groups = std::iter::once(main.clone()).chain(all.iter().filter(|r| r.held_back).map(with_main));
    let several = groups.filter(|g| g.len() > 1);
    several.map(|g| measure_of(compare(&g).ratio)).collect()
}

fn measure_of(value: f64) -> Measure {
    Measure { code: Code::RecordingsContradict, joint: None, value, limit: LIMIT }
}

fn parameter_names(companions: &[Companion<'_>]) -> Vec<String> {
    let names = |subject: &Subject<'_>| subject.base.parameters().iter().map(|p| p.name.clone()).collect();
    companions.first().map(|c| names(&c.subject)).unwrap_or_default()
}

/// A recording's rows, and the residual of its own fit.
struct FittedRecording<'a> {
    name: &'a str,
    held_back: bool,
    regression: Regression,
    /// Squared residuals, joint by joint, N m or N.
    squares: Vec<f64>,
    /// Part of the rows that count as independent.
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
    let correlation = ((0..joints).map(neighbours).sum::<f64>() / joints as f64).clamp(0.0, 0.99);
    let prediction = regression.x.times(&fit.theta());
    let squares = regression.layout.squares(&regression.residual(&prediction));
    let independent = (1.0 - correlation) / (1.0 + correlation);
    Some(FittedRecording { name: companion.name, held_back: companion.held_back, regression, squares, independent })
}

/// One over the rms residual of each joint in the separate fits.
fn joint_weights(all: &[FittedRecording<'_>]) -> Vec<f64> {
    let joints = all.first().map_or(0, |f| f.squares.len());
    let rows: f64 = all.iter().map(|f| f.regression.y.len() as f64 / joints as f64).sum();
    let residual = |j: usize| (all.iter().map(|f| f.squares[j]).sum::<f64>() / rows).sqrt();
    (0..joints).map(|j| Some(residual(j)).filter(|s| *s > 0.0).map_or(1.0, f64::recip)).collect()
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

/// Sums of squares, without weights.
struct Squares {
    residual: f64,
    torque: f64,
}

impl Squares {
    fn new(recording: &ReducedRecording<'_>, theta: &[f64]) -> Self {
        let y = &recording.regression.y;
        let residual = y.iter().zip(recording.regression.x.times(theta)).map(|(y, p)| (y - p).powi(2)).sum();
        Self { residual, torque: dot(y, y) }
    }

    fn sum(parts: impl Iterator<Item = Self>) -> Self {
        let zero = Self { residual: 0.0, torque: 0.0 };
        parts.fold(zero, |sum, p| Self { residual: sum.residual + p.residual, torque: sum.torque + p.torque })
    }

    /// Relative error, percent.
    fn percent(&self) -> f64 {
        100.0 * (self.residual / self.torque.max(f64::MIN_POSITIVE)).sqrt()
    }
}

fn residual(x: &Matrix, y: &[f64]) -> Vec<f64> {
    let fitted = x.times(&PivotedQr::new(x).solve(y));
    y.iter().zip(fitted).map(|(y, f)| y - f).collect()
}

fn compare(recordings: &[&ReducedRecording<'_>]) -> FitComparison {
    let joined = common(recordings);
    let separate_fits: Vec<CommonFit> = recordings.iter().map(|r| common(&[r])).collect();
    let (squares, rank) =
        (separate_fits.iter().map(|c| c.squares).sum::<f64>(), separate_fits.iter().map(|c| c.rank).sum::<f64>());
    let rows: f64 = recordings.iter().map(|r| r.rows).sum();
    let effective = recordings.iter().map(|r| r.effective).sum::<f64>();
    let freedom = |rows: f64, rank: f64| (rows - rank).max(1.0);
    let ratio = (joined.squares / freedom(rows, joined.rank)) / (squares / freedom(rows, rank));
    let f = (joined.squares - squares) / freedom(rank, joined.rank) / (squares / freedom(effective, rank));
    let ratio = ratio.max(0.0).sqrt();
    let of_common = recordings.iter().map(|r| Squares::new(r, &joined.theta));
    let of_separate = recordings.iter().zip(&separate_fits).map(|(r, own)| Squares::new(r, &own.theta));
    let (common, separate) = (Squares::sum(of_common).percent(), Squares::sum(of_separate).percent());
    let ratio = ratio.max(common / separate.max(f64::MIN_POSITIVE));
    FitComparison { common, separate, ratio: if f > SIGNIFICANT { ratio } else { 0.0 } }
}

/// Leaves out recordings one by one, the most contradictory first, until the others agree; all recordings if they never do.
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
    let (who, different) = if out.len() == main.len() {
        (format!("{} differ from one another", list(main)), main[main.len() - 1])
    } else {
        let others: Vec<&ReducedRecording<'_>> =
            main.iter().copied().filter(|r| !out.iter().any(|o| std::ptr::eq(*o, *r))).collect();
        let differ = if out.len() == 1 { "differs" } else { "differ" };
        (format!("{} {differ} from {}, which agree", list(&out), list(&others)), out[0])
    };
    build(&comparison, &who, &changed(main, different, names), Severity::Problem)
}

fn held_back_finding(both: &[&ReducedRecording<'_>], other: &ReducedRecording<'_>, names: &[String]) -> Finding {
    let who = format!("{}, which is held back, differs from the others", other.name);
    build(&compare(both), &who, &changed(both, other, names), Severity::Warning)
}

fn build(comparison: &FitComparison, who: &str, parameters: &[String], severity: Severity) -> Finding {
    let FitComparison { common, separate, ratio } = comparison;
    Finding {
        code: Code::RecordingsContradict,
        severity,
        joint: None,
        joint_name: None,
        value: *ratio,
        unit: "times the residual of separate fits".to_owned(),
        limit: Some(LIMIT),
        message: format!(
            "the recordings contradict each other: separate fits leave {separate:.1} % of the torques, a common fit \
             {common:.1} %; {who}, mainly in {}",
            parameters.join(" ")
        ),
        remedy: "check the payload, tool, zeros, drives and temperature of the recording that differs, and identify it in an \
                 experiment of its own"
            .to_owned(),
        parameters: parameters.to_vec(),
        step: None,
    }
}

/// The parameters whose separate value in one of the recordings explains most of the residual of the common fit.
fn changed(all: &[&ReducedRecording<'_>], different: &ReducedRecording<'_>, names: &[String]) -> Vec<String> {
    let stacked = Matrix::stack(&all.iter().map(|r| &r.triangle).collect::<Vec<_>>());
    let columns = stacked.columns() - 1;
    let x = stacked.select_columns(&(0..columns).collect::<Vec<_>>());
    let qr = PivotedQr::new(&x);
    let x = x.select_columns(&qr.pivots()[..qr.rank(RANK_TOLERANCE)]);
    let rest = residual(&x, stacked.column(columns));
    let mut own = Vec::new();
    for r in all {
        own.extend(std::iter::repeat_n(std::ptr::eq(*r, different), r.triangle.rows()));
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
