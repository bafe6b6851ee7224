//! Errors in the keys of a file, in the words of who wrote it: `expected a number, found the text "x"` in place of the types of a program.

/// A message of a parser of TOML or JSON, on one line or several, without trailing blanks.
#[must_use]
pub fn in_plain_words(message: &str) -> String {
    message.trim_end().lines().map(line).collect::<Vec<_>>().join("\n")
}

fn line(line: &str) -> String {
    let place = |rest: &str| rest.rfind(" at line ").filter(|_| !line.starts_with("TOML")).unwrap_or(rest.len());
    for start in ["invalid type: ", "invalid value: ", "invalid length "] {
        let Some((found, rest)) = line.strip_prefix(start).and_then(|rest| rest.split_once(", expected ")) else {
            continue;
        };
        let (expected, place) = rest.split_at(place(rest));
        let found = if start == "invalid length " { format!("{found} of them") } else { value(found) };
        return format!("expected {}, found {found}{place}", kind(expected));
    }
    line.to_owned()
}

/// What was found, without the name of its type.
fn value(found: &str) -> String {
    let quoted = found.split_once('`').and_then(|(_, rest)| rest.strip_suffix('`'));
    match (found, quoted) {
        ("sequence", _) => "a list".to_owned(),
        ("map", _) => "a table".to_owned(),
        ("null" | "unit" | "unit value", _) => "nothing".to_owned(),
        (_, Some(value)) => value.to_owned(),
        _ => found.strip_prefix("string ").map_or_else(|| found.to_owned(), |text| format!("the text {text}")),
    }
}

/// What was expected, in place of a type.
fn kind(expected: &str) -> String {
    let words = match expected {
        "f64" | "f32" => "a number",
        "usize" | "u64" | "u32" | "u16" | "u8" => "a whole number, zero or above",
        "isize" | "i64" | "i32" | "i16" | "i8" => "a whole number",
        "a boolean" | "bool" => "true or false",
        "a string" | "string" => "a text",
        "a sequence" => "a list, [...]",
        "a map" => "a table, {...}",
        "option" => "a value",
        "a datetime" => "a date",
        _ => "",
    };
    let is_length = |text: &str| text.starts_with("an array of length ") || text.starts_with("a tuple of size ");
    match words {
        "" if is_length(expected) => format!("a list of {} values", expected.rsplit(' ').next().unwrap_or_default()),
        "" if expected.starts_with("enum ") => "one of its words, as a text".to_owned(),
        "" if ["struct ", "internally tagged enum ", "adjacently tagged enum ", "tuple struct "]
            .iter()
            .any(|start| expected.starts_with(start)) =>
        {
            "a table of keys, {...}".to_owned()
        }
        "" => expected.to_owned(),
        words => words.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_the_program_are_said_in_words() {
        for (message, expected) in [
            ("invalid type: string \"x\", expected f64", "expected a number, found the text \"x\""),
            ("invalid value: integer `-3`, expected usize", "expected a whole number, zero or above, found -3"),
            ("invalid type: floating point `2.5`, expected usize", "expected a whole number, zero or above, found 2.5"),
            ("invalid type: integer `3`, expected struct ChannelSource", "expected a table of keys, {...}, found 3"),
            ("invalid type: map, expected a sequence", "expected a list, [...], found a table"),
            ("invalid type: string \"true\", expected a boolean", "expected true or false, found the text \"true\""),
            ("invalid length 2, expected an array of length 3", "expected a list of 3 values, found 2 of them"),
            (
                "invalid type: boolean `true`, expected one value for all, or a list",
                "expected one value for all, or a list, found true",
            ),
            (
                "invalid type: null, expected f64 at line 3 column 5",
                "expected a number, found nothing at line 3 column 5",
            ),
            ("unknown field `a`, expected `b`", "unknown field `a`, expected `b`"),
            (
                "TOML parse error at line 2, column 3\n  |\n2 | a = \"x\"\n  |   ^\ninvalid type: string \"x\", expected f64\n",
                "TOML parse error at line 2, column 3\n  |\n2 | a = \"x\"\n  |   ^\nexpected a number, found the text \"x\"",
            ),
        ] {
            assert_eq!(in_plain_words(message), expected);
        }
    }
}
