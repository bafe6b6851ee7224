//! What CLIE and CLOE estimate of the loop in addition to the robot's parameters.

use std::borrow::Cow;

use serde::Deserialize;

use thetahat_estimation::{
    control::ControllerDescription,
    simulation::{Motors, SensitiveTo, SimulatorBias},
};
use thetahat_model::robot::Transmission;

/// Largest factor on `sign_velocity_scale`, and on its inverse.
const MOST_OF_TRANSITION: f64 = 10.0;

/// A quantity of the simulated loop that is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopParameter {
    /// One factor on all gear ratios.
    GearRatio,
    /// One factor on all drive gains.
    DriveGain,
    /// A factor on the drive gain of each motor.
    DriveGains,
    /// One factor on all position gains.
    PositionGain,
    /// A factor on the position gain of each motor.
    PositionGains,
    /// One factor on all velocity gains.
    VelocityGain,
    /// A factor on the velocity gain of each motor.
    VelocityGains,
    /// A delay on top of the controller's; of the reference, where the controller is continuous.
    Delay,
    /// The velocity at which friction changes its sign, in place of `sign_velocity_scale`.
    FrictionTransition,
}

impl LoopParameter {
    /// Its name in an experiment file.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::GearRatio => "gear-ratio",
            Self::DriveGain => "drive-gain",
            Self::DriveGains => "drive-gains",
            Self::PositionGain => "position-gain",
            Self::PositionGains => "position-gains",
            Self::VelocityGain => "velocity-gain",
            Self::VelocityGains => "velocity-gains",
            Self::Delay => "delay",
            Self::FrictionTransition => "friction-transition",
        }
    }

    /// Whether it is a gain of the controller.
    pub(crate) fn is_gain(self) -> bool {
        match self {
            Self::PositionGain | Self::PositionGains | Self::VelocityGain | Self::VelocityGains => true,
            Self::GearRatio | Self::DriveGain | Self::DriveGains | Self::Delay | Self::FrictionTransition => false,
        }
    }

    fn sensitive_to(self, motors: usize) -> Vec<SensitiveTo> {
        let each = |gain: fn(Motors) -> SensitiveTo| (0..motors).map(|i| gain(Motors::One(i))).collect();
        match self {
            Self::GearRatio => vec![SensitiveTo::GearRatio],
            Self::DriveGain => vec![SensitiveTo::DriveGain(Motors::All)],
            Self::DriveGains => each(SensitiveTo::DriveGain),
            Self::PositionGain => vec![SensitiveTo::PositionGain(Motors::All)],
            Self::PositionGains => each(SensitiveTo::PositionGain),
            Self::VelocityGain => vec![SensitiveTo::VelocityGain(Motors::All)],
            Self::VelocityGains => each(SensitiveTo::VelocityGain),
            Self::Delay => vec![SensitiveTo::Delay],
            Self::FrictionTransition => vec![SensitiveTo::FrictionTransition],
        }
    }
}

/// The quantities of the loop that are estimated, in the order of the estimate after the robot's parameters: logarithms of
/// factors, and a delay in s. Zeros leave the loop as it is described.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct LoopParameters(Vec<SensitiveTo>);

/// In what an estimated quantity of the loop is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LoopUnit {
    Seconds,
    /// The estimate is the logarithm of a factor.
    Factor,
    /// The estimate is the logarithm of a factor on this velocity, rad/s or m/s.
    Velocity {
        scale: f64,
    },
}

impl LoopUnit {
    /// The quantity with an estimate.
    pub(crate) fn value(self, estimate: f64) -> f64 {
        match self {
            Self::Seconds => estimate,
            Self::Factor => estimate.exp(),
            Self::Velocity { scale } => scale * estimate.exp(),
        }
    }

    /// The change of the quantity with the estimate.
    pub(crate) fn slope(self, estimate: f64) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Factor | Self::Velocity { .. } => self.value(estimate),
        }
    }

    pub(crate) fn symbol(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Factor => "",
            Self::Velocity { .. } => "rad/s or m/s",
        }
    }
}

/// The parts of a loop that they change.
pub(crate) struct LoopParts<'a> {
    pub(crate) controller: Cow<'a, ControllerDescription>,
    pub(crate) transmission: Cow<'a, Transmission>,
    pub(crate) bias: SimulatorBias,
    pub(crate) sign_velocity_factor: f64,
}

impl LoopParameters {
    pub(crate) fn new(asked: &[LoopParameter], motors: usize) -> Self {
        Self(asked.iter().flat_map(|parameter| parameter.sensitive_to(motors)).collect())
    }

    pub(crate) fn sensitive_to(&self) -> &[SensitiveTo] {
        &self.0
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Their names, motors from one.
    pub(crate) fn names(&self) -> Vec<String> {
        let of_motors = |name: &str, motors: Motors| match motors {
            Motors::All => name.to_owned(),
            Motors::One(motor) => format!("{name} {}", motor + 1),
        };
        let name = |to: &SensitiveTo| match *to {
            SensitiveTo::Parameter(_) => String::new(),
            SensitiveTo::PositionGain(motors) => of_motors("position gain", motors),
            SensitiveTo::VelocityGain(motors) => of_motors("velocity gain", motors),
            SensitiveTo::DriveGain(motors) => of_motors("drive gain", motors),
            SensitiveTo::GearRatio => "gear ratio".to_owned(),
            SensitiveTo::Delay => "delay".to_owned(),
            SensitiveTo::FrictionTransition => "friction transition".to_owned(),
        };
        self.0.iter().map(name).collect()
    }

    /// What an estimated value is, with its standard deviation or its interval: a factor, a time, or a velocity.
    pub(crate) fn unit(&self, index: usize, sign_velocity_scale: f64) -> LoopUnit {
        match self.0[index] {
            SensitiveTo::Delay => LoopUnit::Seconds,
            SensitiveTo::FrictionTransition => LoopUnit::Velocity { scale: sign_velocity_scale },
            SensitiveTo::Parameter(_)
            | SensitiveTo::PositionGain(_)
            | SensitiveTo::VelocityGain(_)
            | SensitiveTo::DriveGain(_)
            | SensitiveTo::GearRatio => LoopUnit::Factor,
        }
    }

    /// Values that can be simulated: friction that changes its sign at once takes steps without end.
    pub(crate) fn within_bounds(&self, mut values: Vec<f64>) -> Vec<f64> {
        let bound = MOST_OF_TRANSITION.ln();
        let of_transition = |to: &SensitiveTo| *to == SensitiveTo::FrictionTransition;
        let transitions = self.0.iter().zip(&mut values).filter(|(to, _)| of_transition(to));
        transitions.for_each(|(_, value)| *value = value.clamp(-bound, bound));
        values
    }

    /// The parts of a loop with estimated values; `inertia` is that for which gains given by a bandwidth are resolved.
    pub(crate) fn apply<'a>(&self, values: &[f64], mut parts: LoopParts<'a>, inertia: &[f64]) -> LoopParts<'a> {
        for (to, value) in self.0.iter().zip(values) {
            let factor = value.exp();
            match *to {
                SensitiveTo::Parameter(_) => {}
                SensitiveTo::PositionGain(motors) => {
                    scale_gains(parts.controller.to_mut(), inertia, [(motors, factor), (motors, 1.0)]);
                }
                SensitiveTo::VelocityGain(motors) => {
                    scale_gains(parts.controller.to_mut(), inertia, [(motors, 1.0), (motors, factor)]);
                }
                SensitiveTo::DriveGain(Motors::All) => parts.bias.drive_gain *= factor,
                SensitiveTo::DriveGain(Motors::One(motor)) => {
                    parts.transmission.to_mut().scale_drive_gain(motor, factor)
                }
                SensitiveTo::GearRatio => parts.bias.gear_ratio *= factor,
                SensitiveTo::Delay => parts.bias.delay_s += value,
                SensitiveTo::FrictionTransition => parts.sign_velocity_factor *= factor,
            }
        }
        parts
    }
}

/// Multiplies position and velocity gains of a controller, which then states its gains.
fn scale_gains(
    controller: &mut ControllerDescription,
    inertia: &[f64],
    [(of_position, position), (of_velocity, velocity)]: [(Motors, f64); 2],
) {
    controller.state_gains(inertia);
    let scale = |gains: &mut [f64], motors: Motors, factor: f64| {
        gains.iter_mut().enumerate().filter(|(i, _)| motors.contains(*i)).for_each(|(_, gain)| *gain *= factor);
    };
    scale(&mut controller.position_gain, of_position, position);
    scale(&mut controller.velocity_gain, of_velocity, velocity);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(controller: &ControllerDescription) -> LoopParts<'_> {
        let transmission = Cow::Owned(Transmission::direct(2));
        LoopParts {
            controller: Cow::Borrowed(controller),
            transmission,
            bias: SimulatorBias::NONE,
            sign_velocity_factor: 1.0,
        }
    }

    /// Gains by bandwidth and gains as stated give the same signal, before and after a factor.
    #[test]
    fn the_sign_of_friction_changes_within_a_factor_of_ten() {
        let loop_parameters = LoopParameters::new(&[LoopParameter::Delay, LoopParameter::FrictionTransition], 2);
        assert_eq!(loop_parameters.within_bounds(vec![-3.0, -7.0]), [-3.0, -MOST_OF_TRANSITION.ln()]);
        assert_eq!(loop_parameters.within_bounds(vec![0.1, 1.0]), [0.1, 1.0]);
        let description = ControllerDescription::pd(10.0);
        let changed = loop_parameters.apply(&[0.0, 2.0_f64.ln()], parts(&description), &[1.0; 2]);
        assert!((changed.sign_velocity_factor - 2.0).abs() < 1e-12);
    }

    #[test]
    fn one_motors_gain_is_multiplied_and_the_other_stays() {
        let description = ControllerDescription::pd(10.0);
        let inertia = [2.0, 5.0];
        let loop_parameters = LoopParameters::new(&[LoopParameter::PositionGains], 2);
        let changed = loop_parameters.apply(&[0.0, 2.0_f64.ln()], parts(&description), &inertia);
        let (before, after) = (description.resolve(&inertia, 1.0), changed.controller.resolve(&inertia, 1.0));
        let of_position = |c: &thetahat_estimation::control::Controller, motor| c.command(motor, 0.01, 0.0, 0.0, 0.0);
        assert!((of_position(&after, 0) - of_position(&before, 0)).abs() < 1e-12);
        assert!((of_position(&after, 1) - 2.0 * of_position(&before, 1)).abs() < 1e-9);
        for motor in 0..2 {
            let others = |c: &thetahat_estimation::control::Controller| c.command(motor, 0.0, 0.3, 0.7, 1.1);
            assert!((others(&after) - others(&before)).abs() < 1e-9);
        }
    }

    #[test]
    fn factors_of_ratio_and_drive_multiply_what_is_there() {
        let description = ControllerDescription::pd(10.0);
        let loop_parameters =
            LoopParameters::new(&[LoopParameter::GearRatio, LoopParameter::DriveGains, LoopParameter::Delay], 2);
        assert_eq!(loop_parameters.names(), ["gear ratio", "drive gain 1", "drive gain 2", "delay"]);
        let changed = loop_parameters.apply(&[0.9_f64.ln(), 0.0, 1.1_f64.ln(), 1e-3], parts(&description), &[1.0; 2]);
        assert!((changed.bias.gear_ratio - 0.9).abs() < 1e-15 && changed.bias.delay_s == 1e-3);
        let drive = changed.transmission.drive_to_joint_units();
        assert!(drive[0] == 1.0 && (drive[1] - 1.1).abs() < 1e-15);
    }
}
