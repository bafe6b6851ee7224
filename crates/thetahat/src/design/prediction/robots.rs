//! The possible robots: as expected, with the payload and without, and with parameters that are off by what the design states.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::design::{error::DesignError, text::description::Design};
use crate::preparation::Payload;
use thetahat_model::{
    dynamics::Model,
    robot::{ParameterTable, Quantity},
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
        robots.insert(0, a_priori);
        let of_payload = self.payload_parameters(model)?;
        Ok(match of_payload {
            None => robots,
            Some(payload) => robots.into_iter().flat_map(|robot| [sum(&robot, &payload), robot]).collect(),
        })
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
