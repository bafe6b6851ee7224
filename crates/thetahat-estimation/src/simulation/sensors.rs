use std::f64::consts::TAU;

use serde::Deserialize;

use super::{
    motion::SimulatedMotion,
    noise::{SignalNoise, random_numbers},
};
use thetahat_ground::{one_or_each, series::Series};
use thetahat_model::robot::Robot;

/// Streams of the random numbers of torques and positions.
const TORQUES: u64 = 0;
const POSITIONS: u64 = 1;

/// The sensors between a simulated motion and its recording: encoders, torque ripple and torque noise.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Encoder counts per turn of each motor.
    pub encoder_counts_per_turn: f64,
    /// Standard deviation of the white noise on each joint torque, N m or N.
    #[serde(deserialize_with = "one_or_each::list")]
    pub torque_noise: Vec<f64>,
    /// Standard deviation of the white noise on each joint position, degrees or mm; zero by default.
    #[serde(default = "no_noise", deserialize_with = "one_or_each::list")]
    pub position_noise: Vec<f64>,
    /// Amplitude of the ripple on each joint torque, N m or N.
    #[serde(deserialize_with = "one_or_each::list")]
    pub torque_ripple: Vec<f64>,
    /// Periods of the ripple per turn of the motor.
    pub ripple_per_turn: f64,
    /// Seed of the noise.
    pub seed: u64,
}

fn no_noise() -> Vec<f64> {
    vec![0.0]
}

impl Sensors {
    /// Records a robot's motion: motor positions in rad and drive signals, as its controller would log them.
    #[must_use]
    pub fn record(&self, motion: &SimulatedMotion, robot: &Robot) -> (Series, Series) {
        let transmission = &robot.transmission;
        let mut positions = transmission.motor_positions(&self.noisy_positions(motion.q.clone(), robot));
        let mut torques = motion.tau.clone();
        let noise = SignalNoise::White(&self.torque_noise).draw(torques.len(), &mut random_numbers(self.seed, TORQUES));
        for k in 0..torques.len() {
            let motors = positions.sample(k).to_vec();
            for (j, tau) in torques.sample_mut(k).iter_mut().enumerate() {
                let ripple = (self.ripple_per_turn * motors[j]).sin();
                *tau += noise.sample(k)[j] + self.torque_ripple[j] * ripple;
            }
        }
        let step = TAU / self.encoder_counts_per_turn;
        positions.values_mut().iter_mut().for_each(|p| *p = step * (*p / step).round());
        (positions, transmission.drive_signals(&torques))
    }

    /// Positions with their noise, whose numbers are not those of the torques'.
    fn noisy_positions(&self, q: Series, robot: &Robot) -> Series {
        let joints = self.position_noise.iter().zip(robot.coordinates());
        let deviations: Vec<f64> = joints.map(|(value, joint)| joint.kind.to_si(*value)).collect();
        if deviations.iter().any(|deviation| *deviation > 0.0) {
            return SignalNoise::White(&deviations).added_to(q, &mut random_numbers(self.seed, POSITIONS));
        }
        q
    }
}
