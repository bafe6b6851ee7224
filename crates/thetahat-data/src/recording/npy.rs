//! NumPy arrays: `.npy`, of real numbers, in C or Fortran order.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::budget::Budget;
use super::error::RecordingError;
use super::npy_header::{Header, LONGEST_HEADER, unquoted};
use super::place::{open, unreadable};
use super::table::{Column, Table};

/// The array of a file, named after the file.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Table, RecordingError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut budget = Budget::of(path, bytes.len() as u64);
    let column = column(name, bytes, path, &mut budget)?;
    Ok(Table { name: String::new(), columns: vec![column] })
}

/// An array as a column: one channel for a vector, one for each column of a matrix.
pub(super) fn column(name: String, bytes: &[u8], path: &Path, budget: &mut Budget) -> Result<Column, RecordingError> {
    let damaged = |reason: String| RecordingError::damaged(path, format!("array {name:?}: {reason}"));
    let header = Header::parse(bytes).map_err(|reason| damaged(reason.to_owned()))?;
    let Some((samples, channels)) = samples_and_channels(&header.shape) else {
        return Ok(Column::of_kind(name, format!("an array of {} dimensions", header.shape.len())));
    };
    let Some(element) = Element::parse(&header.descr) else {
        return Ok(Column::of_kind(name, format!("an array of {}", header.descr)));
    };
    let rest = &bytes[header.end..];
    let count = budget.take(&format!("array {name:?}"), &[samples, channels])?;
    let held = rest.len() / element.width();
    if held < count {
        return Err(damaged(format!("expected {count} values, the file ends after {held}")));
    }
    let values = element.values(&rest[..count * element.width()]);
    let values = if !header.fortran_order && channels > 1 { by_channel(&values, channels) } else { values };
    Ok(Column::of_numbers(name, channels, values))
}

/// An array of which any samples can be read: one that is stored uncompressed.
pub(super) struct ArrayPieces {
    path: PathBuf,
    name: String,
    fortran_order: bool,
    element: Element,
    samples: usize,
    channels: usize,
    /// Offset of the values in the file.
    start: u64,
}

impl ArrayPieces {
    /// The array that begins at a byte of a file and takes `length` bytes; none if it is not an array of numbers or is too short: the
    /// reader of whole files then reports what is wrong.
    pub(super) fn open(path: &Path, name: String, place: u64, length: u64) -> Result<Option<Self>, RecordingError> {
        let mut beginning = Vec::new();
        let refuse = |e| unreadable(path, e);
        let mut file = open(path)?;
        file.seek(SeekFrom::Start(place)).map_err(refuse)?;
        file.take(length.min(2 * LONGEST_HEADER as u64)).read_to_end(&mut beginning).map_err(refuse)?;
        let Ok(Header { descr, fortran_order, shape, end }) = Header::parse(&beginning) else { return Ok(None) };
        let described = samples_and_channels(&shape).zip(Element::parse(&descr));
        let Some(((samples, channels), element)) = described else { return Ok(None) };
        let before = end as u64;
        let needed = samples.checked_mul(channels).and_then(|values| values.checked_mul(element.width()));
        let fits = needed.is_some_and(|bytes| bytes as u64 <= length - before);
        let start = place + before;
        Ok(fits.then(|| Self { path: path.to_owned(), name, fortran_order, element, samples, channels, start }))
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn samples(&self) -> usize {
        self.samples
    }

    /// These samples as a column.
    pub(super) fn read(&self, range: Range<usize>) -> Result<Column, RecordingError> {
        let c_order = !self.fortran_order || self.channels == 1;
        let values = if c_order {
            let values = self.values(range.start * self.channels, range.len() * self.channels)?;
            if self.channels > 1 { by_channel(&values, self.channels) } else { values }
        } else {
            let channel = |c: usize| self.values(c * self.samples + range.start, range.len());
            (0..self.channels).map(channel).collect::<Result<Vec<_>, _>>()?.concat()
        };
        Ok(Column::of_numbers(self.name.clone(), self.channels, values))
    }

    /// Values in the order of the file.
    fn values(&self, first: usize, count: usize) -> Result<Vec<f64>, RecordingError> {
        let refuse = |e| unreadable(&self.path, e);
        let damaged = |reason: String| RecordingError::damaged(&self.path, format!("array {:?}: {reason}", self.name));
        let width = self.element.width();
        let mut bytes = Vec::with_capacity(count * width);
        let mut file = open(&self.path)?;
        file.seek(SeekFrom::Start(self.start + (first * width) as u64)).map_err(refuse)?;
        file.take((count * width) as u64).read_to_end(&mut bytes).map_err(refuse)?;
        if bytes.len() < count * width {
            return Err(damaged("it was changed while it was read".to_owned()));
        }
        Ok(self.element.values(&bytes))
    }
}

/// A row or column vector is one channel; a matrix has one for each column.
fn samples_and_channels(shape: &[u64]) -> Option<(usize, usize)> {
    let side = |side: u64| usize::try_from(side).ok();
    match *shape {
        [] => Some((1, 1)),
        [n] | [1, n] => Some((side(n)?, 1)),
        [n, m] => Some((side(n)?, side(m)?)),
        _ => None,
    }
}

/// A type of real numbers.
#[derive(Debug, Clone, Copy)]
struct Element {
    kind: Kind,
    big_endian: bool,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Bool,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl Element {
    /// The type that a header names, such as `'<f8'`; none if it is not one of real numbers.
    fn parse(descr: &str) -> Option<Self> {
        let (order, name) = unquoted(descr)?.split_at_checked(1)?;
        let kind = match name {
            "b1" => Kind::Bool,
            "i1" => Kind::I8,
            "i2" => Kind::I16,
            "i4" => Kind::I32,
            "i8" => Kind::I64,
            "u1" => Kind::U8,
            "u2" => Kind::U16,
            "u4" => Kind::U32,
            "u8" => Kind::U64,
            "f4" => Kind::F32,
            "f8" => Kind::F64,
            _ => return None,
        };
        let element = Self { kind, big_endian: order == ">" };
        (matches!(order, "<" | ">") || order == "|" && element.width() == 1).then_some(element)
    }

    /// Bytes of a number.
    fn width(self) -> usize {
        match self.kind {
            Kind::Bool | Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }

    /// The numbers in these bytes.
    fn values(self, bytes: &[u8]) -> Vec<f64> {
        match self.kind {
            Kind::Bool => self.decoded(bytes, |[byte]| f64::from(byte != 0)),
            Kind::I8 => self.decoded(bytes, |b| i8::from_le_bytes(b).into()),
            Kind::I16 => self.decoded(bytes, |b| i16::from_le_bytes(b).into()),
            Kind::I32 => self.decoded(bytes, |b| i32::from_le_bytes(b).into()),
            Kind::I64 => self.decoded(bytes, |b| i64::from_le_bytes(b) as f64),
            Kind::U8 => self.decoded(bytes, |b| u8::from_le_bytes(b).into()),
            Kind::U16 => self.decoded(bytes, |b| u16::from_le_bytes(b).into()),
            Kind::U32 => self.decoded(bytes, |b| u32::from_le_bytes(b).into()),
            Kind::U64 => self.decoded(bytes, |b| u64::from_le_bytes(b) as f64),
            Kind::F32 => self.decoded(bytes, |b| f32::from_le_bytes(b).into()),
            Kind::F64 => self.decoded(bytes, f64::from_le_bytes),
        }
    }

    fn decoded<const WIDTH: usize>(self, bytes: &[u8], number: fn([u8; WIDTH]) -> f64) -> Vec<f64> {
        let number = |&bytes: &[u8; WIDTH]| {
            let mut bytes = bytes;
            if self.big_endian {
                bytes.reverse();
            }
            number(bytes)
        };
        bytes.as_chunks().0.iter().map(number).collect()
    }
}

/// Reorders values from sample by sample to channel by channel.
fn by_channel(values: &[f64], channels: usize) -> Vec<f64> {
    (0..channels).flat_map(|channel| values.iter().skip(channel).step_by(channels).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_files::{npy, npy_with_header};
    use super::*;

    const FILE: &str = "q.npy";

    fn loaded(bytes: &[u8]) -> Result<Column, RecordingError> {
        read(bytes, Path::new(FILE)).map(|mut table| table.columns.remove(0))
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    /// Three samples of two channels, sample by sample.
    const MATRIX: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];

    #[test]
    fn matrix_in_c_order() {
        let column = loaded(&npy("<f8", false, "(3, 2)", &doubles(&MATRIX))).unwrap();
        assert_eq!((column.name.as_str(), column.channels), ("q", 2));
        assert_eq!(column.channel(1), [2.0, 4.0, 6.0]);
    }

    #[test]
    fn matrix_in_fortran_order() {
        let column = loaded(&npy("<f8", true, "(3, 2)", &doubles(&MATRIX))).unwrap();
        assert_eq!(column.channel(1), [4.0, 5.0, 6.0]);
    }

    #[test]
    fn vectors_and_rows_are_one_channel() {
        for shape in ["(6,)", "(1, 6)", "(6, 1)"] {
            let column = loaded(&npy("<f8", false, shape, &doubles(&MATRIX))).unwrap();
            assert_eq!((column.channels, column.samples()), (1, 6), "{shape}");
        }
    }

    #[test]
    fn other_types_of_numbers() {
        assert_eq!(loaded(&npy(">f8", false, "(1,)", &1.5_f64.to_be_bytes())).unwrap().values, [1.5]);
        assert_eq!(loaded(&npy(">i8", false, "(1,)", &(-3_i64).to_be_bytes())).unwrap().values, [-3.0]);
        assert_eq!(loaded(&npy("<u8", false, "(1,)", &[0, 0, 0, 0, 1, 0, 0, 0])).unwrap().values, [4_294_967_296.0]);
        assert_eq!(loaded(&npy("|i1", false, "(1,)", &[0xfe])).unwrap().values, [-2.0]);
        let floats: Vec<u8> = [1.5_f32, -2.0].iter().flat_map(|v| v.to_be_bytes()).collect();
        assert_eq!(loaded(&npy(">f4", false, "(2,)", &floats)).unwrap().values, [1.5, -2.0]);
        assert_eq!(loaded(&npy("<i2", false, "(2,)", &[1, 0, 0xff, 0xff])).unwrap().values, [1.0, -1.0]);
        assert_eq!(loaded(&npy("|u1", false, "(2,)", &[1, 255])).unwrap().values, [1.0, 255.0]);
        assert_eq!(loaded(&npy("|b1", false, "(2,)", &[1, 0])).unwrap().values, [1.0, 0.0]);
    }

    #[test]
    fn kinds_that_are_not_read_say_what_they_are() {
        for (code, shape) in [("<f8", "(1, 2, 1)"), ("<c16", "(1,)"), ("<U4", "(1,)"), ("<f2", "(8,)")] {
            assert!(!loaded(&npy(code, false, shape, &[0; 16])).unwrap().is_numeric(), "{code} {shape}");
        }
    }

    #[test]
    fn file_cut_short() {
        let whole = npy("<f8", false, "(3, 2)", &doubles(&MATRIX));
        for length in 0..whole.len() {
            let error = loaded(&whole[..length]).unwrap_err();
            assert!(matches!(error, RecordingError::Damaged { .. }), "{length}: {error}");
        }
    }

    #[test]
    fn forged_shapes() {
        for shape in ["(99999999999, 99999999999)", "(18446744073709551615,)", "(4611686018427387904, 2)", "(-1,)"] {
            let error = loaded(&npy("<f8", false, shape, &[0; 16])).unwrap_err();
            assert!(matches!(error, RecordingError::Damaged { .. }), "{shape}: {error}");
        }
        let error = loaded(&npy("<f8", false, "(99999999999,)", &[0; 16])).unwrap_err();
        assert!(matches!(error, RecordingError::TooLarge { .. }), "{error}");
    }

    #[test]
    fn header_of_many_brackets() {
        let error = loaded(&npy_with_header(&"(".repeat(10_000))).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
    }

    #[test]
    fn other_file() {
        assert!(matches!(loaded(b"a,b\n1,2\n"), Err(RecordingError::Damaged { .. })));
    }

    #[test]
    fn damaged_bytes_never_panic() {
        let whole = npy("<f8", false, "(3, 2)", &doubles(&MATRIX));
        for place in 0..whole.len() {
            for damage in 0..=255 {
                let mut bytes = whole.clone();
                bytes[place] = damage;
                let _ = loaded(&bytes);
            }
        }
    }
}
