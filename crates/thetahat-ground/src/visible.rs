//! Texts of others, names above all, that cannot steer a terminal or a spreadsheet.

use std::borrow::Cow;

/// A text with every control character written out, `\u{1b}` for the one that starts a terminal's commands, and so that it
/// is one line.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, steers)
}

/// The same of a text of several lines: line ends and tabs stay.
#[must_use]
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| steers(c) && !matches!(c, '\n' | '\t'))
}

/// A text as a cell of a CSV file: visible, and with an apostrophe before what a spreadsheet would take for a formula.
/// Numbers stay numbers.
#[must_use]
pub fn cell(text: &str) -> Cow<'_, str> {
    let text = visible(text);
    let formula = text.trim_start().starts_with(['=', '+', '-', '@']) && text.parse::<f64>().is_err();
    if formula { Cow::Owned(format!("'{text}")) } else { text }
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if hidden(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// Control characters, line and paragraph separators, and the marks that turn the direction of writing.
fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        assert_eq!(visible("a\x1b[31mb\x07\u{9b}2J\r\n\u{202e}c"), r"a\u{1b}[31mb\u{7}\u{9b}2J\r\n\u{202e}c");
        assert_eq!(visible_lines("a\tb\n\x1b]0;c"), "a\tb\n\\u{1b}]0;c");
        assert!(matches!(visible("Gelenk ä 1 µ"), Cow::Borrowed(_)));
    }

    #[test]
    fn formulas_are_texts_and_numbers_stay() {
        for text in ["=1+1", "+cmd", "-2+3", "@SUM(A1)", " =1", "-"] {
            assert_eq!(cell(text), format!("'{text}"));
        }
        for text in ["-1.5", "+2", "-1e-9", "q1", "", "xx1r + 2 m2", "-inf"] {
            assert_eq!(cell(text), text);
        }
        assert_eq!(cell("\t=1"), r"\t=1");
    }
}
