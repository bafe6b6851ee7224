//! The encoding of a text: UTF-8 and Latin-1 stay as they are, UTF-16 becomes UTF-8.

use std::borrow::Cow;
use std::path::Path;

use super::super::error::RecordingError;

/// Number of bytes that are examined for UTF-16 without a byte order mark.
const EXAMINED_BYTES: usize = 1 << 12;
/// Least number of characters that show UTF-16 without a mark.
const LEAST_CHARACTERS: usize = 4;
/// Fraction of characters below 256, which UTF-16 writes with a zero byte.
const ZERO_BYTES: f64 = 0.8;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

/// A text in UTF-8 or Latin-1: lines keep their numbers.
pub(super) fn decoded<'a>(bytes: &'a [u8], path: &Path) -> Result<Cow<'a, [u8]>, RecordingError> {
    if bytes.starts_with(b"\xff\xfe\0\0") || bytes.starts_with(b"\0\0\xfe\xff") {
        return Err(RecordingError::damaged(path, "the text is in UTF-32; save it as UTF-8".to_owned()));
    }
    Ok(match byte_order(bytes) {
        Some((order, mark)) => Cow::Owned(from_utf_16(&bytes[mark..], order).into_bytes()),
        None => Cow::Borrowed(bytes),
    })
}

/// Whether a text is in UTF-16, by its first bytes.
pub(super) fn is_utf_16(bytes: &[u8]) -> bool {
    byte_order(bytes).is_some()
}

/// The byte order of UTF-16 and the length of its mark; none for another encoding.
fn byte_order(bytes: &[u8]) -> Option<(ByteOrder, usize)> {
    if bytes.starts_with(b"\xff\xfe") {
        return Some((ByteOrder::Little, 2));
    }
    if bytes.starts_with(b"\xfe\xff") {
        return Some((ByteOrder::Big, 2));
    }
    let pairs = bytes[..bytes.len().min(EXAMINED_BYTES)].as_chunks::<2>().0;
    let zeros = |place: usize| pairs.iter().filter(|pair| pair[place] == 0).count();
    let most = |count: usize| pairs.len() >= LEAST_CHARACTERS && count as f64 >= ZERO_BYTES * pairs.len() as f64;
    match (zeros(0), zeros(1)) {
        (0, high) if most(high) => Some((ByteOrder::Little, 0)),
        (high, 0) if most(high) => Some((ByteOrder::Big, 0)),
        _ => None,
    }
}

/// The characters; a half character at the end becomes one that is in no number, so that its cell is refused.
fn from_utf_16(bytes: &[u8], order: ByteOrder) -> String {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let unit = |pair: &[u8; 2]| match order {
        ByteOrder::Little => u16::from_le_bytes(*pair),
        ByteOrder::Big => u16::from_be_bytes(*pair),
    };
    let characters = char::decode_utf16(pairs.iter().map(unit)).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    characters.chain(rest.iter().map(|_| char::REPLACEMENT_CHARACTER)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "t;q [°]\n0;1,5\n";

    fn utf_16(order: ByteOrder, mark: bool) -> Vec<u8> {
        let units = mark.then_some('\u{feff}').into_iter().chain(TEXT.chars()).map(|c| c as u16);
        units
            .flat_map(|unit| if order == ByteOrder::Little { unit.to_le_bytes() } else { unit.to_be_bytes() })
            .collect()
    }

    #[test]
    fn utf_16_in_both_byte_orders_with_and_without_a_mark() {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            for mark in [true, false] {
                let bytes = utf_16(order, mark);
                assert_eq!(decoded(&bytes, Path::new("q.csv")).unwrap(), TEXT.as_bytes(), "{order:?} {mark}");
            }
        }
    }

    #[test]
    fn other_texts_are_left_alone() {
        for bytes in [&b"t,q\n0,1\n"[..], b"q [\xb0]\n1\n", b"", b"\0", "Größe;Δ\n1;2\n".as_bytes()] {
            assert!(matches!(decoded(bytes, Path::new("q.csv")).unwrap(), Cow::Borrowed(_)), "{bytes:?}");
        }
        assert!(decoded(b"\xff\xfe\0\0t\0\0\0", Path::new("q.csv")).is_err());
    }

    #[test]
    fn a_half_character_is_in_no_number() {
        let bytes = utf_16(ByteOrder::Little, true);
        let text = decoded(&bytes[..bytes.len() - 1], Path::new("q.csv")).unwrap();
        assert!(str::from_utf8(&text).unwrap().ends_with("1,5\u{fffd}"));
    }
}
