//! Lines of units below the names: `s;rad;N m`, `[ms];[deg];[Nm]`.

use super::super::unit::Unit;

/// Other spellings of units, in lower case without spaces.
const SPELLINGS: [&str; 31] = [
    "°", "°/s", "°/s²", "°/s^2", "degree", "degrees", "deg/sec", "deg/s²", "deg/s2", "radian", "radians", "rad/sec",
    "rad/s²", "rad/s2", "m/s²", "m/s2", "turns", "1/min", "min-1", "sec", "second", "seconds", "msec", "usec", "µs",
    "μs", "nm", "amp", "volt", "°c", "degc",
];

/// The unit in a cell, without brackets around it.
pub(super) fn without_brackets(cell: &str) -> &str {
    cell.trim().trim_start_matches(['[', '(', '{', '<']).trim_end_matches([']', ')', '}', '>']).trim()
}

/// Whether cells are a line of units: more than half of those that are not empty are known units.
pub(super) fn is_unit_line(cells: &[String]) -> bool {
    let written: Vec<&str> = cells.iter().map(|cell| without_brackets(cell)).filter(|cell| !is_blank(cell)).collect();
    let known = written.iter().filter(|cell| is_unit(cell)).count();
    known > 0 && 2 * known > written.len()
}

/// A name with its unit, as `inspect` lists it.
pub(super) fn with_unit(name: &str, unit: &str) -> String {
    let unit = without_brackets(unit);
    if is_blank(unit) { name.to_owned() } else { format!("{name} [{unit}]") }
}

fn is_blank(cell: &str) -> bool {
    matches!(cell, "" | "-" | "--")
}

fn is_unit(text: &str) -> bool {
    let plain = text.to_lowercase().replace(' ', "");
    text.parse::<Unit>().is_ok() || SPELLINGS.contains(&plain.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_line(line: &str) -> bool {
        is_unit_line(&line.split(';').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn lines_of_units_are_told_from_names() {
        for line in ["s;rad;N m", "[ms];[deg];[Nm]", "(s);(°);;(counts);(A)", "s;-;Nm"] {
            assert!(is_line(line), "{line}");
        }
        for line in ["t;q1;tau1", ";;", "Time;Position;Torque", "a;b;s"] {
            assert!(!is_line(line), "{line}");
        }
        assert_eq!((with_unit("q1", "[deg]"), with_unit("n", "-")), ("q1 [deg]".to_owned(), "n".to_owned()));
    }
}
