//! The choice of the belief's weight and of the friction's transition by what is left out.

use std::collections::HashMap;

use super::{
    folds::{FOLDS, ModelFolds},
    rows::ModelRows,
};
use thetahat_estimation::statistics::repeated_widening;
use thetahat_ground::{
    linear_algebra::{Matrix, dot, norm},
    pool::in_parallel,
};
use thetahat_model::{
    base_parameters::BaseParameters,
    consistency::{ConsistentSet, LeastSquares, Prior, fit_within},
    robot::TermDescription,
};
use thetahat_report::results::ModelCandidate;

/// Standard errors of the mean difference by which a challenger must be better.
const STANDARD_ERRORS: f64 = 2.0;
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
    pub(super) folds: &'a ModelFolds,
}

/// A law of friction: a transition of the robot as described, or one with more torque terms.
pub(super) struct Law<'a> {
    pub(super) set: &'a ConsistentSet,
    pub(super) base: &'a BaseParameters,
    pub(super) rows: &'a ModelRows,
    pub(super) transition: f64,
    /// In addition to the robot's.
    pub(super) terms: &'a [TermDescription],
}

impl Law<'_> {
    fn kinds(&self) -> Vec<String> {
        let mut kinds: Vec<String> = self.terms.iter().map(|term| term.kind().to_owned()).collect();
        kinds.dedup();
        kinds
    }
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
    pub(super) unseen: Option<Unseen>,
    pub(super) found: Found,
}

/// What was computed on the way; it holds for the same laws with others after them.
#[derive(Default)]
pub(super) struct Found {
    /// The long-run deviations of each law's residual, joint by joint.
    deviations: Vec<Vec<f64>>,
    /// Base parameters; none if a fit has no result.
    fitted: HashMap<Fitted, Option<Vec<f64>>>,
}

/// The prediction of rows that neither fit nor choice has seen.
pub(super) struct Unseen {
    pub(super) prediction: Vec<f64>,
    pub(super) seen: Vec<bool>,
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
    pub(super) fn choose(&self, threads: usize, found: Found) -> Option<Choice> {
        let Found { mut deviations, fitted } = found;
        let first = deviations.len();
        let of_others = in_parallel(self.laws.len() - first, threads, |k| self.deviations(&self.laws[first + k]));
        deviations.extend(of_others.into_iter().collect::<Option<Vec<_>>>()?);
        let of_law = |(law, own): (&Law, &Vec<f64>)| {
            Whitened::new(law.rows, self.folds, &deviations[DEFAULT.law], &weighted(own, POWER))
        };
        let whitened: Vec<Whitened> = self.laws.iter().zip(&deviations).map(of_law).collect();
        let mut search = Search { choosing: self, whitened: &whitened, threads, fitted };
        let (chosen, candidates) = search.chosen(None);
        let unseen = search.unseen();
        let found = Found { fitted: search.fitted, deviations: deviations.clone() };
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
        Whitened::new(law.rows, self.folds, deviations, deviations).all(law)
    }

    /// The long-run deviation of each joint's residual, next to free estimates; along a motion that repeats, with errors that do.
    fn deviations(&self, law: &Law) -> Option<Vec<f64>> {
        let rows = law.rows;
        let torque: Vec<f64> = rows.layout.by_joint(&rows.y).iter().map(|y| rms(y)).collect();
        let largest = torque.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let least: Vec<f64> = torque.iter().map(|t| LEAST_DEVIATION * t.max(LEAST_DEVIATION * largest)).collect();
        let mut deviations: Vec<f64> =
            torque.iter().zip(&least).map(|(t, least)| (FIRST_DEVIATION * t).max(*least)).collect();
        let mut start: Option<Vec<f64>> = None;
        for round in 0..ROUNDS {
            let whitened = Whitened::new(rows, self.folds, &deviations, &deviations);
            let data = whitened.all(law)?;
            let prior = Prior::Belief { weight: NEXT_TO_FREE };
            let fit = fit_within(law.set, &data, prior, start.as_deref(), GAPS[0]).ok()?;
            let prediction = rows.x.times(&law.base.from_standard(&fit.standard));
            let residual: Vec<f64> = rows.y.iter().zip(prediction).map(|(y, p)| y - p).collect();
            let last = round + 1 == ROUNDS;
            let repeated = if last { repeated_widening(&rows.layout, &residual) } else { vec![1.0; least.len()] };
            let of_joint = |e: &Vec<f64>| if last { long_run_deviation(e) } else { rms(e) };
            let found = rows.layout.by_joint(&residual).into_iter().zip(repeated);
            deviations = found.zip(&least).map(|((e, r), least)| (of_joint(&e) * r.sqrt()).max(*least)).collect();
            start = Some(fit.standard);
        }
        Some(deviations)
    }
}

/// Deviations of all joints that lie between their own and the one that they have in common.
fn weighted(deviations: &[f64], power: f64) -> Vec<f64> {
    let common = rms(deviations);
    deviations.iter().map(|own| own.powf(power) * common.powf(1.0 - power)).collect()
}

fn rms(values: &[f64]) -> f64 {
    norm(values) / (values.len().max(1) as f64).sqrt()
}

/// The deviation of the mean of a series times the root of its length: widened by its autocorrelation with Bartlett's
/// weights (Newey and West, 1987).
fn long_run_deviation(residual: &[f64]) -> f64 {
    let count = residual.len();
    let mean = residual.iter().sum::<f64>() / count.max(1) as f64;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let variance = dot(&centred, &centred);
    if variance == 0.0 {
        return rms(residual);
    }
    let lags = ((4.0 * (count as f64 / 100.0).powf(2.0 / 9.0)) as usize + 4).min(count - 1);
    let part = |k: usize| (1.0 - k as f64 / (lags + 1) as f64) * dot(&centred[k..], &centred[..count - k]) / variance;
    let widening = 1.0 + 2.0 * (1..=lags).map(part).sum::<f64>();
    rms(residual) * widening.max(1.0).sqrt()
}

/// Whitened rows of one law: triangular factors of each part, and of the rows that belong to none.
struct Whitened {
    x: Matrix,
    y: Vec<f64>,
    /// Deviation by which each row is divided, over the one in which errors are compared.
    part: Vec<f64>,
    /// The factor of `[X y]` of each part; the last is that of the rows near borders.
    factors: Vec<Matrix>,
    /// The part of each row.
    of_row: Vec<usize>,
}

impl Whitened {
    fn new(rows: &ModelRows, folds: &ModelFolds, compared: &[f64], deviations: &[f64]) -> Self {
        let part = rows.layout.spread(|block| deviations[block.joint] / compared[block.joint]);
        let scale: Vec<f64> = rows.layout.spread(|block| 1.0 / deviations[block.joint]);
        let scale: Vec<f64> = scale.iter().zip(&rows.weights).map(|(s, w)| s * w).collect();
        let x = rows.x.scale_rows(&scale);
        let y: Vec<f64> = rows.y.iter().zip(&scale).map(|(y, s)| y * s).collect();
        let per_joint = folds.of_row.len();
        let of_row: Vec<usize> = (0..y.len()).map(|k| folds.of_row[k % per_joint].unwrap_or(FOLDS)).collect();
        let right = Matrix::from_fn(y.len(), 1, |k, _| y[k]);
        let both = Matrix::side_by_side(&[&x, &right]);
        let factor = |part: usize| {
            let keep: Vec<bool> = of_row.iter().map(|p| *p == part).collect();
            both.select_rows(&keep).triangular_factor()
        };
        Self { factors: (0..=FOLDS).map(factor).collect(), x, y, part, of_row }
    }

    /// The least squares of all rows.
    fn all(&self, law: &Law) -> Option<LeastSquares> {
        let parts: Vec<&Matrix> = self.factors.iter().filter(|f| f.rows() > 0).collect();
        least_squares(&parts, law)
    }

    /// Those without some parts, and without the rows near borders.
    fn without(&self, out: &[usize], law: &Law) -> Option<LeastSquares> {
        let kept = (0..FOLDS).filter(|part| !out.contains(part)).map(|part| &self.factors[part]);
        least_squares(&kept.filter(|f| f.rows() > 0).collect::<Vec<_>>(), law)
    }

    fn rows_of(&self, part: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.y.len()).filter(move |k| self.of_row[*k] == part)
    }
}

fn least_squares(parts: &[&Matrix], law: &Law) -> Option<LeastSquares> {
    let factor = Matrix::stack(parts).triangular_factor();
    let columns = factor.columns() - 1;
    let r = factor.select_columns(&(0..columns).collect::<Vec<_>>());
    LeastSquares::in_base(&r, factor.column(columns).to_vec(), law.base, law.set.parameter_table().len()).ok()
}

/// A candidate fitted without some parts.
type Fitted = (Candidate, Vec<usize>);

/// The fits of candidates without one or two parts, each made once.
struct Search<'a> {
    choosing: &'a Choosing<'a>,
    whitened: &'a [Whitened],
    threads: usize,
    /// Base parameters; none if a fit has no result.
    fitted: HashMap<Fitted, Option<Vec<f64>>>,
}

impl Search<'_> {
    /// The parts that are left out in turn when one is kept from the choice.
    fn parts(&self, kept_out: Option<usize>) -> Vec<usize> {
        (0..self.choosing.folds.count).filter(|part| Some(*part) != kept_out).collect()
    }

    /// The candidate that is chosen without a part, with all that were compared.
    fn chosen(&mut self, kept_out: Option<usize>) -> (Candidate, Vec<ModelCandidate>) {
        let (with_terms, transitions): (Vec<usize>, Vec<usize>) =
            (0..self.choosing.laws.len()).partition(|law| !self.choosing.laws[*law].terms.is_empty());
        let candidate = |law: usize| Candidate { law, ..DEFAULT };
        let transitions: Vec<Candidate> = transitions.into_iter().map(candidate).collect();
        let (best, mut compared) = self.best_of(&transitions, kept_out);
        let with_terms: Vec<Candidate> = [best].into_iter().chain(with_terms.into_iter().map(candidate)).collect();
        let (best, further) = self.best_of(&with_terms, kept_out);
        compared.extend(further.into_iter().skip(1));
        let weights: Vec<Candidate> =
            (0..self.choosing.weights.len()).map(|weight| Candidate { weight, ..best }).collect();
        let (best, further) = self.best_of(&weights, kept_out);
        compared.extend(further.into_iter().skip(1));
        (best, compared)
    }

    /// The best of candidates, of which the first is the one that the others challenge.
    fn best_of(&mut self, candidates: &[Candidate], kept_out: Option<usize>) -> (Candidate, Vec<ModelCandidate>) {
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
            let is_better =
                difference.is_some_and(|[mean, error]| mean < -STANDARD_ERRORS * error) && parts.len() >= FEWEST_FOLDS;
            if is_better && squares[best].as_ref().is_none_or(|b| mean(found) < mean(b)) {
                best = k;
            }
            compared.push((k, self.described(candidates[k], mean(found), difference)));
        }
        let described = compared.into_iter().map(|(k, c)| ModelCandidate { taken: k == best, ..c });
        (candidates[best], described.collect())
    }

    fn described(&self, candidate: Candidate, unseen_square: f64, difference: Option<[f64; 2]>) -> ModelCandidate {
        let law = &self.choosing.laws[candidate.law];
        ModelCandidate {
            belief_weight: self.choosing.weights[candidate.weight],
            friction_transition: law.transition,
            terms: law.kinds(),
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
        let rows = &self.whitened[candidate.law];
        let of_part = |part: &usize| {
            let theta = self.estimate(candidate, left_out(*part, kept_out))?;
            let prediction = rows.x.times(theta);
            let errors: Vec<f64> = rows.rows_of(*part).map(|k| rows.part[k] * (rows.y[k] - prediction[k])).collect();
            Some(dot(&errors, &errors) / errors.len().max(1) as f64)
        };
        let squares: Option<Vec<f64>> = parts.iter().map(of_part).collect();
        squares.filter(|s| !s.is_empty() && s.iter().all(|v| v.is_finite()))
    }

    /// Each part predicted by the candidate that is chosen, and fitted, without it.
    fn unseen(&mut self) -> Option<Unseen> {
        let parts = self.parts(None);
        if parts.is_empty() {
            return None;
        }
        let count = self.whitened[0].y.len();
        let mut unseen = Unseen { prediction: vec![0.0; count], seen: vec![false; count] };
        for part in parts {
            let (chosen, _) = self.chosen(Some(part));
            self.fit_all(vec![(chosen, vec![part])]);
            let theta = self.estimate(chosen, vec![part])?;
            let prediction = self.choosing.laws[chosen.law].rows.x.times(theta);
            for k in self.whitened[chosen.law].rows_of(part) {
                (unseen.prediction[k], unseen.seen[k]) = (prediction[k], true);
            }
        }
        Some(unseen)
    }
}

/// The parts without which a fit predicts one, in order.
fn left_out(part: usize, kept_out: Option<usize>) -> Vec<usize> {
    let mut out: Vec<usize> = [part].into_iter().chain(kept_out).collect();
    out.sort_unstable();
    out
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean of the differences of two lists, and its standard error.
fn mean_and_error(of: &[f64], from: &[f64]) -> [f64; 2] {
    let differences: Vec<f64> = of.iter().zip(from).map(|(a, b)| a - b).collect();
    let (centre, count) = (mean(&differences), differences.len() as f64);
    let spread: f64 = differences.iter().map(|d| (d - centre).powi(2)).sum();
    [centre, (spread / (count - 1.0).max(1.0) / count).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_difference_has_its_standard_error() {
        let [mean, error] = mean_and_error(&[1.0, 2.0, 3.0], &[0.0, 0.0, 0.0]);
        assert!((mean - 2.0).abs() < 1e-15 && (error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_series_that_holds_each_value_twice_has_a_larger_deviation_of_its_mean() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        };
        let white: Vec<f64> = (0..400).map(|_| next()).collect();
        let held: Vec<f64> = white.iter().flat_map(|v| [*v, *v]).collect();
        assert!(long_run_deviation(&held) > 1.2 * long_run_deviation(&white));
        assert_eq!(long_run_deviation(&[0.0; 8]), 0.0);
    }
}
