//! The velocity at which friction changes its sign, between those that are tried first.
//!
//! They are a factor of three apart. One in between would leave the difference of two hyperbolic tangents in the torque of every joint,
//! which the other parameters of friction take up: a viscous friction was 42 % too large, with a narrow interval.

use super::{choice::Choice, law::Law, whitened::Whitened};
use thetahat_model::{
    consistency::{Prior, fit_within},
    dynamics::FrictionTransition,
};

/// Most steps between neighbours.
const STEPS: usize = 8;
/// The change of ln v below which a step is made only for a gain, in long-run variances of the residual, and that below which none is made.
const LEAST_STEP: f64 = 0.03;
const LEAST_GAIN: f64 = 1.0;
const FINEST_STEP: f64 = 0.005;
/// Distance of ln v between neighbours beyond which the objective is no parabola: the middle is tried.
const WIDE: f64 = 0.7;
/// Distance of ln v at which a neighbour is tried where there is none.
const APART: f64 = 0.6;
/// Part of the distance to a neighbour that a step keeps from it.
const CLEAR: f64 = 0.1;
/// Accuracy of the objectives that are compared.
const GAP: f64 = 1e-7;

/// The velocity that is searched, while the other stays.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Searched {
    /// Both in proportion.
    All,
    Turning,
    Sliding,
}

impl Searched {
    fn of(self, transition: FrictionTransition) -> f64 {
        match self {
            Self::All | Self::Turning => transition.turning,
            Self::Sliding => transition.sliding,
        }
    }

    /// The transition with another velocity `v`.
    fn with(self, transition: FrictionTransition, v: f64) -> FrictionTransition {
        let FrictionTransition { turning, sliding } = transition;
        match self {
            Self::All if turning == sliding => FrictionTransition::of_all(v),
            Self::All => FrictionTransition { turning: v, sliding: with_digits(v * sliding / turning) },
            Self::Turning => FrictionTransition { turning: v, sliding },
            Self::Sliding => FrictionTransition { turning, sliding: v },
        }
    }
}

/// A velocity v with the objective of its fit, which is infinite if there is none.
#[derive(Debug, Clone, Copy)]
struct Tried {
    transition: FrictionTransition,
    ln_v: f64,
    objective: f64,
}

/// The search for the velocity with the least objective, by parabolas over ln v through the best and its neighbours: where some joints turn
/// and others slide, first for both in proportion, then for each.
pub(super) struct Refinement<'c> {
    choice: &'c Choice,
    searched: Searched,
    /// What is searched after it, the last first.
    after: Vec<Searched>,
    /// Where a neighbour is tried if there is none.
    limits: [FrictionTransition; 2],
    tried: Vec<Tried>,
    steps: usize,
}

impl<'c> Refinement<'c> {
    /// Between the laws from which was chosen; one alone is stated.
    pub(super) fn of<'a>(laws: impl Iterator<Item = Law<'a>> + Clone, choice: &'c Choice) -> Self {
        let is_stated = laws.clone().nth(1).is_none();
        let has_both = laws.clone().any(|law| law.transition.sliding_apart().is_some());
        let after = if has_both && !is_stated { vec![Searched::Turning, Searched::Sliding] } else { Vec::new() };
        let limit = |better: fn(f64, f64) -> f64| FrictionTransition {
            turning: laws.clone().map(|law| law.transition.turning).reduce(better).unwrap_or(f64::NAN),
            sliding: laws.clone().map(|law| law.transition.sliding).reduce(better).unwrap_or(f64::NAN),
        };
        let limits = [limit(f64::min), limit(f64::max)];
        let mut refinement = Self { choice, searched: Searched::All, after, limits, tried: Vec::new(), steps: 0 };
        for law in laws {
            refinement.add(&law);
        }
        refinement
    }

    /// The same up to these velocities, where columns of any can be made.
    pub(super) fn up_to(self, most: FrictionTransition) -> Self {
        Self { limits: [self.limits[0], most], ..self }
    }

    /// The velocities to try next, until the best are found.
    pub(super) fn next(&mut self) -> Option<FrictionTransition> {
        loop {
            let best = self.best()?;
            if let Some(ln_v) = self.next_place() {
                return Some(self.searched.with(best.transition, with_digits(ln_v.exp())));
            }
            self.searched = self.after.pop()?;
            self.tried = vec![Tried { ln_v: self.searched.of(best.transition).ln(), ..best }];
            self.steps = 0;
        }
    }

    fn best(&self) -> Option<Tried> {
        best_of(&self.tried).map(|best| self.tried[best])
    }

    /// Of those that were tried first, only a best between two others is refined.
    fn next_place(&mut self) -> Option<f64> {
        self.tried.sort_by(|a, b| a.ln_v.total_cmp(&b.ln_v));
        let missing = match self.searched {
            Searched::All => None,
            Searched::Turning | Searched::Sliding => {
                missing_neighbour(&self.tried, self.limits.map(|limit| self.searched.of(limit).ln()))
            }
        };
        missing.or_else(|| {
            self.steps += 1;
            (self.steps <= STEPS).then(|| next(&self.tried)).flatten()
        })
    }

    /// Adds a law that was tried; returns whether it is the best until now.
    pub(super) fn add(&mut self, law: &Law) -> bool {
        let objective = self.objective(law).unwrap_or(f64::INFINITY);
        let is_best = objective.is_finite() && self.tried.iter().all(|other| objective < other.objective);
        let transition = law.transition;
        self.tried.push(Tried { transition, ln_v: self.searched.of(transition).ln(), objective });
        is_best
    }

    fn objective(&self, law: &Law) -> Option<f64> {
        let data = Whitened::new(law.factors, &self.choice.deviations).all(law)?;
        let prior = Prior::Belief { weight: self.choice.weight };
        Some(fit_within(law.set, &data, prior, Some(&self.choice.standard), GAP).ok()?.objective)
    }
}

/// The place of the least objective.
fn best_of(tried: &[Tried]) -> Option<usize> {
    (0..tried.len()).min_by(|a, b| tried[*a].objective.total_cmp(&tried[*b].objective))
}

/// A place within the limits on the side of the best where there is no neighbour.
fn missing_neighbour(tried: &[Tried], [least, most]: [f64; 2]) -> Option<f64> {
    let best = best_of(tried)?;
    let ln_v = tried[best].ln_v;
    if best == 0 && ln_v > least + LEAST_STEP {
        return Some((ln_v - APART).max(least));
    }
    (best + 1 == tried.len() && ln_v < most - LEAST_STEP).then(|| (ln_v + APART).min(most))
}

/// A number of three digits, as many as the steps decide: it does not depend on the rounding of fits.
fn with_digits(v: f64) -> f64 {
    format!("{v:.2e}").parse().unwrap_or(v)
}

/// The vertex of the parabola through the best and its neighbours, or the middle to a distant one; none if it is next to the best.
fn next(tried: &[Tried]) -> Option<f64> {
    let best = best_of(tried)?;
    let (before, after) = (tried.get(best.checked_sub(1)?)?, tried.get(best + 1)?);
    let (a, b, c) = (before.ln_v, tried[best].ln_v, after.ln_v);
    if (b - a).max(c - b) > WIDE {
        return Some(if b - a > c - b { 0.5 * (a + b) } else { 0.5 * (b + c) });
    }
    let (rise_before, rise_after) = (before.objective - tried[best].objective, after.objective - tried[best].objective);
    let (left, right) = ((b - a) * rise_after, (c - b) * rise_before);
    let step = 0.5 * ((c - b) * right - (b - a) * left) / (left + right);
    let ln_v = (b + step).clamp(a + CLEAR * (b - a), c - CLEAR * (c - b));
    let change = (ln_v - b).abs();
    let gain = (left + right) / ((b - a) * (c - b) * (c - a)) * change.powi(2);
    (change > LEAST_STEP || (change > FINEST_STEP && gain > LEAST_GAIN)).then_some(ln_v)
}

#[cfg(test)]
mod tests {
    use super::{FrictionTransition, Tried, missing_neighbour, next};

    fn at(ln_v: f64, objective: f64) -> Tried {
        Tried { transition: FrictionTransition::of_all(ln_v.exp()), ln_v, objective }
    }

    #[test]
    fn a_neighbour_is_tried_within_the_limits_where_there_is_none() {
        let limits = [-7.0, -2.0];
        assert_eq!(missing_neighbour(&[at(-4.0, 1.0)], limits), Some(-4.6));
        assert_eq!(missing_neighbour(&[at(-4.5, 2.0), at(-4.0, 1.0)], limits), Some(-3.4));
        assert_eq!(missing_neighbour(&[at(-3.0, 2.0), at(-2.5, 1.0)], limits), Some(-2.0));
        assert_eq!(missing_neighbour(&[at(-2.5, 2.0), at(-2.0, 1.0)], limits), None);
        assert_eq!(missing_neighbour(&[at(-4.5, 2.0), at(-4.0, 1.0), at(-3.5, 3.0)], limits), None);
    }

    #[test]
    fn a_step_leads_to_the_vertex_of_a_parabola() {
        let tried = |ln_v: f64| at(ln_v, 3.0 + 2.0 * (ln_v + 3.9).powi(2));
        let found = next(&[tried(-4.3), tried(-3.8), tried(-3.2)]).unwrap();
        assert!((found + 3.9).abs() < 1e-12, "{found}");
        assert!(next(&[tried(-4.3), tried(-3.9), tried(-3.3)]).is_none());
        assert!(next(&[tried(-3.8), tried(-3.3)]).is_none());
    }

    #[test]
    fn between_distant_neighbours_the_middle_is_tried() {
        let (before, best, after) = (at(-5.8, 2839.0), at(-4.6, 1267.0), at(-3.5, 2453.0));
        assert!((next(&[before, best, after]).unwrap() + 5.2).abs() < 1e-12);
        assert!((next(&[at(-5.2, 2000.0), best, after]).unwrap() + 4.05).abs() < 1e-12);
    }
}
