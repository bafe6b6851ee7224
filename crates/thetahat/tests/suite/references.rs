//! References that are not recorded, or recorded wrongly, and what IV makes of them.

use std::{f64::consts::TAU, path::Path};

use super::followed_twin::{RATE_HZ, controller, record, robot};
use thetahat::{
    Experiment, Identification, Method, Recording, Results, Series, Settings,
    checks::Code,
    identification::Status,
    preparation::ReferenceCorrection,
    trajectory::{Move, Moves},
};
use thetahat_estimation::{signal::delayed, trajectory::TimeLaw};
use thetahat_testing::Folder;

const BASE_HZ: f64 = 0.4;

fn settings() -> Settings {
    let mut settings = Settings::new(20.0, 10).with_methods([Method::IDIM_LS, Method::IDIM_IV]);
    settings.controller = Some(controller());
    settings.simulation.sign_velocity_scale = 0.05;
    settings
}

/// A wave of three harmonics for each joint.
fn wave(seconds: f64) -> Series {
    let of = |t: f64, j: f64| [1.0, 2.0, 3.0].map(|h| 0.5 * (TAU * BASE_HZ * h * t + h * h + j).sin() / h).iter().sum();
    let time = (0..(seconds * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect())
}

fn identify(recording: Recording) -> Results {
    Identification::new(&robot(), vec![recording], settings()).unwrap().run().unwrap()
}

/// A planned motion in a file of its own has not the samples of a recording that began before it: torques are fitted without it,
/// and positions are not.
#[test]
fn a_planned_motion_of_another_length_is_left_out() {
    let folder = Folder::new();
    let position = |k: usize| (TAU * 0.5 * k as f64 / RATE_HZ).sin();
    let log = |k: usize| format!("{},{},{}\n", k as f64 / RATE_HZ, position(k), 2.0 * position(k + 5));
    folder.write("log.csv", format!("t,q,tau\n{}", (0..4000).map(log).collect::<String>()));
    folder
        .write("planned.csv", format!("q\n{}", (100..3900).map(|k| format!("{}\n", position(k))).collect::<String>()));
    let read = |methods: &str| {
        let text = format!(
            "title = 't'\nrobot = 'joint.toml'\n[recording]\ntime = {{ file = 'log.csv', columns = ['t'], unit = 's' }}\nposition = \
             {{ file = 'log.csv', columns = ['q'], unit = 'rad' }}\ntorque = {{ file = 'log.csv', columns = ['tau'], unit = 'N m' }}\n\
             reference = {{ file = 'planned.csv', columns = ['q'], unit = 'rad' }}\n[signal]\ncutoff_hz = 20\ndecimation = 10\n\
             [controller]\nlaw = 'pd'\nbandwidth_hz = 10\n[estimation]\nmethods = ['{methods}']\n"
        );
        let robot = "name = 'joint'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n".to_owned();
        Experiment::from_texts(Path::new("t.toml"), text, robot).unwrap().recordings(folder.path())
    };
    let recording = read("idim-iv").unwrap().remove(0);
    assert!(recording.reference.is_none());
    assert!(recording.notes.iter().any(|note| note.contains("3800 samples")), "{:?}", recording.notes);
    let refused = read("cloe").unwrap_err().to_string();
    assert!(refused.contains("3800") && refused.contains("4000"), "{refused}");
}

/// The largest error of IV in its deviations.
fn largest_error(results: &Results) -> f64 {
    let run = results.run("nominal", Method::IDIM_IV).unwrap();
    assert_eq!(run.status, Status::Converged);
    let error = |p: &thetahat::results::ParameterResult| {
        (p.estimate - p.true_value.unwrap()).abs() / p.standard_deviation_robust.unwrap()
    };
    run.parameters.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn iv_follows_a_periodic_motion_as_a_fourier_series() {
    let results = identify(record(&wave(12.0), 2e-4));
    let reference = results.recordings[0].reference.as_ref().unwrap();
    let periodic = reference.periodic.unwrap();
    assert_eq!(reference.origin, "periodic");
    assert!((periodic.base_frequency_hz / BASE_HZ - 1.0).abs() < 1e-3, "{periodic:?}");
    assert!(periodic.harmonics >= 3 && periodic.harmonics <= 12, "{periodic:?}");
    assert!(largest_error(&results) < 4.0, "{}", largest_error(&results));
    let run = results.run("nominal", Method::IDIM_IV).unwrap();
    assert!(run.cross_validation_relative_error_percent.is_some());
}

#[test]
fn less_than_two_periods_are_the_motion_itself() {
    let results = identify(record(&wave(1.6 / BASE_HZ), 2e-4));
    let reference = results.recordings[0].reference.as_ref().unwrap();
    assert_eq!((reference.origin.as_str(), reference.periodic), ("filtered", None));
    let cutoff_hz = reference.smoothing_cutoff_hz.unwrap();
    assert!((2.0..15.0).contains(&cutoff_hz), "{cutoff_hz}");
    let run = results.run("nominal", Method::IDIM_IV).unwrap();
    assert!(run.notes.iter().any(|n| n.contains("smoothed with a cut-off of")), "{:?}", run.notes);
    assert!(run.cross_validation_relative_error_percent.is_some());
}

fn mismatches(results: &Results) -> Vec<&str> {
    let findings = results.findings.iter().flat_map(|f| &f.findings);
    findings.filter(|f| f.code == Code::ReferenceMismatch).map(|f| f.remedy.as_str()).collect()
}

/// The correction in the remedy, as a user would paste it.
fn pasted(remedy: &str) -> ReferenceCorrection {
    #[derive(serde::Deserialize)]
    struct Table {
        reference_correction: ReferenceCorrection,
    }
    let start = remedy.find("reference_correction = ").unwrap();
    let end = start + remedy[start..].find('}').unwrap() + 1;
    toml::from_str::<Table>(&remedy[start..end]).unwrap().reference_correction
}

#[test]
fn a_wrong_reference_is_right_after_pasting_the_remedy() {
    let reference = wave(12.0);
    let right = record(&reference, 1e-5).with_reference(reference.clone());
    let late = delayed(&reference, &[17.0, 17.0]);
    let scaled = Series::shaped(2, reference.values().chunks(2).flat_map(|r| [r[0] / 1.1, r[1]]).collect());
    let moved = Series::shaped(2, reference.values().chunks(2).flat_map(|r| [r[0], r[1] - 0.2]).collect());
    let expected = identify(right.clone());
    assert_eq!(mismatches(&expected), Vec::<&str>::new());
    for wrong in [late, scaled, moved] {
        let wrong = right.clone().with_reference(wrong);
        let results = identify(wrong.clone());
        let remedies = mismatches(&results);
        assert!(!remedies.is_empty());
        let corrected = identify(wrong.with_corrected_reference(&pasted(remedies[0])));
        assert_eq!(mismatches(&corrected), Vec::<&str>::new(), "{}", remedies[0]);
        let [a, b] = [&corrected, &expected].map(|r| r.run("nominal", Method::IDIM_IV).unwrap());
        for (a, b) in a.parameters.iter().zip(&b.parameters) {
            let difference = (a.estimate - b.estimate).abs() / b.standard_deviation.unwrap();
            // The correction holds the tracking of the loop as well, a fraction of a sample here.
            assert!(difference < 0.2, "{}: {difference}, {}", a.name, remedies[0]);
        }
    }
}

const ONE_MOVE: &str = r#"
title = "one move"
robot = "r.toml"
[twin]
sample_rate_hz = 500
unlisted = "a-priori"
points = [[0, 0], [90, -120]]
max_velocity = [100, 150]
acceleration_time_s = 0.3
smoothing_time_s = 0.05
rest_s = 0.2
[twin.sensors]
encoder_counts_per_turn = 65536
torque_noise = [0.05, 0.05]
torque_ripple = [0, 0]
ripple_per_turn = 1
seed = 1
[signal]
cutoff_hz = 30
decimation = 5
[parameters]
estimate = ["zz1r", "fv1", "fc1", "mx1r"]
[estimation]
methods = ["idim-ls"]
[controller]
law = "pd"
bandwidth_hz = [10]
"#;

#[test]
fn one_move_is_validated_by_its_parts() {
    let robot = std::fs::read_to_string(thetahat_testing::root().join("robots/two_joint.toml")).unwrap();
    let experiment = Experiment::from_texts(Path::new("one_move.toml"), ONE_MOVE.to_owned(), robot).unwrap();
    let results = experiment.run(Path::new("."), &mut |_| {}).unwrap();
    assert_eq!(results.recordings[0].reference.as_ref().unwrap().moves, Some(1));
    let run = &results.runs[0];
    assert!(run.cross_validation_relative_error_percent.is_some(), "{:?}", run.reason);
    assert!(run.influence.as_ref().unwrap().part.starts_with("part "), "{:?}", run.influence);
}

/// A record that is held back was said to be "off the reconstructed moves": it need not be made of moves, and nothing of the
/// estimate follows it.
#[test]
fn a_motion_that_is_held_back_need_not_be_made_of_moves() {
    let law = |start_s| TimeLaw { start_s, t1_s: 0.5, t2_s: 0.2, t3_s: 0.05 };
    let to = |(k, end): (usize, [f64; 2])| Move { law: law(0.5 + k as f64), end: end.to_vec() };
    let ends = [[0.8, -0.6], [-0.5, 0.9], [0.4, 0.2], [-0.7, -0.8], [0.6, 0.5], [0.0, 0.0]];
    let moves = Moves::new(vec![0.0; 2], ends.into_iter().enumerate().map(to).collect()).unwrap();
    let along_moves = record(&moves.sample(RATE_HZ, (7.0 * RATE_HZ) as usize).q, 2e-4);
    let sines = record(&wave(6.0), 2e-4);
    let identification = Identification::new(&robot(), vec![along_moves], settings()).unwrap();
    let results = identification.with_validation(vec![sines]).unwrap().run().unwrap();
    assert_eq!(results.recordings[0].reference.as_ref().unwrap().origin, "reconstructed");
    assert!(results.findings.iter().any(|f| f.held_back), "{:?}", results.findings);
    assert!(mismatches(&results).is_empty(), "{:?}", mismatches(&results));
}
