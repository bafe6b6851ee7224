//! Lines of units below the names: `s;rad;N m`, `[ms];[deg];[Nm]`.

use super::super::unit::Unit;

/// Other spellings of units, in lower case without spaces.
const SPELLINGS: [(&str, Unit); 26] = [
    ("°", Unit::Degree),
    ("degree", Unit::Degree),
    ("degrees", Unit::Degree),
    ("°/s", Unit::DegreePerSecond),
    ("deg/sec", Unit::DegreePerSecond),
    ("°/s²", Unit::DegreePerSecondSquared),
    ("°/s^2", Unit::DegreePerSecondSquared),
    ("deg/s²", Unit::DegreePerSecondSquared),
    ("deg/s2", Unit::DegreePerSecondSquared),
    ("radian", Unit::Radian),
    ("radians", Unit::Radian),
    ("rad/sec", Unit::RadianPerSecond),
    ("rad/s²", Unit::RadianPerSecondSquared),
    ("rad/s2", Unit::RadianPerSecondSquared),
    ("m/s²", Unit::MetrePerSecondSquared),
    ("m/s2", Unit::MetrePerSecondSquared),
    ("turns", Unit::Revolution),
    ("1/min", Unit::RevolutionPerMinute),
    ("min-1", Unit::RevolutionPerMinute),
    ("sec", Unit::Second),
    ("second", Unit::Second),
    ("seconds", Unit::Second),
    ("msec", Unit::Millisecond),
    ("usec", Unit::Microsecond),
    ("µs", Unit::Microsecond),
    ("μs", Unit::Microsecond),
];
/// Units of other quantities, in lower case without spaces.
const OTHER_UNITS: [&str; 5] = ["°c", "degc", "bar", "pa", "w"];

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

/// The unit in a name such as `q [deg]` that was asked for as `q`.
pub(in super::super) fn unit_left_out(asked: &str, name: &str) -> Option<Unit> {
    let unit = name.strip_prefix(asked)?.strip_prefix(" [")?.strip_suffix(']')?;
    unit_of(unit)
}

fn plain(text: &str) -> String {
    text.to_lowercase().replace(' ', "")
}

fn unit_of(text: &str) -> Option<Unit> {
    let spelling = || SPELLINGS.iter().find(|(spelling, _)| *spelling == plain(text)).map(|(_, unit)| *unit);
    text.parse().ok().or_else(spelling)
}

fn is_unit(text: &str) -> bool {
    unit_of(text).is_some() || OTHER_UNITS.contains(&plain(text).as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_line(line: &str) -> bool {
        is_unit_line(&line.split(';').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn lines_of_units_are_not_names() {
        for line in ["s;rad;N m", "[ms];[deg];[Nm]", "(s);(°);;(counts);(A)", "s;-;Nm"] {
            assert!(is_line(line), "{line}");
        }
        for line in ["t;q1;tau1", ";;", "Time;Position;Torque", "a;b;s"] {
            assert!(!is_line(line), "{line}");
        }
        assert_eq!((with_unit("q1", "[deg]"), with_unit("n", "-")), ("q1 [deg]".to_owned(), "n".to_owned()));
    }
}
