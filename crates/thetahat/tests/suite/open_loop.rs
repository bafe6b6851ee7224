//! CLOE in an open loop: the recorded torques act from the state of the first samples on.

use std::f64::consts::TAU;

use super::followed_twin::{RATE_HZ, record_with_noise, robot};
use thetahat::{
    Identification, Method, Recording, Series, Settings, identification::Status, preparation::LoopParameter,
};

/// Samples that are left out, so that the recording begins in motion.
const BEFORE: usize = 250;
/// Largest relative error of an estimate whose interval is narrow: the parabola of the start errs by its jerk, 1e-3 rad/s.
const CLOSE: f64 = 0.02;

/// 3 s of a motion that begins at 0.5 s.
fn begun() -> Recording {
    let of = |t: f64, j: f64| [0.6, 1.4].map(|h| 0.4 * (TAU * 0.5 * h * t + h + j).sin() / h).iter().sum();
    let time = (0..(3.5 * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    let reference = Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect());
    // Noise of the torques would act on the simulated robot.
    let whole = record_with_noise(&reference, [1e-5, 0.0]);
    let rest = |series: Series| series.window(BEFORE..series.len());
    Recording { position: rest(whole.position), torque: whole.torque.map(rest), ..whole }
}

fn settings(methods: &[Method]) -> Settings {
    let mut settings = Settings::new(40.0, 1).with_methods(methods.iter().copied());
    settings.controller = Some(toml::from_str("law = 'open-loop'").unwrap());
    settings.simulation.sign_velocity_scale = 0.05;
    settings
}

#[test]
fn recorded_torques_alone_identify_a_robot_that_is_in_motion() {
    let results = Identification::new(&robot(), vec![begun()], settings(&[Method::CLOE])).unwrap().run().unwrap();
    let run = results.run("nominal", Method::CLOE).unwrap();
    assert_eq!(run.status, Status::Converged, "{:?}", run.reason);
    for p in &run.parameters {
        println!("{} {} +- {:?}, true {:?}", p.name, p.estimate, p.standard_deviation, p.true_value);
    }
    let narrow = || {
        run.parameters.iter().filter(|p| p.standard_deviation.is_some_and(|sd| sd < 0.25 * CLOSE * p.estimate.abs()))
    };
    assert!(narrow().count() >= 3);
    assert!(narrow().all(|p| (p.estimate / p.true_value.unwrap() - 1.0).abs() < CLOSE));
    println!("{:?}", run.notes);
    assert_eq!(results.recordings[0].reference.as_ref().unwrap().origin, "motion");
}

#[test]
fn what_an_open_loop_does_not_have_is_refused() {
    let refused = |recording: Recording, settings: Settings| {
        Identification::new(&robot(), vec![recording], settings).and_then(|i| i.run()).unwrap_err().to_string()
    };
    let without_torque = Recording { torque: None, ..begun() };
    let message = refused(without_torque, settings(&[Method::CLOE]));
    assert!(message.contains("torque is missing, expected recorded, since it acts"), "{message}");
    let message = refused(begun(), settings(&[Method::IDIM_LS, Method::DIDIM]));
    assert!(message.contains("methods is didim, expected idim-ls, idim-wls or cloe"), "{message}");
    let mut with_gain = settings(&[Method::CLOE]);
    with_gain.estimation.loop_parameters = vec![LoopParameter::PositionGain];
    let message = refused(begun(), with_gain);
    assert!(message.contains("loop_parameters is position-gain, expected no position or velocity gain"), "{message}");
}
