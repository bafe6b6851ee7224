use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    ReductionError,
    error::SharedSpan,
    factors::{KeptRows, MOST_SEGMENTS, coarsened},
    identity::{Identity, unlike},
    overlap::Marks,
    samples,
};
use crate::{
    preparation::Recording,
    run::{FEWEST_RECORDINGS, ModelFactors},
};
use thetahat_estimation::checks::Finding;
use thetahat_report::results::NearRestResult;

/// Part by which the sample rates of recordings may differ, as in an experiment with several.
const RATE_TOLERANCE: f64 = 0.01;
/// Segments of all recordings of a reduction: with more recordings, each keeps fewer.
const MOST_IN_ALL: usize = 256;

/// Numbers of the rows of all recordings up to which rows are kept: of more, triangular factors.
const MOST_NUMBERS: usize = 1 << 22;

/// What an identification needs of recordings: their rows, or triangular factors where they are many, with the findings of
/// the checks.
///
/// Its size is limited, whatever the length of the recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduction {
    /// What must agree.
    pub identity: Identity,
    /// The experiment file's name, for messages.
    pub experiment_name: String,
    /// Its text.
    pub experiment_description: String,
    /// The text of the robot description.
    pub robot_description: String,
    /// The base parameters with which the instruments were simulated, where there are instruments.
    pub instruments: Option<Vec<f64>>,
    /// The recordings, by fingerprint where reductions were merged.
    pub recordings: Vec<ReducedRecording>,
    /// What was found in recordings that were compared with one another.
    pub compared: Vec<ComparedRecordings>,
}

/// Recordings that were compared with one another, by their fingerprints, and what was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparedRecordings {
    /// Their fingerprints.
    pub fingerprints: Vec<String>,
    /// What was found.
    pub findings: Vec<Finding>,
}

/// What is left out in turn of a recording whose rows are kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingFolds {
    /// The fold of each row of a joint.
    pub of_row: Vec<usize>,
    /// The name of each fold.
    pub names: Vec<String>,
}

/// One recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedRecording {
    /// Its name, or its number.
    pub name: String,
    /// The file of its positions; empty for a twin.
    pub file: String,
    /// Weight of its rows.
    pub weight: f64,
    /// By which it is known again: of the positions and torques in the window, 16 hexadecimal digits.
    pub fingerprint: String,
    /// By which samples are known again that another recording holds as well.
    pub marks: Marks,
    /// Samples in the window.
    pub samples: usize,
    /// Rows of each joint.
    pub rows: usize,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Start and end of the window, s.
    pub window_s: [f64; 2],
    /// Time for which its torques hold, s, over which they were centred; zero where they were measured at their instants.
    pub torque_hold_s: f64,
    /// Samples near rest that make no rows; none if all make rows.
    pub near_rest: Option<NearRestResult>,
    /// True base parameters, for a twin.
    pub truth: Option<Vec<f64>>,
    /// What the checks found.
    pub findings: Vec<Finding>,
    /// Parts in which the checks looked at it, one by one.
    pub examined_parts: usize,
    /// What is left out in turn; none if it was not examined as a whole.
    pub folds: Option<RecordingFolds>,
    /// Its rows, or their factors.
    pub kept: KeptRows,
    /// The factors of the rows of every sample, from which the model is chosen.
    pub model: ModelFactors,
    /// The recording itself, where it is short: an identification reads it.
    pub samples_kept: Option<Box<Recording>>,
}

impl Reduction {
    /// Adds a recording.
    pub(super) fn add(&mut self, recording: ReducedRecording) -> Result<(), ReductionError> {
        self.require_another(&recording)?;
        self.recordings.push(recording);
        self.coarsen();
        Ok(())
    }

    /// Refuses a recording that is there already, or has another sample rate.
    fn require_another(&self, recording: &ReducedRecording) -> Result<(), ReductionError> {
        if let Some(same) = self.recordings.iter().find(|r| r.fingerprint == recording.fingerprint) {
            let (first, other) = (same.name.clone(), recording.name.clone());
            return Err(ReductionError::SameRecording { first, other });
        }
        if let Some(error) = self.recordings.iter().find_map(|first| first.overlap(recording)) {
            return Err(error);
        }
        if let Some(first) = self.recordings.first()
            && (recording.sample_rate_hz / first.sample_rate_hz - 1.0).abs() > RATE_TOLERANCE
        {
            return Err(unlike("the sample rate in Hz", &first.sample_rate_hz, &recording.sample_rate_hz));
        }
        Ok(())
    }

    /// Refuses another reduction that cannot be merged with this one.
    fn require_like(&self, other: &Self) -> Result<(), ReductionError> {
        self.identity.require_like(&other.identity)?;
        if self.instruments != other.instruments {
            let of = |r: &Self| match &r.instruments {
                None => "none".to_owned(),
                Some(theta) => format!("of parameters {theta:?}"),
            };
            return Err(unlike("the instruments", &of(self), &of(other)));
        }
        other.recordings.iter().try_for_each(|recording| self.require_another(recording))
    }

    /// Adds the recordings of another reduction. In whatever order reductions are merged, estimates agree to 1e-10.
    ///
    /// # Errors
    /// [`ReductionError`] where the two are not of one robot and one way of filtering, or share a recording.
    pub fn merge(mut self, other: Self) -> Result<Self, ReductionError> {
        self.require_like(&other)?;
        other.recordings.into_iter().try_for_each(|recording| self.add(recording))?;
        self.compared.extend(other.compared);
        self.compared.sort_by(|a, b| a.fingerprints.cmp(&b.fingerprints));
        self.recordings.sort_by(|a, b| a.fingerprint.cmp(&b.fingerprint));
        Ok(self)
    }

    /// Merges all.
    ///
    /// # Errors
    /// As [`Reduction::merge`], and where there is none.
    pub fn merge_all(reductions: impl IntoIterator<Item = Self>) -> Result<Self, ReductionError> {
        let mut reductions = reductions.into_iter();
        let first = reductions.next().ok_or(ReductionError::Nothing)?;
        reductions.try_fold(first, Self::merge)
    }

    /// Reads files and merges what they hold.
    ///
    /// # Errors
    /// As [`Reduction::read`] and [`Reduction::merge`]; where two files do not go together, both are named.
    pub fn read_all(paths: &[PathBuf]) -> Result<Self, ReductionError> {
        let all = paths.iter().map(|path| Self::read(path)).collect::<Result<Vec<_>, _>>()?;
        for (k, other) in all.iter().enumerate() {
            for (first, path) in all.iter().zip(paths).take(k) {
                let (first_path, other_path) = (path.clone(), paths[k].clone());
                first.require_like(other).map_err(|source| ReductionError::Apart {
                    first: first_path,
                    other: other_path,
                    source: Box::new(source),
                })?;
            }
        }
        Self::merge_all(all)
    }

    /// Keeps factors in the place of rows where all recordings have too many, and few segments of many recordings: how few
    /// follows from the number of recordings alone. Of many recordings the model's factors are those of whole ones, which are left out in
    /// turn. Samples are kept of all recordings or of none.
    fn coarsen(&mut self) {
        if !self.keeps_samples() {
            self.recordings.iter_mut().for_each(|recording| recording.samples_kept = None);
        }
        let of_row: usize = self.identity.acting.iter().map(|acting| self.matrices() * acting.len() + 1).sum();
        let are_many = of_row * self.recordings.iter().map(|r| r.rows).sum::<usize>() > MOST_NUMBERS;
        let most = most_segments(self.recordings.len());
        let left_out_whole = self.recordings.len() >= FEWEST_RECORDINGS;
        for recording in &mut self.recordings {
            if left_out_whole {
                recording.model.join_parts();
            }
            recording.model.coarsen(most);
            if are_many || matches!(recording.kept, KeptRows::Factors(_)) {
                recording.kept = KeptRows::Factors(coarsened(recording.kept.segments().into_owned(), most));
            }
        }
    }

    /// Whether each recording has its samples, and all together are few.
    fn keeps_samples(&self) -> bool {
        let numbers = |r: &ReducedRecording| r.samples_kept.as_deref().map(samples::numbers);
        let all: Option<usize> = self.recordings.iter().map(numbers).sum();
        all.is_some_and(|all| all <= samples::MOST_NUMBERS_KEPT)
    }

    /// X, and Z where there are instruments.
    pub(super) fn matrices(&self) -> usize {
        if self.instruments.is_some() { 2 } else { 1 }
    }
}

impl ReducedRecording {
    /// The error where another recording holds some of its samples.
    fn overlap(&self, other: &Self) -> Option<ReductionError> {
        let shift_s = self.marks.shift_from(&other.marks)? as f64 / self.sample_rate_hz;
        let start = self.window_s[0].max(other.window_s[0] + shift_s);
        let end = self.window_s[1].min(other.window_s[1] + shift_s);
        let span = |recording: &Self, earlier: f64| SharedSpan {
            recording: recording.name.clone(),
            file: recording.file.clone(),
            span_s: [start - earlier, end - earlier],
        };
        Some(ReductionError::Overlap { first: Box::new(span(self, 0.0)), other: Box::new(span(other, shift_s)) })
    }
}

/// Segments of each of so many recordings.
pub(super) fn most_segments(recordings: usize) -> usize {
    let mut most = MOST_SEGMENTS;
    while most > 1 && most * recordings > MOST_IN_ALL {
        most /= 2;
    }
    most
}
