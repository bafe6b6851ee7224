//! How far estimates with a filter are from the truth.

use crate::results::{Filter, FilterError};

/// Squared differences of estimates that the errors of the narrower filter explain, in multiples of those.
const ALLOWED: f64 = 3.0;
/// How many times larger mean squared errors of a narrower filter may be that tells of a wider one's bias.
const COMPARABLE: f64 = 9.0;
/// Part of the parameters that must differ by more than that: one that a narrow filter hardly shows differs by chance.
const DIFFERENT: f64 = 0.3;

/// Errors of the estimates with one filter: mean squares, one for each parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Errors {
    /// What the filter and the noise of the positions bring.
    pub(super) bias: Vec<f64>,
    /// What the noise of the torques brings.
    pub(super) variance: Vec<f64>,
}

impl Errors {
    fn squares(&self) -> impl Iterator<Item = f64> {
        self.bias.iter().zip(&self.variance).map(|(bias, variance)| bias + variance)
    }

    /// The mean over several records; none where one has no estimate.
    pub(super) fn mean(all: &[Option<Self>]) -> Option<Self> {
        let all: Vec<&Self> = all.iter().map(Option::as_ref).collect::<Option<_>>()?;
        let mean = |of: &dyn Fn(&Self) -> &Vec<f64>| {
            let parameters = all.first().map_or(0, |e| of(e).len());
            (0..parameters).map(|p| all.iter().map(|e| of(e)[p]).sum::<f64>() / all.len() as f64).collect()
        };
        Some(Self { bias: mean(&|e| &e.bias), variance: mean(&|e| &e.variance) })
    }
}

/// What a filter gives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tried {
    pub(super) filter: Filter,
    /// The estimates from the record itself.
    pub(super) estimates: Vec<f64>,
    /// The errors of the estimates from twins of it.
    pub(super) errors: Errors,
}

/// The relative errors of filters; none where a filter gives no estimate.
///
/// What the twins do not know of, a record that was low-passed, a lag, friction that changes smoothly, shows in the record's own
/// estimates: those of a wide filter differ from those of a narrower one by more than the narrower one's errors. The part beyond
/// is bias of the wide one (A. Goldenshluger, O. Lepski, "Bandwidth selection in kernel density estimation: oracle inequalities
/// and adaptive minimax optimality", Annals of Statistics 39 (2011), section 3). `part` of all samples are in the twins.
pub(super) fn relative_errors(all: &[Option<Tried>], part: f64) -> Vec<Option<FilterError>> {
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
        let beyond = |other: &Tried| {
            let beyond = beyond(of, other, part);
            let different = beyond.iter().filter(|excess| **excess > 0.0).count();
            if (different as f64) < DIFFERENT * parameters as f64 { 0.0 } else { mean(&mut beyond.into_iter()) }
        };
        narrower.map(beyond).fold(0.0, f64::max)
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

/// By how much the squared differences of two estimates exceed what the errors of the narrower filter allow.
fn beyond(wide: &Tried, narrow: &Tried, part: f64) -> Vec<f64> {
    let differences = wide.estimates.iter().zip(&narrow.estimates).map(|(w, n)| (w - n).powi(2));
    let allowed = narrow.errors.bias.iter().zip(&narrow.errors.variance).map(move |(b, v)| b + v / part);
    differences.zip(allowed).map(|(difference, allowed)| difference - ALLOWED * allowed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(cutoff_hz: f64, decimation: usize, estimate: f64, variance: f64) -> Option<Tried> {
        let errors = Errors { bias: vec![0.0; 2], variance: vec![variance, 100.0 * variance] };
        Some(Tried { filter: Filter { cutoff_hz, decimation }, estimates: vec![estimate; 2], errors })
    }

    #[test]
    fn errors_count_in_units_of_the_least() {
        let found = relative_errors(&[tried(10.0, 2, 0.0, 1.0), None, tried(5.0, 4, 0.0, 9.0)], 1.0);
        let error = |total| Some(FilterError { total, bias: 0.0 });
        assert_eq!(found, [error(1.0), None, error(3.0)]);
    }

    #[test]
    fn an_estimate_that_drifts_as_the_filter_widens_has_bias() {
        let found = relative_errors(&[tried(40.0, 1, 5.0, 1e-2), tried(10.0, 4, 0.0, 4e-2)], 1.0);
        let [wide, narrow] = [&found[0], &found[1]].map(|e| e.unwrap());
        assert!(wide.total > 10.0 && wide.bias > 10.0 && narrow.total == 2.0 && narrow.bias == 0.0);
    }
}
