//! Converts cells to numbers.

use std::str;

use serde::{Deserialize, Serialize};

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

/// Reads the cells of a file. The first number with a decimal sign determines it for the others, unless it is set.
#[derive(Clone, Copy)]
pub(super) struct Numbers {
    decimal: Option<Decimal>,
}

impl Numbers {
    /// If the comma is the delimiter, the decimal sign is a point unless it is set.
    pub(super) fn new(decimal: Option<Decimal>, delimiter: u8) -> Self {
        Self { decimal: decimal.or((delimiter == b',').then_some(Decimal::Point)) }
    }

    pub(super) fn decimal(self) -> Option<Decimal> {
        self.decimal
    }

    /// The number in a cell; none if the cell is not a number. NaN and infinities are numbers.
    pub(super) fn read(&mut self, cell: &[u8]) -> Option<f64> {
        let text = str::from_utf8(cell).ok()?.trim();
        match self.decimal {
            Some(Decimal::Point) => text.parse().ok(),
            Some(Decimal::Comma) => with_comma(text),
            None => self.read_undecided(text),
        }
    }

    fn read_undecided(&mut self, text: &str) -> Option<f64> {
        let decimal = match (text.contains('.'), text.contains(',')) {
            (true, _) => Some(Decimal::Point),
            (false, true) => Some(Decimal::Comma),
            (false, false) => None,
        };
        let number = if decimal == Some(Decimal::Comma) { with_comma(text) } else { text.parse().ok() };
        if number.is_some() {
            self.decimal = decimal;
        }
        number
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
