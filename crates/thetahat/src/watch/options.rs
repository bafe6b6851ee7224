//! How a robot is watched.

use super::error::WatchError;

/// How a robot is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchOptions {
    /// Time in which baseline and noise are learned, s.
    pub settle_s: f64,
    /// False alarms per hour: half for collisions, half for changes.
    pub alarms_per_hour: f64,
    /// Time between two residuals, s; `None` for the summary's alone.
    pub every_s: Option<f64>,
}

impl Default for WatchOptions {
    fn default() -> Self {
        Self { settle_s: 30.0, alarms_per_hour: 0.01, every_s: None }
    }
}

impl WatchOptions {
    pub(super) fn check(&self) -> Result<(), WatchError> {
        let refuse = |option, expected, found| Err(WatchError::Option { option, expected, found });
        if !(self.settle_s >= 5.0 && self.settle_s.is_finite()) {
            return refuse("--settle", "5 s or more", self.settle_s);
        }
        if !(self.alarms_per_hour > 0.0 && self.alarms_per_hour <= 60.0) {
            return refuse("--alarms-per-hour", "above 0 and at most 60", self.alarms_per_hour);
        }
        match self.every_s.filter(|every| !(*every >= 0.1 && every.is_finite())) {
            Some(every) => refuse("--every", "0.1 s or more", every),
            None => Ok(()),
        }
    }
}
