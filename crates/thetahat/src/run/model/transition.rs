//! The velocity at which friction changes its sign, between those that are tried first.
//!
//! They are a factor of three apart. One in between would leave the difference of two hyperbolic tangents in the torque of every joint,
//! which the other parameters of friction take up: a viscous friction was 42 % too large, with a narrow interval.

use super::{choice::Choice, law::Law, whitened::Whitened};
use thetahat_model::consistency::{Prior, fit_within};

/// Most steps, and the change of ln v below which none is made.
const STEPS: usize = 6;
const LEAST_STEP: f64 = 0.03;
/// Distance of ln v between neighbours beyond which the objective is no parabola: the middle is tried.
const WIDE: f64 = 0.7;
/// Part of the distance to a neighbour that a step keeps from it.
const CLEAR: f64 = 0.1;
/// Accuracy of the objectives that are compared.
const GAP: f64 = 1e-7;

/// A velocity v with the objective of its fit.
#[derive(Debug, Clone, Copy)]
struct Tried {
    ln_v: f64,
    objective: f64,
}

/// The search for the velocity with the least objective, by parabolas over ln v through the best and its neighbours.
pub(super) struct Refinement<'c> {
    choice: &'c Choice,
    tried: Vec<Tried>,
    steps: usize,
}

impl<'c> Refinement<'c> {
    /// Between the laws from which was chosen.
    pub(super) fn of<'a>(laws: impl Iterator<Item = Law<'a>>, choice: &'c Choice) -> Self {
        let mut refinement = Self { choice, tried: Vec::new(), steps: 0 };
        for law in laws {
            refinement.add(&law);
        }
        refinement
    }

    /// The velocity to try next, until the best is found; only a best between two others can be refined.
    pub(super) fn next(&mut self) -> Option<f64> {
        self.steps += 1;
        self.tried.sort_by(|a, b| a.ln_v.total_cmp(&b.ln_v));
        let ln_v = (self.steps <= STEPS).then(|| next(&self.tried)).flatten()?;
        Some(with_digits(ln_v.exp()))
    }

    /// Adds a law that was tried; returns whether it is the best until now.
    pub(super) fn add(&mut self, law: &Law) -> bool {
        let Some(objective) = self.objective(law) else { return false };
        let is_best = self.tried.iter().all(|other| objective < other.objective);
        self.tried.push(Tried { ln_v: law.transition.ln(), objective });
        is_best
    }

    fn objective(&self, law: &Law) -> Option<f64> {
        let data = Whitened::new(law.factors, &self.choice.deviations).all(law)?;
        let prior = Prior::Belief { weight: self.choice.weight };
        Some(fit_within(law.set, &data, prior, Some(&self.choice.standard), GAP).ok()?.objective)
    }
}

/// A number of three digits, as many as the steps decide: it does not depend on the rounding of fits.
fn with_digits(v: f64) -> f64 {
    format!("{v:.2e}").parse().unwrap_or(v)
}

/// The vertex of the parabola through the best and its neighbours, or the middle to a distant one; none if it is next to the best.
fn next(tried: &[Tried]) -> Option<f64> {
    let best = (0..tried.len()).min_by(|a, b| tried[*a].objective.total_cmp(&tried[*b].objective))?;
    let (before, after) = (tried.get(best.checked_sub(1)?)?, tried.get(best + 1)?);
    let (a, b, c) = (before.ln_v, tried[best].ln_v, after.ln_v);
    if (b - a).max(c - b) > WIDE {
        return Some(if b - a > c - b { 0.5 * (a + b) } else { 0.5 * (b + c) });
    }
    let (rise_before, rise_after) = (before.objective - tried[best].objective, after.objective - tried[best].objective);
    let (left, right) = ((b - a) * rise_after, (c - b) * rise_before);
    let step = 0.5 * ((c - b) * right - (b - a) * left) / (left + right);
    let ln_v = (b + step).clamp(a + CLEAR * (b - a), c - CLEAR * (c - b));
    (ln_v.is_finite() && (ln_v - b).abs() > LEAST_STEP).then_some(ln_v)
}

/// The weights with which the columns of some velocities sum to nearly those of one between them: Lagrange's polynomial in ln v. Between
/// 0.01 and 0.03 rad/s the sum is within 0.03 of the hyperbolic tangent, and within 0.008 rms up to 0.3 rad/s.
pub(super) fn weights_between(transitions: &[f64], transition: f64) -> Vec<f64> {
    let places: Vec<f64> = transitions.iter().map(|v| v.ln()).collect();
    let weight = |k: usize| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != k);
        others.map(|(_, place)| (transition.ln() - place) / (places[k] - place)).product()
    };
    (0..places.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::{Tried, next, weights_between};

    #[test]
    fn columns_between_two_velocities_are_nearly_sums_of_those_of_all() {
        let transitions = [0.03, 0.001, 0.003, 0.01, 0.1];
        assert_eq!(weights_between(&transitions, 0.01), [0.0, 0.0, 0.0, 1.0, 0.0]);
        let weights = weights_between(&transitions, 0.02);
        let error = |dq: f64| {
            let sum: f64 = transitions.iter().zip(&weights).map(|(v, weight)| weight * (dq / v).tanh()).sum();
            (sum - (dq / 0.02).tanh()).abs()
        };
        let worst = (0..3000).map(|k| error(1e-4 * f64::from(k))).fold(0.0, f64::max);
        assert!(worst < 0.03, "{worst}");
    }

    #[test]
    fn a_step_leads_to_the_vertex_of_a_parabola() {
        let tried = |ln_v: f64| Tried { ln_v, objective: 3.0 + 2.0 * (ln_v + 3.9).powi(2) };
        let found = next(&[tried(-4.3), tried(-3.8), tried(-3.2)]).unwrap();
        assert!((found + 3.9).abs() < 1e-12, "{found}");
        assert!(next(&[tried(-4.3), tried(-3.9), tried(-3.3)]).is_none());
        assert!(next(&[tried(-3.8), tried(-3.3)]).is_none());
    }

    #[test]
    fn between_distant_neighbours_the_middle_is_tried() {
        let tried = |ln_v: f64, objective: f64| Tried { ln_v, objective };
        let (before, best, after) = (tried(-5.8, 2839.0), tried(-4.6, 1267.0), tried(-3.5, 2453.0));
        assert!((next(&[before, best, after]).unwrap() + 5.2).abs() < 1e-12);
        assert!((next(&[tried(-5.2, 2000.0), best, after]).unwrap() + 4.05).abs() < 1e-12);
    }
}
