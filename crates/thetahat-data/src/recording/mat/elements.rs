//! The data elements of a MAT file of version 5: each has a tag with kind and size, the data, and padding.

/// The number by which a file marks an element as a matrix.
pub(super) const MATRIX: u32 = 14;
/// The number by which a file marks an element as compressed.
pub(super) const COMPRESSED: u32 = 15;

/// How the file orders the bytes of a number.
#[derive(Clone, Copy)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    pub(super) fn word(self, bytes: &[u8], offset: usize) -> Option<u32> {
        let word = *bytes.get(offset..)?.first_chunk()?;
        Some(match self {
            Self::Little => u32::from_le_bytes(word),
            Self::Big => u32::from_be_bytes(word),
        })
    }

    /// The bytes of a number as little-endian.
    fn little<const N: usize>(self, mut bytes: [u8; N]) -> [u8; N] {
        if matches!(self, Self::Big) {
            bytes.reverse();
        }
        bytes
    }
}

/// An element of a file.
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) offset: usize,
    pub(super) data: &'a [u8],
    /// Length including tag and padding.
    length: usize,
}

impl Element<'_> {
    /// The size in bytes of the numbers of an element, if it holds numbers.
    fn width(&self) -> Option<usize> {
        match self.kind {
            1 | 2 => Some(1),
            3 | 4 => Some(2),
            5..=7 => Some(4),
            9 | 12 | 13 => Some(8),
            _ => None,
        }
    }

    /// How many numbers the element holds, if it holds numbers.
    pub(super) fn count(&self) -> Option<usize> {
        Some(self.data.len() / self.width()?)
    }

    /// The numbers of the element in double precision.
    pub(super) fn numbers(&self, order: ByteOrder) -> Option<Vec<f64>> {
        Some(match self.kind {
            1 => self.read(order, |b| i8::from_le_bytes(b).into()),
            2 => self.read(order, |b| u8::from_le_bytes(b).into()),
            3 => self.read(order, |b| i16::from_le_bytes(b).into()),
            4 => self.read(order, |b| u16::from_le_bytes(b).into()),
            5 => self.read(order, |b| i32::from_le_bytes(b).into()),
            6 => self.read(order, |b| u32::from_le_bytes(b).into()),
            7 => self.read(order, |b| f32::from_le_bytes(b).into()),
            9 => self.read(order, f64::from_le_bytes),
            12 => self.read(order, |b| i64::from_le_bytes(b) as f64),
            13 => self.read(order, |b| u64::from_le_bytes(b) as f64),
            _ => return None,
        })
    }

    fn read<const N: usize>(&self, order: ByteOrder, number: fn([u8; N]) -> f64) -> Vec<f64> {
        self.data.as_chunks::<N>().0.iter().map(|bytes| number(order.little(*bytes))).collect()
    }
}

/// The consecutive elements in `bytes`, or the offset of the first that does not fit.
pub(super) fn elements(bytes: &[u8], order: ByteOrder) -> Result<Vec<Element<'_>>, usize> {
    let mut elements = Vec::new();
    let mut offset = 0;
    while offset < bytes.len() {
        let element = element_at(bytes, offset, order).ok_or(offset)?;
        offset += element.length;
        elements.push(element);
    }
    Ok(elements)
}

fn element_at(bytes: &[u8], offset: usize, order: ByteOrder) -> Option<Element<'_>> {
    let rest = &bytes[offset..];
    let tag = order.word(rest, 0)?;
    let (kind, tag_length, size) = match tag >> 16 {
        0 => (tag, 8, usize::try_from(order.word(rest, 4)?).ok()?),
        small_size @ 1..=4 => (tag & 0xffff, 4, small_size as usize),
        _ => return None,
    };
    let data = rest.get(tag_length..)?.get(..size)?;
    let end = tag_length + size;
    let length = if kind == COMPRESSED { end } else { end.next_multiple_of(8).min(rest.len()) };
    Some(Element { kind, offset, data, length })
}
