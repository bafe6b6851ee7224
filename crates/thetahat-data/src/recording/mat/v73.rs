//! Variables of MAT files of version 7.3: HDF5 files in which MATLAB stores the class of each data set, with dimensions in reverse order,
//! so that a matrix of n samples of 7 channels is a data set of 7 x n, channel by channel. Other HDF5 files, as h5py writes them, are read
//! with a sample in each row.

use std::collections::HashMap;
use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, File, Group, Object};

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::table::{Column, RequestedColumns};
use super::kinds::{MOST_CELLS, NOT_VECTORS, kind_of_object, of_cells};
use super::shape::samples_and_channels;
use super::soft_links;

/// Deepest nesting of structures.
const DEEPEST_STRUCTURE: usize = 8;
/// Most variables and structures of one file. Groups may contain themselves, so that a limit of depth alone does not end a walk.
const MOST_OBJECTS: usize = 1 << 14;
/// Sides beyond which a matrix is no recording: compressed images, a row each, are such.
const LARGEST_SIDES: [usize; 2] = [100, 10_000];

/// The program whose conventions a file follows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Convention {
    /// Dimensions in reverse order, a class for each variable, fields of structures as `log.q`.
    Matlab,
    /// A sample in each row, data sets in groups as `log/q`.
    Hdf5,
}

impl Convention {
    fn separator(self) -> char {
        match self {
            Self::Matlab => '.',
            Self::Hdf5 => '/',
        }
    }
}

/// The variables of a file. Variables that are not requested have a name and no values.
pub(super) fn read(
    mut bytes: Vec<u8>,
    path: &Path,
    convention: Convention,
    wanted: RequestedColumns<'_>,
) -> Result<Vec<Column>, RecordingError> {
    panics_as_damage(path, "HDF5", || {
        let budget = Budget::of(path, bytes.len() as u64);
        let mut reader = Reader { path, convention, wanted, budget, objects: 0, columns: Vec::new() };
        let length = bytes.len() as u64;
        soft_links::take_out(&mut bytes);
        let file = File::from_bytes(bytes).map_err(|e| reader.damaged("file", &e))?;
        let expected = file.superblock().eof_address;
        if length < expected {
            return Err(RecordingError::damaged(path, format!("expected {expected} bytes, found {length}")));
        }
        reader.add_group("", &file.root(), 0)?;
        Ok(reader.columns)
    })
}

struct Reader<'a> {
    path: &'a Path,
    convention: Convention,
    wanted: RequestedColumns<'a>,
    budget: Budget,
    objects: usize,
    columns: Vec<Column>,
}

impl Reader<'_> {
    fn damaged(&self, what: &str, error: &hdf5_pure::Error) -> RecordingError {
        RecordingError::damaged(self.path, format!("HDF5 {what}: {error}"))
    }

    /// Whether a group or data set is not one of MATLAB's own, whose names begin with `#`.
    fn is_variable(&self, name: &str) -> bool {
        self.convention == Convention::Hdf5 || !name.starts_with('#')
    }

    /// Adds the variables of a group: of the file, or the fields of a structure.
    fn add_group(&mut self, prefix: &str, group: &Group, depth: usize) -> Result<(), RecordingError> {
        for name in group.datasets().map_err(|e| self.damaged("group", &e))? {
            if self.is_variable(&name) {
                self.count_object()?;
                let set = group.dataset(&name).map_err(|e| self.damaged(&name, &e))?;
                let name = format!("{prefix}{name}");
                let column = match self.column(name.clone(), &set) {
                    Err(RecordingError::Damaged { reason, .. }) if self.convention == Convention::Hdf5 => {
                        Column::of_kind(name, format!("a data set that cannot be read ({reason})"))
                    }
                    column => column?,
                };
                self.columns.push(column);
            }
        }
        for name in group.groups().map_err(|e| self.damaged("group", &e))? {
            if self.is_variable(&name) && depth < DEEPEST_STRUCTURE {
                self.count_object()?;
                let inner = group.group(&name).map_err(|e| self.damaged(&name, &e))?;
                self.add_inner(format!("{prefix}{name}"), &inner, depth + 1)?;
            }
        }
        Ok(())
    }

    /// A group is a structure, or otherwise a sparse matrix.
    fn add_inner(&mut self, name: String, group: &Group, depth: usize) -> Result<(), RecordingError> {
        let attributes = group.attrs().map_err(|e| self.damaged(&name, &e))?;
        if attributes.contains_key("MATLAB_sparse") {
            self.columns.push(Column::of_kind(name, "a sparse matrix"));
            return Ok(());
        }
        self.add_group(&format!("{name}{}", self.convention.separator()), group, depth)
    }

    fn count_object(&mut self) -> Result<(), RecordingError> {
        self.objects += 1;
        if self.objects <= MOST_OBJECTS {
            return Ok(());
        }
        let reason = format!("it has more than {MOST_OBJECTS} variables and structures");
        Err(RecordingError::damaged(self.path, reason))
    }

    fn column(&mut self, name: String, set: &Dataset) -> Result<Column, RecordingError> {
        let kind = set.dtype().map_err(|e| self.damaged(&name, &e))?;
        if self.convention == Convention::Hdf5 {
            return self.data_set(name, set, &kind);
        }
        let attributes = set.attrs().map_err(|e| self.damaged(&name, &e))?;
        if is_cell(&attributes, &kind) {
            return self.cell(name, set);
        }
        if let Some(kind) = kind_not_read(&attributes, &kind) {
            return Ok(Column::of_kind(name, kind));
        }
        if attributes.contains_key("MATLAB_empty") {
            return Ok(Column::of_numbers(name, 1, Vec::new()));
        }
        let shape = self.shape(&name, set)?;
        let Some((samples, channels)) = samples_and_channels(&shape) else {
            return Ok(Column::of_kind(name, format!("an array of {} dimensions", shape.len())));
        };
        if !self.wanted.includes(&name) {
            return Ok(Column::of_numbers(name, 0, Vec::new()));
        }
        let values = self.values(&name, set, samples, channels)?;
        Ok(Column::of_numbers(name, channels, values))
    }

    /// The values of a data set in the order of the file, with their number checked before memory is reserved.
    fn values(
        &mut self,
        name: &str,
        set: &Dataset,
        samples: usize,
        channels: usize,
    ) -> Result<Vec<f64>, RecordingError> {
        self.check_chunks(name, set)?;
        let count = self.budget.take(&format!("variable {name:?}"), &[samples, channels])?;
        let values = set.read_f64().map_err(|e| self.damaged(name, &e))?;
        if values.len() != count {
            let reason = format!("variable {name:?} has the size of {count} values and holds {}", values.len());
            return Err(RecordingError::damaged(self.path, reason));
        }
        Ok(values)
    }

    /// A data set of a file that MATLAB did not write: a sample in each row.
    fn data_set(&mut self, name: String, set: &Dataset, kind: &DType) -> Result<Column, RecordingError> {
        if let Some(kind) = kind_of_other_values(kind) {
            return Ok(Column::of_kind(name, kind));
        }
        let mut shape = self.shape(&name, set)?;
        shape.reverse();
        let (samples, channels) = match shape[..] {
            [] => (1, 1),
            [samples] | [1, samples] => (samples, 1),
            [samples, channels] => (samples, channels),
            _ => return Ok(Column::of_kind(name, format!("an array of {} dimensions", shape.len()))),
        };
        if samples > LARGEST_SIDES[0] && channels > LARGEST_SIDES[1] {
            return Ok(Column::of_kind(name, format!("a matrix of {samples} x {channels} values, as of images")));
        }
        if !self.wanted.includes(&name) {
            return Ok(Column::of_numbers(name, 0, Vec::new()));
        }
        let values = self.values(&name, set, samples, channels)?;
        let channel = |channel: usize| values.iter().skip(channel).step_by(channels.max(1)).copied();
        let values = (0..channels).flat_map(channel).collect();
        Ok(Column::of_numbers(name, channels, values))
    }

    /// A cell array of vectors of one length: a channel for each cell.
    fn cell(&mut self, name: String, set: &Dataset) -> Result<Column, RecordingError> {
        let sides = self.shape(&name, set)?;
        let cells = sides.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        let is_small = cells.is_some_and(|cells| (1..=MOST_CELLS).contains(&cells));
        if !is_small || !self.wanted.includes(&name) {
            let kind =
                if is_small { Column::of_numbers(name, 0, Vec::new()) } else { Column::of_kind(name, NOT_VECTORS) };
            return Ok(kind);
        }
        let targets = set.dereference().map_err(|e| self.damaged(&name, &e))?;
        let mut vectors = Vec::new();
        for target in &targets {
            let Object::Dataset(set) = target else { return Ok(Column::of_kind(name, NOT_VECTORS)) };
            let Some(vector) = self.vector(&name, set)? else { return Ok(Column::of_kind(name, NOT_VECTORS)) };
            vectors.push(vector);
        }
        Ok(of_cells(name, vectors))
    }

    /// The values of a cell; none if it is not a vector of numbers.
    fn vector(&mut self, name: &str, set: &Dataset) -> Result<Option<Vec<f64>>, RecordingError> {
        let attributes = set.attrs().map_err(|e| self.damaged(name, &e))?;
        let kind = set.dtype().map_err(|e| self.damaged(name, &e))?;
        let shape = self.shape(name, set)?;
        let is_vector = matches!(shape[..], [1, _] | [_, 1]) && !attributes.contains_key("MATLAB_empty");
        if kind_not_read(&attributes, &kind).is_some() || !is_vector {
            return Ok(None);
        }
        self.values(name, set, shape[0], shape[1]).map(Some)
    }

    /// Rows and columns as in MATLAB.
    fn shape(&self, name: &str, set: &Dataset) -> Result<Vec<usize>, RecordingError> {
        let sides = set.shape().map_err(|e| self.damaged(name, &e))?;
        Ok(sides.into_iter().rev().map(|side| usize::try_from(side).unwrap_or(usize::MAX)).collect())
    }

    /// Checks the size of a chunk of a data set, which is decompressed as a whole, against the limit.
    fn check_chunks(&self, name: &str, set: &Dataset) -> Result<(), RecordingError> {
        let chunk = set.chunk_shape().map_err(|e| self.damaged(name, &e))?.unwrap_or_default();
        let values = chunk.iter().try_fold(1_u64, |product, &side| product.checked_mul(side));
        match values {
            Some(values) if values <= self.budget.left() as u64 => Ok(()),
            _ => Err(self.budget.exceeded(&format!("a piece of variable {name:?}"))),
        }
    }
}

/// Classes of MATLAB that are arrays of real numbers.
const NUMERIC_CLASSES: [&str; 11] =
    ["double", "single", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "logical"];

fn class(attributes: &HashMap<String, AttrValue>) -> Option<&str> {
    attributes.get("MATLAB_class").and_then(AttrValue::as_str)
}

fn is_cell(attributes: &HashMap<String, AttrValue>, kind: &DType) -> bool {
    class(attributes) == Some("cell") && matches!(kind, DType::ObjectReference)
}

/// The kind of a data set, if it is not an array of real numbers.
fn kind_not_read(attributes: &HashMap<String, AttrValue>, kind: &DType) -> Option<String> {
    let Some(class) = class(attributes) else {
        return Some("a data set without the class that MATLAB gives to its variables".to_owned());
    };
    match (class, kind) {
        ("char", _) => Some("text".to_owned()),
        ("cell", _) => Some(NOT_VECTORS.to_owned()),
        ("struct", _) => Some("an array of structures".to_owned()),
        (_, DType::Compound(_)) => Some("complex".to_owned()),
        (class, _) if !NUMERIC_CLASSES.contains(&class) => Some(kind_of_object(class)),
        (_, kind) => kind_of_other_values(kind),
    }
}

/// The kind of values that are not real numbers.
fn kind_of_other_values(kind: &DType) -> Option<String> {
    match kind {
        DType::F32 | DType::F64 | DType::I8 | DType::I16 | DType::I32 | DType::I64 => None,
        DType::U8 | DType::U16 | DType::U32 | DType::U64 => None,
        DType::String | DType::VariableLengthString => Some("text".to_owned()),
        DType::Compound(_) => Some("a compound type, as pandas and PyTables write tables".to_owned()),
        DType::Enum(_) | DType::Array(..) | DType::ObjectReference | DType::Other(_) | _ => {
            Some(format!("values of type {kind}"))
        }
    }
}
