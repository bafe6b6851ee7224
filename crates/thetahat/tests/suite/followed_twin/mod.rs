//! A robot of two joints that follows a reference under a controller, and its record.

use thetahat::{
    ControllerDescription, Recording, Robot, Series,
    dynamics::Model,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatorBias, Solver},
};
use thetahat_estimation::simulation::{Job, simulate_all};

pub const RATE_HZ: f64 = 500.0;

pub fn robot() -> Robot {
    Robot::read(&thetahat_testing::root().join("robots/two_joint.toml")).unwrap()
}

pub fn controller() -> ControllerDescription {
    toml::from_str("law = 'pd'\nbandwidth_hz = [20]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0")
        .unwrap()
}

/// White noise from a linear congruential generator, the sum of four uniform numbers.
fn noise(count: usize, deviation: f64) -> Vec<f64> {
    let mut state = 7_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..count).map(|_| 3_f64.sqrt() * deviation * (uniform() + uniform() + uniform() + uniform())).collect()
}

/// The record of a twin that follows a reference.
pub fn record(reference: &Series, position_noise: f64) -> Recording {
    record_with_noise(reference, [position_noise, 0.05])
}

/// The same with these standard deviations of positions and torques.
pub fn record_with_noise(reference: &Series, [position_noise, torque_noise]: [f64; 2]) -> Recording {
    let robot = robot();
    let (model, controller, theta) = (Model::new(&robot), controller(), robot.a_priori_parameters());
    let followed = Reference::Sampled(SampledReference::new(reference.clone(), RATE_HZ));
    let closed_loop = ClosedLoop {
        model: &model,
        transmission: &robot.transmission,
        controller: &controller,
        reference: &followed,
        added_signal: None,
        channels: None,
        bias: SimulatorBias::NONE,
        solver: Solver::Adaptive { relative_tolerance: 1e-6, absolute_tolerance: 1e-9 },
        sign_velocity_scale: 0.05,
    };
    let motor_inertia = closed_loop.motor_inertia(&theta, 5.0);
    let grid = OutputGrid { start_s: 0.0, sample_rate_hz: RATE_HZ, samples: reference.len() };
    let motion =
        simulate_all(&[Job { closed_loop, theta: &theta, motor_inertia: &motor_inertia, grid }]).remove(0).unwrap();
    let noisy = |series: &Series, deviation: f64| {
        let noise = noise(series.values().len(), deviation);
        let values = series.values().iter().zip(noise).map(|(v, e)| v + e).collect();
        Series::shaped(series.channels(), values)
    };
    let (q, tau) = (noisy(&motion.q, position_noise), noisy(&motion.tau, torque_noise));
    Recording { truth: Some(theta), ..Recording::new(RATE_HZ, q, tau) }
}
