//! The header of a NumPy array: a Python dictionary of its element type, its order and its shape.
//!
//! Format: NumPy Enhancement Proposal 1, versions 1.0 to 3.0. Nothing here is recursive, so that no nesting in a header exhausts the stack.

use std::ops::Range;

/// Longest header that is read. Headers of arrays of numbers have about 100 bytes.
pub(super) const LONGEST_HEADER: usize = 1 << 14;

const NOT_NUMBERS: &str = "its header does not describe an array of numbers";

/// The content of a header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    /// The element type as written, such as `'<f8'`.
    pub(super) descr: String,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<u64>,
    /// Offset of the values.
    pub(super) end: usize,
}

impl Header {
    /// The header at the beginning of `bytes`.
    ///
    /// # Errors
    /// What is wrong with it, as a phrase that follows the array's name.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, &'static str> {
        let place = text_place(bytes)?;
        let text = bytes.get(place.clone()).ok_or("it ends within its header")?;
        let text = str::from_utf8(text).map_err(|_| NOT_NUMBERS)?;
        Self::from_dictionary(text, place.end).ok_or(NOT_NUMBERS)
    }

    fn from_dictionary(text: &str, end: usize) -> Option<Self> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
        while !rest.is_empty() {
            let (item, after) = rest.split_at(end_of_item(rest));
            rest = after.strip_prefix(',').unwrap_or(after).trim();
            let (key, value) = item.split_once(':')?;
            match unquoted(key.trim())? {
                "descr" => descr = Some(value.trim().to_owned()),
                "fortran_order" => order = Some(truth(value.trim())?),
                "shape" => shape = Some(sides(value.trim())?),
                _ => return None,
            }
        }
        Some(Self { descr: descr?, fortran_order: order?, shape: shape?, end })
    }
}

/// The range of the dictionary: after the magic word, the version and its length.
fn text_place(bytes: &[u8]) -> Result<Range<usize>, &'static str> {
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("it does not begin as a NumPy array does");
    }
    let place = match (bytes.get(6), bytes.get(8..12)) {
        (Some(1), Some(&[a, b, ..])) => 10..10 + usize::from(u16::from_le_bytes([a, b])),
        (Some(2 | 3), Some(&[a, b, c, d])) => 12..12_usize.saturating_add(u32::from_le_bytes([a, b, c, d]) as usize),
        (Some(1..=3) | None, _) => return Err("it ends within its header"),
        (Some(_), _) => return Err("it is of an unknown version of the format"),
    };
    if place.len() > LONGEST_HEADER {
        return Err("its header is longer than that of any array of numbers");
    }
    Ok(place)
}

/// The position of the first comma outside brackets and text, or the end.
fn end_of_item(text: &str) -> usize {
    let (mut depth, mut quote) = (0_usize, None);
    for (place, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), _) => quote = quote.filter(|_| byte != open),
            (None, b'\'' | b'"') => quote = Some(byte),
            (None, b'(' | b'[' | b'{') => depth += 1,
            (None, b')' | b']' | b'}') => depth = depth.saturating_sub(1),
            (None, b',') if depth == 0 => return place,
            (None, _) => {}
        }
    }
    text.len()
}

/// A text without its quotes.
pub(super) fn unquoted(text: &str) -> Option<&str> {
    let within = |quote: char| text.strip_prefix(quote)?.strip_suffix(quote);
    within('\'').or_else(|| within('"'))
}

fn truth(text: &str) -> Option<bool> {
    match text {
        "True" => Some(true),
        "False" => Some(false),
        _ => None,
    }
}

/// The side lengths of an array, whose product fits into an `i64`.
fn sides(text: &str) -> Option<Vec<u64>> {
    let list = text.strip_prefix('(')?.strip_suffix(')')?.trim();
    let list = list.strip_suffix(',').unwrap_or(list);
    if list.is_empty() {
        return Some(Vec::new());
    }
    let sides = list.split(',').map(|side| side.trim().parse().ok()).collect::<Option<Vec<u64>>>()?;
    let product = |product: i64, side: &u64| product.checked_mul(i64::try_from(*side).ok()?.max(1));
    sides.iter().try_fold(1, product)?;
    Some(sides)
}

#[cfg(test)]
mod tests {
    use super::super::test_files::{npy, npy_with_header};
    use super::*;

    #[test]
    fn headers_of_numpy() {
        let bytes = npy("<f8", true, "(3, 2)", &[]);
        let expected = Header { descr: "'<f8'".into(), fortran_order: true, shape: vec![3, 2], end: bytes.len() };
        assert_eq!(Header::parse(&bytes), Ok(expected));
        for (shape, sides) in [("()", vec![]), ("(7,)", vec![7]), ("(1, 2, 3)", vec![1, 2, 3])] {
            assert_eq!(Header::parse(&npy("<f8", false, shape, &[])).map(|header| header.shape), Ok(sides));
        }
    }

    #[test]
    fn longer_lengths_of_version_2() {
        let text = b"{\"shape\": (2,), \"fortran_order\": False, \"descr\": [('a', '<f8', (2,)), ('b', '|S1')]}   \n";
        let size = u32::try_from(text.len()).unwrap().to_le_bytes();
        let bytes = [b"\x93NUMPY\x02\x00".as_slice(), &size, text].concat();
        let header = Header::parse(&bytes).unwrap();
        assert_eq!(header.descr, "[('a', '<f8', (2,)), ('b', '|S1')]");
        assert_eq!((header.shape, header.end), (vec![2], bytes.len()));
    }

    #[test]
    fn what_is_no_header() {
        let texts = [
            "",
            "{}",
            "{'descr': '<f8', 'fortran_order': False}",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (1,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), 'more': 1}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': 3}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1 2)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (9223372036854775807, 2)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1,)",
        ];
        for text in texts {
            assert!(Header::parse(&npy_with_header(text)).is_err(), "{text}");
        }
    }
}
