use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    ReductionError,
    factors::{MOST_SEGMENTS, Segment, coarsened},
};
use crate::{
    preparation::{Mask, NamedMask},
    results::NearRestResult,
};

/// Part by which the sample rates of recordings may differ, as in an experiment with several.
const RATE_TOLERANCE: f64 = 0.01;
/// Segments of all recordings of a reduction: with more recordings, each keeps fewer.
const MOST_IN_ALL: usize = 256;

/// What must agree before reductions can be solved together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints, in the order of the factors.
    pub joints: Vec<String>,
    /// Names of all base parameters, in the order of the columns.
    pub parameters: Vec<String>,
    /// Their regrouping formulas, which hold the geometry.
    pub expressions: Vec<String>,
    /// The joints that are locked, with their values.
    #[serde(default)]
    pub locked: Vec<String>,
    /// For each joint the base parameters, from zero, that act on it.
    pub acting: Vec<Vec<usize>>,
    /// Order of the position filter.
    pub filter_order: usize,
    /// Its cut-off, Hz.
    pub cutoff_hz: f64,
    /// Every how many samples a row was kept.
    pub decimation: usize,
    /// How positions were differentiated; a file of form 1 does not say.
    #[serde(default = "not_stated")]
    pub derivative: String,
    /// Which samples near rest make no rows; a file of form 1 has rows of all.
    #[serde(default = "every_sample")]
    pub mask: String,
}

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

impl Identity {
    fn require_like(&self, other: &Self) -> Result<(), ReductionError> {
        let list = |list: &[String]| list.join(" ");
        let texts = [
            ("the list of joints", list(&self.joints), list(&other.joints)),
            ("the locked joints", list(&self.locked), list(&other.locked)),
            ("the list of base parameters", list(&self.parameters), list(&other.parameters)),
            ("the position filter's order", self.filter_order.to_string(), other.filter_order.to_string()),
            ("the position filter's cut-off in Hz", self.cutoff_hz.to_string(), other.cutoff_hz.to_string()),
            ("the decimation", self.decimation.to_string(), other.decimation.to_string()),
            ("the derivative", self.derivative.clone(), other.derivative.clone()),
            ("the mask near rest", self.mask.clone(), other.mask.clone()),
        ];
        if let Some((what, first, other)) = texts.into_iter().find(|(_, first, other)| first != other) {
            return Err(ReductionError::Unlike { what, first, other });
        }
        match self.expressions.iter().zip(&other.expressions).find(|(a, b)| a != b) {
            Some((first, other)) => Err(unlike("a base parameter's formula (the robot's geometry)", first, other)),
            None if self.acting != other.acting => {
                Err(unlike("which parameters act on which joint", &"one", &"another"))
            }
            None => Ok(()),
        }
    }
}

fn not_stated() -> String {
    "not stated".to_owned()
}

fn every_sample() -> String {
    Mask::Named(NamedMask::None).to_string()
}

fn unlike(what: &'static str, first: &dyn ToString, other: &dyn ToString) -> ReductionError {
    ReductionError::Unlike { what, first: first.to_string(), other: other.to_string() }
}
