//! Units: their names in files, their factors to SI, and the dimensions they measure.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A text that names no known unit.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown unit {found:?}; the known units are {}", .expected.join(", "))]
pub struct UnknownUnit {
    /// The text.
    pub found: String,
    /// The known units, in quotation marks.
    pub expected: Vec<String>,
}

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
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

impl fmt::Display for Dimension {
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

/// A unit of the values in a file. Written by its symbol, with a space between factors: `"N m"`.
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
    /// Every known unit.
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

    /// The symbol of the unit in files.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        self.definition().0
    }

    /// The factor to SI: a value in SI is `to_si()` times the value in this unit.
    ///
    /// ```
    /// use thetahat_data::recording::Unit;
    /// assert_eq!(180.0 * Unit::Degree.to_si(), std::f64::consts::PI);
    /// ```
    #[must_use]
    pub fn to_si(self) -> f64 {
        self.definition().1
    }

    /// What the unit measures.
    #[must_use]
    pub fn dimension(self) -> Dimension {
        self.definition().2
    }

    /// The table of units: symbol, factor to SI, dimension.
    fn definition(self) -> (&'static str, f64, Dimension) {
        match self {
            Self::Radian => ("rad", 1.0, Dimension::Angle),
            Self::Milliradian => ("mrad", 1e-3, Dimension::Angle),
            Self::Degree => ("deg", PI / 180.0, Dimension::Angle),
            Self::Revolution => ("rev", 2.0 * PI, Dimension::Angle),
            Self::Metre => ("m", 1.0, Dimension::Length),
            Self::Millimetre => ("mm", 1e-3, Dimension::Length),
            Self::Micrometre => ("um", 1e-6, Dimension::Length),
            Self::RadianPerSecond => ("rad/s", 1.0, Dimension::AngularVelocity),
            Self::DegreePerSecond => ("deg/s", PI / 180.0, Dimension::AngularVelocity),
            Self::RevolutionPerSecond => ("rev/s", 2.0 * PI, Dimension::AngularVelocity),
            Self::RevolutionPerMinute => ("rpm", PI / 30.0, Dimension::AngularVelocity),
            Self::MetrePerSecond => ("m/s", 1.0, Dimension::LinearVelocity),
            Self::MillimetrePerSecond => ("mm/s", 1e-3, Dimension::LinearVelocity),
            Self::RadianPerSecondSquared => ("rad/s^2", 1.0, Dimension::AngularAcceleration),
            Self::DegreePerSecondSquared => ("deg/s^2", PI / 180.0, Dimension::AngularAcceleration),
            Self::MetrePerSecondSquared => ("m/s^2", 1.0, Dimension::LinearAcceleration),
            Self::MillimetrePerSecondSquared => ("mm/s^2", 1e-3, Dimension::LinearAcceleration),
            Self::NewtonMetre => ("N m", 1.0, Dimension::Torque),
            Self::MillinewtonMetre => ("mN m", 1e-3, Dimension::Torque),
            Self::KilonewtonMetre => ("kN m", 1e3, Dimension::Torque),
            Self::Newton => ("N", 1.0, Dimension::Force),
            Self::Kilonewton => ("kN", 1e3, Dimension::Force),
            Self::Ampere => ("A", 1.0, Dimension::Current),
            Self::Milliampere => ("mA", 1e-3, Dimension::Current),
            Self::Volt => ("V", 1.0, Dimension::Voltage),
            Self::Millivolt => ("mV", 1e-3, Dimension::Voltage),
            Self::Second => ("s", 1.0, Dimension::Time),
            Self::Millisecond => ("ms", 1e-3, Dimension::Time),
            Self::Microsecond => ("us", 1e-6, Dimension::Time),
            Self::Nanosecond => ("ns", 1e-9, Dimension::Time),
            Self::One => ("1", 1.0, Dimension::Dimensionless),
            Self::Percent => ("%", 1e-2, Dimension::Dimensionless),
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// A unit by its symbol; `Nm`, `N*m` and `N·m` are `N m`, and `N mm` is `mN m`.
    fn from_str(symbol: &str) -> Result<Self, UnknownUnit> {
        let letters = |symbol: &str| symbol.replace([' ', '*', '·'], "");
        if letters(symbol) == "Nmm" {
            return Ok(Self::MillinewtonMetre);
        }
        let known = Self::ALL.into_iter().find(|unit| letters(unit.symbol()) == letters(symbol));
        known.ok_or_else(|| UnknownUnit {
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
    type Error = UnknownUnit;

    fn try_from(symbol: String) -> Result<Self, UnknownUnit> {
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
    fn a_product_is_written_in_several_ways() {
        for symbol in ["N m", "Nm", "N*m", "N·m"] {
            assert_eq!(symbol.parse::<Unit>().unwrap(), Unit::NewtonMetre);
        }
        for symbol in ["mNm", "Nmm", "N mm"] {
            assert_eq!(symbol.parse::<Unit>().unwrap(), Unit::MillinewtonMetre);
        }
        assert!("nm".parse::<Unit>().is_err());
    }

    #[test]
    fn factors_lead_to_si() {
        assert_eq!(Unit::Revolution.to_si(), 2.0 * PI);
        assert_eq!(Unit::Millimetre.to_si(), 1e-3);
        assert_eq!(Unit::MillinewtonMetre.dimension(), Dimension::Torque);
        assert_eq!(30.0 * Unit::RevolutionPerMinute.to_si(), PI);
        assert_eq!(50.0 * Unit::Percent.to_si(), 0.5);
    }

    #[test]
    fn unknown_symbol_is_refused_with_the_known_ones() {
        let UnknownUnit { found, expected } = "lbf".parse::<Unit>().unwrap_err();
        assert_eq!(found, "lbf");
        assert!(expected.contains(&"\"N m\"".to_owned()));
    }
}
