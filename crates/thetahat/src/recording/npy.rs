//! NumPy arrays: `.npy`, of real numbers, in C or Fortran order.
//!
//! `npyz` reads header and values. Before it sees a header, this file checks what it does not: its parser of the header
//! calls itself for each bracket, and the product of a forged shape overflows.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar};

use super::budget::Budget;
use super::error::RecordingError;
use super::place::{open, unreadable};
use super::table::{Column, Table};

/// Longest header that is read. Those of arrays of numbers have about 100 bytes.
const LONGEST_HEADER: usize = 1 << 14;
/// Brackets within brackets in a header: a record type with shapes has four.
const DEEPEST_HEADER: usize = 8;

/// The array of a file, named like it.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Table, RecordingError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut budget = Budget::of(path, bytes.len() as u64);
    let column = column(name, bytes, path, &mut budget)?;
    Ok(Table { name: String::new(), columns: vec![column] })
}

/// An array as a column: one channel for a vector, one for each column of a matrix.
pub(super) fn column(name: String, bytes: &[u8], path: &Path, budget: &mut Budget) -> Result<Column, RecordingError> {
    let damaged = |reason: String| RecordingError::damaged(path, format!("array {name:?}: {reason}"));
    check_header(bytes).map_err(|reason| damaged(reason.to_owned()))?;
    let mut rest = bytes;
    let header = NpyHeader::from_reader(&mut rest).map_err(|e| damaged(e.to_string()))?;
    let Some((samples, channels)) = samples_and_channels(header.shape()) else {
        return Ok(Column::of_kind(name, format!("an array of {} dimensions", header.shape().len())));
    };
    let Some((code, width)) = number_type(&header.dtype()) else {
        return Ok(Column::of_kind(name, format!("an array of {}", header.dtype().descr())));
    };
    let count = budget.take(&format!("array {name:?}"), &[samples, channels])?;
    if rest.len() / width < count {
        return Err(damaged(format!("expected {count} values, the file ends after {}", rest.len() / width)));
    }
    let c_order = header.order() == Order::C;
    let values = values(code, width, NpyFile::with_header(header, rest), count).map_err(damaged)?;
    let values = if c_order && channels > 1 { by_channel(&values, channels) } else { values };
    Ok(Column::of_numbers(name, channels, values))
}

/// An array of which any samples can be read: one that lies in a file as it is.
pub(super) struct ArrayPieces {
    path: PathBuf,
    name: String,
    header: NpyHeader,
    code: TypeChar,
    width: usize,
    samples: usize,
    channels: usize,
    /// Where its values begin in the file.
    start: u64,
}

impl ArrayPieces {
    /// The array that begins at a byte of a file and takes `length` bytes; none where it is not one of numbers, or too
    /// short for them: the reader of whole files says what is wrong.
    pub(super) fn open(path: &Path, name: String, place: u64, length: u64) -> Result<Option<Self>, RecordingError> {
        let mut beginning = Vec::new();
        let refuse = |e| unreadable(path, e);
        let mut file = open(path)?;
        file.seek(SeekFrom::Start(place)).map_err(refuse)?;
        file.take(length.min(2 * LONGEST_HEADER as u64)).read_to_end(&mut beginning).map_err(refuse)?;
        if check_header(&beginning).is_err() {
            return Ok(None);
        }
        let mut rest = &beginning[..];
        let Ok(header) = NpyHeader::from_reader(&mut rest) else { return Ok(None) };
        let described = samples_and_channels(header.shape()).zip(number_type(&header.dtype()));
        let Some(((samples, channels), (code, width))) = described else { return Ok(None) };
        let before = (beginning.len() - rest.len()) as u64;
        let needed = samples.checked_mul(channels).and_then(|values| values.checked_mul(width));
        let fits = needed.is_some_and(|bytes| bytes as u64 <= length - before);
        let start = place + before;
        Ok(fits.then(|| Self { path: path.to_owned(), name, header, code, width, samples, channels, start }))
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn samples(&self) -> usize {
        self.samples
    }

    /// These samples as a column.
    pub(super) fn read(&self, range: Range<usize>) -> Result<Column, RecordingError> {
        let c_order = self.header.order() == Order::C || self.channels == 1;
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
        let mut bytes = Vec::with_capacity(count * self.width);
        let mut file = open(&self.path)?;
        file.seek(SeekFrom::Start(self.start + (first * self.width) as u64)).map_err(refuse)?;
        file.take((count * self.width) as u64).read_to_end(&mut bytes).map_err(refuse)?;
        if bytes.len() < count * self.width {
            return Err(damaged("it was changed while it was read".to_owned()));
        }
        let file = NpyFile::with_header(self.header.clone(), &bytes[..]);
        values(self.code, self.width, file, count).map_err(damaged)
    }
}

/// Checks length, brackets and numbers of a header, which begins behind the magic word and the version.
fn check_header(bytes: &[u8]) -> Result<(), &'static str> {
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("it does not begin as a NumPy array does");
    }
    let size = match (bytes.get(6), bytes.get(8..12)) {
        (Some(1), Some(&[a, b, ..])) => 10..10 + usize::from(u16::from_le_bytes([a, b])),
        (Some(_), Some(&[a, b, c, d])) => 12..12_usize.saturating_add(u32::from_le_bytes([a, b, c, d]) as usize),
        _ => return Err("it ends within its header"),
    };
    if size.len() > LONGEST_HEADER {
        return Err("its header is longer than that of any array of numbers");
    }
    let header = bytes.get(size).ok_or("it ends within its header")?;
    if deepest_bracket(header) > DEEPEST_HEADER || !shape_is_countable(header) {
        return Err("its header does not describe an array of numbers");
    }
    Ok(())
}

fn deepest_bracket(header: &[u8]) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for byte in header {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

/// Whether the product of all numbers in the header fits into an `i64`; then so does the product of the shape.
fn shape_is_countable(header: &[u8]) -> bool {
    let numbers = header.split(|b| !b.is_ascii_digit()).filter(|digits| !digits.is_empty());
    let number = |digits| str::from_utf8(digits).ok()?.parse::<i64>().ok();
    numbers.into_iter().try_fold(1_i64, |product, digits| product.checked_mul(number(digits)?.max(1))).is_some()
}

/// A vector, whichever way it lies, is one channel; a matrix has one for each column.
fn samples_and_channels(shape: &[u64]) -> Option<(usize, usize)> {
    let side = |side: u64| usize::try_from(side).ok();
    match *shape {
        [] => Some((1, 1)),
        [n] | [1, n] => Some((side(n)?, 1)),
        [n, m] => Some((side(n)?, side(m)?)),
        _ => None,
    }
}

/// The letter of a type of real numbers, and its size in bytes.
fn number_type(dtype: &DType) -> Option<(TypeChar, usize)> {
    let DType::Plain(text) = dtype else { return None };
    let width = usize::try_from(text.size_field()).ok()?;
    let known = matches!(
        (text.type_char(), width),
        (TypeChar::Float, 4 | 8) | (TypeChar::Int | TypeChar::Uint, 1 | 2 | 4 | 8) | (TypeChar::Bool, 1)
    );
    known.then(|| (text.type_char(), width))
}

/// The first `count` values.
fn values(code: TypeChar, width: usize, file: NpyFile<&[u8]>, count: usize) -> Result<Vec<f64>, String> {
    match (code, width) {
        (TypeChar::Float, 8) => collected(file, count, |x: f64| x),
        (TypeChar::Float, _) => collected(file, count, |x: f32| x.into()),
        (TypeChar::Int, 1) => collected(file, count, |x: i8| x.into()),
        (TypeChar::Int, 2) => collected(file, count, |x: i16| x.into()),
        (TypeChar::Int, 4) => collected(file, count, |x: i32| x.into()),
        (TypeChar::Int, _) => collected(file, count, |x: i64| x as f64),
        (TypeChar::Uint, 1) => collected(file, count, |x: u8| x.into()),
        (TypeChar::Uint, 2) => collected(file, count, |x: u16| x.into()),
        (TypeChar::Uint, 4) => collected(file, count, |x: u32| x.into()),
        (TypeChar::Uint, _) => collected(file, count, |x: u64| x as f64),
        _ => collected(file, count, |x: bool| x.into()),
    }
}

fn collected<T: Deserialize>(file: NpyFile<&[u8]>, count: usize, number: fn(T) -> f64) -> Result<Vec<f64>, String> {
    let values = file.data::<T>().map_err(|e| e.to_string())?.take(count);
    values.map(|value| value.map(number).map_err(|e| e.to_string())).collect()
}

/// Values stored sample by sample, put channel by channel.
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
