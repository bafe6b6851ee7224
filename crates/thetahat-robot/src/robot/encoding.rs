//! Text of a description from its bytes: UTF-8, or the encoding of its byte order mark or XML declaration.

use std::borrow::Cow;

/// Most bytes at the beginning of a file in which an XML declaration is looked for.
const DECLARATION: usize = 200;

/// Windows-1252 in the places where Latin-1 has control characters.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘', '’',
    '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Bytes that are not text in the encoding they should have.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NotText {
    /// The first line that cannot be read, from one.
    pub(super) line: usize,
    pub(super) encoding: String,
}

/// The text of these bytes. A declaration of another encoding says UTF-8 afterwards, as the text is written in it from then
/// on.
pub(super) fn decoded(bytes: Vec<u8>) -> Result<String, NotText> {
    match bytes[..] {
        [0xff, 0xfe, ..] => utf_16(&bytes[2..], u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf_16(&bytes[2..], u16::from_be_bytes),
        [b'<', 0, ..] => utf_16(&bytes, u16::from_le_bytes),
        [0, b'<', ..] => utf_16(&bytes, u16::from_be_bytes),
        _ => of_bytes(bytes),
    }
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, NotText> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let units = pairs.iter().map(|pair| unit(*pair));
    let text: Result<String, _> = char::decode_utf16(units.clone()).collect();
    match text {
        Ok(text) if rest.is_empty() => Ok(with_utf_8_declared(text)),
        Ok(_) | Err(_) => {
            let readable = char::decode_utf16(units).take_while(Result::is_ok).flatten();
            Err(NotText { line: 1 + readable.filter(|c| *c == '\n').count(), encoding: "UTF-16".to_owned() })
        }
    }
}

fn of_bytes(bytes: Vec<u8>) -> Result<String, NotText> {
    let declared = declared_encoding(&bytes).map(|range| String::from_utf8_lossy(&bytes[range]).into_owned());
    let declared = declared.unwrap_or_else(|| "UTF-8".to_owned());
    match single_byte(&declared) {
        Some(letter) if !bytes.is_ascii() => Ok(with_utf_8_declared(bytes.into_iter().map(letter).collect())),
        _ => String::from_utf8(bytes).map_err(|error| NotText {
            line: 1 + error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count(),
            encoding: declared,
        }),
    }
}

/// The letter of each byte in an encoding with one byte for each letter.
fn single_byte(encoding: &str) -> Option<fn(u8) -> char> {
    match encoding.to_ascii_lowercase().as_str() {
        "iso-8859-1" | "iso8859-1" | "iso_8859-1" | "latin1" | "latin-1" => Some(char::from),
        "windows-1252" | "cp1252" => Some(of_windows_1252),
        _ => None,
    }
}

fn of_windows_1252(byte: u8) -> char {
    byte.checked_sub(0x80).and_then(|place| WINDOWS_1252.get(usize::from(place))).copied().unwrap_or(char::from(byte))
}

/// The place of the encoding's name in an XML declaration.
fn declared_encoding(bytes: &[u8]) -> Option<std::ops::Range<usize>> {
    let head: Cow<'_, str> = String::from_utf8_lossy(&bytes[..bytes.len().min(DECLARATION)]);
    let start = head.trim_start_matches('\u{feff}').starts_with("<?xml").then(|| head.find("encoding"))??;
    let declaration_end = head.find("?>")?;
    let open = start + head[start..].find(['"', '\''])?;
    let quote = head[open..].chars().next()?;
    let close = open + 1 + head[open + 1..].find(quote)?;
    // Before anything that is not ASCII, so that places in the text are places in the bytes.
    (close < declaration_end && head[..close].is_ascii()).then_some(open + 1..close)
}

fn with_utf_8_declared(mut text: String) -> String {
    if let Some(range) = declared_encoding(text.as_bytes()) {
        text.replace_range(range, "UTF-8");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: &str = "<?xml version=\"1.0\" encoding=\"UTF-16\"?>\n<robot name=\"bras à une articulation\"/>\n";

    fn utf_16_of(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn utf_16_is_read_by_its_mark_or_its_first_letter() {
        let expected = ARM.replace("UTF-16", "UTF-8");
        for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            assert_eq!(decoded(utf_16_of(ARM, bytes)), Ok(expected.clone()));
            assert_eq!(decoded(utf_16_of(&format!("\u{feff}{ARM}"), bytes)), Ok(expected.clone()));
        }
    }

    #[test]
    fn latin_1_and_windows_1252_are_read_by_their_declaration() {
        let text = |encoding: &str| ARM.replace("UTF-16", encoding);
        let bytes = |text: &str| text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect::<Vec<u8>>();
        for encoding in ["ISO-8859-1", "latin1", "windows-1252"] {
            assert_eq!(decoded(bytes(&text(encoding))), Ok(text("UTF-8")), "{encoding}");
        }
        assert_eq!(of_windows_1252(0x80), '€');
        assert_eq!(of_windows_1252(0xe4), 'ä');
    }

    #[test]
    fn ascii_and_utf_8_stay_as_they_are() {
        for text in ["<?xml version='1.0' encoding='ISO-8859-1'?>\n<robot/>", "name = 'ä'", "<robot name='ä'/>", ""] {
            assert_eq!(decoded(text.as_bytes().to_vec()).as_deref(), Ok(text));
        }
    }

    #[test]
    fn other_bytes_are_refused_with_their_line() {
        let of = |bytes: &[u8]| decoded(bytes.to_vec()).unwrap_err();
        assert_eq!(of(b"a = 1\nname = '\xe4'"), NotText { line: 2, encoding: "UTF-8".to_owned() });
        let gbk = of(b"<?xml version=\"1.0\" encoding=\"GBK\"?>\n\n<a n='\xc4\xe3'/>");
        assert_eq!(gbk, NotText { line: 3, encoding: "GBK".to_owned() });
        assert_eq!(of(b"\xff\xfe<\0\n\0\x00\xd8<\0").line, 2);
        assert_eq!(of(b"<\0a").encoding, "UTF-16");
    }
}
