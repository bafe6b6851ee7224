//! Texts in lines that fit a terminal.

use thetahat_ground::visible::visible_lines;

/// Columns of a terminal: the longest line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextWidth(usize);

impl TextWidth {
    /// The smallest and largest number of columns for the layout of texts.
    pub const RANGE: [usize; 2] = [40, 200];

    /// The width if the terminal does not report one: 80 columns.
    pub const DEFAULT: Self = Self(80);

    /// This many columns, within [`TextWidth::RANGE`].
    #[must_use]
    pub fn new(columns: usize) -> Self {
        let [least, most] = Self::RANGE;
        Self(columns.clamp(least, most))
    }

    /// The number of columns.
    #[must_use]
    pub fn columns(self) -> usize {
        self.0
    }
}

impl Default for TextWidth {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Splits a text into indented lines that fit, at spaces where possible.
pub(super) fn wrap(text: &str, indent: &str, width: TextWidth) -> String {
    let width = width.columns().saturating_sub(indent.chars().count()).max(1);
    wrap_to(text, width).iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// The lines of a text with at most this many characters, split at spaces where possible.
pub(super) fn wrap_to(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in visible_lines(text).split_whitespace().flat_map(|word| pieces(word, width)) {
        match lines.last_mut() {
            Some(line) if line.is_empty() => *line = word,
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => *line += &format!(" {word}"),
            _ => lines.push(word),
        }
    }
    lines
}

/// A label in a column of this many characters, and its text next to it.
pub(super) fn labelled(label: &str, text: &str, column: usize, width: TextWidth) -> String {
    let lines = wrap(text, &" ".repeat(column), width);
    format!("{label:<column$}{}", lines.trim_start())
}

/// A text shortened to this many characters.
pub(super) fn shortened(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    text.chars().take(width.saturating_sub(1)).chain(['…']).collect()
}

/// A word, split if it is longer than a line.
fn pieces(word: &str, width: usize) -> Vec<String> {
    let characters: Vec<char> = word.chars().collect();
    characters.chunks(width).map(|piece| piece.iter().collect()).collect()
}
