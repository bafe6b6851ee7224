//! Units: their names in files, their factors to SI, and the quantities they measure.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::RecordingError;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position of a revolute joint or of a motor.
    Angle,
    /// Position of a prismatic joint.
    Length,
    /// Velocity of a revolute joint or of a motor.
    AngularVelocity,
    /// Velocity of a prismatic joint.
    LinearVelocity,
    /// Acceleration of a revolute joint or of a motor.
    AngularAcceleration,
    /// Acceleration of a prismatic joint.
    LinearAcceleration,
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
            Self::AngularVelocity => "an angular velocity",
            Self::LinearVelocity => "a velocity",
            Self::AngularAcceleration => "an angular acceleration",
            Self::LinearAcceleration => "an acceleration",
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(try_from = "String", into = "&'static str")]
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
    /// `rad/s`
    RadianPerSecond,
    /// `deg/s`
    DegreePerSecond,
    /// `rev/s`
    RevolutionPerSecond,
    /// `rpm`
    RevolutionPerMinute,
    /// `m/s`
    MetrePerSecond,
    /// `mm/s`
    MillimetrePerSecond,
    /// `rad/s^2`
    RadianPerSecondSquared,
    /// `deg/s^2`
    DegreePerSecondSquared,
    /// `m/s^2`
    MetrePerSecondSquared,
    /// `mm/s^2`
    MillimetrePerSecondSquared,
    /// `N m`
    NewtonMetre,
    /// `mN m`
    MillinewtonMetre,
    /// `kN m`
    KilonewtonMetre,
    /// `N`
    Newton,
    /// `kN`
    Kilonewton,
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
    /// `%`, of a nominal torque or current that is given as gain
    Percent,
}

impl Unit {
    /// Every unit that is known.
    pub const ALL: [Self; 32] = [
        Self::Radian,
        Self::Milliradian,
        Self::Degree,
        Self::Revolution,
        Self::Metre,
        Self::Millimetre,
        Self::Micrometre,
        Self::RadianPerSecond,
        Self::DegreePerSecond,
        Self::RevolutionPerSecond,
        Self::RevolutionPerMinute,
        Self::MetrePerSecond,
        Self::MillimetrePerSecond,
        Self::RadianPerSecondSquared,
        Self::DegreePerSecondSquared,
        Self::MetrePerSecondSquared,
        Self::MillimetrePerSecondSquared,
        Self::NewtonMetre,
        Self::MillinewtonMetre,
        Self::KilonewtonMetre,
        Self::Newton,
        Self::Kilonewton,
        Self::Ampere,
        Self::Milliampere,
        Self::Volt,
        Self::Millivolt,
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Nanosecond,
        Self::One,
        Self::Percent,
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
            Self::RadianPerSecond => ("rad/s", 1.0, Quantity::AngularVelocity),
            Self::DegreePerSecond => ("deg/s", PI / 180.0, Quantity::AngularVelocity),
            Self::RevolutionPerSecond => ("rev/s", 2.0 * PI, Quantity::AngularVelocity),
            Self::RevolutionPerMinute => ("rpm", PI / 30.0, Quantity::AngularVelocity),
            Self::MetrePerSecond => ("m/s", 1.0, Quantity::LinearVelocity),
            Self::MillimetrePerSecond => ("mm/s", 1e-3, Quantity::LinearVelocity),
            Self::RadianPerSecondSquared => ("rad/s^2", 1.0, Quantity::AngularAcceleration),
            Self::DegreePerSecondSquared => ("deg/s^2", PI / 180.0, Quantity::AngularAcceleration),
            Self::MetrePerSecondSquared => ("m/s^2", 1.0, Quantity::LinearAcceleration),
            Self::MillimetrePerSecondSquared => ("mm/s^2", 1e-3, Quantity::LinearAcceleration),
            Self::NewtonMetre => ("N m", 1.0, Quantity::Torque),
            Self::MillinewtonMetre => ("mN m", 1e-3, Quantity::Torque),
            Self::KilonewtonMetre => ("kN m", 1e3, Quantity::Torque),
            Self::Newton => ("N", 1.0, Quantity::Force),
            Self::Kilonewton => ("kN", 1e3, Quantity::Force),
            Self::Ampere => ("A", 1.0, Quantity::Current),
            Self::Milliampere => ("mA", 1e-3, Quantity::Current),
            Self::Volt => ("V", 1.0, Quantity::Voltage),
            Self::Millivolt => ("mV", 1e-3, Quantity::Voltage),
            Self::Second => ("s", 1.0, Quantity::Time),
            Self::Millisecond => ("ms", 1e-3, Quantity::Time),
            Self::Microsecond => ("us", 1e-6, Quantity::Time),
            Self::Nanosecond => ("ns", 1e-9, Quantity::Time),
            Self::One => ("1", 1.0, Quantity::Dimensionless),
            Self::Percent => ("%", 1e-2, Quantity::Dimensionless),
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

impl From<Unit> for &'static str {
    fn from(unit: Unit) -> Self {
        unit.symbol()
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
        assert_eq!(30.0 * Unit::RevolutionPerMinute.to_si(), PI);
        assert_eq!(50.0 * Unit::Percent.to_si(), 0.5);
    }

    #[test]
    fn unknown_symbol_is_refused_with_the_known_ones() {
        let error = "Nm".parse::<Unit>().unwrap_err();
        let RecordingError::UnknownUnit { found, expected } = error else { panic!("{error}") };
        assert_eq!(found, "Nm");
        assert!(expected.contains(&"\"N m\"".to_owned()));
    }
}
