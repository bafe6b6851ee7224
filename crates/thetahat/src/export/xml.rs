//! Numbers, names and comments in XML.

/// Below this and above the other, numbers are written with an exponent.
const SMALL: f64 = 1e-4;
const LARGE: f64 = 1e9;

/// A number with as few digits as give it back.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (SMALL..LARGE).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Numbers with spaces between.
pub(super) fn numbers(values: &[f64]) -> String {
    values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(" ")
}

/// A text as an attribute's value or an element's content.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// Lines as one comment, which cannot be ended by what they hold.
pub(super) fn comment(lines: &[String]) -> String {
    let inside: String = lines.iter().map(|line| format!("  {}\n", commentable(line))).collect();
    format!("<!--\n{inside}-->\n")
}

fn commentable(line: &str) -> String {
    let line: String = line.chars().filter(|c| !c.is_control()).collect();
    line.replace("--", "- -").replace("--", "- -").trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        for value in [0.0, 1.0, -0.1, 1.0 / 3.0, 1e-12, -4.2e17, 1e9, f64::MIN_POSITIVE] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!([number(0.5), number(2e-7), number(-0.0)], ["0.5", "2e-7", "0"]);
    }

    #[test]
    fn what_a_comment_holds_cannot_end_it() {
        let text = format!("{}<a/>", comment(&["--> <b/> ---".to_owned(), "a--force-".to_owned()]));
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().tag_name().name(), "a");
    }

    #[test]
    fn names_come_back() {
        let text = format!("<a b=\"{}\"/>", escaped("<x> & \"y\""));
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("b"), Some("<x> & \"y\""));
    }
}
