//! What the sensors of a twin add to its motion: encoder steps and noise, white or coloured torque noise.

use std::f64::consts::TAU;
use thetahat_estimation::simulation::{Autoregression, SignalNoise, random_numbers};

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardUniform};
use thetahat::Series;

use super::twin::Twin;

/// Time constant of the coloured torque noise, an autoregression of the first order: a corner at 5.3 Hz.
const TIME_CONSTANT_S: f64 = 0.03;
/// What the parallel filter lets through of white noise: the cut-off over the Nyquist frequency of the decimated rate.
const PASS_BAND: f64 = 0.8;

/// The spectrum of the torque noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Independent samples.
    White,
    /// An autoregression with a time constant of 30 ms and the standard deviation that the decimated white noise has.
    Coloured,
}

impl Colour {
    pub const ALL: [Self; 2] = [Self::White, Self::Coloured];

    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Coloured => "coloured",
        }
    }
}

/// How much noise there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// A quarter of the noise of the high level.
    Low,
    /// The torque noise of the twin's description, and white noise on the positions.
    High,
}

impl Level {
    pub const ALL: [Self; 2] = [Self::Low, Self::High];

    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::High => "high",
        }
    }

    fn factor(self) -> f64 {
        match self {
            Self::Low => 0.25,
            Self::High => 1.0,
        }
    }
}

/// A twin's noise in one condition.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    pub level: Level,
    pub colour: Colour,
}

impl Noise {
    /// The generator of one seed: conditions draw from streams of their own.
    pub fn generator(self, seed: u64) -> ChaCha8Rng {
        random_numbers(seed, 2 * self.level as u64 + self.colour as u64)
    }

    /// Standard deviation of the white noise on each joint's torque.
    pub fn torque_deviation(self, twin: &Twin) -> Vec<f64> {
        twin.sensors().torque_noise.iter().map(|sd| self.level.factor() * sd).collect()
    }

    /// Noise on the joint torques in the twin's window.
    pub fn torque(self, twin: &Twin, generator: &mut ChaCha8Rng) -> Series {
        let (deviation, samples) = (self.torque_deviation(twin), twin.window.len());
        match self.colour {
            Colour::White => SignalNoise::White(&deviation).draw(samples, generator),
            // The stream has one sample more than the window: numbers that are published were drawn with it.
            Colour::Coloured => {
                SignalNoise::Autoregressive(&coloured(&deviation, twin)).draw(samples + 1, generator).window(0..samples)
            }
        }
    }

    /// The recorded joint positions of the whole motion: white noise, then the steps of encoders whose zero lies anywhere
    /// in a step.
    pub fn positions(self, twin: &Twin, generator: &mut ChaCha8Rng) -> Series {
        let transmission = &twin.experiment.robot.transmission;
        let deviation = vec![self.level.factor() * twin.position_noise; twin.motion.q.channels()];
        let joints = SignalNoise::White(&deviation).added_to(twin.motion.q.clone(), generator);
        let mut motors = transmission.motor_positions(&joints);
        let zeros: Vec<f64> = (0..motors.channels()).map(|_| StandardUniform.sample(generator)).collect();
        let step = TAU / twin.sensors().encoder_counts_per_turn;
        for k in 0..motors.len() {
            motors.sample_mut(k).iter_mut().zip(&zeros).for_each(|(p, z)| *p = step * ((*p / step + z).round() - z));
        }
        transmission.joint_positions(&motors)
    }
}

/// Stationary noise with the standard deviation of decimated white noise.
fn coloured(deviation: &[f64], twin: &Twin) -> Autoregression {
    let pole = (-1.0 / (twin.sample_rate_hz * TIME_CONSTANT_S)).exp();
    let decimated = (PASS_BAND / twin.experiment.settings.signal.decimation as f64).sqrt();
    let first: Vec<f64> = deviation.iter().map(|sd| sd * decimated).collect();
    let innovation = first.iter().map(|sd| (1.0 - pole * pole).sqrt() * sd).collect();
    Autoregression { correlation: pole, first, innovation }
}
