//! Files for the tests of recordings: NumPy and MAT files written by hand.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// The bytes of a NumPy array.
pub(super) fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    [npy_with_header(&header).as_slice(), data].concat()
}

/// The beginning of a NumPy array with any header.
pub(super) fn npy_with_header(header: &str) -> Vec<u8> {
    let size = u16::try_from(header.len()).unwrap().to_le_bytes();
    [b"\x93NUMPY\x01\x00".as_slice(), &size, header.as_bytes()].concat()
}

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const CLASS_STRUCTURE: u32 = 2;
const CLASS_CHAR: u32 = 4;
const CLASS_DOUBLE: u32 = 6;
const CLASS_INT32: u32 = 12;
const CLASS_OPAQUE: u32 = 17;
const COMPLEX_FLAG: u32 = 0x0800;

/// The bytes of a MAT file of version 5, little endian, not compressed.
pub(super) struct MatBytes(Vec<u8>);

impl MatBytes {
    /// A file without variables.
    pub(super) fn new() -> Self {
        let mut bytes = b"MATLAB 5.0 MAT-file, written by a test".to_vec();
        bytes.resize(124, b' ');
        bytes.extend([0, 1, b'I', b'M']);
        Self(bytes)
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Adds a real matrix of doubles, given column by column.
    pub(super) fn with(self, name: &str, size: &[u32], values: &[f64]) -> Self {
        self.variable(CLASS_DOUBLE, name, size, &part(DOUBLE, &doubles(values)))
    }

    /// Adds a complex matrix whose real and imaginary parts are the same.
    pub(super) fn with_complex(self, name: &str, size: &[u32], values: &[f64]) -> Self {
        let values = part(DOUBLE, &doubles(values)).repeat(2);
        self.variable(CLASS_DOUBLE | COMPLEX_FLAG, name, size, &values)
    }

    /// Adds a line of text.
    pub(super) fn with_text(self, name: &str, text: &str) -> Self {
        let letters: Vec<_> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        self.variable(CLASS_CHAR, name, &[1, text.len() as u32], &part(UINT16, &letters))
    }

    /// Adds a row of whole numbers.
    pub(super) fn with_int32(self, name: &str, values: &[i32]) -> Self {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.variable(CLASS_INT32, name, &[1, values.len() as u32], &part(INT32, &bytes))
    }

    /// Adds a structure of two columns of doubles.
    pub(super) fn with_structure(self, name: &str, fields: [(&str, &[f64]); 2]) -> Self {
        let names: Vec<u8> = fields.iter().flat_map(|(field, _)| format!("{field:\0<8}").into_bytes()).collect();
        let column = |(_, values): &(&str, &[f64])| {
            matrix(CLASS_DOUBLE, "", &[values.len() as u32, 1], &part(DOUBLE, &doubles(values)))
        };
        let values = [small_part(INT32, 8), part(INT8, &names), fields.iter().flat_map(column).collect()].concat();
        self.variable(CLASS_STRUCTURE, name, &[1, 1], &values)
    }

    /// Adds an object of a class: only its name, the kind of system and its class are as MATLAB writes them.
    pub(super) fn with_object(mut self, name: &str, class: &str) -> Self {
        let flags = part(UINT32, &words(&[CLASS_OPAQUE, 0]));
        let parts = [flags, part(INT8, name.as_bytes()), part(INT8, b"MCOS"), part(INT8, class.as_bytes())];
        self.0.extend(part(MATRIX, &parts.concat()));
        self
    }

    /// Adds a real matrix of doubles, compressed.
    pub(super) fn with_compressed(mut self, name: &str, size: &[u32], values: &[f64]) -> Self {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&matrix(CLASS_DOUBLE, name, size, &part(DOUBLE, &doubles(values)))).unwrap();
        let bytes = encoder.finish().unwrap();
        self.0.extend(words(&[COMPRESSED, bytes.len() as u32]));
        self.0.extend(bytes);
        self
    }

    fn variable(mut self, flags: u32, name: &str, size: &[u32], values: &[u8]) -> Self {
        self.0.extend(matrix(flags, name, size, values));
        self
    }
}

fn matrix(flags: u32, name: &str, size: &[u32], values: &[u8]) -> Vec<u8> {
    let flags = part(UINT32, &words(&[flags, 0]));
    let parts = [flags, part(INT32, &words(size)), part(INT8, name.as_bytes()), values.to_vec()];
    part(MATRIX, &parts.concat())
}

/// One word in the short form of an element.
fn small_part(kind: u32, word: u32) -> Vec<u8> {
    words(&[4 << 16 | kind, word])
}

fn part(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = words(&[kind, data.len() as u32]);
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
