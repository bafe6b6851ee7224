//! A twin of a recording: its motion without noise, the torques of a model along it, and noise like the recording's.

use super::{
    bands,
    low_pass::rate_of_noise,
    recorder::{Recorder, residual_of},
    static_friction::StaticFriction,
};
use crate::preparation::{Recording, STILL, SimulationOptions};
use thetahat_estimation::{
    control::ControllerDescription,
    signal::{Motion, Padding, SecondOrderSections, SignalError, Spectrum, zero_phase},
    simulation::{
        ClosedLoop, OutputGrid, Reference, SampledReference, SignalNoise, SimulatorBias, Solver, random_numbers,
    },
};
use thetahat_ground::series::Series;
use thetahat_model::{
    dynamics::{Model, Sign},
    robot::{JointQuantity, Quantity, Robot},
};

/// Order of the low-pass that separates motion from noise.
const ORDER: usize = 4;
/// Noise below the band's end is as dense as between the end and this multiple of it.
const LEVEL_BAND: f64 = 2.0;
/// Central differences of eighth order, `f' ~ sum_i a_i (f_i - f_-i) / h` and `f'' ~ (b_0 f + sum_i b_i (f_i + f_-i)) / h^2`.
const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
const SECOND: [f64; 5] = [-205.0 / 72.0, 8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];

const TORQUE_SEED: u64 = 1 << 32;

/// Most steps of a twin's simulation times the square of its joints: some seconds. A loop that takes more is too stiff, and the motion
/// itself with its torques does as well.
const MOST_WORK: f64 = 8e6;
/// The velocity scale of friction as a part of a joint's rms velocity.
const OF_VELOCITY: f64 = 0.02;

/// Torques that are noise, drawn several times.
pub(super) type Noise = Vec<Series>;

/// A simulated recording, whose true parameters are known.
pub(super) struct RecordingTwin {
    sample_rate_hz: f64,
    position: Series,
    torque: Series,
    static_friction: StaticFriction,
    position_noise: Spectrum,
    torque_noise: Spectrum,
}

/// The simulated robot of a twin.
pub(super) struct Mover<'a> {
    pub(super) robot: &'a Robot,
    pub(super) model: &'a Model,
    /// Standard parameters.
    pub(super) theta: &'a [f64],
    pub(super) controller: &'a ControllerDescription,
}

impl RecordingTwin {
    /// The twin of a recording: a controlled robot follows its motion below `motion_hz`. Friction and loop add to motion and
    /// torques what that band does not contain. Its torques are recorded as those of the recording were.
    pub(super) fn new(
        recording: &Recording,
        motion_hz: f64,
        recorder: &Recorder,
        mover: &Mover<'_>,
    ) -> Result<Self, SignalError> {
        let Recording { sample_rate_hz: rate, position: recorded, .. } = recording;
        let positions = Spectrum::of(recorded, *rate);
        let noise_rate = rate_of_noise(recording);
        let bands: Vec<f64> =
            (0..recorded.channels()).map(|j| bands::above_noise_hz(&positions, j, noise_rate)).collect();
        let noise = less(recorded, &low_passed(recorded, &bands, *rate)?);
        let reference = low_passed(recorded, &vec![motion_hz; recorded.channels()], *rate)?;
        let (position, torque, static_friction) = mover.follow(reference, *rate);
        Ok(Self {
            sample_rate_hz: *rate,
            position,
            torque: recorder.recorded(torque, *rate)?,
            static_friction,
            position_noise: flat_below(Spectrum::of(&noise, *rate), &bands),
            torque_noise: Spectrum::of(&recorder.noise, *rate),
        })
    }

    /// The torques of the twin along its motion, whose positions are recorded with noise; another one for each seed.
    pub(super) fn record(&self, seed: u64) -> Recording {
        let mut rng = random_numbers(seed, 0);
        let position = self.coloured(&self.position_noise).added_to(self.position.clone(), &mut rng);
        let mut torque = self.torque.clone();
        torque.add(&self.static_friction.draw(&mut rng));
        Recording::new(self.sample_rate_hz, position, torque)
    }

    /// Several draws of the noise of the torques.
    pub(super) fn torque_noise(&self, draws: usize) -> Noise {
        let mut rng = random_numbers(TORQUE_SEED, 0);
        let noise = self.coloured(&self.torque_noise);
        (0..draws).map(|_| noise.draw(self.position.len(), &mut rng)).collect()
    }

    fn coloured<'s>(&self, spectrum: &'s Spectrum) -> SignalNoise<'s> {
        SignalNoise::Coloured { spectrum, sample_rate_hz: self.sample_rate_hz }
    }
}

impl Mover<'_> {
    /// Motion and torques along a reference; the reference itself with its torques where the loop cannot be simulated.
    fn follow(&self, reference: Series, rate: f64) -> (Series, Series, StaticFriction) {
        let samples = reference.len();
        let sign_velocity_scale = sign_velocity_scale(&reference, rate);
        let followed = Reference::Sampled(SampledReference::new(reference.clone(), rate));
        let closed_loop = ClosedLoop {
            model: self.model,
            transmission: &self.robot.transmission,
            controller: self.controller,
            reference: &followed,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver: Solver::default(),
            sign_velocity_scale,
        };
        let inertia = closed_loop.motor_inertia(self.theta, samples as f64 / rate);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: rate, samples };
        let most_steps = MOST_WORK / reference.channels().pow(2) as f64;
        match closed_loop.simulate_within(self.theta, &inertia, &grid, most_steps) {
            Ok(motion) => {
                let static_friction = self.static_friction(&motion.dq, sign_velocity_scale);
                (motion.q, motion.tau, static_friction)
            }
            Err(_) => {
                let motion = differentiated(reference, rate);
                let zero = Series::zeros(samples, motion.q.channels());
                let none = residual_of(&zero, &motion, self.model, self.theta, Sign::Exact);
                let torque = Series::shaped(none.channels(), none.values().iter().map(|v| -v).collect());
                (motion.q, torque, self.static_friction(&motion.dq, sign_velocity_scale))
            }
        }
    }

    /// What static friction may add to the smooth friction of a motion.
    fn static_friction(&self, dq: &Series, sign_velocity_scale: f64) -> StaticFriction {
        let index = |joint| self.model.parameter_table().index(Quantity::Joint(JointQuantity::Fc), joint);
        let coulomb = |joint| index(joint).map_or(0.0, |i| self.theta[i].abs());
        let coulomb: Vec<f64> = self.robot.coordinate_joints().into_iter().map(coulomb).collect();
        StaticFriction::new(&coulomb, dq, sign_velocity_scale)
    }
}

/// Each channel below its own frequency.
fn low_passed(series: &Series, cutoffs_hz: &[f64], rate: f64) -> Result<Series, SignalError> {
    let channel = |(j, cutoff): (usize, &f64)| {
        let filter = SecondOrderSections::butterworth_lowpass(ORDER, *cutoff, rate)?;
        Ok(zero_phase(&filter, &Series::shaped(1, series.channel(j)), Padding::Matlab)?.channel(0))
    };
    let channels = cutoffs_hz.iter().enumerate().map(channel).collect::<Result<Vec<_>, SignalError>>()?;
    Ok(Series::side_by_side(&channels))
}

/// The velocity scale of friction, rad/s or m/s: the usual one, or a part of the slowest joint's velocity, where that is less.
fn sign_velocity_scale(q: &Series, rate: f64) -> f64 {
    let rms_velocity = |j: usize| {
        let steps: f64 = q.channel(j).windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        rate * (steps / q.len() as f64).sqrt()
    };
    let slowest = (0..q.channels()).map(rms_velocity).filter(|v| *v > STILL).fold(f64::INFINITY, f64::min);
    (OF_VELOCITY * slowest).min(SimulationOptions::default().sign_velocity_scale)
}

/// Positions with their derivatives.
fn differentiated(q: Series, rate: f64) -> Motion {
    let (mut dq, mut ddq) = (q.clone(), q.clone());
    for k in 0..q.len() {
        differentiate(&q, k, rate, dq.sample_mut(k), ddq.sample_mut(k));
    }
    Motion { q, dq, ddq }
}

/// First and second derivative at a sample; positions stand still beyond the ends.
fn differentiate(q: &Series, k: usize, rate: f64, dq: &mut [f64], ddq: &mut [f64]) {
    let last = q.len() - 1;
    for j in 0..q.channels() {
        let [mut first, mut second] = [0.0, SECOND[0] * q.sample(k)[j]];
        for i in 1..=FIRST.len() {
            let (before, after) = (q.sample(k.saturating_sub(i))[j], q.sample((k + i).min(last))[j]);
            first += FIRST[i - 1] * (after - before);
            second += SECOND[i] * (after + before);
        }
        (dq[j], ddq[j]) = (first * rate, second * rate * rate);
    }
}

/// Noise whose density below the end of each channel's band is its level just above it.
fn flat_below(noise: Spectrum, bands_hz: &[f64]) -> Spectrum {
    let step_hz = noise.step_hz;
    let flat = |(c, band): (usize, &f64)| {
        let level = noise.median(c, *band..(LEVEL_BAND * band).max(band + 3.5 * step_hz)).unwrap_or(0.0);
        let inside = |(i, density): (usize, &f64)| if i as f64 * step_hz < *band { level } else { *density };
        noise.density[c].iter().enumerate().map(inside).collect()
    };
    Spectrum { step_hz, density: bands_hz.iter().enumerate().map(flat).collect() }
}

fn less(a: &Series, b: &Series) -> Series {
    Series::shaped(a.channels(), a.values().iter().zip(b.values()).map(|(a, b)| a - b).collect())
}
