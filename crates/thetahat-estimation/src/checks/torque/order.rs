//! Joints whose channels are in another order than those of the robot, more than two of them.
//!
//! Of six joints there are 720 orders. Each exchange of two joints towards the right one explains more, as a rule, so that the best
//! exchange is made again and again, from the order of the log and from its reverse.

use super::{hypotheses::Hypothesis, screening::Screening};
use crate::checks::{
    fit::{affine::Affine, thinned_recording::ThinnedRecording},
    remedy_step::RemedySignal,
};

/// Part of the torques' square above which the order is doubted.
const POOR: f64 = 0.01;
/// Operations of the search up to which it is made: those of eight joints take a few seconds.
const MOST_WORK: f64 = 8e9;
/// Factor by which an exchange must reduce the squared residual.
const PROGRESS: f64 = 1.02;

/// Another order of torques, or of positions and torques, that explains much more; looked for where the torques are explained poorly.
pub(super) fn other_order(recording: &ThinnedRecording<'_>, screening: &Screening) -> Option<Hypothesis> {
    let n = recording.coordinates();
    let exchanges = n * n.saturating_sub(1) / 2;
    if n < 3 || (4 * n * exchanges) as f64 * Screening::work(recording) > MOST_WORK {
        return None;
    }
    let stated = screening.squares(recording, &Affine::identity(n))?;
    if stated < POOR * screening.squares_of_none() {
        return None;
    }
    let log: Vec<usize> = (0..n).collect();
    let reverse: Vec<usize> = (0..n).rev().collect();
    let searches = [RemedySignal::Both, RemedySignal::Torque].map(|signal| [(signal, &log), (signal, &reverse)]);
    let found = searches.as_flattened().iter().filter_map(|(signal, start)| {
        let (order, squares) =
            best_order(start, |order| screening.squares(recording, &Affine::ordered(order, *signal)))?;
        Some((*signal, order, squares))
    });
    let (signal, order, _) = found.min_by(|a, b| a.2.total_cmp(&b.2))?;
    let moved = (0..n).filter(|&j| order[j] != j).count();
    (moved > 2).then(|| Hypothesis::of_order(recording.subject.robot, &order, signal))
}

/// The order that no exchange of two makes better, with its squared residual.
fn best_order(start: &[usize], squares: impl Fn(&[usize]) -> Option<f64>) -> Option<(Vec<usize>, f64)> {
    let mut best = (start.to_vec(), squares(start)?);
    loop {
        let n = start.len();
        let exchanged = |a: usize, b: usize| {
            let mut order = best.0.clone();
            order.swap(a, b);
            let squares = squares(&order)?;
            Some((order, squares))
        };
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
        let next = pairs.filter_map(|(a, b)| exchanged(a, b)).min_by(|a, b| a.1.total_cmp(&b.1));
        match next {
            Some(next) if PROGRESS * next.1 < best.1 => best = next,
            Some(_) | None => return Some(best),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each joint at its place reduces what is left: a cycle of four is undone.
    #[test]
    fn a_cycle_is_undone_by_exchanges() {
        let right = [1, 2, 3, 0, 4];
        let misplaced = |order: &[usize]| order.iter().zip(right).filter(|(a, b)| **a != *b).count() as f64;
        let (order, squares) = best_order(&[0, 1, 2, 3, 4], |order| Some(1e-3 + misplaced(order))).unwrap();
        assert_eq!((order.as_slice(), squares), (&right[..], 1e-3));
    }

    #[test]
    fn an_order_that_cannot_be_fitted_is_none() {
        assert!(best_order(&[0, 1, 2], |_| None).is_none());
    }
}
