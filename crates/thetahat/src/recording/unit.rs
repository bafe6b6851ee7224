//! Units: their names in files, their factors to SI, and the quantities they measure.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

use super::RecordingError;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position of a revolute joint or of a motor.
    Angle,
    /// Position of a prismatic joint.
    Length,
    /// Torque of a revolute joint or of a motor.
    Torque,
    /// Force of a prismatic joint.
    Force,
    /// Motor current.
    Current,
    /// Voltage, or the control signal of a drive.
    Voltage,
    /// Time.
    Time,
    /// A number without a unit, such as a count.
    Dimensionless,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Angle => "an angle",
            Self::Length => "a length",
            Self::Torque => "a torque",
            Self::Force => "a force",
            Self::Current => "a current",
            Self::Voltage => "a voltage",
            Self::Time => "a time",
            Self::Dimensionless => "a number without a unit",
        })
    }
}

/// A unit in which a file may hold its values. Written by its symbol, with a space between factors: `"N m"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum Unit {
    /// `rad`
    Radian,
    /// `mrad`
    Milliradian,
    /// `deg`
    Degree,
    /// `rev`, one turn
    Revolution,
    /// `m`
    Metre,
    /// `mm`
    Millimetre,
    /// `um`
    Micrometre,
    /// `N m`
    NewtonMetre,
    /// `mN m`
    MillinewtonMetre,
    /// `N`
    Newton,
    /// `A`
    Ampere,
    /// `mA`
    Milliampere,
    /// `V`
    Volt,
    /// `mV`
    Millivolt,
    /// `s`
    Second,
    /// `ms`
    Millisecond,
    /// `us`
    Microsecond,
    /// `ns`
    Nanosecond,
    /// `1`
    One,
}

impl Unit {
    /// Every unit that is known.
    pub const ALL: [Self; 19] = [
        Self::Radian,
        Self::Milliradian,
        Self::Degree,
        Self::Revolution,
        Self::Metre,
        Self::Millimetre,
        Self::Micrometre,
        Self::NewtonMetre,
        Self::MillinewtonMetre,
        Self::Newton,
        Self::Ampere,
        Self::Milliampere,
        Self::Volt,
        Self::Millivolt,
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Nanosecond,
        Self::One,
    ];

    /// The symbol by which files name the unit.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        self.definition().0
    }

    /// The factor to SI: a value in SI is `to_si()` times the value in this unit.
    ///
    /// ```
    /// use thetahat::recording::Unit;
    /// assert_eq!(180.0 * Unit::Degree.to_si(), std::f64::consts::PI);
    /// ```
    #[must_use]
    pub fn to_si(self) -> f64 {
        self.definition().1
    }

    /// What the unit measures.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        self.definition().2
    }

    /// The one table of units: symbol, factor to SI, quantity.
    fn definition(self) -> (&'static str, f64, Quantity) {
        match self {
            Self::Radian => ("rad", 1.0, Quantity::Angle),
            Self::Milliradian => ("mrad", 1e-3, Quantity::Angle),
            Self::Degree => ("deg", PI / 180.0, Quantity::Angle),
            Self::Revolution => ("rev", 2.0 * PI, Quantity::Angle),
            Self::Metre => ("m", 1.0, Quantity::Length),
            Self::Millimetre => ("mm", 1e-3, Quantity::Length),
            Self::Micrometre => ("um", 1e-6, Quantity::Length),
            Self::NewtonMetre => ("N m", 1.0, Quantity::Torque),
            Self::MillinewtonMetre => ("mN m", 1e-3, Quantity::Torque),
            Self::Newton => ("N", 1.0, Quantity::Force),
            Self::Ampere => ("A", 1.0, Quantity::Current),
            Self::Milliampere => ("mA", 1e-3, Quantity::Current),
            Self::Volt => ("V", 1.0, Quantity::Voltage),
            Self::Millivolt => ("mV", 1e-3, Quantity::Voltage),
            Self::Second => ("s", 1.0, Quantity::Time),
            Self::Millisecond => ("ms", 1e-3, Quantity::Time),
            Self::Microsecond => ("us", 1e-6, Quantity::Time),
            Self::Nanosecond => ("ns", 1e-9, Quantity::Time),
            Self::One => ("1", 1.0, Quantity::Dimensionless),
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

impl FromStr for Unit {
    type Err = RecordingError;

    fn from_str(symbol: &str) -> Result<Self, RecordingError> {
        let known = Self::ALL.into_iter().find(|unit| unit.symbol() == symbol);
        known.ok_or_else(|| RecordingError::UnknownUnit {
            found: symbol.to_owned(),
            expected: Self::ALL.map(|unit| format!("\"{unit}\"")).to_vec(),
        })
    }
}

impl TryFrom<String> for Unit {
    type Error = RecordingError;

    fn try_from(symbol: String) -> Result<Self, RecordingError> {
        symbol.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_names_its_unit() {
        for unit in Unit::ALL {
            assert_eq!(unit.symbol().parse::<Unit>().unwrap(), unit);
        }
    }

    #[test]
    fn factors_lead_to_si() {
        assert_eq!(Unit::Revolution.to_si(), 2.0 * PI);
        assert_eq!(Unit::Millimetre.to_si(), 1e-3);
        assert_eq!(Unit::MillinewtonMetre.quantity(), Quantity::Torque);
    }

    #[test]
    fn unknown_symbol_is_refused_with_the_known_ones() {
        let error = "Nm".parse::<Unit>().unwrap_err();
        let RecordingError::UnknownUnit { found, expected } = error else { panic!("{error}") };
        assert_eq!(found, "Nm");
        assert!(expected.contains(&"\"N m\"".to_owned()));
    }
}
