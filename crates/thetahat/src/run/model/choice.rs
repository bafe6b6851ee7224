//! The choice of the belief's weight and of the friction's transition by what is left out.

use std::collections::HashMap;

use super::{
    deviations::{mean, mean_and_error, weighted},
    errors::SquaredErrors,
    folds::ModelFolds,
    law::Law,
    rows::ModelRows,
    whitened::Whitened,
};
use thetahat_estimation::statistics::repeated_widening;
use thetahat_ground::pool::in_parallel;
use thetahat_model::{
    consistency::{LeastSquares, Prior, fit_within},
    robot::JointKind,
};
use thetahat_report::results::{ModelCandidate, ModelError, kinds_of};

/// Standard errors of the mean difference by which a challenger must be better.
const STANDARD_ERRORS: f64 = 2.0;
/// The same for the velocity at which the friction changes its sign, a number that the rows determine as they do the friction: with two,
/// 2 of 16 simulated arms whose joints move one after the other kept one that is three times too large, and missed an ordinary
/// motion by 4 instead of 0.4 %; without any, the halves of recorded robots decide by chance.
const OF_TRANSITIONS: f64 = 1.0;
/// Part of the squared error that a torque term must take. On a clean arm one has taken 0.04, which is what filters leave; those of
/// recorded robots and of twins whose friction has the term took 0.15 and more.
const GAIN_OF_TERM: f64 = 0.1;
/// Fewest parts left out with which a challenger can replace the default.
const FEWEST_FOLDS: usize = 4;
/// Accuracy of fits that are compared, and of the one that is kept.
const GAPS: [f64; 2] = [1e-7, 1e-10];
/// Rounds in which the deviations of the joints settle.
const ROUNDS: usize = 4;
/// First deviation of a joint's residual, relative to its torque.
const FIRST_DEVIATION: f64 = 0.02;
/// Least deviation relative to the torque: simulated recordings without noise have none.
const LEAST_DEVIATION: f64 = 1e-6;
/// The weight at which the deviations are measured: next to free estimates.
const NEXT_TO_FREE: f64 = 1e-3;

/// What is chosen from.
pub(super) struct Choosing<'a> {
    pub(super) laws: &'a [Law<'a>],
    pub(super) weights: &'a [f64],
    pub(super) folds: ModelFolds,
    /// Whether each joint turns or slides.
    pub(super) kinds: &'a [JointKind],
}

/// What was chosen.
pub(super) struct Choice {
    pub(super) law: usize,
    pub(super) weight: f64,
    pub(super) standard: Vec<f64>,
    /// The long-run deviation of each joint's residual.
    pub(super) deviations: Vec<f64>,
    /// The rows of unit variance.
    pub(super) data: LeastSquares,
    pub(super) candidates: Vec<ModelCandidate>,
    /// The error of rows that neither fit nor choice has seen.
    pub(super) unseen: Option<ModelError>,
    pub(super) found: SearchedLaws,
}

/// What was computed on the way; it holds for the same laws with others after them.
#[derive(Default)]
pub(super) struct SearchedLaws {
    /// The long-run deviations of each law's residual, joint by joint.
    deviations: Vec<Vec<f64>>,
    /// Base parameters; none if a fit has no result.
    fitted: HashMap<Fitted, Option<Vec<f64>>>,
}

/// A candidate: indices of its law and weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Candidate {
    law: usize,
    weight: usize,
}

const DEFAULT: Candidate = Candidate { law: 0, weight: 0 };
/// Power of the joints' deviations by which the rows that are fitted are divided: at one the joints weigh alike, at zero newton
/// metres do. Errors of the model are not noise: weights by the deviation alone let a joint of small torques and a bad
/// friction law decide on the bodies that it carries.
const POWER: f64 = 0.5;

impl Choosing<'_> {
    /// The best law and weight; `found` is of the same laws without the last ones.
    pub(super) fn choose(&self, threads: usize, found: SearchedLaws) -> Option<Choice> {
        let SearchedLaws { mut deviations, fitted } = found;
        let first = deviations.len();
        let of_others = in_parallel(self.laws.len() - first, threads, |k| self.deviations(&self.laws[first + k]));
        deviations.extend(of_others.into_iter().collect::<Option<Vec<_>>>()?);
        let of_law = |(law, own): (&Law, &Vec<f64>)| Whitened::new(law.factors, &weighted(own, self.kinds, POWER));
        let whitened: Vec<Whitened> = self.laws.iter().zip(&deviations).map(of_law).collect();
        let compared = &deviations[DEFAULT.law];
        let mut search = Search { choosing: self, whitened: &whitened, compared, threads, fitted };
        let (chosen, candidates) = search.chosen(None);
        let unseen = search.unseen();
        let found = SearchedLaws { fitted: search.fitted, deviations: deviations.clone() };
        let law = &self.laws[chosen.law];
        let fitted = whitened[chosen.law].all(law)?;
        let standard = fit_within(law.set, &fitted, self.prior(chosen), None, GAPS[1]).ok()?.standard;
        Some(Choice {
            law: chosen.law,
            weight: self.weights[chosen.weight],
            standard,
            deviations: deviations[chosen.law].clone(),
            data: self.of_unit_variance(law, &deviations[chosen.law])?,
            candidates,
            unseen,
            found,
        })
    }

    fn prior(&self, candidate: Candidate) -> Prior {
        Prior::Belief { weight: self.weights[candidate.weight] }
    }

    /// The rows of a law, each joint divided by its deviation.
    fn of_unit_variance(&self, law: &Law, deviations: &[f64]) -> Option<LeastSquares> {
        Whitened::new(law.factors, deviations).all(law)
    }

    /// The long-run deviation of each joint's residual, next to free estimates; along a motion that repeats, with errors that do, where
    /// the rows are in the order of time.
    fn deviations(&self, law: &Law) -> Option<Vec<f64>> {
        let rows = law.factors;
        let torque = rows.rms(&vec![0.0; rows.parameters]);
        let largest = torque.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let least: Vec<f64> = torque.iter().map(|t| LEAST_DEVIATION * t.max(LEAST_DEVIATION * largest)).collect();
        let at_least =
            |found: Vec<f64>| -> Vec<f64> { found.iter().zip(&least).map(|(own, least)| own.max(*least)).collect() };
        let mut deviations = at_least(torque.iter().map(|t| FIRST_DEVIATION * t).collect());
        let mut start: Option<Vec<f64>> = None;
        for round in 0..ROUNDS {
            let data = Whitened::new(rows, &deviations).all(law)?;
            let prior = Prior::Belief { weight: NEXT_TO_FREE };
            let fit = fit_within(law.set, &data, prior, start.as_deref(), GAPS[0]).ok()?;
            let theta = law.base.from_standard(&fit.standard);
            let last = round + 1 == ROUNDS;
            deviations = at_least(if last { long_run_deviations(law, &theta) } else { rows.rms(&theta) });
            start = Some(fit.standard);
        }
        Some(deviations)
    }
}

/// Those of the errors of base parameters.
fn long_run_deviations(law: &Law, theta: &[f64]) -> Vec<f64> {
    let found = law.factors.long_run_deviations(law.columns, theta);
    let repeated = law.rows.map_or_else(|| vec![1.0; found.len()], |rows| repeated(rows, theta));
    found.into_iter().zip(repeated).map(|(deviation, widening)| deviation * widening.sqrt()).collect()
}

fn repeated(rows: &ModelRows, theta: &[f64]) -> Vec<f64> {
    let residual: Vec<f64> = rows.y.iter().zip(rows.x.times(theta)).map(|(y, p)| y - p).collect();
    repeated_widening(&rows.layout, &residual)
}

/// A candidate fitted without some parts.
type Fitted = (Candidate, Vec<usize>);

/// The fits of candidates without one or two parts, each made once.
struct Search<'a> {
    choosing: &'a Choosing<'a>,
    whitened: &'a [Whitened],
    /// The deviation of each joint in which errors are compared.
    compared: &'a [f64],
    threads: usize,
    /// Base parameters; none if a fit has no result.
    fitted: HashMap<Fitted, Option<Vec<f64>>>,
}

impl Search<'_> {
    /// The parts that are left out in turn when one is kept from the choice.
    fn parts(&self, kept_out: Option<usize>) -> Vec<usize> {
        (0..self.choosing.folds.count()).filter(|part| Some(*part) != kept_out).collect()
    }

    /// The candidate that is chosen without a part, with all that were compared.
    fn chosen(&mut self, kept_out: Option<usize>) -> (Candidate, Vec<ModelCandidate>) {
        let (with_terms, transitions): (Vec<usize>, Vec<usize>) =
            (0..self.choosing.laws.len()).partition(|law| !self.choosing.laws[*law].terms.is_empty());
        let candidate = |law: usize| Candidate { law, ..DEFAULT };
        let transitions: Vec<Candidate> = transitions.into_iter().map(candidate).collect();
        let (best, mut compared) = self.best_of(&transitions, kept_out, OF_TRANSITIONS);
        let with_terms: Vec<Candidate> = [best].into_iter().chain(with_terms.into_iter().map(candidate)).collect();
        let (best, further) = self.best_of(&with_terms, kept_out, STANDARD_ERRORS);
        compared.extend(further.into_iter().skip(1));
        let weights: Vec<Candidate> =
            (0..self.choosing.weights.len()).map(|weight| Candidate { weight, ..best }).collect();
        let (best, further) = self.best_of(&weights, kept_out, STANDARD_ERRORS);
        compared.extend(further.into_iter().skip(1));
        (best, compared)
    }

    /// The best of candidates, of which the first is the one that the others challenge.
    fn best_of(
        &mut self,
        candidates: &[Candidate],
        kept_out: Option<usize>,
        standard_errors: f64,
    ) -> (Candidate, Vec<ModelCandidate>) {
        let parts = self.parts(kept_out);
        let mut jobs = Vec::new();
        for candidate in candidates {
            jobs.extend(parts.iter().map(|part| (*candidate, left_out(*part, kept_out))));
        }
        self.fit_all(jobs);
        let squares: Vec<Option<Vec<f64>>> = candidates.iter().map(|c| self.squares(*c, &parts, kept_out)).collect();
        let Some(default) = &squares[0] else { return (candidates[0], Vec::new()) };
        let mut best = 0;
        let mut compared = Vec::new();
        for (k, found) in squares.iter().enumerate() {
            let Some(found) = found else { continue };
            let difference = (k > 0).then(|| mean_and_error(found, default));
            let is_better = difference.is_some_and(|[gain, error]| {
                gain < -standard_errors * error
                    && gain <= -self.least_gain(candidates[k], candidates[0]) * mean(default)
            }) && parts.len() >= FEWEST_FOLDS;
            if is_better && squares[best].as_ref().is_none_or(|b| mean(found) < mean(b)) {
                best = k;
            }
            compared.push((k, self.described(candidates[k], mean(found), difference)));
        }
        let described = compared.into_iter().map(|(k, c)| ModelCandidate { taken: k == best, ..c });
        (candidates[best], described.collect())
    }

    /// Part of the squared error of what is challenged by which a challenger must be better.
    fn least_gain(&self, challenger: Candidate, challenged: Candidate) -> f64 {
        let terms = |candidate: Candidate| self.choosing.laws[candidate.law].terms;
        if terms(challenger) == terms(challenged) { 0.0 } else { GAIN_OF_TERM }
    }

    fn described(&self, candidate: Candidate, unseen_square: f64, difference: Option<[f64; 2]>) -> ModelCandidate {
        let law = &self.choosing.laws[candidate.law];
        ModelCandidate {
            belief_weight: self.choosing.weights[candidate.weight],
            friction_transition: law.transition.turning,
            friction_transition_sliding: law.transition.sliding_apart(),
            terms: kinds_of(law.terms).into_iter().map(str::to_owned).collect(),
            unseen_square,
            difference,
            taken: false,
        }
    }

    /// Makes the fits that are missing, several at a time.
    fn fit_all(&mut self, jobs: Vec<Fitted>) {
        let missing: Vec<Fitted> = jobs.into_iter().filter(|job| !self.fitted.contains_key(job)).collect();
        let found = in_parallel(missing.len(), self.threads, |k| self.fit(&missing[k]));
        self.fitted.extend(missing.into_iter().zip(found));
    }

    fn fit(&self, (candidate, out): &Fitted) -> Option<Vec<f64>> {
        let law = &self.choosing.laws[candidate.law];
        let data = self.whitened[candidate.law].without(out, law)?;
        let fit = fit_within(law.set, &data, self.choosing.prior(*candidate), None, GAPS[0]).ok()?;
        Some(law.base.from_standard(&fit.standard))
    }

    fn estimate(&self, candidate: Candidate, out: Vec<usize>) -> Option<&[f64]> {
        self.fitted.get(&(candidate, out))?.as_deref()
    }

    /// The mean square of the errors in each part.
    fn squares(&self, candidate: Candidate, parts: &[usize], kept_out: Option<usize>) -> Option<Vec<f64>> {
        let blocks = &self.choosing.laws[candidate.law].factors.blocks;
        let of_part = |part: &usize| {
            let theta = self.estimate(candidate, left_out(*part, kept_out))?;
            let own = blocks.iter().filter(|block| block.part == *part);
            let rows: usize = own.clone().map(|block| block.rows).sum();
            let compared =
                own.map(|block| block.square(theta) * (block.weight / self.compared[block.joint]).powi(2)).sum::<f64>();
            Some(compared / rows.max(1) as f64)
        };
        let squares: Option<Vec<f64>> = parts.iter().map(of_part).collect();
        squares.filter(|s| !s.is_empty() && s.iter().all(|v| v.is_finite()))
    }

    /// The error in each part of the candidate that is chosen, and fitted, without it.
    fn unseen(&mut self) -> Option<ModelError> {
        let parts = self.parts(None);
        if parts.is_empty() {
            return None;
        }
        let mut unseen = SquaredErrors::of_nothing(self.choosing.kinds.len());
        for part in parts {
            let (chosen, _) = self.chosen(Some(part));
            self.fit_all(vec![(chosen, vec![part])]);
            let theta = self.estimate(chosen, vec![part])?;
            unseen.add(self.choosing.laws[chosen.law].factors, Some(part), theta);
        }
        Some(unseen.error())
    }
}

/// The parts without which a fit predicts one, in order.
fn left_out(part: usize, kept_out: Option<usize>) -> Vec<usize> {
    let mut out: Vec<usize> = [part].into_iter().chain(kept_out).collect();
    out.sort_unstable();
    out
}
