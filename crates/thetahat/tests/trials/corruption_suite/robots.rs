//! The robots of the table of defects: recorded ones, and twins without data.

use super::{
    arms::{ARMS, Arm},
    record::{Record, Which, from_experiment, twin, tx40},
};

/// A robot of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Specimen {
    Tx40,
    Lwr4,
    Ur10,
    /// The closed-loop twin of the TX40.
    Twin,
    /// Seven axes at 1 kHz.
    SevenAxes,
    /// Three axes at 100 Hz.
    ThreeAxes,
}

impl Specimen {
    pub const ALL: [Self; 6] = [Self::Tx40, Self::Lwr4, Self::Ur10, Self::Twin, Self::SevenAxes, Self::ThreeAxes];

    pub fn name(self) -> &'static str {
        match self {
            Self::Tx40 => "TX40",
            Self::Lwr4 => "LWR4+",
            Self::Ur10 => "UR10",
            Self::Twin => "twin of the TX40",
            Self::SevenAxes => "twin, 7 axes",
            Self::ThreeAxes => "twin, 3 axes",
        }
    }

    /// Whether its record is data of others.
    pub fn is_recorded(self) -> bool {
        match self {
            Self::Tx40 | Self::Lwr4 | Self::Ur10 => true,
            Self::Twin | Self::SevenAxes | Self::ThreeAxes => false,
        }
    }

    /// Whether its description has masses.
    pub fn has_masses(self) -> bool {
        self != Self::Ur10
    }

    pub fn record(self) -> Record {
        let root = thetahat_testing::root();
        let recorded =
            |name: &str, which| from_experiment(&root.join("experiments").join(name), &thetahat_testing::data(), which);
        match self {
            Self::Tx40 => tx40(&root, &thetahat_testing::data()),
            Self::Lwr4 => recorded("kuka_lwr4.toml", Which::Main(1)),
            Self::Ur10 => recorded("ur10.toml", Which::Main(0)),
            Self::Twin => twin(|_| {}),
            Self::SevenAxes => ARMS[0].record(),
            Self::ThreeAxes => Arm { noise: 0.02, ..ARMS[10] }.record(),
        }
    }
}
