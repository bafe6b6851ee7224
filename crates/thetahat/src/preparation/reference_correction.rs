use serde::Deserialize;

use super::error::PreparationError;
use thetahat_estimation::signal::delayed;
use thetahat_ground::{one_or_each::OneOrEach, series::Series};

/// How a recorded reference is put right: `r(t) = scale r_recorded(t - delay_s) + offset`, joint by joint.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceCorrection {
    /// How much later it is, s; negative where it was recorded too late.
    #[serde(default = "zero")]
    pub delay_s: OneOrEach<f64>,
    /// Its factor.
    #[serde(default = "one")]
    pub scale: OneOrEach<f64>,
    /// What is added, rad or m.
    #[serde(default = "zero")]
    pub offset: OneOrEach<f64>,
}

fn zero() -> OneOrEach<f64> {
    OneOrEach::One(0.0)
}

fn one() -> OneOrEach<f64> {
    OneOrEach::One(1.0)
}

/// Longest delay to either side, s: a longer one is an error in the file.
const LONGEST_S: f64 = 60.0;

/// Refuses a list that does not fit, and values that cannot be.
fn validate(
    values: &OneOrEach<f64>,
    key: &str,
    coordinates: usize,
    (expected, holds): (&str, fn(f64) -> bool),
) -> Result<(), PreparationError> {
    let key = format!("[recording] reference_correction.{key}");
    let list = format!("one number, or a list of {coordinates}, one for each coordinate of the robot");
    let found = values.given();
    PreparationError::require(values.fits(coordinates), &key, &list, format!("a list of {}", found.len()))?;
    found.iter().try_for_each(|v| PreparationError::require(holds(*v), &key, expected, v))
}

impl ReferenceCorrection {
    /// Refuses lists that do not fit the robot, and values that are none.
    ///
    /// # Errors
    /// [`PreparationError::Value`], which names the key.
    pub fn validate(&self, coordinates: usize) -> Result<(), PreparationError> {
        validate(&self.delay_s, "delay_s", coordinates, ("from -60 to 60 s", |v| v.abs() <= LONGEST_S))?;
        let scale = ("a finite number other than zero", (|v: f64| v.is_finite() && v != 0.0) as fn(f64) -> bool);
        validate(&self.scale, "scale", coordinates, scale)?;
        validate(&self.offset, "offset", coordinates, ("a finite number", f64::is_finite))
    }

    /// The reference put right, with as many samples; at its ends it stays at its first and last values.
    ///
    /// # Panics
    /// If a list has fewer numbers than the reference has channels.
    #[must_use]
    pub fn apply(&self, reference: &Series, sample_rate_hz: f64) -> Series {
        let channels = reference.channels();
        let delays: Vec<f64> = (0..channels).map(|j| self.delay_s.of(j) * sample_rate_hz).collect();
        let mut corrected = delayed(reference, &delays);
        for (k, value) in corrected.values_mut().iter_mut().enumerate() {
            *value = self.scale.of(k % channels) * *value + self.offset.of(k % channels);
        }
        corrected
    }

    /// Samples to either side that a corrected sample is made of.
    pub(crate) fn reach(&self, coordinates: usize, sample_rate_hz: f64) -> usize {
        let longest = (0..coordinates).map(|j| self.delay_s.of(j).abs()).fold(0.0, f64::max);
        (longest * sample_rate_hz).ceil() as usize + 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn correction(text: &str) -> ReferenceCorrection {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn scale_offset_and_delay_are_per_joint_or_common() {
        let found = correction("delay_s = -0.01\nscale = [1, 2.0]\noffset = [0.5, 0.0]")
            .apply(&Series::shaped(2, (0..20).flat_map(|k| [f64::from(k), 10.0 * f64::from(k)]).collect()), 100.0);
        assert!((found.sample(4)[0] - 5.5).abs() < 1e-12 && (found.sample(4)[1] - 100.0).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        assert!(correction("").validate(3).is_ok());
        for (text, expected) in [
            ("scale = [1.0]", "reference_correction.scale is a list of 1, expected one number, or a list of 2"),
            ("scale = 0.0", "reference_correction.scale is 0, expected a finite number other than zero"),
            ("delay_s = 100", "reference_correction.delay_s is 100, expected from -60 to 60 s"),
            ("offset = [0, nan]", "reference_correction.offset is NaN"),
        ] {
            let message = correction(text).validate(2).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
