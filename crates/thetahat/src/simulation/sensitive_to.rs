/// Which motors a gain belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motors {
    /// All of them: one common factor.
    All,
    /// One, from zero.
    One(usize),
}

impl Motors {
    /// Whether `motor` is among them.
    #[must_use]
    pub fn contains(self, motor: usize) -> bool {
        match self {
            Self::All => true,
            Self::One(own) => own == motor,
        }
    }
}

/// What a simulated loop can be sensitive to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensitiveTo {
    /// The standard parameter at this index of the model's table, in its own unit. An estimated base parameter is the
    /// standard parameter of the column that it keeps.
    Parameter(usize),
    /// The logarithm of the position gain `kp` of [`crate::control::Law`].
    PositionGain(Motors),
    /// The logarithm of the velocity gain `kv`; a cascade multiplies its position loop by it as well.
    VelocityGain(Motors),
    /// The logarithm of the drive gain: torque per drive signal.
    DriveGain(Motors),
    /// The logarithm of the common factor of all gear ratios, [`super::SimulatorBias::gear_ratio`].
    GearRatio,
    /// The delay in s: of the signals of a sampled controller, of the reference of a continuous one.
    Delay,
}
