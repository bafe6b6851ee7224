//! The part of YAML in which parameters of robots are written: blocks and flows of lists and dictionaries, scalars, comments
//! and xacro's units such as `!degrees`.

use super::{
    value::Value,
    yaml_scalars::{DEEPEST, Parsed, Problem, Scalars, balance, key_end},
};

/// The value of a YAML text; `evaluate` gives the numbers of expressions with units.
pub(super) fn parse(text: &str, evaluate: &mut dyn FnMut(&str) -> Option<f64>) -> Parsed {
    let mut parser = Parser { lines: lines(text)?, next: 0, scalars: Scalars { evaluate } };
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
    scalars: Scalars<'f>,
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
            let key = self.scalars.scalar(&key, number)?;
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
        let mut open = if is_flow { balance(&content) } else { 0 };
        while open > 0 {
            let Some(line) = self.lines.get(self.next) else {
                return Err(Problem { line: number, problem: "a bracket is not closed" });
            };
            content.push(' ');
            content.push_str(&line.content);
            open += balance(&line.content);
            self.next += 1;
        }
        if is_flow { self.scalars.flow(&content, number, depth) } else { self.scalars.scalar(&content, number) }
    }
}

fn is_item(content: &str) -> bool {
    content == "-" || content.starts_with("- ")
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
            Ok(format!("{{'a': {:?}, 'b': 0.02}}", 180.0 * std::f64::consts::PI / 180.0))
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
        assert_eq!(line(&format!("a: [\n{}", "1,\n".repeat(100_000))), 1);
        assert!(read(&"- ".repeat(1000)).is_err());
        assert!(read(&"[".repeat(1000)).is_err());
    }
}
