//! The possible robots: as expected, with the payload and without, and with parameters that are off by what the design states.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::design::{
    error::DesignError,
    limits::joint_limits::JointLimits,
    text::{description::Design, options::UncertaintyOptions},
};
use crate::preparation::Payload;
use thetahat_model::{
    dynamics::Model,
    robot::{ParameterTable, Quantity, Role},
};

/// Stream of the random numbers of the draws, which no search uses.
const STREAM: u64 = u64::MAX;

impl Design {
    /// The payload that the robot carries.
    pub(in crate::design) fn payload(&self) -> Option<&Payload> {
        self.settings.payloads.first()
    }

    /// The standard parameters of the robot as it is expected to move: with its payload.
    pub(in crate::design) fn expected_robot(&self, model: &Model) -> Result<Vec<f64>, DesignError> {
        let of_payload = self.payload_parameters(model)?;
        let a_priori = self.robot.a_priori_parameters();
        Ok(of_payload.map_or_else(|| a_priori.clone(), |payload| sum(&a_priori, &payload)))
    }

    /// The standard parameters of every robot for which the limits of torque and power must hold, the expected one first. With a payload
    /// each of them is listed with and without it.
    pub(in crate::design) fn possible_robots(&self, model: &Model) -> Result<Vec<Vec<f64>>, DesignError> {
        let a_priori = self.robot.a_priori_parameters();
        let options = &self.file.uncertainty;
        let mut rng = ChaCha8Rng::seed_from_u64(self.file.motion.seed);
        rng.set_stream(STREAM);
        let part = 0.01 * options.percent;
        let mut robots: Vec<Vec<f64>> =
            (0..options.draws).map(|_| drawn(model.parameter_table(), &a_priori, part, &mut rng)).collect();
        let assumed = self.with_assumed_drives(model, &a_priori)?;
        robots.splice(0..0, std::iter::once(a_priori).chain(assumed));
        let of_payload = self.payload_parameters(model)?;
        Ok(match of_payload {
            None => robots,
            Some(payload) => robots.into_iter().flat_map(|robot| [sum(&robot, &payload), robot]).collect(),
        })
    }

    /// The robot that a loop is simulated with: with its payload, and with assumed drives in the joints that have none.
    pub(in crate::design) fn robot_of_loop(&self, model: &Model) -> Result<Vec<f64>, DesignError> {
        let a_priori = self.robot.a_priori_parameters();
        let robot = self.with_assumed_drives(model, &a_priori)?.unwrap_or(a_priori);
        let of_payload = self.payload_parameters(model)?;
        Ok(of_payload.map_or_else(|| robot.clone(), |payload| sum(&robot, &payload)))
    }

    /// The robot with usual friction and motor inertias in the joints that have none, where there are such joints and their torques are
    /// limited: a description without them would let torques exceed their limits.
    fn with_assumed_drives(&self, model: &Model, a_priori: &[f64]) -> Result<Option<Vec<f64>>, DesignError> {
        let limits = self.limits()?;
        let middle: Vec<f64> = limits.iter().map(JointLimits::middle).collect();
        let inertias = model.joint_inertias(a_priori, &middle).unwrap_or_default();
        let UncertaintyOptions { friction_percent, motor_inertia_percent, .. } = self.file.uncertainty;
        let lacking = [self.joints_without_friction(), self.joints_without_motor_inertia()];
        let mut robot = a_priori.to_vec();
        for (i, value) in robot.iter_mut().enumerate() {
            let parameter = model.parameter_table().get(i);
            let coordinates = self.robot.coordinate_joints();
            let Some(c) = coordinates.iter().position(|joint| joint + 1 == parameter.number) else { continue };
            let Some(torque) = limits[c].torque else { continue };
            let of_friction = 0.5 * 0.01 * friction_percent * torque;
            let [lacks_friction, lacks_inertia] = lacking.each_ref().map(|lacking| lacking.contains(&coordinates[c]));
            match parameter.quantity.role() {
                Role::CoulombFriction if lacks_friction => *value = of_friction,
                Role::ViscousFriction if lacks_friction => *value = of_friction / limits[c].velocity,
                Role::MotorInertia if lacks_inertia => {
                    *value = 0.01 * motor_inertia_percent * inertias.get(c).copied().unwrap_or_default();
                }
                Role::CoulombFriction | Role::ViscousFriction | Role::MotorInertia | Role::Inertial | Role::Load => {}
            }
        }
        Ok((robot != a_priori).then_some(robot))
    }

    /// The joints that move of which the a-priori robot has no parameter of a kind, or zero.
    pub(in crate::design) fn joints_without(&self, is_meant: impl Fn(Role) -> bool) -> Vec<usize> {
        let theta = self.robot.a_priori_parameters();
        let table = self.robot.parameter_table();
        let has_any = |joint: usize| {
            let own = table.iter().zip(&theta).filter(|(p, _)| p.number == joint + 1 && is_meant(p.quantity.role()));
            own.map(|(_, value)| value.abs()).sum::<f64>() > 0.0
        };
        self.robot.coordinate_joints().into_iter().filter(|joint| !has_any(*joint)).collect()
    }

    /// The joints without friction.
    pub(in crate::design) fn joints_without_friction(&self) -> Vec<usize> {
        self.joints_without(|role| matches!(role, Role::ViscousFriction | Role::CoulombFriction))
    }

    /// The joints without motor inertia.
    pub(in crate::design) fn joints_without_motor_inertia(&self) -> Vec<usize> {
        self.joints_without(|role| role == Role::MotorInertia)
    }

    /// The standard parameters that the payload adds.
    fn payload_parameters(&self, model: &Model) -> Result<Option<Vec<f64>>, DesignError> {
        let standard = |payload: &Payload| payload.standard_parameters(&self.robot, model.parameter_table());
        self.payload().map(standard).transpose().map_err(|source| self.refuse(source))
    }
}

/// Standard parameters at a random corner of their range. A link's ten share one factor, so that it stays physically possible. Torques
/// are linear in the factors: the largest occur at corners.
fn drawn(table: &ParameterTable, theta: &[f64], part: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut factor = || if rng.random_bool(0.5) { 1.0 + part } else { 1.0 - part };
    let links = (0..theta.len()).map(|i| table.get(i).number).max().unwrap_or(0);
    let of_links: Vec<f64> = (0..links).map(|_| factor()).collect();
    let of_parameter = |(i, value): (usize, &f64)| {
        let parameter = table.get(i);
        value
            * match parameter.quantity {
                Quantity::Link(_) => of_links[parameter.number - 1],
                Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_) => factor(),
            }
    };
    theta.iter().enumerate().map(of_parameter).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}
