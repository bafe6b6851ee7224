use std::path::PathBuf;

use super::{
    ReductionError,
    factors::{MOST_SEGMENTS, Segment, coarsened},
    identity::{Identity, unlike},
};
use thetahat_report::results::NearRestResult;

/// Part by which the sample rates of recordings may differ, as in an experiment with several.
const RATE_TOLERANCE: f64 = 0.01;
/// Segments of all recordings of a reduction: with more recordings, each keeps fewer.
const MOST_IN_ALL: usize = 256;

/// Recordings as far as least squares need them: the triangular factors of their rows, and what must be known to solve.
///
/// Its size does not depend on the length of the recordings.
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
}

/// One recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedRecording {
    /// Its name, or its number.
    pub name: String,
    /// Weight of its rows.
    pub weight: f64,
    /// By which it is known again: of the positions and torques in the window, 16 hexadecimal digits.
    pub fingerprint: String,
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
    /// Samples near rest that make no rows; none where all make rows.
    pub near_rest: Option<NearRestResult>,
    /// True base parameters, for a twin.
    pub truth: Option<Vec<f64>>,
    /// Its stretches of time, one after the other.
    pub segments: Vec<Segment>,
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

    /// Keeps the segments of many recordings few: how few follows from the number of recordings alone.
    fn coarsen(&mut self) {
        let mut most = MOST_SEGMENTS;
        while most > 1 && most * self.recordings.len() > MOST_IN_ALL {
            most /= 2;
        }
        for recording in &mut self.recordings {
            recording.segments = coarsened(std::mem::take(&mut recording.segments), most);
        }
    }
}
