//! How far estimates with a filter are from the truth.

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

/// The rms error of a filter over the parameters, each in units of the least rms error that any filter gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// Of everything.
    pub total: f64,
    /// Of what the filter and the noise of the positions bring: more data does not make it smaller.
    pub bias: f64,
}

/// The relative errors of filters whose estimates have errors.
pub(super) fn relative_errors(all: &[Option<Errors>]) -> Vec<Option<RelativeError>> {
    let parameters = all.iter().flatten().map(|e| e.bias.len()).next().unwrap_or(0);
    let mut least = vec![f64::INFINITY; parameters];
    for errors in all.iter().flatten() {
        least.iter_mut().zip(errors.squares()).for_each(|(least, square)| *least = least.min(square));
    }
    let rms = |squares: &mut dyn Iterator<Item = f64>| {
        let sum: f64 = squares.zip(&least).map(|(square, least)| square / least.max(f64::MIN_POSITIVE)).sum();
        (sum / parameters as f64).sqrt()
    };
    let relative = |e: &Errors| RelativeError { total: rms(&mut e.squares()), bias: rms(&mut e.bias.iter().copied()) };
    all.iter().map(|e| e.as_ref().map(relative)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_count_in_units_of_the_least() {
        let errors =
            |bias: f64, variance: f64| Some(Errors { bias: vec![bias; 2], variance: vec![variance, 100.0 * variance] });
        let found = relative_errors(&[errors(0.0, 1.0), None, errors(0.0, 9.0)]);
        assert_eq!(
            found,
            [Some(RelativeError { total: 1.0, bias: 0.0 }), None, Some(RelativeError { total: 3.0, bias: 0.0 })]
        );
    }
}
