//! A control law of the user's own.

use std::{fmt, sync::Arc};

/// What a control law sees of one motor, in joint units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LawInput {
    /// The motor, from 0.
    pub motor: usize,
    /// Position error: the reference less the motor's position, rad or m.
    pub error: f64,
    /// The velocity that the controller sees, rad/s or m/s.
    pub velocity: f64,
    /// Velocity of the reference.
    pub reference_velocity: f64,
    /// Acceleration of the reference.
    pub reference_acceleration: f64,
}

impl LawInput {
    pub(super) fn new(motor: usize, [error, velocity, reference_velocity, reference_acceleration]: [f64; 4]) -> Self {
        Self { motor, error, velocity, reference_velocity, reference_acceleration }
    }
}

/// A control law of the user's own: the drive signal of each motor. A closure of a [`LawInput`] is one without memory.
///
/// The simulated loop, the instruments of IV, DIDIM and the design of a motion take it in the place of a PD or cascaded law,
/// by [`ControllerDescription::own`](super::ControllerDescription::own). The description's limit, sample time and delay act on it.
///
/// ```
/// use thetahat_estimation::control::{ControlLaw, ControllerDescription, LawInput};
///
/// /// PI control of the velocity, with proportional control of the position; the integral is kept from sample to sample.
/// #[derive(Debug)]
/// struct Cascade;
///
/// impl ControlLaw for Cascade {
///     fn memory(&self) -> usize {
///         1
///     }
///
///     fn command(&self, input: &LawInput, memory: &mut [f64]) -> f64 {
///         let error = 20.0 * input.error + input.reference_velocity - input.velocity;
///         memory[0] += 1e-3 * error;
///         5.0 * error + 40.0 * memory[0]
///     }
/// }
///
/// let controller = ControllerDescription::own(Cascade).sampled(1e-3, 0.0);
/// assert!(controller.validate(6).is_ok());
/// // A memory needs samples at which it changes.
/// assert!(ControllerDescription::own(Cascade).validate(6).is_err());
/// ```
pub trait ControlLaw: Send + Sync {
    /// The drive signal of a motor. `memory` holds the motor's numbers from the sample before, zeros at first.
    fn command(&self, input: &LawInput, memory: &mut [f64]) -> f64;

    /// How many numbers each motor keeps from sample to sample. Above zero, the controller must be sampled, and CLIE and CLOE
    /// refuse it: their sensitivities have no derivatives of a memory.
    fn memory(&self) -> usize {
        0
    }

    /// What one more of position and of velocity takes away from the drive signal of a law without memory; by central differences
    /// where the law does not say.
    fn slopes(&self, input: &LawInput) -> [f64; 2] {
        let command = |input: LawInput| self.command(&input, &mut []);
        let [of_error, of_velocity] = [step(input.error), step(input.velocity)];
        let with_error = |by: f64| command(LawInput { error: input.error + by, ..*input });
        let with_velocity = |by: f64| command(LawInput { velocity: input.velocity + by, ..*input });
        [
            (with_error(of_error) - with_error(-of_error)) / (2.0 * of_error),
            (with_velocity(-of_velocity) - with_velocity(of_velocity)) / (2.0 * of_velocity),
        ]
    }
}

/// The step of a central difference at a value of about unit scale: the cube root of the rounding error.
fn step(value: f64) -> f64 {
    f64::EPSILON.cbrt() * value.abs().max(1.0)
}

impl<F: Fn(&LawInput) -> f64 + Send + Sync> ControlLaw for F {
    fn command(&self, input: &LawInput, _memory: &mut [f64]) -> f64 {
        self(input)
    }
}

/// A shared control law: equal to itself and to no other.
#[derive(Clone)]
pub struct OwnLaw(Arc<dyn ControlLaw>);

impl OwnLaw {
    /// A law that descriptions share.
    pub fn new(law: impl ControlLaw + 'static) -> Self {
        Self(Arc::new(law))
    }

    /// The law.
    #[must_use]
    pub fn get(&self) -> &dyn ControlLaw {
        &*self.0
    }
}

impl PartialEq for OwnLaw {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl fmt::Debug for OwnLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("OwnLaw")
    }
}

/// An own law with a factor of its signal, as errors of a simulator's gains are, and what its motors remember.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ResolvedLaw {
    law: OwnLaw,
    scale: f64,
    memory: Vec<Vec<f64>>,
}

impl ResolvedLaw {
    pub(super) fn new(law: OwnLaw, scale: f64, motors: usize) -> Self {
        let memory = vec![vec![0.0; law.0.memory()]; motors];
        Self { law, scale, memory }
    }

    /// The signal that the memory as it is gives; it stays so.
    #[cold]
    pub(super) fn command(&self, input: &LawInput) -> f64 {
        self.scale * self.law.0.command(input, &mut self.memory[input.motor].clone())
    }

    /// The signal of a sample, which the memory takes note of.
    pub(super) fn sample(&mut self, input: &LawInput) -> f64 {
        self.scale * self.law.0.command(input, &mut self.memory[input.motor])
    }

    #[cold]
    pub(super) fn slopes(&self, input: &LawInput) -> [f64; 2] {
        self.law.0.slopes(input).map(|slope| self.scale * slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{ControllerDescription, ControllerError};

    fn pd(input: &LawInput) -> f64 {
        100.0 * input.error + 20.0 * (input.reference_velocity - input.velocity)
    }

    #[test]
    fn a_closure_is_the_law_that_it_states() {
        let text = "law = 'pd'\nposition_gain = 100\nvelocity_gain = 20\nvelocity_feed_forward = 1\nsaturation = 15";
        let built_in: ControllerDescription = toml::from_str(text).unwrap();
        let own = ControllerDescription { saturation: vec![15.0], ..ControllerDescription::own(pd) };
        let [built_in, own] = [built_in, own].map(|d| d.resolve(&[1.0, 1.0], 1.1));
        for (e, v) in [(0.1, 0.2), (0.3, -1.0), (-0.9, 0.4)] {
            assert!((built_in.command(1, e, v, 0.05, 3.0) - own.command(1, e, v, 0.05, 3.0)).abs() < 1e-12);
            let [a, b] = [&built_in, &own].map(|c| c.slopes(1, e, v, 0.05, 3.0));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7), "{a:?} {b:?}");
        }
    }

    #[test]
    fn gains_belong_to_built_in_laws() {
        let both = ControllerDescription { bandwidth_hz: vec![10.0], ..ControllerDescription::own(pd) };
        assert!(matches!(both.validate(2), Err(ControllerError::GainOfOwnLaw { key: "bandwidth_hz" })));
    }
}
