//! Makes text from outside, such as names, safe to print: it cannot steer a terminal or a spreadsheet.

use std::borrow::Cow;

/// The text on one line with every control character escaped, for example `\u{1b}`, which starts a terminal's commands.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, steers)
}

/// The text with control characters escaped; line ends and tabs stay.
#[must_use]
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| steers(c) && !matches!(c, '\n' | '\t'))
}

/// The text as a cell of a CSV file: escaped, and with an apostrophe before anything that a spreadsheet would read as a formula. Numbers
/// stay numbers.
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

/// Control characters, line and paragraph separators, marks that change the direction of writing, and characters of no width, with which
/// two names look alike.
fn steers(c: char) -> bool {
    let has_no_width = matches!(
        c,
        '\u{ad}' | '\u{34f}' | '\u{180e}' | '\u{200b}'..='\u{200d}' | '\u{2060}'..='\u{2064}' | '\u{feff}' | '\u{e0000}'..='\u{e007f}'
    );
    let directs = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || has_no_width || directs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        assert_eq!(visible("a\x1b[31mb\x07\u{9b}2J\r\n\u{202e}c"), r"a\u{1b}[31mb\u{7}\u{9b}2J\r\n\u{202e}c");
        assert_eq!(visible("q\u{200b}1\u{feff}\u{61c}"), r"q\u{200b}1\u{feff}\u{61c}");
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
