//! Mechanisms that close: a five-bar arm simulated with known truth is identified by every method, exported and refused where trees are
//! needed.

use std::path::Path;

use thetahat::{
    Experiment, Identification, Method, Recording, Results, Robot,
    consistency::completed_a_priori,
    design::Design,
    export::{ExportError, ExportFormat, export_robot},
    identification::Status,
};
use thetahat_ground::series::Series;
use thetahat_model::robot::{LoopKind, RobotError};
use thetahat_testing::{Folder, project};

/// Standard deviations from the truth that none of 21 normal numbers exceeds in 99.9 % of all cases.
const DEVIATIONS: f64 = 4.1;

/// The results of the experiment of the checkout with other text in the place of some.
fn run_changed(from: &str, to: &str) -> Results {
    let folder = Folder::new();
    let read = |path: &str| std::fs::read_to_string(project(path)).unwrap();
    folder.write("robots/five_bar.toml", read("robots/five_bar.toml"));
    folder.write("experiments/five_bar.toml", read("experiments/five_bar.toml").replace(from, to));
    let file = folder.path().join("experiments/five_bar.toml");
    Experiment::read(&file, folder.path()).unwrap().run(folder.path(), &mut |_| {}).unwrap()
}

fn assert_near_truth(results: &Results, method: Method) {
    let run = results.run("nominal", method).unwrap();
    assert_eq!(run.status, Status::Converged, "{method}: {:?}", run.reason);
    assert_eq!(run.parameters.len(), 21);
    for p in &run.parameters {
        let (truth, sd) = (p.true_value.unwrap(), p.standard_deviation_robust.unwrap());
        assert!((p.estimate - truth).abs() < DEVIATIONS * sd, "{method} {}: {} of {truth}, {sd}", p.name, p.estimate);
    }
}

#[test]
fn every_method_finds_the_parameters_of_a_five_bar_arm() {
    let methods = "cutoff_hz = 40\ndecimation = 10\n[estimation]\nmethods = ['idim-ls', 'idim-wls', 'idim-iv', 'didim', 'clie', \
                   'cloe']\n[simulation]\nsign_velocity_scale = 0.02";
    let results = run_changed("cutoff_hz = 40\ndecimation = 10", methods);
    for method in [Method::IDIM_LS, Method::IDIM_WLS, Method::IDIM_IV, Method::DIDIM, Method::CLIE, Method::CLOE] {
        assert_near_truth(&results, method);
    }
    // Torque noise of 0.1 N m; the model explains the rest.
    let model = results.model.as_ref().unwrap();
    let unseen = model.unseen.as_ref().map(|error| error.percent).unwrap();
    assert!(unseen < 5.0, "{unseen}");
}

const DELTA: &str = "title = 'delta'\nrobot = 'robots/delta.toml'\n[twin]\nsample_rate_hz = 500\nunlisted = 'a-priori'\npoints = \
    [[0, 0, 0], [25, -20, 10], [-15, 20, 25], [10, 25, -25], [-25, -10, 15], [20, 15, -20], [-10, -25, -15], [25, 20, 25], [0, 0, 0]]\n\
    max_velocity = [250, 250, 250]\nacceleration_time_s = 0.15\nsmoothing_time_s = 0.03\nrest_s = 0.1\n[twin.sensors]\n\
    encoder_counts_per_turn = 1048576\ntorque_noise = [0.05, 0.05, 0.05]\ntorque_ripple = [0, 0, 0]\nripple_per_turn = 6\nseed = 1\n\
    [signal]\ncutoff_hz = 40\ndecimation = 10\n[parameters]\nexclude = ['fv4', 'fc4', 'fv5', 'fc5', 'fv6', 'fc6']\n[estimation]\n\
    methods = ['idim-ls', 'idim-wls', 'idim-iv', 'didim']\n[simulation]\nsign_velocity_scale = 0.02\n[controller]\nlaw = 'pd'\n\
    bandwidth_hz = [10]\ndamping = 1.0\n";

/// The platform of a Delta slides without bearings; every other parameter is found, and the model predicts what it has not seen.
#[test]
fn a_delta_robot_is_identified() {
    let folder = Folder::new();
    folder.write("robots/delta.toml", std::fs::read_to_string(project("robots/delta.toml")).unwrap());
    let file = folder.path().join("delta.toml");
    std::fs::write(&file, DELTA).unwrap();
    let results = Experiment::read(&file, folder.path()).unwrap().run(folder.path(), &mut |_| {}).unwrap();
    for method in [Method::IDIM_LS, Method::IDIM_WLS, Method::IDIM_IV, Method::DIDIM] {
        assert_near_truth(&results, method);
    }
    // Torque noise of 0.05 N m of torques near 5 N m.
    let unseen = results.model.as_ref().and_then(|model| model.unseen.as_ref()).map(|error| error.percent).unwrap();
    assert!(unseen < 1.0, "{unseen}");
}

fn robot() -> Robot {
    Robot::read(&project("robots/five_bar.toml")).unwrap()
}

#[test]
fn a_position_at_which_the_loop_is_open_is_refused_with_its_sample() {
    let text = std::fs::read_to_string(project("robots/five_bar.toml")).unwrap().replace("[0.4, 0, 0]", "[0.3, 0, 0]");
    let robot = Robot::parse(&text, Path::new("five.toml")).unwrap();
    // From 2 s on the left arm turns outwards until the hand is out of reach.
    let position = |k: usize| {
        let t = k as f64 / 500.0;
        [2.0 + 0.4 * (t - 2.0).max(0.0) + 0.1 * (3.0 * t).sin(), 1.1 + 0.1 * (2.0 * t).sin()]
    };
    let q = Series::shaped(2, (0..2500).flat_map(position).collect());
    let recording = Recording::new(500.0, q.clone(), q).named("a");
    let refused = Identification::new(&robot, vec![recording], thetahat::Settings::new(30.0, 10)).err();
    let message = refused.map(|error| error.to_string()).unwrap_or_default();
    for part in ["recording a, sample ", "the loops do not determine joint "] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn an_export_has_the_loops_of_the_robot_or_is_refused() {
    let robot = robot();
    let parameters = completed_a_priori(&robot, None);
    let export = |robot: &Robot, format| export_robot(robot, None, &parameters, format, &[]);
    let mjcf = export(&robot, ExportFormat::Mjcf).unwrap();
    assert!(mjcf.check().unwrap() < 1e-9);
    for part in ["<connect name=\"hand\" site1=", "<motor name=\"left\"", "<key name=\"closed\" qpos=\"2.09439510"] {
        assert!(mjcf.text.contains(part), "{part}: {}", mjcf.text);
    }
    // The file is a robot of its own.
    let back = Robot::parse(&mjcf.text, Path::new("five.xml")).unwrap();
    assert_eq!((back.coordinate_count(), back.link_count()), (2, 4));
    assert!(export(&robot, ExportFormat::Json).unwrap().text.contains("\"loops\""));
    for format in [ExportFormat::Urdf, ExportFormat::Sdf] {
        assert!(matches!(export(&robot, format), Err(ExportError::Loops { .. })), "{format:?}");
    }
}

/// Rods are tendons of a constant length, which are read back as rods.
#[test]
fn an_export_has_the_rods_of_a_delta_and_of_an_ankle() {
    for (file, rods) in [("robots/delta.toml", 3), ("robots/ankle.toml", 2)] {
        let robot = Robot::read(&project(file)).unwrap();
        let mjcf = export_robot(&robot, None, &completed_a_priori(&robot, None), ExportFormat::Mjcf, &[]).unwrap();
        assert!(mjcf.check().unwrap() < 1e-9, "{file}");
        assert_eq!(mjcf.text.matches("<spatial name=\"loop_").count(), rods, "{}", mjcf.text);
        let back = Robot::parse(&mjcf.text, Path::new("back.xml")).unwrap();
        let length = |robot: &Robot, k: usize| {
            let LoopKind::Distance { length } = robot.loops[k].kind else { panic!("{file}: {:?}", robot.loops[k]) };
            length
        };
        assert!((0..rods).all(|k| (length(&back, k) - length(&robot, k)).abs() < 1e-12), "{:?}", back.loops);
    }
}

const DESIGN: &str = "title = 'five bars'\nrobot = 'five_bar.toml'\nduration_s = 3\nsample_rate_hz = 500\n[motion]\nharmonics = 3\n\
    starts = 1\n[limits]\nposition = [[90, 150], [30, 90]]\nvelocity = 250\nacceleration = 2500\ntorque = [20, 20]\n[noise]\n\
    torque = 0.1\n[signal]\ncutoff_hz = 40\ndecimation = 10\n";

/// A designed motion determines the base parameters better than the planned moves of the experiment, second by second.
#[test]
#[ignore = "long, each night"]
fn a_motion_of_a_five_bar_arm_is_designed_within_ranges_that_close() {
    let design = |text: &str| Design::parse(text, &project("robots/design.toml")).map_err(Box::new);
    let results = design(DESIGN).unwrap().run(2).unwrap();
    assert_eq!(results.predicted.len(), 21);
    assert!(results.limits.iter().all(|limit| limit.part <= 1.0), "{:?}", results.limits);
    let open = design(&DESIGN.replace("[[90, 150], [30, 90]]", "[[0, 180], [0, 180]]"));
    let message = open.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(message.contains("ranges within which the loops are closed"), "{message}");
}

#[test]
fn what_takes_trees_refuses_loops() {
    let text = std::fs::read_to_string(project("robots/five_bar.toml")).unwrap();
    let refused = |more: &str| {
        let robot = Robot::parse(&format!("{more}\n{text}"), Path::new("five.toml"));
        robot.err().map(|error: RobotError| error.to_string()).unwrap_or_default()
    };
    assert!(refused("locked = { 'right' = 1 }").contains("loops of links"));
    let term = Robot::parse(&format!("{text}\n[[term]]\nkind = 'load-friction'\n"), Path::new("five.toml"));
    assert!(term.unwrap_err().to_string().contains("not supported yet"));
    let spring = Robot::parse(
        &format!("{text}\n[[term]]\nkind = 'joint-spring'\njoints = ['left elbow']\n"),
        Path::new("five.toml"),
    );
    assert_eq!(spring.unwrap().terms.len(), 2);
}
