//! The file of a reduction: a line that names its form, a line of JSON, numbers as doubles in little-endian order, and a
//! checksum. The numbers are of each recording the rows of each joint, row by row, with the parts of them that a mask leaves;
//! or where they were too many of each segment the counted rows and the upper triangles of the factors of all joints; then the
//! samples of each signal, where they are kept.
//!
//! Forms 1 and 2 had neither findings of the checks nor marks of samples, form 3 had no samples, form 4 nothing of the
//! model.

use std::{
    io::{self, Read},
    path::Path,
};

use serde::{Deserialize, Serialize};

use super::{
    Identity, JointRows, KeptRows, ReducedRecording, Reduction, ReductionError, Segment,
    factors::MOST_SEGMENTS,
    fingerprint::scrambled,
    overlap::Marks,
    samples::{self, SamplesHeader},
    value::{ComparedRecordings, RecordingFolds},
};
use crate::{
    preparation::Recording,
    run::{FOLDS, ModelCell, ModelFactors, Parts, RepeatedRows, STRETCHES, SettledRows, span},
};
use thetahat_estimation::checks::Finding;
use thetahat_ground::{files, linear_algebra::Matrix, output::replace_file};
use thetahat_report::results::NearRestResult;

const MAGIC: &[u8] = b"thetahat reduction ";
/// The form that is written and read.
const FORM: u32 = 5;
const CHECKSUM: usize = 8;

#[derive(Serialize, Deserialize)]
struct Header {
    identity: Identity,
    experiment_name: String,
    experiment_description: String,
    robot_description: String,
    instruments: Option<Vec<f64>>,
    recordings: Vec<RecordingHeader>,
    compared: Vec<ComparedRecordings>,
}

/// How the rows of a recording stand in the file.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum KeptHeader {
    All {
        rows: usize,
        is_masked: bool,
    },
    /// With the rows of each joint in each segment.
    Factors {
        segment_rows: Vec<usize>,
    },
}

#[derive(Serialize, Deserialize)]
struct RecordingHeader {
    name: String,
    file: String,
    weight: f64,
    fingerprint: String,
    marks: Marks,
    samples: usize,
    sample_rate_hz: f64,
    window_s: [f64; 2],
    torque_hold_s: f64,
    near_rest: Option<NearRestResult>,
    truth: Option<Vec<f64>>,
    findings: Vec<Finding>,
    examined_parts: usize,
    folds: Option<RecordingFolds>,
    kept: KeptHeader,
    model: ModelHeader,
    samples_kept: Option<SamplesHeader>,
}

/// How what the model is chosen from stands in the file.
#[derive(Serialize, Deserialize)]
struct ModelHeader {
    rows: usize,
    span: usize,
    mean_position: Vec<f64>,
    squared_velocities: Vec<Vec<f64>>,
    cells: Vec<CellHeader>,
    settled: Vec<SettledHeader>,
    repeated: Option<RepeatedHeader>,
}

#[derive(Serialize, Deserialize)]
struct RepeatedHeader {
    period: f64,
    pairs: f64,
}

#[derive(Serialize, Deserialize)]
struct SettledHeader {
    joint: usize,
    stretch: usize,
    transitions: usize,
    rows: usize,
}

#[derive(Serialize, Deserialize)]
struct CellHeader {
    joint: usize,
    parts: Parts,
    is_near_rest: bool,
    rows: usize,
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
            file: r.file.clone(),
            weight: r.weight,
            fingerprint: r.fingerprint.clone(),
            marks: r.marks.clone(),
            samples: r.samples,
            sample_rate_hz: r.sample_rate_hz,
            window_s: r.window_s,
            torque_hold_s: r.torque_hold_s,
            near_rest: r.near_rest.clone(),
            truth: r.truth.clone(),
            findings: r.findings.clone(),
            examined_parts: r.examined_parts,
            folds: r.folds.clone(),
            kept: KeptHeader::of(&r.kept),
            model: ModelHeader::of(&r.model),
            samples_kept: r.samples_kept.as_deref().map(SamplesHeader::of),
        };
        let header = Header {
            identity: self.identity.clone(),
            experiment_name: self.experiment_name.clone(),
            experiment_description: self.experiment_description.clone(),
            robot_description: self.robot_description.clone(),
            instruments: self.instruments.clone(),
            recordings: self.recordings.iter().map(recording).collect(),
            compared: self.compared.clone(),
        };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(format!("{FORM}\n").bytes());
        serde_json::to_writer(&mut bytes, &header)?;
        bytes.push(b'\n');
        let mut write = |value: f64| bytes.extend(value.to_le_bytes());
        for recording in &self.recordings {
            recording.kept.write(&mut write);
            write_model(&recording.model, &mut write);
            recording.samples_kept.iter().for_each(|samples| samples::write(samples, &mut write));
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
        if form != FORM.to_string().as_bytes() {
            let found = String::from_utf8_lossy(&form[..form.len().min(20)]).into_owned();
            return Err(ReductionError::Version { path: path.to_owned(), found, form: FORM });
        }
        let Some((content, sum)) = bytes.split_last_chunk::<CHECKSUM>() else { return Err(damaged("it is cut short")) };
        if checksum(content) != u64::from_le_bytes(*sum) {
            return Err(damaged("its checksum is not that of its content"));
        }
        let (header, rest) = line(rest).ok_or_else(|| damaged("it ends in its description"))?;
        let header: Header = serde_json::from_slice(header).map_err(|e| damaged(&e.to_string()))?;
        header.identity.check().ok_or_else(|| damaged("its description contradicts itself"))?;
        let values = &rest[..rest.len() - CHECKSUM];
        header.with_values(values).ok_or_else(|| damaged("it holds more or fewer values than it says"))
    }
}

impl Identity {
    /// Lists of matching lengths, and columns in order.
    fn check(&self) -> Option<()> {
        let parameters = self.parameters.len();
        let columns = |acting: &Vec<usize>| acting.is_sorted_by(|a, b| a < b) && acting.iter().all(|c| *c < parameters);
        let fits = self.acting.len() == self.joints.len() && self.expressions.len() == parameters;
        let fits = fits && columns(&self.changing) && !self.transitions.is_empty();
        let fits = fits && [0, self.transitions.len()].contains(&self.sliding_transitions.len());
        (fits && !self.joints.is_empty() && self.acting.iter().all(columns)).then_some(())
    }
}

impl Header {
    /// The reduction, if there are as many values as it says.
    fn with_values(self, bytes: &[u8]) -> Option<Reduction> {
        let parameters = self.identity.parameters.len();
        if self.instruments.as_ref().is_some_and(|theta| theta.len() != parameters) {
            return None;
        }
        let matrices = if self.instruments.is_some() { 2 } else { 1 };
        let columns: Vec<usize> = self.identity.acting.iter().map(|acting| matrices * acting.len() + 1).collect();
        let joints = columns.len();
        let of_model = self.identity.model_columns();
        let model_columns: Vec<usize> = (0..joints).map(|joint| of_model.count(joint)).collect();
        let values = |r: &RecordingHeader| {
            let samples = r.samples_kept.as_ref().map_or(Some(0), |samples| samples.values(joints));
            let model = r.model.values(&model_columns)?;
            r.kept.values(&columns)?.checked_add(model)?.checked_add(samples?)
        };
        let needed = total_of(self.recordings.iter().map(values))?;
        if bytes.len() != needed.checked_mul(8)? || !self.recordings.iter().all(RecordingHeader::has_folds_of_its_rows)
        {
            return None;
        }
        let mut values = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
        let mut next = || values.next().unwrap_or(0.0);
        let recordings = self.recordings.into_iter().map(|r| ReducedRecording {
            rows: r.kept.rows().unwrap_or_default(),
            kept: r.kept.read(&columns, &mut next),
            model: r.model.read(&model_columns, &mut next),
            samples_kept: r.samples_kept.map(|samples| {
                let recording = samples.read(joints, &mut next);
                let (name, weight, torque_hold_s) = (r.name.clone(), r.weight, r.torque_hold_s);
                Box::new(Recording { name, weight, torque_hold_s, ..recording })
            }),
            name: r.name,
            file: r.file,
            weight: r.weight,
            fingerprint: r.fingerprint,
            marks: r.marks,
            samples: r.samples,
            sample_rate_hz: r.sample_rate_hz,
            window_s: r.window_s,
            torque_hold_s: r.torque_hold_s,
            near_rest: r.near_rest,
            truth: r.truth,
            findings: r.findings,
            examined_parts: r.examined_parts,
            folds: r.folds,
        });
        Some(Reduction {
            recordings: recordings.collect(),
            identity: self.identity,
            experiment_name: self.experiment_name,
            experiment_description: self.experiment_description,
            robot_description: self.robot_description,
            instruments: self.instruments,
            compared: self.compared,
        })
    }
}

impl RecordingHeader {
    /// Whether its folds, where it has any, are one for each row and have names.
    fn has_folds_of_its_rows(&self) -> bool {
        let fits = |folds: &RecordingFolds| {
            Some(folds.of_row.len()) == self.kept.rows() && folds.of_row.iter().all(|fold| *fold < folds.names.len())
        };
        self.folds.as_ref().is_none_or(fits)
    }
}

/// Rows of a factor of so many rows: no more than its columns.
fn rows_of_factor(rows: usize, columns: usize) -> usize {
    rows.min(columns)
}

fn write_model(model: &ModelFactors, write: &mut impl FnMut(f64)) {
    let mut factor = |factor: &Matrix| {
        upper(factor.rows(), factor.columns()).for_each(|(i, j)| write(factor.at(i, j)));
    };
    model.cells.iter().for_each(|cell| factor(&cell.factor));
    model.moving_sums.iter().for_each(&mut factor);
    model.settled.iter().for_each(|rows| factor(&rows.factor));
    model.repeated.iter().flat_map(|repeated| &repeated.factors).for_each(&mut factor);
    model.sums.iter().flatten().for_each(|sum| write(*sum));
}

impl ModelHeader {
    fn of(model: &ModelFactors) -> Self {
        let cell = |cell: &ModelCell| CellHeader {
            joint: cell.joint,
            parts: cell.parts,
            is_near_rest: cell.is_near_rest,
            rows: cell.rows,
        };
        let settled = |rows: &SettledRows| SettledHeader {
            joint: rows.joint,
            stretch: rows.stretch,
            transitions: rows.transitions,
            rows: rows.rows,
        };
        Self {
            rows: model.rows,
            span: model.span,
            mean_position: model.mean_position.clone(),
            squared_velocities: model.squared_velocities.clone(),
            cells: model.cells.iter().map(cell).collect(),
            settled: model.settled.iter().map(settled).collect(),
            repeated: model.repeated.as_ref().map(|r| RepeatedHeader { period: r.period, pairs: r.pairs }),
        }
    }

    /// Rows of the factor of moving sums over so many columns and ones.
    fn moving(&self, columns: usize) -> usize {
        rows_of_factor(self.rows.saturating_add(self.span - 1), columns + 1)
    }

    /// How many values stand in the file, of joints with so many columns; none if it contradicts itself.
    fn values(&self, columns: &[usize]) -> Option<usize> {
        let joints = columns.len();
        let is_of_joints = self.mean_position.len() == joints && self.squared_velocities.len() == joints;
        let has_parts = self.squared_velocities.iter().all(|of| of.len() == STRETCHES.len() * FOLDS);
        let is_part = |part: &Option<u8>| part.is_none_or(|part| usize::from(part) < FOLDS);
        let is_cell = |cell: &CellHeader| cell.joint < joints && cell.parts.iter().all(is_part);
        let is_settled =
            |rows: &SettledHeader| rows.joint < joints && rows.stretch < MOST_SEGMENTS && rows.rows <= self.rows;
        let rows_of =
            |joint: usize| total_of(self.cells.iter().filter(|cell| cell.joint == joint).map(|cell| Some(cell.rows)));
        let has_all_rows = (0..joints).all(|joint| rows_of(joint) == Some(self.rows));
        let are_valid = self.cells.iter().all(is_cell) && self.settled.iter().all(is_settled);
        if !is_of_joints || !has_parts || !are_valid || !has_all_rows || self.span != span(self.rows) {
            return None;
        }
        let of_rows =
            |joint: usize, rows: usize| Some(upper_count(rows_of_factor(rows, columns[joint]), columns[joint]));
        let of_cells = self.cells.iter().map(|cell| of_rows(cell.joint, cell.rows));
        let of_settled = self.settled.iter().map(|settled| of_rows(settled.joint, settled.rows));
        let of_joint = |n: &usize| upper_count(self.moving(*n), n + 1).checked_add(*n);
        let of_phases = |(repeated, n): (&RepeatedHeader, &usize)| {
            Some(upper_count(rows_of_factor(RepeatedRows::phases(repeated.period), *n), *n))
        };
        let of_repeated = self.repeated.iter().flat_map(|repeated| columns.iter().map(move |n| (repeated, n)));
        let of_all = of_cells.chain(columns.iter().map(of_joint)).chain(of_settled);
        total_of(of_all.chain(of_repeated.map(of_phases)))
    }

    fn read(self, columns: &[usize], next: &mut impl FnMut() -> f64) -> ModelFactors {
        let mut factor = |rows: usize, n: usize| matrix((rows, n), upper(rows, n), next);
        let cell = |cell: &CellHeader| {
            let n = columns[cell.joint];
            ModelCell {
                joint: cell.joint,
                parts: cell.parts,
                is_near_rest: cell.is_near_rest,
                rows: cell.rows,
                factor: factor(rows_of_factor(cell.rows, n), n),
            }
        };
        let cells = self.cells.iter().map(cell).collect();
        let moving_sums = columns.iter().map(|n| factor(self.moving(*n), n + 1)).collect();
        let settled = |rows: &SettledHeader| {
            let n = columns[rows.joint];
            SettledRows {
                joint: rows.joint,
                stretch: rows.stretch,
                transitions: rows.transitions,
                rows: rows.rows,
                factor: factor(rows_of_factor(rows.rows, n), n),
            }
        };
        let settled = self.settled.iter().map(settled).collect();
        let repeated = self.repeated.map(|RepeatedHeader { period, pairs }| {
            let phases = RepeatedRows::phases(period);
            let factors = columns.iter().map(|n| factor(rows_of_factor(phases, *n), *n)).collect();
            RepeatedRows { period, pairs, factors }
        });
        let sums = columns.iter().map(|n| (0..*n).map(|_| next()).collect()).collect();
        let Self { rows, span, mean_position, squared_velocities, .. } = self;
        ModelFactors { rows, mean_position, squared_velocities, cells, sums, span, moving_sums, settled, repeated }
    }
}

impl KeptRows {
    fn write(&self, write: &mut impl FnMut(f64)) {
        match self {
            Self::All(JointRows { rows, shares }) => {
                rows.iter()
                    .for_each(|matrix| all(matrix.rows(), matrix.columns()).for_each(|(i, j)| write(matrix.at(i, j))));
                shares.iter().flatten().flatten().for_each(|share| write(*share));
            }
            Self::Factors(segments) => {
                for segment in segments {
                    segment.counted.iter().for_each(|counted| write(*counted));
                    for factor in &segment.factors {
                        upper(factor.rows(), factor.columns()).for_each(|(i, j)| write(factor.at(i, j)));
                    }
                }
            }
        }
    }
}

impl KeptHeader {
    fn of(kept: &KeptRows) -> Self {
        match kept {
            KeptRows::All(JointRows { rows, shares }) => {
                Self::All { rows: rows.first().map_or(0, Matrix::rows), is_masked: shares.is_some() }
            }
            KeptRows::Factors(segments) => Self::Factors { segment_rows: segments.iter().map(|s| s.rows).collect() },
        }
    }

    /// Rows of each joint; none if they are more than can be counted.
    fn rows(&self) -> Option<usize> {
        match self {
            Self::All { rows, .. } => Some(*rows),
            Self::Factors { segment_rows } => total_of(segment_rows.iter().map(|rows| Some(*rows))),
        }
    }

    /// How many values stand in the file, of joints with so many columns.
    fn values(&self, columns: &[usize]) -> Option<usize> {
        match self {
            Self::All { rows, is_masked } => {
                let of_joint = |n: &usize| rows.checked_mul(n + usize::from(*is_masked));
                total_of(columns.iter().map(of_joint))
            }
            Self::Factors { segment_rows } => {
                self.rows()?;
                let of_joints = |rows: usize| columns.iter().map(move |&n| Some(upper_count(rows.min(n), n)));
                let of_segment = |rows: &usize| total_of(of_joints(*rows).chain([Some(columns.len())]));
                total_of(segment_rows.iter().map(of_segment))
            }
        }
    }

    fn read(&self, columns: &[usize], next: &mut impl FnMut() -> f64) -> KeptRows {
        match self {
            Self::All { rows, is_masked } => {
                let matrices = columns.iter().map(|n| matrix((*rows, *n), all(*rows, *n), next)).collect();
                let mut of_joint = || (0..*rows).map(|_| next()).collect::<Vec<f64>>();
                let shares = is_masked.then(|| columns.iter().map(|_| of_joint()).collect());
                KeptRows::All(JointRows { rows: matrices, shares })
            }
            Self::Factors { segment_rows } => {
                let mut segment = |rows: &usize| Segment {
                    rows: *rows,
                    counted: columns.iter().map(|_| next()).collect(),
                    factors: columns
                        .iter()
                        .map(|n| matrix(((*rows).min(*n), *n), upper((*rows).min(*n), *n), next))
                        .collect(),
                };
                KeptRows::Factors(segment_rows.iter().map(&mut segment).collect())
            }
        }
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

/// The bytes up to a line's end, and those after it.
fn line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = memchr::memchr(b'\n', bytes)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// The places of the upper triangle, row by row.
fn upper(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows).flat_map(move |i| (i..columns).map(move |j| (i, j)))
}

/// All places, row by row.
fn all(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)))
}

/// A matrix of a size with values one by one at given places, else zeros.
fn matrix(
    (rows, columns): (usize, usize),
    places: impl Iterator<Item = (usize, usize)>,
    next: &mut impl FnMut() -> f64,
) -> Matrix {
    let mut matrix = Matrix::zeros(rows, columns);
    places.for_each(|(i, j)| *matrix.at_mut(i, j) = next());
    matrix
}

/// The sum of counts; none if one is none, or they are more than can be counted.
fn total_of(counts: impl IntoIterator<Item = Option<usize>>) -> Option<usize> {
    counts.into_iter().try_fold(0_usize, |sum, count| sum.checked_add(count?))
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
