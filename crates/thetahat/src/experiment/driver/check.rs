use std::path::Path;

use super::{
    error::DriverError,
    file::{Driver, DriverSignal},
    pattern::Pattern,
};
use crate::experiment::column_names::Signal;
use thetahat_data::recording::Dimension;

/// The signals with their keys.
const SIGNALS: [(Signal, &str); 5] = [
    (Signal::Time, "time"),
    (Signal::Position, "position"),
    (Signal::Velocity, "velocity"),
    (Signal::Torque, "torque"),
    (Signal::Reference, "reference"),
];

impl Driver {
    /// That every value can be meant.
    pub(super) fn check(&self, path: &Path) -> Result<(), DriverError> {
        let refuse = |key: &str, expected: &'static str, found: String| {
            Err(DriverError::Value { path: path.to_owned(), key: key.to_owned(), expected, found })
        };
        if let Some(rate) = self.rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            return refuse("rate_hz", "a positive number", rate.to_string());
        }
        if let Some(joint) = self.joints.iter().find(|joint| joint.trim_start_matches('*').is_empty()) {
            return refuse("joints", "names of joints, with a * at most at the start", format!("{joint:?}"));
        }
        for (signal, key) in SIGNALS {
            if let Some(name) = self.columns(signal).iter().find(|name| Pattern::of(name).is_none()) {
                let expected = "a name of columns, with one * at most for the number or the name of the joint";
                return refuse(&format!("[{key}] columns"), expected, format!("{name:?}"));
            }
            if let Some((of, expected, found)) = self.signal(signal).and_then(|of| wrong(of, signal)) {
                return refuse(&format!("[{key}] {of}"), expected, found);
            }
        }
        Ok(())
    }
}

/// The first value of a signal that cannot be meant: its key, what is expected and what is found.
fn wrong(of: &DriverSignal, signal: Signal) -> Option<(&'static str, &'static str, String)> {
    if of.columns.is_empty() {
        return Some(("columns", "at least one name", "none".to_owned()));
    }
    if !is_factor(of.scale) {
        return Some(("scale", "a finite number other than zero", of.scale.to_string()));
    }
    if let Some(gain) = of.gain.iter().flat_map(|gain| gain.given()).find(|gain| !is_factor(**gain)) {
        return Some(("gain", "finite numbers other than zero", gain.to_string()));
    }
    let is_torque = matches!(of.unit.dimension(), Dimension::Torque | Dimension::Force);
    if of.gain.is_some() && (signal != Signal::Torque || is_torque) {
        return Some(("gain", "no gain, as the unit is the signal's own: scale is the factor", "one".to_owned()));
    }
    let (fits, expected) = units_of(signal);
    (!fits.contains(&of.unit.dimension())).then(|| ("unit", expected, format!("\"{}\"", of.unit)))
}

fn is_factor(value: f64) -> bool {
    value.is_finite() && value != 0.0
}

/// The dimensions in which a driver may have a signal, and their name.
fn units_of(signal: Signal) -> (&'static [Dimension], &'static str) {
    match signal {
        Signal::Position | Signal::Reference => (
            &[Dimension::Angle, Dimension::Length, Dimension::Dimensionless],
            "a unit of an angle or a length, or \"1\" for counts",
        ),
        Signal::Velocity => (&[Dimension::AngularVelocity, Dimension::LinearVelocity], "a unit of a velocity"),
        Signal::Torque => (
            &[Dimension::Torque, Dimension::Force, Dimension::Current, Dimension::Voltage, Dimension::Dimensionless],
            "a unit of a torque, a force, a current or a voltage, \"%\" or \"1\"",
        ),
        Signal::Time => (&[Dimension::Time], "a unit of time"),
    }
}
