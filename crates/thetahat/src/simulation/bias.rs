use serde::Deserialize;

/// How the simulator differs from the true loop: factors, and a delay that comes on top.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulatorBias {
    /// Factor on every gear ratio with which the simulated robot turns motors into joints: `N_s = factor N`.
    pub gear_ratio: f64,
    /// Factor on every drive gain of the simulated robot.
    pub drive_gain: f64,
    /// Factor on every gain of the simulated controller.
    pub controller_gain: f64,
    /// Delay in s on top of the controller's.
    pub delay_s: f64,
}

impl SimulatorBias {
    /// No difference.
    pub const NONE: Self = Self { gear_ratio: 1.0, drive_gain: 1.0, controller_gain: 1.0, delay_s: 0.0 };

    /// Whether every factor is a positive number and the delay is not negative.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        positive(self.gear_ratio)
            && positive(self.drive_gain)
            && positive(self.controller_gain)
            && self.delay_s.is_finite()
            && self.delay_s >= 0.0
    }
}

impl Default for SimulatorBias {
    fn default() -> Self {
        Self::NONE
    }
}
