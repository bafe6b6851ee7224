//! Synthetic arms without data: robots of `robots/`, a random band-limited motion, and torques by inverse dynamics with
//! friction of several kinds.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Robot, Series,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::JointKind,
};
use thetahat_estimation::checks::SignalSettings;

use super::record::Record;

/// The friction of a synthetic arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Viscous and Coulomb friction of a fifth of the torque.
    Light,
    /// The last three joints have friction of five times the rest of their torque.
    HeavyWrist,
    /// A breakaway torque half as large again as Coulomb friction, gone at 0.1 rad/s.
    Stribeck,
}

/// A synthetic record.
#[derive(Debug, Clone, Copy)]
pub struct Arm {
    /// In the folder of the project.
    pub robot: &'static str,
    pub rate_hz: f64,
    pub law: Law,
    /// White noise of the torques at [`NOISE_RATE_HZ`], part of their deviations; more at higher rates.
    pub noise: f64,
    /// Of the motion.
    pub seed: u64,
    pub noise_seed: u64,
}

/// The rate at which the noise is as stated: the band of the motion has the same noise at every rate.
const NOISE_RATE_HZ: f64 = 200.0;
/// Length of the records, s.
const SECONDS: f64 = 30.0;
/// Base frequency of the motion, Hz, and its harmonics.
const BASE_HZ: f64 = 0.1;
const HARMONICS: usize = 8;
/// Steps of the encoders, rad or m.
const ENCODER_STEP: f64 = 1e-5;

/// Clean arms of several robots, rates and kinds of friction.
pub const ARMS: [Arm; 12] = [
    Arm { robot: "robots/seven_axes.urdf", rate_hz: 1000.0, law: Law::Light, noise: 0.02, seed: 1, noise_seed: 1 },
    Arm { robot: "robots/seven_axes.urdf", rate_hz: 50.0, law: Law::Light, noise: 0.02, seed: 2, noise_seed: 2 },
    Arm { robot: "robots/seven_axes.urdf", rate_hz: 200.0, law: Law::HeavyWrist, noise: 0.05, seed: 3, noise_seed: 3 },
    Arm { robot: "robots/seven_axes.urdf", rate_hz: 1000.0, law: Law::Stribeck, noise: 0.02, seed: 4, noise_seed: 4 },
    Arm { robot: "robots/tx40.toml", rate_hz: 5000.0, law: Law::Light, noise: 0.02, seed: 5, noise_seed: 5 },
    Arm { robot: "robots/tx40.toml", rate_hz: 250.0, law: Law::Stribeck, noise: 0.05, seed: 6, noise_seed: 6 },
    Arm { robot: "robots/tx40.toml", rate_hz: 125.0, law: Law::HeavyWrist, noise: 0.1, seed: 7, noise_seed: 7 },
    Arm { robot: "robots/branching.urdf", rate_hz: 500.0, law: Law::Light, noise: 0.02, seed: 8, noise_seed: 8 },
    Arm { robot: "robots/scara.toml", rate_hz: 500.0, law: Law::Stribeck, noise: 0.02, seed: 9, noise_seed: 9 },
    Arm { robot: "robots/scara.toml", rate_hz: 100.0, law: Law::HeavyWrist, noise: 0.05, seed: 10, noise_seed: 10 },
    Arm { robot: "examples/arm/arm.urdf", rate_hz: 100.0, law: Law::Light, noise: 0.05, seed: 11, noise_seed: 11 },
    Arm { robot: "examples/arm/arm.urdf", rate_hz: 2000.0, law: Law::Stribeck, noise: 0.1, seed: 12, noise_seed: 12 },
];

impl Arm {
    /// Its record; `change` may spoil the standard parameters.
    pub fn record(&self) -> Record {
        let robot = Robot::read(&thetahat_testing::root().join(self.robot)).unwrap();
        let motion = self.motion(&robot);
        let torque = self.torque(&robot, &motion);
        let [position, ..] = motion;
        let samples = position.len();
        let edge = (self.rate_hz * 0.5).ceil() as usize;
        let cutoff_hz = (0.2 * self.rate_hz).min(15.0);
        let mut record = Record {
            excluded: Vec::new(),
            rate_hz: self.rate_hz,
            time_s: None,
            position,
            velocity: None,
            torque,
            reference: None,
            reconstructed_deviation: None,
            added_signal: false,
            geared: false,
            signal: SignalSettings {
                filter_order: 4,
                cutoff_hz,
                decimation: ((0.4 * self.rate_hz / cutoff_hz) as usize).max(1),
                window: edge..samples - edge,
            },
            controller: None,
            moves: None,
            robot,
        };
        record.position.values_mut().iter_mut().for_each(|q| *q = (*q / ENCODER_STEP).round() * ENCODER_STEP);
        record
    }

    /// Positions, velocities and accelerations: random Fourier series.
    fn motion(&self, robot: &Robot) -> [Series; 3] {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let n = robot.coordinate_count();
        let samples = (SECONDS * self.rate_hz) as usize;
        let size: Vec<f64> = robot
            .coordinates()
            .map(|j| match j.kind {
                JointKind::Revolute => 0.9,
                JointKind::Prismatic => 0.1,
            })
            .collect();
        let waves: Vec<Vec<[f64; 2]>> = (0..n)
            .map(|j| {
                let amplitude = |h: usize| size[j] * rng.random_range(0.3..1.0) / (1.0 + h as f64).powf(0.7);
                let amplitudes: Vec<f64> = (0..HARMONICS).map(amplitude).collect();
                amplitudes.into_iter().map(|a| [a, rng.random_range(0.0..TAU)]).collect()
            })
            .collect();
        [0, 1, 2].map(|order: i32| {
            let value = |k: usize, j: usize| {
                let t = k as f64 / self.rate_hz;
                let wave = |(h, [a, phase]): (usize, &[f64; 2])| {
                    let w = TAU * BASE_HZ * (h + 1) as f64;
                    a * w.powi(order) * (w * t + phase + f64::from(order) * TAU / 4.0).sin()
                };
                waves[j].iter().enumerate().map(wave).sum()
            };
            Series::shaped(
                n,
                (0..samples).flat_map(|k| (0..n).map(move |j| (k, j))).map(|(k, j)| value(k, j)).collect(),
            )
        })
    }

    fn torque(&self, robot: &Robot, [q, dq, ddq]: &[Series; 3]) -> Series {
        let mut rng = ChaCha8Rng::seed_from_u64(self.noise_seed + 1000);
        let model = Model::new(robot);
        let mut theta = robot.a_priori_parameters();
        let table = model.parameter_table();
        for (i, value) in theta.iter_mut().enumerate() {
            if table.get(i).quantity.is_friction() {
                *value = 0.0;
            }
        }
        let parameters = DynamicParameters::sorted(&model, &theta);
        let (n, mut workspace) = (q.channels(), Workspace::new(&model));
        let mut tau = Series::zeros(q.len(), n);
        for k in 0..q.len() {
            let state = State::new(q.sample(k), dq.sample(k));
            model.inverse_dynamics(&parameters, state, ddq.sample(k), Sign::Exact, &mut workspace, tau.sample_mut(k));
        }
        let noise = self.noise * (self.rate_hz / NOISE_RATE_HZ).sqrt();
        for j in 0..n {
            let deviation = deviation(&tau.channel(j)).max(0.2);
            let heavy = self.law == Law::HeavyWrist && j + 3 >= n;
            let level = if heavy { 5.0 } else { 0.2 } * deviation;
            let peak = dq.channel(j).iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let total = deviation.hypot(level);
            for k in 0..tau.len() {
                let v = dq.sample(k)[j];
                let coulomb = match self.law {
                    Law::Light | Law::HeavyWrist => 1.0,
                    Law::Stribeck => 1.0 + 0.5 * (-(v / 0.1).powi(2)).exp(),
                };
                let friction = level * (coulomb * (v / 0.002).tanh() + 0.7 * v / peak);
                let normal: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
                tau.sample_mut(k)[j] += friction + noise * total * normal;
            }
        }
        tau
    }
}

fn deviation(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}
