//! The words and signs of an IDL text, without its comments.

/// A part of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// A name or a number.
    Word(&'a str),
    Sign(char),
    /// A text in quotes.
    Quoted,
}

/// The parts of a text in their order.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        rest = if let Some(after) = after_comment(rest)? {
            after
        } else if first == '"' || first == '\'' {
            tokens.push(Token::Quoted);
            after_quote(&rest[1..], first)?
        } else {
            let end = rest.find(|c| !is_of_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
            let (token, after) = rest.split_at(end);
            tokens.push(if is_of_word(first) { Token::Word(token) } else { Token::Sign(first) });
            after
        }
        .trim_start();
    }
    Ok(tokens)
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.')
}

/// The text after a comment or a line for the preprocessor at the beginning.
fn after_comment(text: &str) -> Result<Option<&str>, String> {
    if text.starts_with("//") || text.starts_with('#') {
        return Ok(Some(text.find('\n').map_or("", |end| &text[end..])));
    }
    let Some(comment) = text.strip_prefix("/*") else { return Ok(None) };
    let end = comment.find("*/").ok_or("a comment of the IDL has no end")?;
    Ok(Some(&comment[end + 2..]))
}

fn after_quote(text: &str, quote: char) -> Result<&str, String> {
    let mut escaped = false;
    for (place, c) in text.char_indices() {
        if c == quote && !escaped {
            return Ok(&text[place + 1..]);
        }
        escaped = c == '\\' && !escaped;
    }
    Err("a text of the IDL has no closing quote".to_owned())
}
