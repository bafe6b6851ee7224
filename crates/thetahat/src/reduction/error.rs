use std::{io, path::PathBuf};

use crate::experiment::ExperimentError;
use thetahat_estimation::{identification::EstimationError, simulation::SimulationError};
use thetahat_report::results::ResultsError;

/// The part of a recording that another one holds as well.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedSpan {
    /// The recording's name.
    pub recording: String,
    /// The file of its positions; empty for a twin.
    pub file: String,
    /// From and to, s.
    pub span_s: [f64; 2],
}

impl SharedSpan {
    fn named(&self) -> String {
        if self.file.is_empty() { self.recording.clone() } else { format!("{} ({})", self.recording, self.file) }
    }

    fn span(&self) -> String {
        let [start, end] = self.span_s;
        format!("{start:.4} to {end:.4} s")
    }
}

/// Why there is no reduction, or no estimate from it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// The experiment or its recordings are not usable.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The results that give the estimates cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A recording has time steps that are not equal.
    #[error(
        "recording {recording}: the step to sample {sample} is {found:e} s, expected {expected:e} s within a thousandth; \
         a long recording is not brought to equal steps: export it at equal steps, or identify from the whole recording"
    )]
    UnequalSteps {
        /// The recording.
        recording: String,
        /// The sample at the end of the step.
        sample: usize,
        /// The mean step, s.
        expected: f64,
        /// The step found, s.
        found: f64,
    },
    /// A recording has gaps.
    #[error(
        "recording {recording}: {gaps} gaps, the first at sample {sample}; a reduction takes recordings without gaps: cut the recording \
         there, or identify from the whole recording"
    )]
    Gaps {
        /// The recording.
        recording: String,
        /// Their number.
        gaps: usize,
        /// The first sample missing.
        sample: usize,
    },
    /// A recording without torque.
    #[error("recording {recording}: the torque is zero throughout its window; record it, or name another column")]
    NoTorque {
        /// The recording.
        recording: String,
    },
    /// Two reductions are not of one robot and one way of filtering.
    #[error(
        "{what} differs: {first} in the first, {other} in the other; reduce both with the same robot, parameters, [signal] and \
         instruments"
    )]
    Unlike {
        /// What differs.
        what: &'static str,
        /// In the first.
        first: String,
        /// In the other.
        other: String,
    },
    /// A recording was reduced twice.
    #[error("recordings {first} and {other} hold the same samples; a recording counts once: leave one out")]
    SameRecording {
        /// Its name.
        first: String,
        /// Its other name.
        other: String,
    },
    /// Two recordings share samples.
    #[error(
        "recordings {} and {} share samples: {} of the one are {} of the other, and their rows would count twice; give them \
         windows that do not overlap (window_start_s, window_end_s in [[recording]]), or leave one out",
        first.named(),
        other.named(),
        first.span(),
        other.span()
    )]
    Overlap {
        /// Of the first recording.
        first: Box<SharedSpan>,
        /// Of the other.
        other: Box<SharedSpan>,
    },
    /// Two files do not go together.
    #[error("{}, {}: {source}", first.display(), other.display())]
    Apart {
        /// The first.
        first: PathBuf,
        /// The other.
        other: PathBuf,
        /// Why.
        source: Box<ReductionError>,
    },
    /// A long recording has no reference that can be read in pieces.
    #[error(
        "recording {recording}: instruments for a long recording follow its recorded reference: name it as `reference`, or \
         identify from the whole recording"
    )]
    NoReference {
        /// The recording.
        recording: String,
    },
    /// The simulation of the instruments failed.
    #[error("recording {recording}, instruments simulated from {from_s:.4} s on: {source}")]
    Simulation {
        /// The recording.
        recording: String,
        /// Where the piece begins, s.
        from_s: f64,
        /// Why.
        source: SimulationError,
    },
    /// Two pieces of a simulation do not meet.
    #[error(
        "recording {recording}: simulated pieces are {tolerances:.0} tolerances apart at {time_s:.4} s: the loop remembers \
         longer than the {warm_up_s} s before each piece; raise the bandwidth of the controller"
    )]
    Seam {
        /// The recording.
        recording: String,
        /// Where they meet, s.
        time_s: f64,
        /// How far they are apart, in tolerances of the integration.
        tolerances: f64,
        /// Time that each is simulated before, s.
        warm_up_s: f64,
    },
    /// The results hold no estimates to simulate with.
    #[error(
        "{}: no estimates for instruments: {reason}; give the results.json of an identification or of solved reductions \
         of this robot",
        path.display()
    )]
    NoEstimates {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// No reduction was given.
    #[error("there is no reduction to solve; give at least one")]
    Nothing,
    /// The file is not a reduction, or damaged.
    #[error("{}: not a reduction, or damaged: {reason}; reduce the recordings again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The file is of another version of its form.
    #[error(
        "{}: a reduction of form {found}, this program reads form {form} alone; reduce the recordings again",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The form of the file.
        found: String,
        /// The form that is read.
        form: u32,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("{}: cannot be written: {source}; choose another file", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// There is no estimate.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
}
