use serde::{Deserialize, Serialize};

/// Name of the case without errors of the simulator.
pub const NOMINAL: &str = "nominal";

/// How the simulator differs from the true loop: factors, and an additional delay.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulatorBias {
    /// Factor on every gear ratio with which the simulated robot turns motors into joints: `N_s = factor N`.
    pub gear_ratio: f64,
    /// Factor on every drive gain of the simulated robot.
    pub drive_gain: f64,
    /// Factor on every gain of the simulated controller.
    pub controller_gain: f64,
    /// Delay in s on top of the controller's; for a continuous controller, of its reference.
    pub delay_s: f64,
    /// Factor on the displacement of the reference from where it starts.
    pub reference_scale: f64,
    /// Added to the reference of every joint, rad or m.
    pub reference_offset: f64,
    /// Factor on all friction of the simulated robot.
    pub friction: f64,
}

impl SimulatorBias {
    /// No difference.
    pub const NONE: Self = Self {
        gear_ratio: 1.0,
        drive_gain: 1.0,
        controller_gain: 1.0,
        delay_s: 0.0,
        reference_scale: 1.0,
        reference_offset: 0.0,
        friction: 1.0,
    };

    /// Whether every factor is a positive number (the friction factor may be zero) and the delay is not negative.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        positive(self.gear_ratio)
            && positive(self.drive_gain)
            && positive(self.controller_gain)
            && positive(self.reference_scale)
            && self.reference_offset.is_finite()
            && self.friction.is_finite()
            && self.friction >= 0.0
            && self.delay_s.is_finite()
            && self.delay_s >= 0.0
    }
}

impl Default for SimulatorBias {
    fn default() -> Self {
        Self::NONE
    }
}

/// One way in which a simulator can differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BiasKind {
    /// Gear ratios.
    GearRatio,
    /// Drive gains.
    DriveGain,
    /// Controller gains.
    ControllerGain,
    /// Delay, s.
    Delay,
    /// Displacements of the reference.
    ReferenceScale,
    /// Positions of the reference, rad or m.
    ReferenceOffset,
    /// Friction of the simulated robot.
    Friction,
}

impl BiasKind {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::GearRatio,
        Self::DriveGain,
        Self::ControllerGain,
        Self::Delay,
        Self::ReferenceScale,
        Self::ReferenceOffset,
        Self::Friction,
    ];

    /// Its name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::GearRatio => "gear ratios",
            Self::DriveGain => "drive gains",
            Self::ControllerGain => "controller gains",
            Self::Delay => "delay",
            Self::ReferenceScale => "reference scale",
            Self::ReferenceOffset => "reference offset",
            Self::Friction => "friction",
        }
    }

    /// Whether it is a factor; otherwise it is added.
    #[must_use]
    pub fn is_factor(self) -> bool {
        !matches!(self, Self::Delay | Self::ReferenceOffset)
    }
}

impl SimulatorBias {
    /// The bias with one more difference: a factor is multiplied, a value is added.
    #[must_use]
    pub fn with(self, kind: BiasKind, by: f64) -> Self {
        match kind {
            BiasKind::GearRatio => Self { gear_ratio: self.gear_ratio * by, ..self },
            BiasKind::DriveGain => Self { drive_gain: self.drive_gain * by, ..self },
            BiasKind::ControllerGain => Self { controller_gain: self.controller_gain * by, ..self },
            BiasKind::Delay => Self { delay_s: self.delay_s + by, ..self },
            BiasKind::ReferenceScale => Self { reference_scale: self.reference_scale * by, ..self },
            BiasKind::ReferenceOffset => Self { reference_offset: self.reference_offset + by, ..self },
            BiasKind::Friction => Self { friction: self.friction * by, ..self },
        }
    }
}
