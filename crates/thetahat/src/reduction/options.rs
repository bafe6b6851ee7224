//! How recordings are reduced, and how far a reduction is.

/// How a recording is reduced. The numbers that come out are the same for any number of threads; another length of the
/// pieces changes their last digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReduceOptions {
    /// Pieces that are worked on at a time.
    pub threads: usize,
    /// Samples of one piece, about.
    pub piece_samples: usize,
    /// Whether rows alone are kept: of short recordings the samples are kept otherwise, from which `Reduction::solve`
    /// estimates all that `Experiment::run` does.
    pub rows_only: bool,
}

impl Default for ReduceOptions {
    fn default() -> Self {
        Self { threads: 1, piece_samples: 1 << 16, rows_only: false }
    }
}

/// How far a reduction is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReduceProgress {
    /// The recording, from one.
    pub recording: usize,
    /// Recordings in all.
    pub recordings: usize,
    /// Pieces read, including the pass that looks for the moving part and for what counts as near rest.
    pub done: usize,
    /// Pieces to read; more than before where a joint hardly moves, so that the rows are made again.
    pub to_do: usize,
}
