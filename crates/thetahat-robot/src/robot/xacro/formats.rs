//! Texts with places for values: `'%s_%d' % (name, 2)` and `'{}_{}'.format(name, 2)`.

use super::{
    ExpressionError,
    value::{Number, Value},
};

/// Most digits after the point, and the least width.
const MOST_DIGITS: usize = 100;

/// Fills `%s`, `%d`, `%i` and `%f`, such as `%.3f` or `%02d`, with values.
pub(super) fn percent(text: &str, values: &Value) -> Result<Value, ExpressionError> {
    let values = if let Value::List(values) = values { values.to_vec() } else { vec![values.clone()] };
    let (mut filled, mut rest, mut values) = (String::new(), text, values.iter());
    while let Some((before, after)) = rest.split_once('%') {
        filled.push_str(before);
        rest = match after.strip_prefix('%') {
            Some(after) => {
                filled.push('%');
                after
            }
            None => {
                let (written, after) = placed(after, &mut values)?;
                filled.push_str(&written);
                after
            }
        };
    }
    filled.push_str(rest);
    if values.next().is_some() { Err(wrong_count()) } else { Ok(Value::text(&filled)) }
}

fn wrong_count() -> ExpressionError {
    ExpressionError::Arguments { function: "a text with places".to_owned(), expected: "one value for each place" }
}

fn unsupported() -> ExpressionError {
    let remedy = "use %s, %d or %f with width and digits, or {} and {0}; or join texts with + and str()";
    ExpressionError::Unsupported { what: "this format of a value", remedy }
}

/// A value by the letters after `%`, and what follows them.
fn placed<'t, 'v>(
    text: &'t str,
    values: &mut impl Iterator<Item = &'v Value>,
) -> Result<(String, &'t str), ExpressionError> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).ok_or_else(unsupported)?;
    let (layout, kind) = text.split_at(end);
    let (width, digits) = layout.split_once('.').map_or((layout, None), |(width, digits)| (width, Some(digits)));
    let value = values.next().ok_or_else(wrong_count)?;
    let digits = digits.map(limited).transpose()?;
    let written = match (kind.chars().next(), value.number(), digits) {
        (Some('s'), _, None) => value.to_text(),
        (Some('d' | 'i'), Some(Number::Integer(value)), None) => value.to_string(),
        (Some('d' | 'i'), Some(Number::Float(value)), None) => format!("{:.0}", value.trunc()),
        (Some('f'), Some(value), digits) => format!("{:.*}", digits.unwrap_or(6), value.float()),
        _ => return Err(unsupported()),
    };
    let is_filled_with_zeros = width.starts_with('0') && value.number().is_some();
    let width = if width.is_empty() { 0 } else { limited(width)? };
    Ok((widened(&written, width, is_filled_with_zeros), &kind[1..]))
}

fn limited(digits: &str) -> Result<usize, ExpressionError> {
    digits.parse().ok().filter(|digits| *digits <= MOST_DIGITS).ok_or_else(unsupported)
}

fn widened(text: &str, width: usize, with_zeros: bool) -> String {
    match text.strip_prefix('-') {
        Some(digits) if with_zeros => format!("-{digits:0>rest$}", rest = width.saturating_sub(1)),
        None if with_zeros => format!("{text:0>width$}"),
        Some(_) | None => format!("{text:>width$}"),
    }
}

/// Fills `{}` and `{0}` with values.
pub(super) fn braces(text: &str, values: &[Value]) -> Result<Value, ExpressionError> {
    let (mut filled, mut rest, mut next) = (String::new(), text, 0);
    while let Some((before, after)) = rest.split_once('{') {
        let (place, after) = after.split_once('}').ok_or_else(unsupported)?;
        let index = if place.is_empty() { next } else { place.parse().map_err(|_| unsupported())? };
        next += 1;
        filled.push_str(before);
        filled.push_str(&values.get(index).ok_or_else(wrong_count)?.to_text());
        rest = after;
    }
    filled.push_str(rest);
    Ok(Value::text(&filled))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written by Python 3.11.
    #[test]
    fn places_are_filled_as_in_python() {
        let of = |text: &str, values: Vec<Value>| percent(text, &Value::list(values)).unwrap().to_text();
        assert_eq!(of("%s_%d%%", vec![Value::text("l"), Value::Float(-2.7)]), "l_-2%");
        let numbers = vec![Value::Float(1.0 / 3.0), Value::Integer(-7), Value::Integer(42), Value::Float(2.5)];
        assert_eq!(of("%.3f %04d %5d %f", numbers), "0.333 -007    42 2.500000");
        assert_eq!(percent("l%s", &Value::Float(1.0)).unwrap().to_text(), "l1.0");
        assert_eq!(braces("{}_{}{0}", &[Value::text("a"), Value::Integer(2)]).unwrap().to_text(), "a_2a");
    }

    #[test]
    fn other_formats_and_counts_are_refused() {
        let is_refused = |text: &str| percent(text, &Value::Integer(1)).is_err();
        assert!(["%x", "%", "%s%s", "none", "%.999f", "%99999999999999999999d"].into_iter().all(is_refused));
        assert!(["{", "{a}", "{1}", "{:.2f}"].into_iter().all(|text| braces(text, &[Value::Integer(1)]).is_err()));
    }
}
