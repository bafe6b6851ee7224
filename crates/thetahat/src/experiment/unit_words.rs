//! Units as the names of columns write them: `q1 [deg]`, `Time/s`, `tau (N·m)`.

use std::ops::Range;

use thetahat_data::recording::Unit;

/// Other spellings of symbols, as [`plain`] has them.
const SPELLINGS: [(&str, Unit); 26] = [
    ("radian", Unit::Radian),
    ("radians", Unit::Radian),
    ("degree", Unit::Degree),
    ("degrees", Unit::Degree),
    ("degs", Unit::Degree),
    ("revolution", Unit::Revolution),
    ("revolutions", Unit::Revolution),
    ("deg/sec", Unit::DegreePerSecond),
    ("degrees/s", Unit::DegreePerSecond),
    ("rad/sec", Unit::RadianPerSecond),
    ("rev/min", Unit::RevolutionPerMinute),
    ("u/min", Unit::RevolutionPerMinute),
    ("1/min", Unit::RevolutionPerMinute),
    ("min^-1", Unit::RevolutionPerMinute),
    ("newtonmeter", Unit::NewtonMetre),
    ("newtonmetre", Unit::NewtonMetre),
    ("amp", Unit::Ampere),
    ("amps", Unit::Ampere),
    ("ampere", Unit::Ampere),
    ("volt", Unit::Volt),
    ("volts", Unit::Volt),
    ("percent", Unit::Percent),
    ("pct", Unit::Percent),
    ("sec", Unit::Second),
    ("seconds", Unit::Second),
    ("msec", Unit::Millisecond),
];

/// Words for numbers that a device counts, or does not convert.
const COUNTS: [&str; 16] = [
    "count",
    "counts",
    "cnt",
    "cnts",
    "tick",
    "ticks",
    "inc",
    "incs",
    "inkr",
    "increment",
    "increments",
    "inkremente",
    "pulse",
    "pulses",
    "lsb",
    "digits",
];

/// The unit that a text names, whatever its spaces, dots and capitals.
pub(super) fn unit(text: &str) -> Option<Unit> {
    let text = plain(text);
    if !text.chars().any(|c| c.is_alphabetic() || c == '%') {
        return None;
    }
    let by_symbol = Unit::ALL.into_iter().find(|unit| plain(unit.symbol()) == text);
    by_symbol.or_else(|| SPELLINGS.into_iter().find(|(spelling, _)| *spelling == text).map(|(_, unit)| unit))
}

/// Whether a word says that values are counts of a device.
pub(super) fn is_count(word: &str) -> bool {
    COUNTS.contains(&plain(word).as_str())
}

/// The text that stands in brackets in a name and is a unit, known or not: an index or the name of an axis is none.
/// Round brackets hold remarks as well, and count where their text can be nothing else.
pub(super) fn in_brackets(name: &str) -> Option<&str> {
    place(name).map(|place| name[place].trim())
}

/// The name without the unit in brackets.
pub(super) fn without_brackets(name: &str) -> String {
    place(name).map_or_else(|| name.to_owned(), |place| [&name[..place.start], &name[place.end..]].concat())
}

fn place(name: &str) -> Option<Range<usize>> {
    let square = groups(name, '[', ']').filter(|place| is_like_a_unit(name[place.clone()].trim())).last();
    square.or_else(|| groups(name, '(', ')').filter(|place| is_marked(name[place.clone()].trim())).last())
}

/// Where the texts between two brackets are.
fn groups(name: &str, open: char, close: char) -> impl Iterator<Item = Range<usize>> {
    let closed = move |start: usize| name[start..].find(close).map(|length| start..start + length);
    name.match_indices(open).filter_map(move |(at, _)| closed(at + open.len_utf8()))
}

/// Whether a text in round brackets can be nothing but a unit.
fn is_marked(text: &str) -> bool {
    unit(text).is_some() || is_count(text) || text.eq_ignore_ascii_case("raw") || text.contains(['%', '°'])
}

/// Indices (`3`, `J3`), axes and names of joints are none.
fn is_like_a_unit(text: &str) -> bool {
    let letters = text.trim_end_matches(|c: char| c.is_ascii_digit());
    let is_numbered = letters.len() < text.len() && letters.chars().all(char::is_alphabetic);
    let is_axis = ["x", "y", "z"].contains(&text.to_lowercase().as_str());
    let says_something = text.chars().any(|c| c.is_alphabetic() || c == '%' || c == '°');
    says_something && !is_numbered && !is_axis && !text.contains('_')
}

/// Lower case, without what stands between factors.
fn plain(text: &str) -> String {
    let kept = text.chars().filter(|c| !c.is_whitespace() && !['·', '⋅', '*', '.'].contains(c));
    let text = kept.flat_map(char::to_lowercase).collect::<String>();
    text.replace(['µ', 'μ'], "u").replace('°', "deg").replace('²', "^2")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_in_the_spellings_of_logs() {
        for (text, expected) in [
            ("N m", Some(Unit::NewtonMetre)),
            ("Nm", Some(Unit::NewtonMetre)),
            ("N·m", Some(Unit::NewtonMetre)),
            ("mNm", Some(Unit::MillinewtonMetre)),
            ("°", Some(Unit::Degree)),
            ("°/s", Some(Unit::DegreePerSecond)),
            ("µs", Some(Unit::Microsecond)),
            ("1/min", Some(Unit::RevolutionPerMinute)),
            ("%", Some(Unit::Percent)),
            ("1", None),
            ("Nm/rad", None),
        ] {
            assert_eq!(unit(text), expected, "{text}");
        }
        assert!(Unit::ALL.into_iter().all(|known| known == Unit::One || unit(known.symbol()) == Some(known)));
    }

    #[test]
    fn brackets_hold_units_indices_or_remarks() {
        for (name, expected) in [
            ("q1 [deg]", Some("deg")),
            ("tau[3] [Nm/rad]", Some("Nm/rad")),
            ("effort[3]", None),
            ("q [J3]", None),
            ("force [x]", None),
            ("q [elbow_joint]", None),
            ("tau (N m)", Some("N m")),
            ("tau (filtered)", None),
            ("pos (counts)", Some("counts")),
            ("load [0.1%]", Some("0.1%")),
        ] {
            assert_eq!(in_brackets(name), expected, "{name}");
        }
        assert_eq!(without_brackets("speed 3 [1/min]"), "speed 3 []");
        assert_eq!(without_brackets("m_1 [ m ]"), "m_1 []");
    }
}
