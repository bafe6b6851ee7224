//! Twelve servos that log positions and commands and no torques: `experiments/quadruped_positions.toml`.

use std::path::Path;

use super::torque_terms::{RATE_HZ, SCALE, controller, record_in_loop, robot, settings};
use thetahat::{
    ControllerDescription, Experiment, Identification, Method, Recording, Results, Settings,
    checks::Code,
    experiment::EstimateRequest,
    export::{ExportError, ExportFormat, IdentifiedModel},
    identification::Status,
    preparation::{LoopParameter, NamedChoice, ParameterChoice},
    results::{RunResult, Verdict},
};
use thetahat_report::report;
use thetahat_testing::root;

/// Of the experiment's controller, N m/rad.
const POSITION_GAIN: f64 = 60.0;

fn all(change: impl Fn(&mut Experiment)) -> Results {
    let path = root().join("experiments/quadruped_positions.toml");
    let mut experiment = Experiment::read(&path, path.parent().unwrap()).unwrap();
    change(&mut experiment);
    experiment.run(path.parent().unwrap(), &mut |_| {}).unwrap()
}

fn cloe(change: impl Fn(&mut Experiment)) -> RunResult {
    all(change).run("nominal", Method::CLOE).unwrap().clone()
}

#[test]
fn inertias_frictions_gain_and_delay_are_found_with_intervals_that_hold_the_truth() {
    let results = all(|_| {});
    for name in report::file_names() {
        let content = report::render(name, &results, None).unwrap();
        assert!(content.is_some_and(|content| !content.is_empty()), "{name}");
    }
    let run = results.run("nominal", Method::CLOE).unwrap();
    assert_eq!(run.status, Status::Converged, "{:?}", run.reason);
    let holds = |interval: [f64; 2], truth: f64| interval[0] <= truth && truth <= interval[1];
    let [gain, delay] = &run.loop_parameters[..] else { panic!("{:?}", run.loop_parameters) };
    assert!(holds(gain.interval_95.unwrap(), 1.0) && gain.standard_deviation < 0.1, "{gain:?}");
    assert!(holds(delay.interval_95.unwrap(), 0.0) && delay.standard_deviation < 1e-4, "{delay:?}");
    let inside = run.parameters.iter().filter(|p| holds(p.interval_95.unwrap(), p.true_value.unwrap())).count();
    println!("{inside} of {} intervals hold the truth", run.parameters.len());
    // 95 % of 108, less three deviations.
    assert!(inside as f64 >= 0.95 * 108.0 - 3.0 * (108.0_f64 * 0.95 * 0.05).sqrt());
    has_its_servos(&results, gain.estimate);
    let of_positions = |note: &String| note.starts_with("the simulated positions are");
    assert!(run.notes.iter().all(of_positions), "{:?}", run.notes);
}

/// A new MJCF has a servo for each joint, with the gains of the experiment times the factor that was found.
fn has_its_servos(results: &Results, factor: f64) {
    let request = EstimateRequest { method: Some(Method::CLOE), untrusted: true, ..EstimateRequest::default() };
    let model = IdentifiedModel::of_results(Path::new("results.json"), results, &request).unwrap();
    let text = model.export(ExportFormat::Mjcf).unwrap().text;
    assert_eq!(text.matches("<general ").count(), 12, "{text}");
    let number = |text: &str, key: &str| {
        let value = text.split_once(key).unwrap().1.split(['"', ' ']).next().unwrap();
        value.parse::<f64>().unwrap()
    };
    let kp = number(&text, "gainprm=\"");
    assert!((kp / (POSITION_GAIN * factor) - 1.0).abs() < 1e-9, "{kp}");
    let bias = text.split_once("biasprm=\"").unwrap().1.split('"').next().unwrap();
    assert_eq!(bias.split(' ').nth(1).unwrap().parse::<f64>().unwrap(), -kp);
    assert!(text.contains(" delay=\"0.0"), "{text}");
    has_all_drives(&model, factor);
    assert!(!model.export(ExportFormat::Urdf).unwrap().text.contains("actuator"));
}

/// PACE's vector has the twelve joints, Isaac Lab their gains, and BAM refuses more than one.
fn has_all_drives(model: &IdentifiedModel, factor: f64) {
    let file = |format| serde_json::from_str::<serde_json::Value>(&model.export(format).unwrap().text).unwrap();
    let pace = file(ExportFormat::Pace);
    assert_eq!(pace["params"].as_array().unwrap().len(), 4 * 12 + 1);
    assert_eq!(pace["params"][4 * 12], 1.0, "a delay of one step");
    let isaac = file(ExportFormat::Isaac);
    let gains = isaac["settings"]["stiffness"].as_object().unwrap();
    assert_eq!(gains.len(), 12);
    let is_found = |gain: &serde_json::Value| (gain.as_f64().unwrap() / (POSITION_GAIN * factor) - 1.0).abs() < 1e-9;
    assert!(gains.values().all(is_found), "{gains:?}");
    let refused = model.export(ExportFormat::Bam).unwrap_err();
    assert!(matches!(refused, ExportError::SeveralActuators { joints: 12, .. }), "{refused}");
}

/// With both gains free all torques may grow alike: what cannot be told apart is named.
#[test]
#[ignore = "long, each night"]
fn gains_and_inertias_that_grow_alike_are_named() {
    let run = cloe(|experiment| {
        experiment.settings.estimation.loop_parameters = vec![LoopParameter::PositionGain, LoopParameter::VelocityGain];
    });
    assert_eq!(run.status, Status::NotIdentifiable, "{:?}", run.reason);
    let reason = run.reason.unwrap();
    assert!(reason.contains("separates only 109 of 110 parameters"), "{reason}");
}

/// What makes the links possible bodies.
const BODIES: &str = "m1 = 4.0\nxx1 = 0.2\nyy1 = 1.1\nxx2 = 0.1\nyy2 = 0.35\n";

/// Drives by positions, with the links as they are described.
fn of_drives() -> Settings {
    let mut settings = settings(&[Method::CLOE]);
    settings.parameters.estimate = ParameterChoice::Named(NamedChoice::Drives);
    settings
}

/// A recording without what positions alone do not have.
fn without_torques(recording: Recording) -> Recording {
    Recording { truth: None, torque: None, ..recording }
}

#[test]
fn gains_that_are_a_fifth_too_low_are_named_with_their_factor() {
    let robot = robot("", BODIES);
    let with_gains = |factor: f64| -> ControllerDescription {
        let gains = [400.0, 120.0, 30.0, 8.0].map(|gain| factor * gain);
        let text = format!("law = 'pd'\nposition_gain = {:?}\nvelocity_gain = {:?}", &gains[..2], &gains[2..]);
        toml::from_str(&text).unwrap()
    };
    let recording = without_torques(record_in_loop(&robot, &with_gains(1.0), 12.0, None));
    let found = |factor: f64| {
        let settings = of_drives().with_controller(with_gains(factor));
        let results = Identification::new(&robot, vec![recording.clone()], settings).unwrap().run().unwrap();
        let named = results.findings.iter().flat_map(|r| &r.findings).find(|f| f.code == Code::ControllerMismatch);
        (results.verdict, named.cloned())
    };
    let (right, none) = found(1.0);
    assert!(right == Some(Verdict::Care) && none.is_none(), "{none:?}");
    let (verdict, named) = found(0.8);
    let named = named.unwrap();
    assert!(named.message.starts_with("gains of the controller times 1.25 for all motors"), "{named:?}");
    assert_eq!(verdict, Some(Verdict::DoNotUse));
}

#[test]
#[ignore = "long, each night"]
fn late_commands_and_the_sign_of_friction_are_found_by_positions_alone() {
    const LATE: usize = 3;
    let robot = robot("", BODIES);
    let recording = record_in_loop(&robot, &controller(), 12.0, None);
    let (samples, reference) = (recording.position.len(), recording.reference.clone().unwrap());
    let early = reference.window(LATE..samples);
    let position = recording.position.window(0..samples - LATE);
    let torque = recording.torque.clone().unwrap().window(0..samples - LATE);
    let recording = without_torques(Recording::new(RATE_HZ, position, torque).with_reference(early));
    let mut settings = of_drives();
    settings.simulation.sign_velocity_scale = 4.0 * SCALE;
    let results = Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap();
    let run = results.run("nominal", Method::CLOE).unwrap();
    let [delay, transition] = &run.loop_parameters[..] else { panic!("{:?}", run.notes) };
    let viscous = run.parameter("fv1").unwrap().interval_95;
    let late_s = LATE as f64 / RATE_HZ;
    for (interval, truth) in [(delay.interval_95, late_s), (transition.interval_95, SCALE), (viscous, 1.1)] {
        let [low, high] = interval.unwrap();
        assert!(low < truth && truth < high, "{truth}: {interval:?}");
    }
    assert!((delay.estimate / late_s - 1.0).abs() < 0.05, "{delay:?}");
}

#[test]
#[ignore = "long, each night"]
fn a_law_is_recommended_by_positions_alone() {
    let term = "[[term]]\nkind = \"load-friction\"\njoints = [\"shoulder\"]\n";
    let with_load = robot(term, &format!("fl1 = 0.3\n{BODIES}"));
    let recording = record_in_loop(&with_load, &controller(), 12.0, None);
    let recording = without_torques(recording);
    let mut settings = of_drives();
    settings.estimation.compare_terms = true;
    let described = robot("", BODIES);
    let results = Identification::new(&described, vec![recording], settings).unwrap().run().unwrap();
    let comparison = results.term_comparison.as_ref().unwrap();
    let recommended =
        comparison.joints.iter().flat_map(|j| j.laws.iter().filter(|l| l.recommended).map(|l| (j.joint.as_str(), l)));
    let recommended: Vec<_> = recommended.collect();
    let [("shoulder", law)] = recommended[..] else { panic!("{recommended:?}") };
    assert_eq!((law.law.as_str(), law.parameters.as_slice()), ("load-friction", ["fl1".to_owned()].as_slice()));
    assert!((law.estimates[0] - 0.3).abs() < 0.02, "{law:?}");
}
