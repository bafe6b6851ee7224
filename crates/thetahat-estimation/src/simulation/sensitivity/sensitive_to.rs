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

    /// The same among some of the motors; none if it is not one of those.
    fn among(self, motors: &[usize]) -> Option<Self> {
        match self {
            Self::All => Some(Self::All),
            Self::One(own) => motors.iter().position(|&motor| motor == own).map(Self::One),
        }
    }

    /// One for a motor among them, otherwise zero.
    pub(super) fn factor(self, motor: usize) -> f64 {
        if self.contains(motor) { 1.0 } else { 0.0 }
    }
}

/// A parameter with respect to which a simulated loop can be differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensitiveTo {
    /// The standard parameter at this index of the model's table, in its own unit. An estimated base parameter is the
    /// standard parameter of its own column.
    Parameter(usize),
    /// The logarithm of the position gain `kp` of [`Law`](crate::control::Law).
    PositionGain(Motors),
    /// The logarithm of the velocity gain `kv`; a cascade multiplies its position loop by it as well.
    VelocityGain(Motors),
    /// The logarithm of the drive gain: torque per drive signal.
    DriveGain(Motors),
    /// The logarithm of the common factor of all gear ratios, [`gear_ratio`](crate::simulation::SimulatorBias::gear_ratio).
    GearRatio,
    /// The delay in s: of the signals of a sampled controller, of the reference of a continuous one.
    Delay,
    /// The logarithm of the velocity at which friction changes its sign,
    /// [`sign_velocity_scale`](crate::simulation::ClosedLoop::sign_velocity_scale).
    FrictionTransition,
}

impl SensitiveTo {
    /// The same for a part of the robot with these motors and standard parameters; none of what acts on the other parts alone.
    #[doc(hidden)]
    #[must_use]
    pub fn of_part(self, motors: &[usize], parameters: &[usize]) -> Option<Self> {
        match self {
            Self::Parameter(index) => parameters.iter().position(|&own| own == index).map(Self::Parameter),
            Self::PositionGain(of) => of.among(motors).map(Self::PositionGain),
            Self::VelocityGain(of) => of.among(motors).map(Self::VelocityGain),
            Self::DriveGain(of) => of.among(motors).map(Self::DriveGain),
            Self::GearRatio | Self::Delay | Self::FrictionTransition => Some(self),
        }
    }

    /// The index of a standard parameter.
    pub(super) fn parameter(self) -> Option<usize> {
        match self {
            Self::Parameter(index) => Some(index),
            Self::PositionGain(_)
            | Self::VelocityGain(_)
            | Self::DriveGain(_)
            | Self::GearRatio
            | Self::Delay
            | Self::FrictionTransition => None,
        }
    }

    /// The motors of a drive gain.
    pub(super) fn drive_gain(self) -> Option<Motors> {
        match self {
            Self::DriveGain(motors) => Some(motors),
            Self::Parameter(_)
            | Self::PositionGain(_)
            | Self::VelocityGain(_)
            | Self::GearRatio
            | Self::Delay
            | Self::FrictionTransition => None,
        }
    }

    /// Its positions in a list.
    pub(super) fn columns_of(self, to: &[Self]) -> Vec<usize> {
        to.iter().enumerate().filter(|(_, other)| **other == self).map(|(column, _)| column).collect()
    }
}
