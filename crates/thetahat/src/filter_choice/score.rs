//! How far estimates with a filter are from the truth.

use thetahat_model::{base_parameters::BaseParameters, dynamics::Model};
use thetahat_report::results::{Filter, FilterError};

/// Squared differences of estimates that the errors of the narrower filter explain, in multiples of those.
const ALLOWED: f64 = 3.0;
/// Largest ratio of mean squared errors at which the narrower filter still reveals bias.
const COMPARABLE: f64 = 9.0;
/// Part of the parameters that must differ by more than that: one that a narrow filter hardly shows differs by chance.
const DIFFERENT: f64 = 0.3;
/// Factor by which more parameters must differ than in any recording of a twin.
const NOT_BY_CHANCE: f64 = 3.0;

/// Errors of the estimates with one filter: mean squares, one for each parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Errors {
    /// Caused by the filter and the noise of the positions.
    pub(super) bias: Vec<f64>,
    /// Caused by the noise of the torques.
    pub(super) variance: Vec<f64>,
    /// Errors of single draws of both, the same draws for every filter.
    pub(super) draws: Vec<Vec<f64>>,
}

/// The size of each base parameter: the largest value among the parameters of its joint or link with the same unit. An error beyond it
/// means that the parameter is unknown, however large the error is.
#[must_use]
pub fn sizes(model: &Model, base: &BaseParameters, values: &[f64]) -> Vec<f64> {
    let table = model.parameter_table();
    let group = |p: usize| {
        let parameter = &base.parameters()[p];
        (table.get(parameter.kept).number, &parameter.unit)
    };
    let all = 0..values.len();
    let of_group = |p: usize| all.clone().filter(move |&other| group(other) == group(p));
    all.clone().map(|p| of_group(p).map(|other| values[other].abs()).fold(0.0, f64::max)).collect()
}

impl Errors {
    /// The same with none beyond the sizes of the parameters.
    pub(super) fn within(self, sizes: &[f64]) -> Self {
        Self { bias: within(self.bias, sizes), variance: within(self.variance, sizes), draws: self.draws }
    }

    fn squares(&self) -> impl Iterator<Item = f64> {
        self.bias.iter().zip(&self.variance).map(|(bias, variance)| bias + variance)
    }

    /// The mean over several recordings; `None` if one has no estimate.
    pub(super) fn mean(all: &[Option<Self>]) -> Option<Self> {
        let all: Vec<&Self> = all.iter().map(Option::as_ref).collect::<Option<_>>()?;
        let mean = |of: &dyn Fn(&Self) -> &Vec<f64>| {
            let parameters = all.first().map_or(0, |e| of(e).len());
            (0..parameters).map(|p| all.iter().map(|e| of(e)[p]).sum::<f64>() / all.len() as f64).collect()
        };
        let draws = all.iter().flat_map(|e| e.draws.iter().cloned()).collect();
        Some(Self { bias: mean(&|e| &e.bias), variance: mean(&|e| &e.variance), draws })
    }
}

/// The estimates with a filter, and their errors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tried {
    pub(super) filter: Filter,
    /// The estimates from the recording itself.
    pub(super) estimates: Vec<f64>,
    /// The errors of the estimates from twins of it.
    pub(super) errors: Errors,
}

/// The relative errors of filters; `None` for a filter that gives no estimate.
///
/// Effects that the twins do not have, such as friction that changes smoothly, show in the recording's own estimates: those of a wide
/// filter differ from those of a narrower one by more than the narrower one's errors, and more often than in recordings of the twin. The
/// excess is bias of the wide one (A. Goldenshluger, O. Lepski, "Bandwidth selection in kernel density estimation: oracle inequalities
/// and adaptive minimax optimality", Annals of Statistics 39 (2011), section 3). `part` of all samples are in the twins.
pub(super) fn relative_errors(all: &[Option<Tried>], sizes: &[f64], part: f64) -> Vec<Option<FilterError>> {
    let parameters = all.iter().flatten().map(|t| t.estimates.len()).next().unwrap_or(0);
    let mut least = vec![f64::MAX; parameters];
    for tried in all.iter().flatten() {
        least.iter_mut().zip(tried.errors.squares()).for_each(|(least, square)| *least = least.min(square));
    }
    let mean = |squares: &mut dyn Iterator<Item = f64>| {
        let sum: f64 = squares.zip(&least).map(|(square, least)| square / least.max(f64::MIN_POSITIVE)).sum();
        sum / parameters as f64
    };
    let drift = |of: &Tried| {
        let limit = COMPARABLE * mean(&mut of.errors.squares());
        let is_comparable =
            |other: &&Tried| is_narrower(other.filter, of.filter) && mean(&mut other.errors.squares()) <= limit;
        let narrower = all.iter().flatten().filter(is_comparable);
        let from = |narrow: &Tried| {
            let allowed = allowed(narrow, part);
            let excess = beyond(&of.estimates, &narrow.estimates, &allowed);
            let draws = of.errors.draws.iter().zip(&narrow.errors.draws);
            let by_chance = draws.map(|(of, narrow)| positive(&beyond(of, narrow, &allowed))).max().unwrap_or(0);
            let limit = (DIFFERENT * parameters as f64).max(NOT_BY_CHANCE * by_chance as f64);
            if (positive(&excess) as f64) < limit { 0.0 } else { mean(&mut within(excess, sizes).into_iter()) }
        };
        narrower.map(from).fold(0.0, f64::max)
    };
    let relative = |tried: &Tried| {
        let drift = drift(tried);
        let (total, bias) = (mean(&mut tried.errors.squares()), mean(&mut tried.errors.bias.iter().copied()));
        FilterError { total: (total + drift).sqrt(), bias: (bias + drift).sqrt() }
    };
    all.iter().map(|tried| tried.as_ref().map(relative)).collect()
}

/// Whether a filter lets less through than another in both of its parts.
fn is_narrower(filter: Filter, other: Filter) -> bool {
    filter != other && filter.decimation >= other.decimation && filter.cutoff_hz <= other.cutoff_hz
}

/// The squared differences that the errors of the narrower filter allow; the twins have `part` of all samples.
fn allowed(narrow: &Tried, part: f64) -> Vec<f64> {
    let errors = narrow.errors.bias.iter().zip(&narrow.errors.variance);
    errors.map(|(bias, variance)| ALLOWED * (bias + variance / part)).collect()
}

/// By how much the squared differences of two estimates exceed what is allowed.
fn beyond(wide: &[f64], narrow: &[f64], allowed: &[f64]) -> Vec<f64> {
    let differences = wide.iter().zip(narrow).map(|(w, n)| (w - n).powi(2));
    differences.zip(allowed).map(|(difference, allowed)| difference - allowed).collect()
}

/// Squared errors, none beyond the sizes of the parameters.
fn within(squares: Vec<f64>, sizes: &[f64]) -> Vec<f64> {
    squares.into_iter().zip(sizes).map(|(square, size)| square.min(size * size)).collect()
}

fn positive(values: &[f64]) -> usize {
    values.iter().filter(|value| **value > 0.0).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(cutoff_hz: f64, decimation: usize, estimate: f64, variance: f64) -> Option<Tried> {
        let errors = Errors { bias: vec![0.0; 2], variance: vec![variance, 100.0 * variance], draws: Vec::new() };
        Some(Tried { filter: Filter { cutoff_hz, decimation }, estimates: vec![estimate; 2], errors })
    }

    #[test]
    fn errors_count_in_units_of_the_least() {
        let found = relative_errors(&[tried(10.0, 2, 0.0, 1.0), None, tried(5.0, 4, 0.0, 9.0)], &[100.0; 2], 1.0);
        let error = |total| Some(FilterError { total, bias: 0.0 });
        assert_eq!(found, [error(1.0), None, error(3.0)]);
    }

    #[test]
    fn a_drift_that_twins_have_too_is_chance() {
        let with_draw = |tried: Option<Tried>, draw: f64| {
            let tried = tried.unwrap();
            Some(Tried { errors: Errors { draws: vec![vec![draw; 2]], ..tried.errors.clone() }, ..tried })
        };
        let pair = |draw| [with_draw(tried(40.0, 1, 5.0, 1e-2), draw), with_draw(tried(10.0, 4, 0.0, 4e-2), 0.0)];
        let bias_of_wide = |draw| relative_errors(&pair(draw), &[100.0; 2], 1.0)[0].unwrap().bias;
        assert!(bias_of_wide(0.0) > 10.0 && bias_of_wide(5.0) == 0.0);
    }

    #[test]
    fn errors_beyond_the_size_of_a_parameter_are_alike() {
        let errors = Errors { bias: vec![9.0, 1e6], variance: vec![1.0, 1e9], draws: Vec::new() }.within(&[10.0, 10.0]);
        assert_eq!((errors.bias, errors.variance), (vec![9.0, 100.0], vec![1.0, 100.0]));
    }

    #[test]
    fn an_estimate_that_drifts_as_the_filter_widens_has_bias() {
        let found = relative_errors(&[tried(40.0, 1, 5.0, 1e-2), tried(10.0, 4, 0.0, 4e-2)], &[100.0; 2], 1.0);
        let [wide, narrow] = [&found[0], &found[1]].map(|e| e.unwrap());
        assert!(wide.total > 10.0 && wide.bias > 10.0 && narrow.total == 2.0 && narrow.bias == 0.0);
    }
}
