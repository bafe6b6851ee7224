use std::{error::Error, f64::consts::TAU};
use thetahat_estimation::simulation::{NoisySignals, RecordingNoise, SignalNoise, random_numbers};

use thetahat::{
    ControllerDescription, Recording, Robot, Series,
    consistency::completed_a_priori,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::Quantity,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulatorBias, Solver},
};
use thetahat_model::robot::JointQuantity;

use super::{
    reference::{Kind, motion},
    robots::Subject,
};

/// Rate of the references.
pub const RATE_HZ: f64 = 500.0;
/// Bandwidth of the true loop.
pub const BANDWIDTH_HZ: f64 = 10.0;
/// Velocity over which friction changes its sign, in the twin and in simulations.
pub const SIGN_VELOCITY_SCALE: f64 = 0.005;
/// Inertia of a motor where the file has none: part of the mean inertia that its joint moves.
const MOTOR_PART: f64 = 0.3;
/// Coulomb and viscous friction where the file has none: part of the torque and of the torque at the usual velocity.
const FRICTION_PART: f64 = 0.1;
const LEAST_TORQUE: f64 = 0.1;
const TIGHT: Solver = Solver::Automatic { relative_tolerance: 1e-7, absolute_tolerance: 1e-10 };

/// Noise of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    pub name: &'static str,
    /// Deviation of the positions, rad or m.
    pub position: f64,
    /// Deviation of the torques, part of their rms.
    pub torque: f64,
}

pub const NOISE: [Noise; 2] =
    [Noise { name: "low", position: 1e-5, torque: 0.01 }, Noise { name: "high", position: 1e-4, torque: 0.05 }];

/// How long a twin moves, and how it is sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    pub kind: Kind,
    pub duration_s: f64,
    pub rate_hz: f64,
}

/// A simulated robot, its motion and its true parameters.
pub struct Twin {
    pub name: &'static str,
    pub robot: Robot,
    /// What CAD knows: the true links, and the motors and friction that the file has.
    pub cad: Vec<f64>,
    pub truth: Vec<f64>,
    reference: Series,
    pub rate_hz: f64,
    pub motion: SimulatedMotion,
    /// What each motor sees, drive signal per acceleration.
    inertia: Vec<f64>,
}

impl Twin {
    pub fn new(
        subject: Subject,
        Sampling { kind, duration_s, rate_hz }: Sampling,
        seed: u64,
    ) -> Result<Self, Box<dyn Error>> {
        let Subject { name, robot, has_motor_inertias } = subject;
        let cad = completed_a_priori(&robot, None);
        let reference = motion(kind, &robot, duration_s, RATE_HZ, seed);
        let model = Model::new(&robot);
        let usual = Usual::along(&reference, &model, &cad);
        let mut truth = cad.clone();
        for (value, p) in truth.iter_mut().zip(model.parameter_table().iter()).filter(|(v, _)| **v == 0.0) {
            let j = robot.coordinate_joints().iter().position(|&k| k + 1 == p.number).unwrap_or_default();
            let torque = usual.torque[j].max(LEAST_TORQUE);
            *value = match p.quantity {
                Quantity::Joint(JointQuantity::Ia) if has_motor_inertias => MOTOR_PART * usual.inertia[j],
                Quantity::Joint(JointQuantity::Fc) => FRICTION_PART * torque,
                Quantity::Joint(JointQuantity::Fv) => FRICTION_PART * torque / usual.velocity[j],
                Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_) => continue,
            };
        }
        let (motion, inertia) = simulate(&robot, &model, &truth, &reference, rate_hz)?;
        Ok(Self { name, robot, cad, truth, reference, rate_hz, motion, inertia })
    }

    /// The Coulomb friction of each coordinate.
    pub fn coulomb_friction(&self) -> Vec<f64> {
        let model = Model::new(&self.robot);
        let index = |joint| model.parameter_table().index(Quantity::Joint(JointQuantity::Fc), joint);
        let of = |joint| index(joint).map_or(0.0, |i| self.truth[i]);
        self.robot.coordinate_joints().into_iter().map(of).collect()
    }

    /// The loop with gains for so many times the true bandwidth.
    pub fn controller(&self, factor: f64) -> ControllerDescription {
        let w = TAU * factor * BANDWIDTH_HZ;
        ControllerDescription {
            bandwidth_hz: Vec::new(),
            position_gain: self.inertia.iter().map(|j| j * w * w).collect(),
            velocity_gain: self.inertia.iter().map(|j| 2.0 * j * w).collect(),
            ..ControllerDescription::pd(BANDWIDTH_HZ)
        }
    }

    /// A recording of the motion with noise, with the reference if both have the same rate.
    pub fn record(&self, noise: Noise, seed: u64) -> Recording {
        let SimulatedMotion { q, tau, .. } = &self.motion;
        let torques: Vec<f64> = (0..tau.channels()).map(|j| noise.torque * rms(&tau.channel(j))).collect();
        let positions = vec![noise.position; torques.len()];
        let noise = RecordingNoise { position: SignalNoise::White(&positions), torque: SignalNoise::White(&torques) };
        let NoisySignals { position, torque } = noise.record(q.clone(), tau.clone(), &mut random_numbers(seed, 0));
        let reference = (self.rate_hz == RATE_HZ).then(|| self.reference.clone());
        Recording { truth: Some(self.truth.clone()), reference, ..Recording::new(self.rate_hz, position, torque) }
    }
}

fn simulate(
    robot: &Robot,
    model: &Model,
    theta: &[f64],
    reference: &Series,
    rate_hz: f64,
) -> Result<(SimulatedMotion, Vec<f64>), Box<dyn Error>> {
    let controller = ControllerDescription::pd(BANDWIDTH_HZ);
    let duration_s = reference.len() as f64 / RATE_HZ;
    let reference = Reference::Sampled(SampledReference::new(reference.clone(), RATE_HZ));
    let closed_loop = ClosedLoop {
        model,
        transmission: &robot.transmission,
        controller: &controller,
        reference: &reference,
        added_signal: None,
        channels: None,
        bias: SimulatorBias::NONE,
        solver: TIGHT,
        sign_velocity_scale: SIGN_VELOCITY_SCALE,
    };
    let inertia = closed_loop.motor_inertia(theta, duration_s);
    let grid = OutputGrid { start_s: 0.0, sample_rate_hz: rate_hz, samples: (duration_s * rate_hz).round() as usize };
    Ok((closed_loop.simulate(theta, &inertia, &grid)?, inertia))
}

/// Rms torque and velocity and mean inertia of each joint along a motion.
struct Usual {
    torque: Vec<f64>,
    velocity: Vec<f64>,
    inertia: Vec<f64>,
}

impl Usual {
    fn along(q: &Series, model: &Model, theta: &[f64]) -> Self {
        let n = q.channels();
        let (parameters, mut workspace) = (DynamicParameters::sorted(model, theta), Workspace::new(model));
        let [mut torque, mut velocity, mut inertia] = [(); 3].map(|()| vec![0.0; n]);
        let (mut tau, mut mass) = (vec![0.0; n], vec![0.0; n * n]);
        let every = 10;
        let points: Vec<usize> = (1..q.len() - 1).step_by(every).collect();
        for &k in &points {
            let (before, here, after) = (q.sample(k - 1), q.sample(k), q.sample(k + 1));
            let dq: Vec<f64> = before.iter().zip(after).map(|(b, a)| 0.5 * RATE_HZ * (a - b)).collect();
            let ddq: Vec<f64> = (0..n).map(|j| RATE_HZ * RATE_HZ * (before[j] - 2.0 * here[j] + after[j])).collect();
            let state = State::new(here, &dq);
            model.inverse_dynamics(&parameters, state, &ddq, Sign::Exact, &mut workspace, &mut tau);
            model.mass_matrix(&parameters, here, &mut workspace, &mut mass);
            for j in 0..n {
                torque[j] += tau[j] * tau[j] / points.len() as f64;
                velocity[j] += dq[j] * dq[j] / points.len() as f64;
                inertia[j] += mass[j * n + j] / points.len() as f64;
            }
        }
        let roots = |squares: Vec<f64>| squares.into_iter().map(f64::sqrt).collect();
        Self { torque: roots(torque), velocity: roots(velocity), inertia }
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}
