//! Times at which brakes hold the robot and its torques are zero.

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
/// The robot stands from one of these times to the other, s, and takes a second to stop and to start.
const STANDS: [f64; 2] = [19.0, 23.0];
const STEP_S: f64 = 1e-4;

fn robot() -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/arm/arm.urdf");
    RobotSource::read(&path).unwrap().robot_with_locks(&Default::default(), &path).unwrap()
}

/// The time that has passed on the way: it stops while the robot stands.
fn passed(t: f64) -> f64 {
    let [start, end] = STANDS;
    // Integrals of 1 - 3 u^2 + 2 u^3 and of 3 u^2 - 2 u^3.
    let stopping = |u: f64| u - u.powi(3) + 0.5 * u.powi(4);
    let starting = |u: f64| u.powi(3) - 0.5 * u.powi(4);
    t.min(start)
        + stopping((t - start).clamp(0.0, 1.0))
        + starting((t - end + 1.0).clamp(0.0, 1.0))
        + (t - end).max(0.0)
}

fn position(t: f64, joint: usize) -> f64 {
    let s = passed(t);
    0.5 * ((0.9 + 0.35 * joint as f64) * s + joint as f64).sin() + 0.3 * ((1.9 + 0.2 * joint as f64) * s).sin()
}

/// With brakes that hold the robot, and torques of zero, from one time to another.
fn recording(robot: &Robot, braked: Option<[f64; 2]>) -> Recording {
    let model = Model::new(robot);
    let theta = robot.a_priori_parameters();
    let parameters = DynamicParameters::sorted(&model, &theta);
    let (joints, mut workspace) = (model.coordinate_count(), Workspace::new(&model));
    let (mut positions, mut torques) = (Vec::new(), Vec::new());
    let mut noise = noise();
    for k in 0..SAMPLES {
        let t = k as f64 / RATE_HZ;
        let each = |of: &dyn Fn(usize) -> f64| (0..joints).map(of).collect::<Vec<_>>();
        let [before, q, after] = [-STEP_S, 0.0, STEP_S].map(|by| each(&|j| position(t + by, j)));
        let dq = each(&|j| (after[j] - before[j]) / (2.0 * STEP_S));
        let ddq = each(&|j| (after[j] - 2.0 * q[j] + before[j]) / STEP_S.powi(2));
        let mut tau = vec![0.0; joints];
        let sign = Sign::smooth(0.01);
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, sign, &mut workspace, &mut tau);
        let is_held = braked.is_some_and(|[from, to]| (from..to).contains(&t));
        torques.extend(tau.iter().map(|tau| if is_held { 0.0 } else { *tau } + 0.05 * noise()));
        positions.extend(q);
    }
    Recording::new(RATE_HZ, Series::shaped(joints, positions), Series::shaped(joints, torques))
}

fn results(braked: Option<[f64; 2]>) -> Results {
    let robot = robot();
    let settings = Settings::new(10.0, 10).with_methods([Method::IDIM_WLS]);
    Identification::new(&robot, vec![recording(&robot, braked)], settings).unwrap().run().unwrap()
}

#[test]
fn torques_of_zero_while_brakes_hold_are_left_out_and_said() {
    let free = results(None);
    let error = |results: &Results| results.model.as_ref().unwrap().fit.percent;
    let has_note = |results: &Results| results.recordings[0].notes.iter().any(|note| note.contains("brakes"));
    assert!(!has_note(&free));
    // Brakes that hold a robot that stands, and an emergency stop, in which they stop it.
    for from in [STANDS[0] + 1.0, STANDS[0]] {
        let braked = results(Some([from, STANDS[1] - 1.0]));
        println!("fit {:.3} % without brakes, {:.3} % with", error(&free), error(&braked));
        assert!(has_note(&braked), "{:?}", braked.recordings[0].notes);
        assert!(error(&braked) < 1.2 * error(&free) + 0.05, "{} {}", error(&braked), error(&free));
        assert_eq!(braked.verdict, Some(Verdict::Good), "{:?}", braked.verdict_reasons);
    }
}
