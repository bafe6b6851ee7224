//! Rust source to tokens: what a compiler would read outside comments, literals, visibilities and test-only items.

/// A word, a punctuation character, or `::`.
pub type Token = String;

/// The tokens of a source text, without comments, literals, `pub(...)` and items under `#[cfg(test)]`.
pub fn tokens(text: &str) -> Vec<Token> {
    without_visibilities(without_test_items(words(text)))
}

/// Words and punctuation; comments and literals leave nothing.
fn words(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &text[at..];
        if let Some(length) = skipped(rest) {
            at += length;
        } else if word_byte(bytes[at]) {
            let length = rest.bytes().take_while(|&byte| word_byte(byte)).count();
            tokens.push(rest[..length].to_owned());
            at += length;
        } else {
            let length = if rest.starts_with("::") { 2 } else { 1 };
            tokens.push(rest[..length].to_owned());
            at += length;
        }
    }
    tokens
}

/// Identifiers, keywords and numbers.
fn word_byte(byte: u8) -> bool {
    byte == b'_' || byte.is_ascii_alphanumeric()
}

/// The length of the white space, comment or literal at the start of `rest`.
fn skipped(rest: &str) -> Option<usize> {
    let first = rest.chars().next()?;
    if first.is_whitespace() || !first.is_ascii() {
        return Some(first.len_utf8());
    }
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(rest.find("*/").map_or(rest.len(), |end| end + 2));
    }
    match first {
        '"' => Some(string_length(rest)),
        'r' | 'b' => prefixed_string_length(rest),
        '\'' => Some(quote_length(rest)),
        _ => None,
    }
}

/// The length of `"..."`.
fn string_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut at = 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    at + 1
}

/// The length of `b"..."`, `r"..."`, `br"..."`, `r#"..."#`; none for a word that only begins with these letters.
fn prefixed_string_length(rest: &str) -> Option<usize> {
    let prefix = rest.bytes().take_while(|byte| b"br".contains(byte)).count();
    let hashes = rest[prefix..].bytes().take_while(|&byte| byte == b'#').count();
    let open = prefix + hashes;
    if rest.as_bytes().get(open) == Some(&b'\'') && &rest[..open] == "b" {
        return Some(open + quote_length(&rest[open..]));
    }
    if prefix > 2 || rest.as_bytes().get(open) != Some(&b'"') {
        return None;
    }
    if !rest[..prefix].contains('r') {
        return Some(open + string_length(&rest[open..]));
    }
    let close = format!("\"{}", "#".repeat(hashes));
    Some(rest[open + 1..].find(&close).map_or(rest.len(), |end| open + 1 + end + close.len()))
}

/// The length of a character, or of the quote that begins a lifetime.
fn quote_length(rest: &str) -> usize {
    if rest[1..].starts_with('\\') {
        return rest[3..].find('\'').map_or(1, |end| end + 4);
    }
    let after = rest[1..].chars().next().map_or(1, |character| 1 + character.len_utf8());
    if rest[after..].starts_with('\'') { after + 1 } else { 1 }
}

/// Drops every item under `#[cfg(test)]` or `#[cfg(all(test, ...))]`.
fn without_test_items(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let ahead: String = tokens[at..].iter().take(8).map(String::as_str).collect();
        if ahead.starts_with("#[cfg(test)]") || ahead.starts_with("#[cfg(all(test,") {
            at = item_end(&tokens, at + 2);
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// Behind the item that begins at `from`: its `;`, or its closing brace.
fn item_end(tokens: &[Token], from: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(from) {
        match token.as_str() {
            "{" => depth += 1,
            "}" if depth == 1 => return at + 1,
            "}" => depth -= 1,
            ";" if depth == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Drops `(crate)`, `(super)` and `(in super::super)` behind `pub`, which import nothing.
fn without_visibilities(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept: Vec<Token> = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let scope = tokens.get(at + 1).map(String::as_str);
        let visibility = tokens[at] == "("
            && kept.last().is_some_and(|token| token == "pub")
            && matches!(scope, Some("crate" | "super" | "in" | "self"));
        if visibility {
            at += 1 + tokens[at..].iter().position(|token| token == ")").unwrap_or(0);
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

#[test]
fn tokens_hold_no_comments_literals_or_test_items() {
    let text = r##"
        /* use a; */ use crate::b; // use c;
        pub(in super::super) fn f<'a>(x: &'a str) -> char { let s = r#"use "d"#; let t = b"\"use e"; '\'' }
        #[cfg(test)]
        mod tests { use super::*; fn g() {} }
        #[cfg(all(test, unix))] use crate::h;
        struct Result;
    "##;
    let expected = "use crate :: b ; pub fn f < a > ( x : & a str ) - > char { let s = ; let t = ; } struct Result ;";
    assert_eq!(tokens(text).join(" "), expected);
}
