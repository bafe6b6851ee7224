//! Converts cells to numbers.

use std::str;

use serde::{Deserialize, Serialize};

use super::text::characters;

/// The sign between the integer part and the fraction of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Decimal {
    /// `1.5`
    #[serde(rename = ".")]
    Point,
    /// `1,5`
    #[serde(rename = ",")]
    Comma,
}

impl Decimal {
    fn sign(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Point => Self::Comma,
            Self::Comma => Self::Point,
        }
    }

    /// The decimal sign that a number shows beyond doubt: the last of two different signs, or the one that does not occur several times.
    pub(super) fn shown_by(number: &str) -> Option<Self> {
        let count = |decimal: Self| number.matches(decimal.sign()).count();
        match (count(Self::Point), count(Self::Comma)) {
            (1.., 1..) if number.rfind('.') > number.rfind(',') => Some(Self::Point),
            (1.., 1..) | (2.., 0) => Some(Self::Comma),
            (0, 2..) => Some(Self::Point),
            (0 | 1, 0) | (0, 1) => None,
        }
    }
}

/// Signs between groups of three digits that mean nothing else.
const GROUP_SIGNS: [char; 4] = ['\'', '\u{2019}', '\u{a0}', '\u{202f}'];

/// Reads the cells of a file. The first number with a decimal sign determines it for the others, unless it is set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    decimal: Option<Decimal>,
    /// Whether the other of point and comma may separate groups of three digits, as in `1,234.5`.
    grouped: bool,
}

impl Numbers {
    pub(super) fn new(decimal: Option<Decimal>, grouped: bool) -> Self {
        Self { decimal, grouped }
    }

    pub(super) fn decimal(self) -> Option<Decimal> {
        self.decimal
    }

    /// The number in a cell; none if the cell is not a number. NaN and infinities are numbers.
    pub(super) fn read(&mut self, cell: &[u8]) -> Option<f64> {
        match str::from_utf8(cell) {
            Ok(text) => self.number(text.trim()),
            Err(_) => self.number(characters(cell).trim()),
        }
    }

    fn number(&mut self, text: &str) -> Option<f64> {
        match self.decimal {
            Some(Decimal::Point) => text.parse().ok().or_else(|| self.in_groups(text, Decimal::Point)),
            Some(Decimal::Comma) => with_comma(text).or_else(|| self.in_groups(text, Decimal::Comma)),
            None => self.undecided(text),
        }
    }

    fn undecided(&mut self, text: &str) -> Option<f64> {
        let decimal = match (text.contains('.'), text.contains(',')) {
            (true, _) => Some(Decimal::Point),
            (false, true) => Some(Decimal::Comma),
            (false, false) => None,
        };
        let number = if decimal == Some(Decimal::Comma) { with_comma(text) } else { text.parse().ok() };
        if number.is_some() {
            self.decimal = decimal;
            return number;
        }
        let in_groups = |decimal| self.in_groups(text, decimal);
        in_groups(Decimal::Point).or_else(|| in_groups(Decimal::Comma))
    }

    /// A number whose integer part is written in groups of three digits.
    fn in_groups(&self, text: &str, decimal: Decimal) -> Option<f64> {
        let end = text.find([decimal.sign(), 'e', 'E']).unwrap_or(text.len());
        let (whole, rest) = text.split_at(end);
        let digits = whole.trim_start_matches(['+', '-']);
        let sign = digits.chars().find(|c| !c.is_ascii_digit())?;
        if !(GROUP_SIGNS.contains(&sign) || self.grouped && sign == decimal.other().sign()) {
            return None;
        }
        let mut groups = digits.split(sign);
        let first = groups.next().filter(|first| (1..=3).contains(&first.len()) && !first.starts_with('0'))?;
        let is_group = |group: &str| group.len() == 3 && group.bytes().all(|b| b.is_ascii_digit());
        if !first.bytes().all(|b| b.is_ascii_digit()) || !groups.all(is_group) || rest.contains(sign) {
            return None;
        }
        format!("{}{}", whole.replace(sign, ""), rest.replacen(decimal.sign(), ".", 1)).parse().ok()
    }
}

fn with_comma(text: &str) -> Option<f64> {
    let (whole, broken) = text.split_once(',').unwrap_or((text, ""));
    if text.contains('.')
        || broken.contains(',')
        || (text.contains(',') && !broken.starts_with(|c: char| c.is_ascii_digit()))
    {
        return None;
    }
    if broken.is_empty() { whole.parse().ok() } else { format!("{whole}.{broken}").parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(decimal: Decimal, grouped: bool, text: &str) -> Option<f64> {
        Numbers::new(Some(decimal), grouped).read(text.as_bytes())
    }

    #[test]
    fn groups_of_three_digits() {
        for (decimal, text) in [
            (Decimal::Point, "-1,234.5"),
            (Decimal::Comma, "-1.234,5"),
            (Decimal::Point, "-1'234.5"),
            (Decimal::Comma, "-1\u{a0}234,5"),
            (Decimal::Point, "-1\u{2019}234.5"),
        ] {
            assert_eq!(read(decimal, true, text), Some(-1234.5), "{text}");
        }
        assert_eq!(read(Decimal::Point, true, "12,345,678"), Some(12_345_678.0));
        assert_eq!(Numbers::new(None, true).read(b"1\xa0234"), Some(1234.0));
    }

    #[test]
    fn what_only_resembles_groups_is_no_number() {
        for text in ["0,123", "1,23", "1,2345", ",123", "1,234,", "1234,567", "1,234.5,678", "1,'234", "1'234,567"] {
            assert_eq!(read(Decimal::Point, true, text), None, "{text}");
        }
        assert_eq!(read(Decimal::Point, false, "1,234"), None);
    }

    #[test]
    fn a_number_may_show_the_decimal_sign() {
        let shown = ["1,234.5", "1.234,5", "1,234,567", "1.234.567", "1,234", "1.234", "12"].map(Decimal::shown_by);
        let (point, comma) = (Some(Decimal::Point), Some(Decimal::Comma));
        assert_eq!(shown, [point, comma, point, comma, None, None, None]);
    }
}
