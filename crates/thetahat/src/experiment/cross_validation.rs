//! How well estimates predict what they have not seen.

use super::chain::Problem;
use crate::{
    identification::{Divisor, EstimationError, Method, didim, idim_iv, idim_ls, relative_error_percent},
    linear_algebra::Matrix,
    trajectory::Moves,
};

/// Fewest moves of which one can be left out.
const FEWEST_MOVES: usize = 3;
/// Fewest recordings of which one can be left out: the others must identify all parameters.
const FEWEST_RECORDINGS: usize = 2;

/// Parts of a record that is left out in pieces, where it has no moves that are known.
const PARTS: usize = 5;

/// The part, of five equal ones, to which each decimated row of a joint belongs.
pub(super) fn folds_by_part(rows: usize) -> Vec<usize> {
    (0..rows).map(|k| k * PARTS / rows.max(1)).collect()
}

/// The recording, from zero, to which each decimated row of a joint belongs.
pub(super) fn folds_by_recording(recordings: Vec<usize>) -> Option<Vec<usize>> {
    let count = recordings.iter().max().map_or(0, |last| last + 1);
    (count >= FEWEST_RECORDINGS).then_some(recordings)
}

/// The move, from zero, to which each decimated row of a joint belongs: the last one that has started.
pub(super) fn folds_by_move(moves: &Moves, times: &[f64]) -> Option<Vec<usize>> {
    let starts: Vec<f64> = moves.moves().iter().map(|m| m.law.start_s).collect();
    let fold = |t: &f64| starts.iter().filter(|s| **s <= *t).count().saturating_sub(1);
    (starts.len() >= FEWEST_MOVES).then(|| times.iter().map(fold).collect())
}

/// Leaves each fold out in turn, estimates from the others with the instruments at hand, and predicts the one left out;
/// the relative error is that of all predictions together.
pub(super) fn leave_folds_out(
    problem: &Problem,
    method: Method,
    instruments: Option<&Matrix>,
    weights: Option<&[f64]>,
    folds: &[usize],
) -> Option<f64> {
    let rows = problem.y.len();
    let fold_of_row = |k: usize| folds[k % folds.len()];
    let count = folds.iter().max()? + 1;
    let mut prediction = vec![0.0; rows];
    for fold in 0..count {
        let keep: Vec<bool> = (0..rows).map(|k| fold_of_row(k) != fold).collect();
        let theta = estimate_rows(problem, method, instruments, weights, &keep).ok()?;
        let predicting = if method == Method::Didim { instruments? } else { &problem.x };
        let all = predicting.times(&theta);
        (0..rows).filter(|&k| !keep[k]).for_each(|k| prediction[k] = all[k]);
    }
    Some(relative_error_percent(&problem.y, &prediction))
}

fn estimate_rows(
    problem: &Problem,
    method: Method,
    instruments: Option<&Matrix>,
    weights: Option<&[f64]>,
    keep: &[bool],
) -> Result<Vec<f64>, EstimationError> {
    let select = |v: &[f64]| v.iter().zip(keep).filter(|(_, k)| **k).map(|(v, _)| *v).collect::<Vec<f64>>();
    let (x, y) = (problem.x.select_rows(keep), select(&problem.y));
    let z = instruments.map(|z| z.select_rows(keep));
    let weights = weights.map(select);
    let (weights, divisor) = (weights.as_deref(), Divisor::default());
    let fit = match (method, &z) {
        (Method::IdimIv, Some(z)) => idim_iv(z, &x, &y, weights, divisor),
        (Method::Didim, Some(z)) => didim(z, &y, weights, divisor),
        _ => idim_ls(&x, &y, weights, divisor),
    };
    fit.map(|f| f.theta)
}
