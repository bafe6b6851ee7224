//! Records of robots whose truth is known, made without a simulation: an exact motion, the torques of inverse dynamics, and
//! friction of its own law, seen through sensors.

use std::f64::consts::TAU;
use thetahat_estimation::simulation::{SignalNoise, random_numbers};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Robot, Series,
    base_parameters::BaseParameters,
    checks::Finding,
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::JointKind,
};
use thetahat_estimation::checks::{SignalSettings, Subject, examine};

/// How the joints rub, in parts of the peak torque that the links and motors need.
#[derive(Debug, Clone, Copy)]
pub struct Friction {
    /// Coulomb friction of the first joint and of the last; between them it grows by equal factors.
    pub coulomb: [f64; 2],
    /// What breaks away above Coulomb friction, part of it, and the velocity over which it falls off, rad/s or m/s.
    pub stribeck: f64,
    pub stribeck_velocity: f64,
    /// Travel over which friction turns around after the motion does, rad or m; zero for a sign of the velocity.
    pub presliding: f64,
}

/// A record to be made.
#[derive(Debug, Clone, Copy)]
pub struct Twin {
    pub robot: &'static str,
    pub rate_hz: f64,
    pub seconds: f64,
    /// Highest frequency of the motion.
    pub motion_hz: f64,
    pub cutoff_hz: f64,
    pub friction: Friction,
    /// White noise of the torques, part of their deviation.
    pub noise: f64,
    /// Steps of the torques over their span; zero for none.
    pub torque_steps: f64,
    /// Samples by which the torques are late.
    pub late: f64,
    pub seed: u64,
}

/// Sines of a joint's motion.
const SINES: usize = 4;
/// Steps of the encoders at the joint, rad or m.
const ENCODER_STEP: f64 = 2e-6;
/// Inertia of the motors beside that of the links: a URDF holds none.
const MOTOR_INERTIA: f64 = 0.05;

/// A made record.
pub struct Record {
    robot: Robot,
    rate_hz: f64,
    position: Series,
    velocity: Series,
    torque: Series,
    signal: SignalSettings,
}

/// The motion of a joint: sines that begin anywhere.
struct Sines([[f64; 3]; SINES]);

impl Sines {
    fn drawn(rng: &mut ChaCha8Rng, size: f64, highest_hz: f64) -> Self {
        Self(std::array::from_fn(|i| {
            let hz = highest_hz * (i as f64 + rng.random_range(0.5..1.0)) / SINES as f64;
            [size / (1.0 + i as f64), hz, rng.random_range(0.0..TAU)]
        }))
    }

    /// The derivative of some order at a time.
    fn at(&self, order: i32, t: f64) -> f64 {
        let sine = |[size, hz, phase]: [f64; 3]| {
            let w = TAU * hz;
            size * w.powi(order) * (w * t + phase + 0.25 * TAU * f64::from(order)).sin()
        };
        self.0.into_iter().map(sine).sum()
    }
}

impl Twin {
    pub fn record(&self) -> Record {
        let robot = robot(self.robot);
        let model = Model::new(&robot);
        let mut rng = random_numbers(self.seed, 0);
        let samples = (self.rate_hz * self.seconds) as usize;
        let size = |kind| if kind == JointKind::Revolute { 0.8 } else { 0.15 };
        let sines: Vec<Sines> =
            robot.coordinates().map(|j| Sines::drawn(&mut rng, size(j.kind), self.motion_hz)).collect();
        let series = |order: i32, late: f64| {
            let at = |k: usize| sines.iter().map(move |s| s.at(order, (k as f64 - late) / self.rate_hz));
            Series::shaped(sines.len(), (0..samples).flat_map(at).collect())
        };
        let mut torque = frictionless(&robot, &model, [0, 1, 2].map(|order| series(order, self.late)));
        let [q, dq] = [0, 1].map(|order| series(order, self.late));
        for j in 0..torque.channels() {
            self.rub(&mut torque, j, [&q.channel(j), &dq.channel(j)]);
            self.measure(&mut torque, j, &mut rng);
        }
        let mut position = series(0, 0.0);
        position.values_mut().iter_mut().for_each(|q| *q = ENCODER_STEP * (*q / ENCODER_STEP).round());
        let decimation = ((self.rate_hz / (2.5 * self.cutoff_hz)) as usize).max(1);
        let edge = (2.0 * self.rate_hz / self.cutoff_hz) as usize;
        let signal =
            SignalSettings { filter_order: 4, cutoff_hz: self.cutoff_hz, decimation, window: edge..samples - edge };
        Record { robot, rate_hz: self.rate_hz, position, velocity: series(1, 0.0), torque, signal }
    }

    /// Adds the friction of joint `j`.
    fn rub(&self, torque: &mut Series, j: usize, [q, dq]: [&[f64]; 2]) {
        let Friction { coulomb, stribeck, stribeck_velocity, presliding } = self.friction;
        let along = j as f64 / (torque.channels() - 1).max(1) as f64;
        let peak = torque.channel(j).iter().fold(0.0_f64, |p, t| p.max(t.abs()));
        let size = peak * coulomb[0] * (coulomb[1] / coulomb[0]).powf(along);
        let mut bent = 0.0;
        for k in 0..torque.len() {
            let step = if k == 0 { 0.0 } else { q[k] - q[k - 1] };
            let towards = step.signum();
            let bends = presliding > 0.0;
            bent = if bends { towards - (towards - bent) * (-step.abs() / presliding).exp() } else { dq[k].signum() };
            let law = 1.0 + stribeck * (-(dq[k] / stribeck_velocity).powi(2)).exp();
            torque.sample_mut(k)[j] += size * (bent * law + 0.3 * dq[k]);
        }
    }

    /// Noise and steps of the sensor of joint `j`.
    fn measure(&self, torque: &mut Series, j: usize, rng: &mut ChaCha8Rng) {
        let own = torque.channel(j);
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let deviation = (own.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / own.len() as f64).sqrt();
        let span =
            own.iter().fold(f64::NEG_INFINITY, |p, t| p.max(*t)) - own.iter().fold(f64::INFINITY, |p, t| p.min(*t));
        let noise = SignalNoise::White(&[self.noise * deviation]);
        let noisy = noise.added_to(Series::shaped(1, own), rng).channel(0);
        for (k, noisy) in noisy.into_iter().enumerate() {
            let step = if self.torque_steps > 0.0 { span / self.torque_steps } else { 0.0 };
            torque.sample_mut(k)[j] = if step > 0.0 { step * (noisy / step).round() } else { noisy };
        }
    }
}

/// A robot of the checkout, or a chain of so many joints.
fn robot(name: &str) -> Robot {
    let Some(joints) = name.strip_prefix("chain of ") else {
        return Robot::read(&thetahat_testing::root().join("robots").join(name)).unwrap();
    };
    let mut text = "<robot name=\"chain\"><link name=\"l0\"/>".to_owned();
    for j in 1..=joints.parse::<usize>().unwrap() {
        let axis = ["1 0 0", "0 1 0", "0 0 1"][j % 3];
        text += &format!(
            "<link name=\"l{j}\"><inertial><origin xyz=\"0.02 0.01 0.05\"/><mass value=\"0.4\"/><inertia ixx=\"0.004\" \
             ixy=\"0\" ixz=\"0\" iyy=\"0.004\" iyz=\"0\" izz=\"0.003\"/></inertial></link><joint name=\"j{j}\" \
             type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{j}\"/><origin xyz=\"0 0 0.1\"/><axis \
             xyz=\"{axis}\"/><limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"3\"/></joint>",
            j - 1
        );
    }
    Robot::parse(&(text + "</robot>"), std::path::Path::new("chain.urdf")).unwrap()
}

/// Torques of the links and motors alone.
fn frictionless(robot: &Robot, model: &Model, [q, dq, ddq]: [Series; 3]) -> Series {
    let mut theta = robot.a_priori_parameters();
    for (i, parameter) in model.parameter_table().iter().enumerate() {
        if parameter.quantity.is_friction() {
            theta[i] = 0.0;
        }
        if parameter.quantity.is_motor_inertia() {
            theta[i] += MOTOR_INERTIA;
        }
    }
    let regressor = Regressor::new(model, &(0..theta.len()).collect::<Vec<_>>());
    let phi = regressor.evaluate_series(model, &q, &dq, &ddq, Sign::Exact);
    let mut torque = Series::zeros(q.len(), q.channels());
    for k in 0..q.len() {
        for (entry, value) in regressor.entries().iter().zip(phi.sample(k)) {
            torque.sample_mut(k)[entry.joint] += value * theta[entry.column];
        }
    }
    torque
}

impl Record {
    /// The same with white noise on the recorded velocities, part of their deviation, and those late by some samples.
    pub fn with_velocity(mut self, noise: f64, late: usize) -> Self {
        let mut rng = random_numbers(3, 0);
        let own = self.velocity.clone();
        for j in 0..own.channels() {
            let rms = (own.channel(j).iter().map(|v| v * v).sum::<f64>() / own.len() as f64).sqrt();
            let noise = SignalNoise::White(&[noise * rms]).draw(own.len(), &mut rng);
            for k in 0..own.len() {
                self.velocity.sample_mut(k)[j] = own.sample(k.saturating_sub(late))[j] + noise.sample(k)[0];
            }
        }
        self
    }

    /// What the checks find.
    pub fn findings(&self) -> Vec<Finding> {
        self.findings_with(&|_| true)
    }

    /// The same where only some of the parameters are estimated.
    pub fn findings_with(&self, is_estimated: &dyn Fn(&str) -> bool) -> Vec<Finding> {
        let model = Model::new(&self.robot);
        let all = BaseParameters::of(&model, &[]).unwrap();
        let names = all.parameters().iter().map(|p| p.name.clone()).filter(|name| is_estimated(name));
        let base = all.select(model.parameter_table(), &names.collect::<Vec<_>>()).unwrap();
        examine(&Subject {
            robot: &self.robot,
            model: &model,
            base: &base,
            all: &all,
            sample_rate_hz: self.rate_hz,
            time_s: None,
            position: &self.position,
            geared: true,
            velocity: Some(&self.velocity),
            torque: Some(&self.torque),
            reference: None,
            reconstructed_deviation: None,
            held_part_of_step: 0.0,
            left_out: &[],
            rests_left_out: false,
            contradicting_times: None,
            added_signal: false,
            signal: self.signal.clone(),
            controller: None,
        })
    }
}
