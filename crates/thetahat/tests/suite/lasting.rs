//! Errors of the model that a narrow filter would take for noise.

use std::path::Path;

use thetahat::{
    Identification, Method, Recording, Results, Robot, Series, Settings,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    results::Verdict,
    robot::RobotSource,
};
use thetahat_testing::noise;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 8000;
/// Angular frequencies and amplitudes of both joints.
const SINES: [[[f64; 2]; 2]; 2] = [[[0.9, 0.8], [1.7, 0.4]], [[1.3, 0.7], [2.1, 0.5]]];

pub fn robot() -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/two_joint.toml");
    RobotSource::read(&path).unwrap().robot_with_locks(&Default::default(), &path).unwrap()
}

/// Positions, velocities and accelerations at a sample.
pub fn motion(k: usize) -> [[f64; 2]; 3] {
    let t = k as f64 / RATE_HZ;
    let derivative = |order: i32| {
        SINES.map(|sines| {
            let turned = std::f64::consts::FRAC_PI_2 * f64::from(order);
            sines.map(|[w, a]| a * w.powi(order) * (w * t + turned).sin()).iter().sum::<f64>()
        })
    };
    [0, 1, 2].map(derivative)
}

/// Torques of the a-priori robot with white noise of a deviation, those of a hardening spring at the first joint that no description has,
/// and a sign of the velocity that changes over `scale` rad/s.
pub fn recording(robot: &Robot, [spring, scale, deviation]: [f64; 3]) -> Recording {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let mut workspace = Workspace::new(&model);
    let (mut position, mut torque, mut noise) = (Vec::new(), Vec::new(), noise());
    for k in 0..SAMPLES {
        let [q, dq, ddq] = motion(k);
        let mut tau = [0.0; 2];
        let sign = Sign::smooth(scale);
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, sign, &mut workspace, &mut tau);
        position.extend(q);
        torque.extend([tau[0] + spring * q[0].powi(3) + deviation * noise(), tau[1] + deviation * noise()]);
    }
    Recording::new(RATE_HZ, Series::shaped(2, position), Series::shaped(2, torque))
}

fn results(spring: f64) -> Results {
    let robot = robot();
    let settings = Settings::new(3.0, 25).with_methods([Method::IDIM_WLS]);
    Identification::new(&robot, vec![recording(&robot, [spring, 0.01, 0.3])], settings).unwrap().run().unwrap()
}

#[test]
fn errors_that_last_are_no_noise_whatever_the_filter() {
    let lasting = |results: &Results| results.model.as_ref().unwrap().lasting_percent.unwrap();
    let [clean, sprung] = [0.0, 4.0].map(results);
    println!("lasting {:.3} % of the clean recording, {:.3} % with a spring", lasting(&clean), lasting(&sprung));
    assert!(lasting(&clean) < 0.3 && clean.verdict == Some(Verdict::Good), "{:?}", clean.verdict_reasons);
    assert!(lasting(&sprung) > 0.7 && sprung.verdict != Some(Verdict::Good), "{:?}", sprung.verdict_reasons);
}
