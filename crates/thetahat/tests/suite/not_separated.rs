//! Parameters that a motion does not separate are left out by themselves; what it separates has the true values.

use std::path::Path;

use thetahat::{
    Identification, Method, Recording, Results, Robot, Series, Settings,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    identification::Status,
    preparation::{NamedChoice, ParameterChoice},
    robot::RobotSource,
};

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 4000;
/// Where the second joint stands, rad.
const STANDS: f64 = 0.3;

fn robot() -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/two_joint.toml");
    RobotSource::read(&path).unwrap().robot_with_locks(&Default::default(), &path).unwrap()
}

/// The first joint swings, the second stands: torques by the inverse dynamics of the a-priori robot, and a little noise.
fn recording(robot: &Robot) -> Recording {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let mut workspace = Workspace::new(&model);
    let (mut position, mut torque) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        let t = k as f64 / RATE_HZ;
        let swing = |power: i32| {
            let part =
                |w: f64, a: f64| a * w.powi(power) * (w * t + std::f64::consts::FRAC_PI_2 * f64::from(power)).sin();
            part(3.0, 0.8) + part(5.1, 0.4)
        };
        let (q, dq, ddq) = ([swing(0), STANDS], [swing(1), 0.0], [swing(2), 0.0]);
        let mut tau = [0.0; 2];
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, Sign::Exact, &mut workspace, &mut tau);
        let noise = |seed: f64| 0.02 * (1e4 * (seed + k as f64).sin()).fract();
        position.extend(q);
        torque.extend([tau[0] + noise(0.3), tau[1] + noise(0.7)]);
    }
    Recording::new(RATE_HZ, Series::shaped(2, position), Series::shaped(2, torque))
}

fn results(choice: NamedChoice) -> (Robot, Results) {
    let robot = robot();
    let mut settings = Settings::new(20.0, 5).with_methods([Method::IDIM_LS]);
    settings.parameters.estimate = ParameterChoice::Named(choice);
    let results = Identification::new(&robot, vec![recording(&robot)], settings).unwrap().run().unwrap();
    (robot, results)
}

#[test]
fn a_joint_that_stands_leaves_the_estimates_of_the_other() {
    let (robot, results) = results(NamedChoice::Base);
    let run = &results.runs[0];
    assert_eq!(run.status, Status::Converged, "{:?}", run.reason);
    let left_out = &results.not_separated;
    assert!(left_out.iter().any(|p| p.parameter == "ia2" || p.parameter == "fv2"), "{left_out:?}");
    assert!(left_out.iter().all(|p| run.parameter(&p.parameter).is_none()));
    let sums = left_out.iter().flat_map(|p| &p.with).filter_map(|name| run.parameter(name));
    assert!(sums.into_iter().all(|p| p.interval_95.is_none() && p.standard_deviation.is_none()));
    let model = results.model.as_ref().unwrap();
    let table = Model::new(&robot);
    for name in ["fv1", "fc1"] {
        let true_value = robot.a_priori_parameters()[table.parameter_table().index_of(name).unwrap()];
        let [low, high] = run.parameter(name).unwrap().interval_95.unwrap();
        assert!((low..=high).contains(&true_value) && high - low < 0.2 * true_value, "{name}: {low} {high}");
        let of_model = model.parameters.iter().find(|p| p.name == name).unwrap();
        assert!(of_model.interval_95.is_some(), "{name} has no interval in the model");
    }
    for name in left_out.iter().map(|p| &p.parameter) {
        let of_model = model.parameters.iter().find(|p| p.name == *name).unwrap();
        assert_eq!(of_model.interval_95, None, "{name}");
    }
}

#[test]
fn an_elimination_begins_with_what_the_motion_separates() {
    let (_, results) = results(NamedChoice::Essential);
    let elimination = results.elimination.as_ref().unwrap();
    assert!(elimination.kept.iter().any(|name| name == "fv1"), "{elimination:?}");
    let is_known = |name: &String| elimination.kept.contains(name) || elimination.eliminated.contains(name);
    assert!(results.not_separated.iter().all(|p| !is_known(&p.parameter)));
    assert_eq!(results.runs[0].status, Status::Converged);
}
