//! MAT files of version 5 (MATLAB `save -v7` and earlier): real numeric vectors and matrices.
//!
//! The `matfile` crate reads the variables. Before it sees a byte, this file walks over the parts of the file:
//! * the crate takes a file that was cut short for one with fewer variables, so the sizes are checked here;
//! * one variable that it cannot read (text in newer files, int32, objects) makes it refuse the whole file, so each
//!   variable is handed to it alone, and those refused are counted;
//! * its arithmetic on sizes overflows for sizes that no file has, which panics in debug builds; such sizes are refused
//!   here for uncompressed variables, and those of compressed ones stand behind a checksum that the crate verifies.

use std::io::Read;
use std::path::Path;

use matfile::{Array, MatFile, NumericData};

use super::RecordingError;
use super::checks::{require_finite, same_length};
use super::source::file_bytes;
use crate::series::Series;

/// Length of the header, after which the variables follow.
const HEADER: usize = 128;
/// The signature of an HDF5 file, at its beginning or behind a header of 512 bytes.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// The number by which a file marks a part as a matrix.
const MATRIX: u32 = 14;
/// The number by which a file marks a part as compressed.
const COMPRESSED: u32 = 15;

/// The value of a variable with one element in a MAT file, such as a gain.
///
/// # Errors
/// A [`RecordingError`] if the file is not a MAT file of version 5, the variable is missing, complex or has more than
/// one element, or its value is not finite.
pub fn read_scalar(path: &Path, name: &str) -> Result<f64, RecordingError> {
    let variables = Variables::load(path)?;
    let array = variables.find(name)?;
    match variables.reals(array)?.as_slice() {
        &[value] => Ok(value),
        _ => Err(variables.wrong_shape(array, "one number")),
    }
}

/// The named variables of a MAT file: a vector is one channel whichever way it lies, a matrix has one channel a column.
pub(super) fn read(path: &Path, names: &[String]) -> Result<Series, RecordingError> {
    let variables = Variables::load(path)?;
    let [first, others @ ..] = names else {
        return Err(RecordingError::NoVariableListed { file: path.into(), found: variables.names() });
    };
    let mut channels = variables.channels(first)?;
    let reference = Series::from_channels(&channels);
    for name in others {
        let more = variables.channels(name)?;
        same_length(&reference, first, path, &Series::from_channels(&more), name, path)?;
        channels.extend(more);
    }
    Ok(Series::from_channels(&channels))
}

/// The numeric variables of a file, and the number of those that could not be read.
struct Variables<'a> {
    path: &'a Path,
    arrays: Vec<Array>,
    skipped: usize,
}

impl<'a> Variables<'a> {
    fn load(path: &'a Path) -> Result<Self, RecordingError> {
        Self::from_bytes(&file_bytes(path)?, path)
    }

    fn from_bytes(bytes: &[u8], path: &'a Path) -> Result<Self, RecordingError> {
        let order = byte_order(bytes, path)?;
        let (header, body) = bytes.split_at(HEADER);
        let damaged = |offset| RecordingError::DamagedMat { file: path.into(), offset: HEADER + offset };
        let mut variables = Self { path, arrays: Vec::new(), skipped: 0 };
        for part in parts(body, order).map_err(damaged)? {
            if !part.is_sound_variable(order) {
                return Err(damaged(part.offset));
            }
            variables.add(header, part.whole);
        }
        Ok(variables)
    }

    /// Adds one variable, read as if it were alone in the file.
    fn add(&mut self, header: &[u8], variable: &[u8]) {
        match MatFile::parse(header.chain(variable)) {
            Ok(file) if !file.arrays().is_empty() => self.arrays.extend(file.arrays().iter().cloned()),
            _ => self.skipped += 1,
        }
    }

    fn names(&self) -> Vec<String> {
        self.arrays.iter().map(|array| array.name().to_owned()).collect()
    }

    fn find(&self, name: &str) -> Result<&Array, RecordingError> {
        let array = self.arrays.iter().find(|array| array.name() == name);
        array.ok_or_else(|| RecordingError::MissingVariable {
            file: self.path.into(),
            variable: name.into(),
            found: self.names(),
            skipped: self.skipped,
        })
    }

    fn channels(&self, name: &str) -> Result<Vec<Vec<f64>>, RecordingError> {
        let array = self.find(name)?;
        let values = self.reals(array)?;
        let &[rows, columns] = array.size().as_slice() else {
            return Err(self.wrong_shape(array, "a vector or a matrix"));
        };
        if values.is_empty() {
            return Err(RecordingError::NoSamples { file: self.path.into() });
        }
        if rows.checked_mul(columns) != Some(values.len()) {
            return Err(self.wrong_shape(array, "as many values as rows times columns"));
        }
        let samples = if rows == 1 { columns } else { rows };
        Ok(values.chunks_exact(samples).map(<[f64]>::to_vec).collect())
    }

    /// The values of a real, finite array, column by column.
    fn reals(&self, array: &Array) -> Result<Vec<f64>, RecordingError> {
        let values = real_values(array.data())
            .ok_or_else(|| RecordingError::ComplexVariable { file: self.path.into(), variable: array.name().into() })?;
        require_finite(&values, self.path, array.name())?;
        Ok(values)
    }

    fn wrong_shape(&self, array: &Array, expected: &'static str) -> RecordingError {
        let (variable, found) = (array.name().to_owned(), array.size().clone());
        RecordingError::VariableShape { file: self.path.into(), variable, expected, found }
    }
}

/// The values in double precision; `None` if they are complex.
fn real_values(data: &NumericData) -> Option<Vec<f64>> {
    match data {
        NumericData::Double { real, imag: None } => Some(real.clone()),
        NumericData::Single { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::Int8 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::UInt8 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::Int16 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::UInt16 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::Int32 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::UInt32 { real, imag: None } => Some(real.iter().map(|&x| x.into()).collect()),
        NumericData::Int64 { real, imag: None } => Some(real.iter().map(|&x| x as f64).collect()),
        NumericData::UInt64 { real, imag: None } => Some(real.iter().map(|&x| x as f64).collect()),
        _ => None,
    }
}

/// How the file orders the bytes of a number.
#[derive(Clone, Copy)]
enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    fn word(self, bytes: &[u8], offset: usize) -> Option<u32> {
        let word = *bytes.get(offset..)?.first_chunk()?;
        Some(match self {
            Self::Little => u32::from_le_bytes(word),
            Self::Big => u32::from_be_bytes(word),
        })
    }
}

/// The byte order that the header of a version 5 file states.
fn byte_order(bytes: &[u8], path: &Path) -> Result<ByteOrder, RecordingError> {
    let version_7_3 = bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(HDF5);
    if version_7_3 || bytes.get(512..).is_some_and(|rest| rest.starts_with(HDF5)) {
        return Err(RecordingError::MatV73 { file: path.into() });
    }
    match bytes.get(HEADER - 4..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(ByteOrder::Little),
        Some([1, 0, b'M', b'I']) => Ok(ByteOrder::Big),
        _ => Err(RecordingError::NotMatV5 { file: path.into() }),
    }
}

/// A part of a file, called a data element by the format: a tag of kind and size, the data, and padding.
struct Part<'a> {
    kind: u32,
    offset: usize,
    whole: &'a [u8],
    data: &'a [u8],
}

impl Part<'_> {
    /// Whether the part is a variable whose sizes fit.
    fn is_sound_variable(&self, order: ByteOrder) -> bool {
        match self.kind {
            COMPRESSED => true,
            MATRIX => parts(self.data, order).is_ok_and(|parts| has_countable_size(&parts, order)),
            _ => false,
        }
    }
}

/// Whether the sides of a matrix, its second part, are not negative and the number of elements fits into an `i32`.
fn has_countable_size(parts: &[Part], order: ByteOrder) -> bool {
    let Some(sides) = parts.get(1) else { return false };
    let sides = (0..sides.data.len() / 4).map(|i| order.word(sides.data, 4 * i).and_then(|w| i32::try_from(w).ok()));
    sides.into_iter().try_fold(1_i32, |product, side| product.checked_mul(side?)).is_some()
}

/// The parts that follow one another in `bytes`; the offset of the first that does not fit, if there is one.
fn parts(bytes: &[u8], order: ByteOrder) -> Result<Vec<Part<'_>>, usize> {
    let mut parts = Vec::new();
    let mut offset = 0;
    while offset < bytes.len() {
        let part = part_at(bytes, offset, order).ok_or(offset)?;
        offset += part.whole.len();
        parts.push(part);
    }
    Ok(parts)
}

fn part_at(bytes: &[u8], offset: usize, order: ByteOrder) -> Option<Part<'_>> {
    let rest = &bytes[offset..];
    let tag = order.word(rest, 0)?;
    let (kind, tag_length, size) = match tag >> 16 {
        0 => (tag, 8, usize::try_from(order.word(rest, 4)?).ok()?),
        small_size @ 1..=4 => (tag & 0xffff, 4, small_size as usize),
        _ => return None,
    };
    let data = rest.get(tag_length..)?.get(..size)?;
    let end = tag_length + size;
    let padded = if kind == COMPRESSED { end } else { end.next_multiple_of(8).min(rest.len()) };
    Some(Part { kind, offset, whole: &rest[..padded], data })
}

#[cfg(test)]
mod tests {
    use super::super::test_files::{Folder, MatBytes};
    use super::*;

    const FILE: &str = "q.mat";

    fn loaded(bytes: &[u8], names: &[&str]) -> Result<Series, RecordingError> {
        let folder = Folder::with(FILE, bytes);
        let names: Vec<_> = names.iter().map(|&n| n.to_owned()).collect();
        read(&folder.path().join(FILE), &names)
    }

    fn failure(bytes: &[u8], names: &[&str]) -> RecordingError {
        loaded(bytes, names).unwrap_err()
    }

    fn scalar(bytes: &[u8], name: &str) -> Result<f64, RecordingError> {
        let folder = Folder::with(FILE, bytes);
        read_scalar(&folder.path().join(FILE), name)
    }

    /// A column, a row, a matrix of two columns, and a scalar.
    fn valid() -> MatBytes {
        let file = MatBytes::new();
        let file = file.with("t", &[3, 1], &[0.0, 0.1, 0.2]).with("row", &[1, 3], &[1.0, 2.0, 3.0]);
        file.with("tau", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).with("kp", &[1, 1], &[160.18])
    }

    #[test]
    fn matrix_gives_one_channel_a_column() {
        let series = loaded(valid().bytes(), &["tau"]).unwrap();
        assert_eq!((series.channels(), series.channel(1)), (2, vec![4.0, 5.0, 6.0]));
    }

    #[test]
    fn variables_stand_side_by_side_and_a_row_is_a_channel() {
        let series = loaded(valid().bytes(), &["row", "tau"]).unwrap();
        assert_eq!(series.values(), [1.0, 1.0, 4.0, 2.0, 2.0, 5.0, 3.0, 3.0, 6.0]);
    }

    #[test]
    fn scalar_of_a_variable() {
        assert_eq!(scalar(valid().bytes(), "kp").unwrap(), 160.18);
    }

    #[test]
    fn vector_is_not_a_scalar() {
        let error = scalar(valid().bytes(), "t").unwrap_err();
        assert!(matches!(error, RecordingError::VariableShape { found, .. } if found == [3, 1]));
    }

    #[test]
    fn empty_file() {
        assert!(matches!(failure(b"", &["t"]), RecordingError::EmptyFile { .. }));
    }

    #[test]
    fn other_file() {
        assert!(matches!(failure(b"a,b\n1,2\n", &["t"]), RecordingError::NotMatV5 { .. }));
    }

    #[test]
    fn version_7_3() {
        let mut bytes = vec![0; 512];
        bytes.extend(HDF5);
        assert!(matches!(failure(&bytes, &["t"]), RecordingError::MatV73 { .. }));
    }

    #[test]
    fn file_cut_short_anywhere_is_refused_or_lacks_the_last_variable() {
        let whole = valid();
        for length in 1..whole.bytes().len() - 1 {
            let variables = Variables::from_bytes(&whole.bytes()[..length], Path::new(FILE));
            let error = variables.and_then(|variables| variables.channels("kp")).unwrap_err();
            let missing = matches!(error, RecordingError::MissingVariable { skipped: 0, .. });
            let refused = matches!(error, RecordingError::NotMatV5 { .. } | RecordingError::DamagedMat { .. });
            assert!(missing || refused, "{length}: {error}");
        }
    }

    #[test]
    fn damaged_bytes_never_panic() {
        let whole = valid();
        for place in 0..whole.bytes().len() {
            for damage in [0x00, 0x01, 0x7f, 0x80, 0xff] {
                let mut bytes = whole.bytes().to_vec();
                bytes[place] = damage;
                let _ = Variables::from_bytes(&bytes, Path::new(FILE)).and_then(|variables| variables.channels("tau"));
            }
        }
    }

    #[test]
    fn size_beyond_all_counting() {
        let bytes = MatBytes::new().with("t", &[1 << 16, 1 << 16], &[1.0]);
        assert!(matches!(failure(bytes.bytes(), &["t"]), RecordingError::DamagedMat { .. }));
    }

    #[test]
    fn no_variable_listed() {
        assert!(matches!(failure(valid().bytes(), &[]), RecordingError::NoVariableListed { found, .. }
            if found == ["t", "row", "tau", "kp"]));
    }

    #[test]
    fn missing_variable_lists_those_present() {
        let error = failure(valid().bytes(), &["q"]);
        assert!(matches!(error, RecordingError::MissingVariable { variable, found, skipped: 0, .. }
            if variable == "q" && found.len() == 4));
    }

    #[test]
    fn text_is_not_read_and_does_not_hide_the_others() {
        let file = valid().with_text("note", "run 3");
        assert_eq!(loaded(file.bytes(), &["t"]).unwrap().len(), 3);
        assert!(matches!(failure(file.bytes(), &["note"]), RecordingError::MissingVariable { skipped: 1, .. }));
    }

    #[test]
    fn complex_variable() {
        let file = MatBytes::new().with_complex("z", &[2, 1], &[1.0, 2.0]);
        assert!(matches!(failure(file.bytes(), &["z"]), RecordingError::ComplexVariable { .. }));
    }

    #[test]
    fn variable_of_three_dimensions() {
        let file = MatBytes::new().with("q", &[1, 2, 2], &[1.0; 4]);
        assert!(matches!(failure(file.bytes(), &["q"]), RecordingError::VariableShape { found, .. }
            if found == [1, 2, 2]));
    }

    #[test]
    fn variable_without_elements() {
        let file = MatBytes::new().with("q", &[0, 2], &[]);
        assert!(matches!(failure(file.bytes(), &["q"]), RecordingError::NoSamples { .. }));
    }

    #[test]
    fn sample_that_is_nan() {
        let file = MatBytes::new().with("q", &[3, 1], &[1.0, f64::NAN, 2.0]);
        assert!(matches!(failure(file.bytes(), &["q"]), RecordingError::NotFiniteSample { sample: 1, .. }));
    }

    #[test]
    fn variables_of_different_lengths() {
        let file = valid().with("q", &[2, 1], &[1.0, 2.0]);
        let error = failure(file.bytes(), &["t", "q"]);
        assert!(matches!(error, RecordingError::DifferentLengths { first_samples: 3, second_samples: 2, .. }));
    }
}
