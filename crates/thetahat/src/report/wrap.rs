//! Texts in lines that fit a terminal.

use crate::visible::visible_lines;

/// Columns of a terminal that no line exceeds.
pub const TEXT_WIDTH: usize = 80;

/// Cuts a text into indented lines of at most [`TEXT_WIDTH`] characters, at spaces where it can.
pub(super) fn wrap(text: &str, indent: &str) -> String {
    let width = TEXT_WIDTH - indent.chars().count();
    let mut lines: Vec<String> = vec![String::new()];
    for word in visible_lines(text).split_whitespace().flat_map(|word| pieces(word, width)) {
        match lines.last_mut() {
            Some(line) if line.is_empty() => *line = word,
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => *line += &format!(" {word}"),
            _ => lines.push(word),
        }
    }
    lines.iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// A word, cut where it is longer than a line.
fn pieces(word: &str, width: usize) -> Vec<String> {
    let characters: Vec<char> = word.chars().collect();
    characters.chunks(width).map(|piece| piece.iter().collect()).collect()
}
