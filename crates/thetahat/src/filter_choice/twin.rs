//! A twin of a record: its motion without noise, the torques of a model along it, and noise like the record's.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::bands;
use crate::{
    control::ControllerDescription,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    preparation::{Recording, SimulationOptions},
    robot::Robot,
    series::Series,
    signal::{Padding, SecondOrderSections, SignalError, Spectrum, zero_phase},
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatorBias},
};

/// Order of the low-pass that separates motion from noise.
const ORDER: usize = 4;
/// Noise below the band's end is as dense as between the end and this multiple of it.
const BESIDE: f64 = 2.0;
/// Central differences of eighth order, `f' ~ sum_i a_i (f_i - f_-i) / h` and `f'' ~ (b_0 f + sum_i b_i (f_i + f_-i)) / h^2`.
const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
const SECOND: [f64; 5] = [-205.0 / 72.0, 8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];

/// Draws of the noise of the torques.
const TORQUE_DRAWS: usize = 12;
const TORQUE_SEED: u64 = 1 << 32;

/// Torques that are noise, drawn several times.
pub(super) type Noise = Vec<Series>;

/// A record whose true parameters are known.
pub(super) struct RecordTwin {
    sample_rate_hz: f64,
    position: Series,
    torque: Series,
    position_noise: Spectrum,
    torque_noise: Spectrum,
    /// The highest frequency of the motion of each joint, Hz.
    pub(super) bands_hz: Vec<f64>,
}

impl RecordTwin {
    /// The twin of a recording whose standard parameters are about `theta`.
    ///
    /// A joint's motion ends where its position is noise, or where it no longer explains the torque.
    pub(super) fn of(recording: &Recording, model: &Model, theta: &[f64]) -> Result<Self, SignalError> {
        let Recording { sample_rate_hz: rate, position: recorded, torque, .. } = recording;
        let (rate, joints) = (*rate, recorded.channels());
        let zeros = || Series::zeros(recorded.len(), joints);
        let torque = &torque.clone().unwrap_or_else(zeros);
        let positions = Spectrum::of(recorded, rate);
        let above_noise: Vec<f64> = (0..joints).map(|j| bands::above_noise_hz(&positions, j, rate)).collect();
        let motion = low_passed(recorded, &above_noise, rate)?;
        let left = less(torque, &torques(&motion, rate, model, theta));
        let (of_torque, of_left) = (Spectrum::of(torque, rate), Spectrum::of(&left, rate));
        let coherent = |j: usize| bands::coherent_hz(&of_torque, &of_left, j, rate);
        let bands_hz: Vec<f64> = (0..joints).map(|j| above_noise[j].min(coherent(j))).collect();
        let position = low_passed(recorded, &bands_hz, rate)?;
        let of_motion = torques(&position, rate, model, theta);
        let position_noise = Spectrum::of(&less(recorded, &position), rate);
        let torque_noise = Spectrum::of(&less(torque, &of_motion), rate);
        let position_noise = flat_below(position_noise, &bands_hz);
        Ok(Self { sample_rate_hz: rate, position, torque: of_motion, position_noise, torque_noise, bands_hz })
    }

    /// The same with the motion and torques of a controlled robot that follows the motion: friction and loop leave in them
    /// what the band of the motion does not hold. A loop that cannot be simulated leaves the twin as it is.
    pub(super) fn simulated(
        self,
        robot: &Robot,
        model: &Model,
        theta: &[f64],
        controller: &ControllerDescription,
    ) -> Self {
        let rate = self.sample_rate_hz;
        let reference = Reference::Sampled(SampledReference::new(self.position.clone(), rate));
        let simulation = SimulationOptions::default();
        let closed_loop = ClosedLoop {
            model,
            transmission: &robot.transmission,
            controller,
            reference: &reference,
            added_signal: None,
            bias: SimulatorBias::NONE,
            solver: simulation.solver,
            sign_velocity_scale: simulation.sign_velocity_scale,
        };
        let samples = self.position.len();
        let inertia = closed_loop.motor_inertia(theta, samples as f64 / rate);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: rate, samples };
        match closed_loop.simulate(theta, &inertia, &grid) {
            Ok(motion) => Self { position: motion.q, torque: motion.tau, ..self },
            Err(_) => self,
        }
    }

    /// The torques of the twin along its motion, whose positions are recorded with noise; another one for each seed.
    pub(super) fn record(&self, seed: u64) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let noise = self.position_noise.draw(self.position.len(), self.sample_rate_hz, &mut rng);
        Recording::new(self.sample_rate_hz, plus(&self.position, &noise), self.torque.clone())
    }

    /// Several draws of the noise of the torques.
    pub(super) fn torque_noise(&self) -> Noise {
        let mut rng = ChaCha8Rng::seed_from_u64(TORQUE_SEED);
        let mut draw = |_| self.torque_noise.draw(self.position.len(), self.sample_rate_hz, &mut rng);
        (0..TORQUE_DRAWS).map(&mut draw).collect()
    }
}

/// Each channel below its own frequency.
fn low_passed(series: &Series, cutoffs_hz: &[f64], rate: f64) -> Result<Series, SignalError> {
    let channel = |(j, cutoff): (usize, &f64)| {
        let filter = SecondOrderSections::butterworth_lowpass(ORDER, *cutoff, rate)?;
        Ok(zero_phase(&filter, &Series::from_values(1, series.channel(j)), Padding::Matlab)?.channel(0))
    };
    let channels = cutoffs_hz.iter().enumerate().map(channel).collect::<Result<Vec<_>, SignalError>>()?;
    Ok(Series::from_channels(&channels))
}

/// The torques of a model along a motion.
fn torques(q: &Series, rate: f64, model: &Model, theta: &[f64]) -> Series {
    let (parameters, mut workspace) = (DynamicParameters::new(model, theta), Workspace::new(model));
    let mut tau = Series::zeros(q.len(), q.channels());
    let (mut dq, mut ddq) = (vec![0.0; q.channels()], vec![0.0; q.channels()]);
    for k in 0..q.len() {
        differentiate(q, k, rate, &mut dq, &mut ddq);
        let state = State { q: q.sample(k), dq: &dq };
        model.inverse_dynamics(&parameters, state, &ddq, Sign::Exact, &mut workspace, tau.sample_mut(k));
    }
    tau
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

/// Noise that goes on below each channel's band as it is beside it.
fn flat_below(noise: Spectrum, bands_hz: &[f64]) -> Spectrum {
    let step_hz = noise.step_hz;
    let flat = |(c, band): (usize, &f64)| {
        let level = noise.median(c, *band..(BESIDE * band).max(band + 3.5 * step_hz)).unwrap_or(0.0);
        let inside = |(i, density): (usize, &f64)| if i as f64 * step_hz < *band { level } else { *density };
        noise.density[c].iter().enumerate().map(inside).collect()
    };
    Spectrum { step_hz, density: bands_hz.iter().enumerate().map(flat).collect() }
}

fn less(a: &Series, b: &Series) -> Series {
    Series::from_values(a.channels(), a.values().iter().zip(b.values()).map(|(a, b)| a - b).collect())
}

fn plus(a: &Series, b: &Series) -> Series {
    Series::from_values(a.channels(), a.values().iter().zip(b.values()).map(|(a, b)| a + b).collect())
}
