//! The file of a reduction: a line that names its form, a line of JSON, of each segment the counted rows and the upper
//! triangles of the factors of all joints as doubles in little-endian order, and a checksum.
//!
//! Form 1 has no counted rows: there every sample makes rows.

use std::{
    io::{self, Read},
    path::Path,
};

use serde::{Deserialize, Serialize};

use super::{Identity, ReducedRecording, Reduction, ReductionError, Segment, fingerprint::scrambled};
use thetahat_ground::{files, linear_algebra::Matrix, output::replace_file};
use thetahat_report::results::NearRestResult;

const MAGIC: &[u8] = b"thetahat reduction ";
/// The form that is written.
const FORM: u32 = 2;
/// The form without counted rows, which is read as well.
const UNCOUNTED: u32 = 1;
const CHECKSUM: usize = 8;

#[derive(Serialize, Deserialize)]
struct Header {
    identity: Identity,
    experiment_name: String,
    experiment_description: String,
    robot_description: String,
    instruments: Option<Vec<f64>>,
    recordings: Vec<RecordingHeader>,
}

#[derive(Serialize, Deserialize)]
struct RecordingHeader {
    name: String,
    weight: f64,
    fingerprint: String,
    samples: usize,
    sample_rate_hz: f64,
    window_s: [f64; 2],
    #[serde(default)]
    torque_hold_s: f64,
    #[serde(default)]
    near_rest: Option<NearRestResult>,
    truth: Option<Vec<f64>>,
    /// Rows of each joint in each segment.
    segment_rows: Vec<usize>,
}

impl Reduction {
    /// Writes a file, whole or not at all.
    ///
    /// # Errors
    /// [`ReductionError::Unwritable`].
    pub fn write(&self, path: &Path) -> Result<(), ReductionError> {
        let refuse = |source| ReductionError::Unwritable { path: path.to_owned(), source };
        let bytes = self.to_bytes().map_err(|e| refuse(e.into()))?;
        replace_file(path, &bytes).map_err(refuse)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ReductionError`] for a file that is damaged or of another form.
    pub fn read(path: &Path) -> Result<Self, ReductionError> {
        let bytes = content(path).map_err(|source| ReductionError::Unreadable { path: path.to_owned(), source })?;
        Self::from_bytes(&bytes, path)
    }

    /// The content of its file.
    ///
    /// # Errors
    /// None for a reduction that was made or read: its description is written as JSON.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let recording = |r: &ReducedRecording| RecordingHeader {
            name: r.name.clone(),
            weight: r.weight,
            fingerprint: r.fingerprint.clone(),
            samples: r.samples,
            sample_rate_hz: r.sample_rate_hz,
            window_s: r.window_s,
            torque_hold_s: r.torque_hold_s,
            near_rest: r.near_rest.clone(),
            truth: r.truth.clone(),
            segment_rows: r.segments.iter().map(|s| s.rows).collect(),
        };
        let header = Header {
            identity: self.identity.clone(),
            experiment_name: self.experiment_name.clone(),
            experiment_description: self.experiment_description.clone(),
            robot_description: self.robot_description.clone(),
            instruments: self.instruments.clone(),
            recordings: self.recordings.iter().map(recording).collect(),
        };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(format!("{FORM}\n").bytes());
        serde_json::to_writer(&mut bytes, &header)?;
        bytes.push(b'\n');
        for segment in self.recordings.iter().flat_map(|r| &r.segments) {
            segment.counted.iter().for_each(|counted| bytes.extend(counted.to_le_bytes()));
            for factor in &segment.factors {
                upper(factor.rows(), factor.columns()).for_each(|(i, j)| bytes.extend(factor.at(i, j).to_le_bytes()));
            }
        }
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// The reduction of a file's content; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Reduction::read`].
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, ReductionError> {
        let damaged = |reason: &str| ReductionError::Damaged { path: path.to_owned(), reason: reason.to_owned() };
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| damaged("it does not begin as one does"))?;
        let (form, rest) = line(rest).ok_or_else(|| damaged("it ends in its first line"))?;
        let Some(form) = [FORM, UNCOUNTED].into_iter().find(|known| form == known.to_string().as_bytes()) else {
            let found = String::from_utf8_lossy(&form[..form.len().min(20)]).into_owned();
            return Err(ReductionError::Version { path: path.to_owned(), found, newest: FORM });
        };
        let Some((content, sum)) = bytes.split_last_chunk::<CHECKSUM>() else { return Err(damaged("it is cut short")) };
        if checksum(content) != u64::from_le_bytes(*sum) {
            return Err(damaged("its checksum is not that of its content"));
        }
        let (header, rest) = line(rest).ok_or_else(|| damaged("it ends in its description"))?;
        let header: Header = serde_json::from_slice(header).map_err(|e| damaged(&e.to_string()))?;
        header.identity.check().ok_or_else(|| damaged("its description contradicts itself"))?;
        let values = &rest[..rest.len() - CHECKSUM];
        header
            .with_values(values, form != UNCOUNTED)
            .ok_or_else(|| damaged("it holds more or fewer values than it says"))
    }
}

impl Identity {
    /// Lists of matching lengths, and columns in order.
    fn check(&self) -> Option<()> {
        let parameters = self.parameters.len();
        let columns = |acting: &Vec<usize>| acting.is_sorted_by(|a, b| a < b) && acting.iter().all(|c| *c < parameters);
        let fits = self.acting.len() == self.joints.len() && self.expressions.len() == parameters;
        (fits && !self.joints.is_empty() && self.acting.iter().all(columns)).then_some(())
    }
}

impl Header {
    /// The reduction, if there are as many values as it says.
    fn with_values(self, bytes: &[u8], is_counted: bool) -> Option<Reduction> {
        let parameters = self.identity.parameters.len();
        if self.instruments.as_ref().is_some_and(|theta| theta.len() != parameters) {
            return None;
        }
        let matrices = if self.instruments.is_some() { 2 } else { 1 };
        let sizes: Vec<usize> = self.identity.acting.iter().map(|acting| matrices * acting.len() + 1).collect();
        let counts = if is_counted { sizes.len() } else { 0 };
        let of_segment = |rows: &usize| total(sizes.iter().map(|&n| upper_count((*rows).min(n), n)).chain([counts]));
        let segments = self.recordings.iter().flat_map(|r| &r.segment_rows);
        let needed = segments.map(of_segment).try_fold(0_usize, |sum, count| sum.checked_add(count?))?;
        if bytes.len() != needed.checked_mul(8)? || self.recordings.iter().any(|r| total_rows(r).is_none()) {
            return None;
        }
        let mut values = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
        let mut next = || values.next().unwrap_or(0.0);
        let mut segment = |rows: usize| Segment {
            rows,
            counted: sizes.iter().map(|_| if is_counted { next() } else { rows as f64 }).collect(),
            factors: sizes.iter().map(|columns| triangle(rows, *columns, &mut next)).collect(),
        };
        let recordings = self.recordings.into_iter().map(|r| ReducedRecording {
            rows: total_rows(&r).unwrap_or_default(),
            segments: r.segment_rows.iter().map(|rows| segment(*rows)).collect(),
            name: r.name,
            weight: r.weight,
            fingerprint: r.fingerprint,
            samples: r.samples,
            sample_rate_hz: r.sample_rate_hz,
            window_s: r.window_s,
            torque_hold_s: r.torque_hold_s,
            near_rest: r.near_rest,
            truth: r.truth,
        });
        Some(Reduction {
            recordings: recordings.collect(),
            identity: self.identity,
            experiment_name: self.experiment_name,
            experiment_description: self.experiment_description,
            robot_description: self.robot_description,
            instruments: self.instruments,
        })
    }
}

/// The bytes of a file, of one that is not a reduction the first ones; folders and devices are refused.
fn content(path: &Path) -> io::Result<Vec<u8>> {
    files::length(path)?;
    let (mut file, mut bytes) = (files::open(path)?, Vec::new());
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut bytes)?;
    if bytes == MAGIC {
        file.read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// The bytes up to a line's end, and those behind it.
fn line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = memchr::memchr(b'\n', bytes)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// The places of the upper triangle, row by row.
fn upper(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows).flat_map(move |i| (i..columns).map(move |j| (i, j)))
}

/// The upper triangle of so many rows, or of as many as columns, of values one by one.
fn triangle(rows: usize, columns: usize, next: &mut impl FnMut() -> f64) -> Matrix {
    let mut triangle = Matrix::zeros(rows.min(columns), columns);
    upper(rows.min(columns), columns).for_each(|(i, j)| *triangle.at_mut(i, j) = next());
    triangle
}

fn total_rows(recording: &RecordingHeader) -> Option<usize> {
    total(recording.segment_rows.iter().copied())
}

fn total(counts: impl IntoIterator<Item = usize>) -> Option<usize> {
    counts.into_iter().try_fold(0_usize, usize::checked_add)
}

fn upper_count(rows: usize, columns: usize) -> usize {
    rows * columns - rows * rows.saturating_sub(1) / 2
}

fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    let add = |sum: u64, word: &[u8; 8]| scrambled(sum.rotate_left(5) ^ u64::from_le_bytes(*word));
    words.iter().chain([&last]).fold(bytes.len() as u64, add)
}
