use super::super::{
    column_names::{self, Signal},
    unit_words,
};
use thetahat_data::recording::{Dimension, Unit};

/// A unit as the name of a column has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Written {
    /// One that is known.
    Unit(Unit),
    /// Counts of a device, by the word that says so.
    Counts(String),
    /// One that is not known.
    Unknown(String),
}

/// The unit that a name has in brackets, or ends with, or that a word of it stands for; words that measure something else
/// than the signal are no units.
pub(super) fn written(name: &str, signal: Signal) -> Option<Written> {
    spelt_out(name, signal).or_else(|| of_a_drive(name, signal).map(Written::Unit))
}

/// The unit that a name has in brackets, or ends with.
pub(super) fn spelt_out(name: &str, signal: Signal) -> Option<Written> {
    if let Some(text) = unit_words::in_brackets(name) {
        return Some(match unit_words::unit(text) {
            Some(unit) => Written::Unit(unit),
            None if unit_words::is_count(text) => Written::Counts(text.to_owned()),
            None => Written::Unknown(text.to_owned()),
        });
    }
    if name.contains('%') {
        return Some(Written::Unit(Unit::Percent));
    }
    let words = column_names::words(name);
    let count = words.iter().skip(1).find(|word| unit_words::is_count(word));
    in_words(name, signal).map(Written::Unit).or_else(|| count.cloned().map(Written::Counts))
}

/// Words for the voltage of a drive; `vir` is that of EMPS.
const VOLTAGES: [&str; 5] = ["voltage", "voltages", "volt", "vir", "spannung"];

/// A current is in A and a voltage in V where nothing else is said.
pub(super) fn of_a_drive(name: &str, signal: Signal) -> Option<Unit> {
    let words = column_names::words(name);
    let has = |of: fn(&str) -> bool| signal == Signal::Torque && words.iter().any(|word| of(word));
    match (has(|word| word.starts_with("curr") || word == "strom"), has(|word| VOLTAGES.contains(&word))) {
        (true, _) => Some(Unit::Ampere),
        (false, true) => Some(Unit::Volt),
        (false, false) => None,
    }
}

/// The dimensions of the units in which a signal may be written.
pub(super) fn dimensions(signal: Signal) -> &'static [Dimension] {
    match signal {
        Signal::Position | Signal::Reference => &[Dimension::Angle, Dimension::Length],
        Signal::Velocity => &[Dimension::AngularVelocity, Dimension::LinearVelocity],
        Signal::Torque => {
            &[Dimension::Torque, Dimension::Force, Dimension::Current, Dimension::Voltage, Dimension::Dimensionless]
        }
        Signal::Time => &[Dimension::Time],
    }
}

/// The last word after the first that is a unit of the signal. Between other signs a unit keeps its capitals together:
/// `mNm` is one word. A single letter is one where it stands by itself as its symbol is written: `a1` is no current.
fn in_words(name: &str, signal: Signal) -> Option<Unit> {
    let whole: Vec<String> = name.split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect();
    let last = |words: &[String], is_whole: bool| {
        let unit = |word: &String| {
            let is_symbol = |unit: &Unit| word.chars().count() > 1 || (is_whole && unit.symbol() == word);
            unit_words::unit(word).filter(is_symbol)
        };
        let mut units = words.iter().skip(1).filter_map(unit);
        units.rfind(|unit| dimensions(signal).contains(&unit.dimension()))
    };
    last(&whole, true).or_else(|| last(&column_names::words(name), false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_from_the_name() {
        let unknown = |text: &str| Some(Written::Unknown(text.to_owned()));
        let counts = |text: &str| Some(Written::Counts(text.to_owned()));
        for (name, signal, expected) in [
            ("q1 [deg]", Signal::Position, Some(Written::Unit(Unit::Degree))),
            ("q3 [mm]", Signal::Position, Some(Written::Unit(Unit::Millimetre))),
            ("q1_rad", Signal::Position, Some(Written::Unit(Unit::Radian))),
            ("tau_1 (mNm)", Signal::Torque, Some(Written::Unit(Unit::MillinewtonMetre))),
            ("torque_mNm", Signal::Torque, Some(Written::Unit(Unit::MillinewtonMetre))),
            ("current_2", Signal::Torque, Some(Written::Unit(Unit::Ampere))),
            ("Achse 2 Strom", Signal::Torque, Some(Written::Unit(Unit::Ampere))),
            ("motor_current_2 [mA]", Signal::Torque, Some(Written::Unit(Unit::Milliampere))),
            ("joint_a1_effort", Signal::Torque, None),
            ("joint_a1.effort", Signal::Torque, None),
            ("motor_3_A", Signal::Torque, Some(Written::Unit(Unit::Ampere))),
            ("tau1 [%]", Signal::Torque, Some(Written::Unit(Unit::Percent))),
            ("torque % 1", Signal::Torque, Some(Written::Unit(Unit::Percent))),
            ("tau1 [Nm/rad]", Signal::Torque, unknown("Nm/rad")),
            ("q1 [inc]", Signal::Position, counts("inc")),
            ("enc_counts_2", Signal::Position, counts("counts")),
            ("dq1 [deg/s]", Signal::Velocity, Some(Written::Unit(Unit::DegreePerSecond))),
            ("q1", Signal::Position, None),
            ("tau_1", Signal::Torque, None),
        ] {
            assert_eq!(written(name, signal), expected, "{name}");
        }
    }
}
