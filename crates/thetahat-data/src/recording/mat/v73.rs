//! Variables of MAT files of version 7.3: HDF5 files in which MATLAB stores the class of each data set, with dimensions in reverse order,
//! so that a matrix of n samples of 7 channels is a data set of 7 x n, channel by channel.

use std::collections::HashMap;
use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, File, Group};

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::table::{Column, RequestedColumns};
use super::shape::samples_and_channels;

/// Deepest nesting of structures.
const DEEPEST_STRUCTURE: usize = 8;
/// Most variables and structures of one file. Groups may contain themselves, so that a limit of depth alone does not end a walk.
const MOST_OBJECTS: usize = 4096;

/// The variables of a file. Variables that are not requested have a name and no values.
pub(super) fn read(bytes: Vec<u8>, path: &Path, wanted: RequestedColumns<'_>) -> Result<Vec<Column>, RecordingError> {
    panics_as_damage(path, "HDF5", || {
        let budget = Budget::of(path, bytes.len() as u64);
        let mut reader = Reader { path, wanted, budget, objects: 0, columns: Vec::new() };
        let length = bytes.len() as u64;
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
    wanted: RequestedColumns<'a>,
    budget: Budget,
    objects: usize,
    columns: Vec<Column>,
}

impl Reader<'_> {
    fn damaged(&self, what: &str, error: &hdf5_pure::Error) -> RecordingError {
        RecordingError::damaged(self.path, format!("HDF5 {what}: {error}"))
    }

    /// Adds the variables of a group: of the file, or the fields of a structure. MATLAB's internal groups begin with `#`.
    fn add_group(&mut self, prefix: &str, group: &Group, depth: usize) -> Result<(), RecordingError> {
        for name in group.datasets().map_err(|e| self.damaged("group", &e))? {
            if !name.starts_with('#') {
                self.count_object()?;
                let set = group.dataset(&name).map_err(|e| self.damaged(&name, &e))?;
                let column = self.column(format!("{prefix}{name}"), &set)?;
                self.columns.push(column);
            }
        }
        for name in group.groups().map_err(|e| self.damaged("group", &e))? {
            if !name.starts_with('#') && depth < DEEPEST_STRUCTURE {
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
        self.add_group(&format!("{name}."), group, depth)
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
        let attributes = set.attrs().map_err(|e| self.damaged(&name, &e))?;
        let kind = set.dtype().map_err(|e| self.damaged(&name, &e))?;
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
        self.check_chunks(&name, set)?;
        let count = self.budget.take(&format!("variable {name:?}"), &[samples, channels])?;
        let values = set.read_f64().map_err(|e| self.damaged(&name, &e))?;
        if values.len() != count {
            let reason = format!("variable {name:?} has the size of {count} values and holds {}", values.len());
            return Err(RecordingError::damaged(self.path, reason));
        }
        Ok(Column::of_numbers(name, channels, values))
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

/// The kind of a data set, if it is not an array of real numbers.
fn kind_not_read(attributes: &HashMap<String, AttrValue>, kind: &DType) -> Option<String> {
    let Some(class) = attributes.get("MATLAB_class").and_then(AttrValue::as_str) else {
        return Some("a data set without the class that MATLAB gives to its variables".to_owned());
    };
    match (class, kind) {
        ("char", _) => Some("text".to_owned()),
        ("cell", _) => Some("a cell array".to_owned()),
        ("struct", DType::U64) => Some("an empty structure".to_owned()),
        (_, DType::Compound(_)) => Some("complex".to_owned()),
        (_, DType::F32 | DType::F64 | DType::I8 | DType::I16 | DType::I32 | DType::I64) => None,
        (_, DType::U8 | DType::U16 | DType::U32 | DType::U64) => None,
        (class, _) => Some(format!("of class {class}")),
    }
}
