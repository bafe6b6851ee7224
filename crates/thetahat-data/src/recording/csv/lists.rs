//! Lists of numbers in cells, as tools write arrays into a table: `[0.1, 0.2]`, `(0.1, 0.2)`, `array('d', [0.1, 0.2])`.

use super::super::table::{Column, Flaw};

/// The numbers of a list; none if the cell is something else.
pub(super) fn parse(cell: &[u8]) -> Option<Vec<f64>> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    let text = match text.strip_prefix("array(") {
        Some(array) => array.get(array.find('[')?..=array.rfind(']')?)?,
        None => text,
    };
    let between = |open, close| text.strip_prefix(open)?.strip_suffix(close);
    let parts = between('[', ']').or_else(|| between('(', ')'))?;
    let parts = parts.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|part| !part.is_empty());
    let numbers: Option<Vec<f64>> = parts.map(|part| part.parse().ok()).collect();
    numbers.filter(|numbers| !numbers.is_empty())
}

/// The lists of a column, which have a channel for each of their numbers.
#[derive(Default)]
pub(super) struct Lists {
    /// The values of each channel.
    channels: Vec<Vec<f64>>,
}

impl Lists {
    pub(super) fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }

    /// Adds a list; whether it has as many numbers as the first. One that has not is missing values.
    pub(super) fn push(&mut self, list: Option<Vec<f64>>) -> bool {
        if let (true, Some(first)) = (self.is_empty(), &list) {
            self.channels = vec![Vec::new(); first.len()];
        }
        let list = list.filter(|list| list.len() == self.channels.len());
        let value = |channel: usize| list.as_ref().map_or(f64::NAN, |list| list[channel]);
        self.channels.iter_mut().enumerate().for_each(|(channel, values)| values.push(value(channel)));
        list.is_some()
    }

    pub(super) fn into_column(self, name: String, flaw: Option<Flaw>) -> Column {
        Column { flaw, ..Column::of_numbers(name, self.channels.len(), self.channels.concat()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_as_tools_write_them() {
        for cell in [
            "[0.5, -2e-3]",
            "(0.5, -2e-3)",
            " [0.5 -2e-3] ",
            "[0.5;-2e-3]",
            "array('d', [0.5, -2e-3])",
            "(0.5, -2e-3,)",
        ] {
            assert_eq!(parse(cell.as_bytes()), Some(vec![0.5, -2e-3]), "{cell}");
        }
        for cell in ["0.5, 2", "[]", "[0.5, x]", "[0.5", "array(][", "array([", "", "[", "("] {
            assert_eq!(parse(cell.as_bytes()), None, "{cell}");
        }
    }
}
