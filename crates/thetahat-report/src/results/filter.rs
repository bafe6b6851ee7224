use serde::{Deserialize, Serialize};

/// A cut-off of the position filter with a decimation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Filter {
    /// Cut-off of the position filter, Hz.
    pub cutoff_hz: f64,
    /// One in this many samples is kept after the parallel filter.
    pub decimation: usize,
}

/// The rms error of the estimates with a filter, over the parameters, each in units of its smallest rms error with any
/// filter, on a simulated twin of the recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FilterError {
    /// The total error.
    pub total: f64,
    /// The bias by the filter and the noise of the positions: more data do not reduce it.
    pub bias: f64,
}

impl FilterError {
    /// The geometric mean of several errors.
    #[must_use]
    pub fn mean(errors: &[Self]) -> Self {
        let mean =
            |of: &dyn Fn(&Self) -> f64| (errors.iter().map(|e| of(e).ln()).sum::<f64>() / errors.len() as f64).exp();
        Self { total: mean(&|e| e.total), bias: mean(&|e| e.bias) }
    }
}

/// A filter that was compared with others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ComparedFilter {
    /// The filter.
    pub filter: Filter,
    /// The error of the estimates; none if the filter gives no estimate.
    pub error: Option<FilterError>,
}

/// The best filter for the estimates, and the errors with the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FilterChoice {
    /// The best filter.
    pub best: Filter,
    /// The filter of the experiment, if it has one, with its error.
    pub own: Option<ComparedFilter>,
    /// Samples per second of the recording.
    pub sample_rate_hz: f64,
    /// The frequency below which nearly all of each joint's velocity lies, Hz.
    pub dynamics_hz: f64,
    /// Every filter that was compared.
    pub compared: Vec<ComparedFilter>,
}

impl FilterChoice {
    /// The error with a filter that was compared.
    #[must_use]
    pub fn error_of(&self, filter: Filter) -> Option<FilterError> {
        self.compared.iter().find(|c| c.filter == filter)?.error
    }

    /// The error with a filter over the error with the best.
    #[must_use]
    pub fn over_best(&self, error: FilterError) -> Option<f64> {
        Some(error.total / self.error_of(self.best)?.total)
    }

    /// The decimations that were compared, in descending order: the parallel filter's cut-off rises.
    #[must_use]
    pub fn decimations(&self) -> Vec<usize> {
        let mut found: Vec<usize> = self.compared.iter().map(|c| c.filter.decimation).collect();
        found.sort_unstable();
        found.dedup();
        found.reverse();
        found
    }

    /// The errors with the best filter and its neighbours, in lines of up to 76 characters: a line for each decimation, with the
    /// cut-offs of the position filter and the error relative to the smallest.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let decimations = self.decimations();
        let best = decimations.iter().position(|d| *d == self.best.decimation).unwrap_or(0);
        let near = best.saturating_sub(NEIGHBOURS)..(best + NEIGHBOURS + 1).min(decimations.len());
        decimations[near].iter().map(|decimation| self.line(*decimation)).collect()
    }

    fn line(&self, decimation: usize) -> String {
        let of_decimation = self.compared.iter().filter(|c| c.filter.decimation == decimation);
        let cell = |c: &ComparedFilter| {
            let error = c.error.and_then(|e| self.over_best(e)).map_or("-".to_owned(), |e| format!("{e:.2}"));
            format!("{:>5} Hz {error:<5}", c.filter.cutoff_hz)
        };
        let mut cells: Vec<String> = of_decimation.map(cell).collect();
        // The highest cut-offs of a line.
        let first = cells.len().saturating_sub(CELLS);
        format!("every {decimation:>4}: {}", cells.split_off(first).join(" ")).trim_end().to_owned()
    }
}

/// Decimations shown on either side of the best.
const NEIGHBOURS: usize = 2;
/// Cut-offs of a line.
const CELLS: usize = 4;
