//! The part of YAML in which parameters of robots are written: blocks and flows of lists and dictionaries, scalars, comments
//! and xacro's units such as `!degrees`.

use super::value::{Number, Value, number_of};

/// Most lists and dictionaries in one another.
const DEEPEST: usize = 40;

/// xacro's units by their tags, with their size in SI.
const UNITS: [(&str, f64); 6] = [
    ("!degrees", std::f64::consts::PI / 180.0),
    ("!radians", 1.0),
    ("!meters", 1.0),
    ("!millimeters", 0.001),
    ("!foot", 0.3048),
    ("!inches", 0.0254),
];

/// Why a file is not read.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Problem {
    /// The line, from one.
    pub(super) line: usize,
    pub(super) problem: &'static str,
}

type Parsed = Result<Value, Problem>;
/// The number of an expression, such as that of `!degrees 90 / 2`.
type Evaluate<'f> = &'f mut dyn FnMut(&str) -> Option<f64>;

/// The value of a YAML text; `evaluate` gives the numbers of expressions with units.
pub(super) fn parse(text: &str, evaluate: Evaluate<'_>) -> Parsed {
    let mut parser = Parser { lines: lines(text)?, next: 0, evaluate };
    let Some(first) = parser.lines.first() else { return Ok(Value::None) };
    let indent = first.indent;
    let value = parser.block(indent, 0)?;
    match parser.lines.get(parser.next) {
        None => Ok(value),
        Some(line) => {
            Err(Problem { line: line.number, problem: "this line is indented less than those it belongs to" })
        }
    }
}

/// A line without comment and indentation.
#[derive(Debug, Clone)]
struct Line {
    indent: usize,
    content: String,
    number: usize,
}

fn lines(text: &str) -> Result<Vec<Line>, Problem> {
    let mut lines = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let number = index + 1;
        let content = without_comment(line).trim_end();
        let trimmed = content.trim_start_matches(' ');
        if trimmed.is_empty() || (lines.is_empty() && (trimmed == "---" || trimmed.starts_with('%'))) {
            continue;
        }
        if trimmed.starts_with('\t') {
            return Err(Problem { line: number, problem: "a tab indents this line; use blanks" });
        }
        if trimmed == "---" || trimmed == "..." {
            return Err(Problem { line: number, problem: "a second document begins here; only one is read" });
        }
        lines.push(Line { indent: content.len() - trimmed.len(), content: trimmed.to_owned(), number });
    }
    Ok(lines)
}

/// The line up to a `#` that is outside of quotes and follows a blank.
fn without_comment(line: &str) -> &str {
    let (mut quote, mut before) = (None, ' ');
    for (place, letter) in line.char_indices() {
        match (quote, letter) {
            (None, '#') if before.is_whitespace() => return &line[..place],
            (None, '"' | '\'') if !before.is_alphanumeric() => quote = Some(letter),
            (Some(open), _) if letter == open => quote = None,
            _ => {}
        }
        before = letter;
    }
    line
}

struct Parser<'f> {
    lines: Vec<Line>,
    next: usize,
    evaluate: Evaluate<'f>,
}

impl Parser<'_> {
    /// The list, dictionary or scalar whose lines have this indentation.
    fn block(&mut self, indent: usize, depth: usize) -> Parsed {
        let Some(line) = self.lines.get(self.next) else { return Ok(Value::None) };
        if depth > DEEPEST {
            return Err(Problem { line: line.number, problem: "lists and dictionaries are nested more than 40 deep" });
        }
        if is_item(&line.content) {
            return self.list(indent, depth);
        }
        if key_end(&line.content).is_some() {
            return self.dictionary(indent, depth);
        }
        self.scalar_lines(depth)
    }

    fn list(&mut self, indent: usize, depth: usize) -> Parsed {
        let mut items = Vec::new();
        while let Some(line) = self.lines.get(self.next).filter(|line| line.indent == indent && is_item(&line.content))
        {
            let rest = line.content[1..].trim_start().to_owned();
            if rest.is_empty() {
                self.next += 1;
                items.push(self.nested(indent, depth)?);
                continue;
            }
            // What follows the dash is a line of its own, indented further.
            let inner = indent + line.content.len() - rest.len();
            let line = &mut self.lines[self.next];
            (line.indent, line.content) = (inner, rest);
            items.push(self.block(inner, depth + 1)?);
        }
        Ok(Value::list(items))
    }

    fn dictionary(&mut self, indent: usize, depth: usize) -> Parsed {
        let mut entries = Vec::new();
        while let Some(line) = self.lines.get(self.next).filter(|line| line.indent == indent && !is_item(&line.content))
        {
            let number = line.number;
            let Some(end) = key_end(&line.content) else {
                return Err(Problem { line: number, problem: "expected `key: value`" });
            };
            let (key, value) = (line.content[..end].trim().to_owned(), line.content[end + 1..].trim().to_owned());
            if key == "<<" {
                return Err(Problem {
                    line: number,
                    problem: "merged dictionaries (<<) are not read; write the entries",
                });
            }
            let key = self.scalar(&key, number)?;
            let value = if value.is_empty() {
                self.next += 1;
                self.of_key(indent, depth)?
            } else {
                let line = &mut self.lines[self.next];
                line.content = value;
                self.scalar_lines(depth)?
            };
            entries.push((key, value));
        }
        Ok(Value::map(entries))
    }

    /// The lines below `key:`, of which a list may have the same indentation.
    fn of_key(&mut self, indent: usize, depth: usize) -> Parsed {
        match self.lines.get(self.next) {
            Some(line) if line.indent == indent && is_item(&line.content) => self.list(indent, depth + 1),
            _ => self.nested(indent, depth),
        }
    }

    fn nested(&mut self, indent: usize, depth: usize) -> Parsed {
        match self.lines.get(self.next).map(|line| line.indent) {
            Some(inner) if inner > indent => self.block(inner, depth + 1),
            _ => Ok(Value::None),
        }
    }

    /// A scalar, or a flow that may go on in the next lines until its brackets are closed.
    fn scalar_lines(&mut self, depth: usize) -> Parsed {
        let Line { mut content, number, .. } = self.lines[self.next].clone();
        self.next += 1;
        let is_flow = content.starts_with(['[', '{']);
        while is_flow && open_brackets(&content) > 0 {
            let Some(line) = self.lines.get(self.next) else {
                return Err(Problem { line: number, problem: "a bracket is not closed" });
            };
            content.push(' ');
            content.push_str(&line.content);
            self.next += 1;
        }
        if is_flow { self.flow(&content, number, depth) } else { self.scalar(&content, number) }
    }

    fn flow(&mut self, text: &str, line: usize, depth: usize) -> Parsed {
        let text = text.trim();
        if depth > DEEPEST {
            return Err(Problem { line, problem: "lists and dictionaries are nested more than 40 deep" });
        }
        let unclosed = Problem { line, problem: "a bracket is not closed" };
        if let Some(inner) = text.strip_prefix('[') {
            let parts = parts(inner.strip_suffix(']').ok_or(unclosed)?);
            let items = parts.into_iter().map(|part| self.flow(part, line, depth + 1));
            return Ok(Value::list(items.collect::<Result<_, _>>()?));
        }
        let Some(inner) = text.strip_prefix('{') else { return self.scalar(text, line) };
        let mut entries = Vec::new();
        for part in parts(inner.strip_suffix('}').ok_or(unclosed)?) {
            let end = key_end(part).ok_or(Problem { line, problem: "expected `key: value` in braces" })?;
            let key = self.scalar(part[..end].trim(), line)?;
            entries.push((key, self.flow(&part[end + 1..], line, depth + 1)?));
        }
        Ok(Value::map(entries))
    }

    fn scalar(&mut self, text: &str, line: usize) -> Parsed {
        let first = text.chars().next().unwrap_or(' ');
        match first {
            '"' | '\'' => quoted(text, first).ok_or(Problem { line, problem: "a quote is not closed" }),
            '!' => self.with_unit(text, line),
            '&' | '*' => Err(Problem { line, problem: "anchors and aliases (& and *) are not read; write the value" }),
            '|' | '>' => Err(Problem { line, problem: "texts of several lines (| and >) are not read; use one line" }),
            _ => Ok(plain(text)),
        }
    }

    fn with_unit(&mut self, text: &str, line: usize) -> Parsed {
        let (tag, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let Some((_, size)) = UNITS.iter().find(|(unit, _)| *unit == tag) else {
            let problem = "the tags are !degrees, !radians, !meters, !millimeters, !foot and !inches";
            return Err(Problem { line, problem });
        };
        let number = (self.evaluate)(rest.trim_matches(|c: char| c.is_whitespace() || c == '"' || c == '\''));
        number
            .map(|number| Value::Float(number * size))
            .ok_or(Problem { line, problem: "expected a number after the unit" })
    }
}

fn is_item(content: &str) -> bool {
    content == "-" || content.starts_with("- ")
}

/// Goes over the letters outside of quotes, with the number of brackets that are open there.
fn outside_quotes(text: &str) -> impl Iterator<Item = (usize, char, usize)> {
    let (mut quote, mut open, mut before) = (None, 0usize, ' ');
    text.char_indices().filter_map(move |(place, letter)| {
        let starts = !before.is_alphanumeric();
        before = letter;
        match (quote, letter) {
            (Some(end), _) => {
                quote = Some(end).filter(|end| *end != letter);
                return None;
            }
            (None, '"' | '\'') if starts => {
                quote = Some(letter);
                return None;
            }
            (None, '[' | '{') => open += 1,
            (None, ']' | '}') => open = open.saturating_sub(1),
            (None, _) => {}
        }
        Some((place, letter, open))
    })
}

fn open_brackets(text: &str) -> usize {
    outside_quotes(text).last().map_or(0, |(_, _, open)| open)
}

/// The place of the colon that ends a key.
fn key_end(text: &str) -> Option<usize> {
    let ends = |place: usize| text[place + 1..].chars().next().is_none_or(char::is_whitespace);
    outside_quotes(text).find(|(place, letter, open)| *letter == ':' && *open == 0 && ends(*place)).map(|found| found.0)
}

/// The parts between commas outside of brackets.
fn parts(text: &str) -> Vec<&str> {
    let commas = outside_quotes(text).filter(|(_, letter, open)| *letter == ',' && *open == 0).map(|found| found.0);
    let ends: Vec<usize> = commas.chain([text.len()]).collect();
    let starts = std::iter::once(0).chain(ends.iter().map(|end| end + 1));
    starts.zip(&ends).map(|(start, end)| text[start..*end].trim()).filter(|part| !part.is_empty()).collect()
}

fn quoted(text: &str, quote: char) -> Option<Value> {
    let inner = text.strip_prefix(quote)?.strip_suffix(quote).filter(|_| text.len() >= 2)?;
    Some(Value::text(&match quote {
        '\'' => inner.replace("''", "'"),
        _ => inner.replace("\\n", "\n").replace("\\t", "\t").replace("\\\"", "\"").replace("\\\\", "\\"),
    }))
}

/// A scalar without quotes.
fn plain(text: &str) -> Value {
    match text {
        "" | "~" | "null" | "Null" | "NULL" => return Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => return Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => return Value::Bool(false),
        ".inf" | "+.inf" => return Value::Float(f64::INFINITY),
        "-.inf" => return Value::Float(f64::NEG_INFINITY),
        ".nan" => return Value::Float(f64::NAN),
        _ => {}
    }
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    match number_of(text).filter(|_| is_number) {
        Some(Number::Integer(value)) => Value::Integer(value),
        Some(Number::Float(value)) => Value::Float(value),
        None => Value::text(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<String, Problem> {
        parse(text, &mut |text| text.parse().ok()).map(|value| value.to_text())
    }

    /// Written by PyYAML 6.0: `print(yaml.safe_load(text))`.
    #[test]
    fn values_are_those_of_pyyaml() {
        let of = |text: &str| read(text).unwrap();
        let block = "---\n# a comment\nlimits:\n  shoulder: {max: 3.5, min: -3.5}  # rad\n  names: [a, 'b c', \"d\"]\n\
                     list:\n- 1\n- x: 2\n  y: yes\n-\n  - true\nempty:\nurl: http://x#y\n'q: r': ~\n";
        let expected = "{'limits': {'shoulder': {'max': 3.5, 'min': -3.5}, 'names': ['a', 'b c', 'd']}, \
                        'list': [1, {'x': 2, 'y': True}, [True]], 'empty': None, 'url': 'http://x#y', 'q: r': None}";
        assert_eq!(of(block), expected);
        assert_eq!(of("a: [1,\n  2,\n  3]\nb: .5"), "{'a': [1, 2, 3], 'b': 0.5}");
        assert_eq!([of("- - 1\n  - 2\n- 3"), of("it's"), of("")], ["[[1, 2], 3]", "it's", "None"]);
    }

    #[test]
    fn units_are_converted() {
        assert_eq!(
            read("a: !degrees 180.0\nb: !millimeters  20"),
            Ok(format!("{{'a': {:?}, 'b': 0.02}}", 180.0 * UNITS[0].1))
        );
        assert_eq!(read("a: !color 3").unwrap_err().line, 1);
    }

    #[test]
    fn other_yaml_is_refused_with_its_line() {
        let line = |text: &str| read(text).unwrap_err().line;
        assert_eq!(line("a: 1\nb: &x 2"), 2);
        assert_eq!(line("a: 1\nb: |\n  text"), 2);
        assert_eq!(line("a: [1, 2"), 1);
        assert_eq!(line("a:\n\tb: 1"), 2);
        assert_eq!(line("a: 1\n---\nb: 1"), 2);
        assert_eq!(line("a: 1\nb"), 2);
        assert_eq!(line("  a: 1\nb: 2"), 2);
        assert!(read(&"- ".repeat(1000)).is_err());
        assert!(read(&"[".repeat(1000)).is_err());
    }
}
