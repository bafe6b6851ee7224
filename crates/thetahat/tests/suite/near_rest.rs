//! Samples near rest make no rows: on the twin of the demonstration with a quarter of its noise.

use std::{path::Path, sync::OnceLock};

use thetahat::{
    Experiment, Method, Results,
    experiment::{EstimateRequest, ExperimentError, IdentifiedRobot},
    results::RunResult,
};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The demonstration with a key in `[signal]`, and LS and IV alone.
fn read(key: &str) -> Result<Experiment, ExperimentError> {
    let root = Path::new(ROOT);
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let quarter = |line: &str| match line.split_once("torque_noise = ") {
        Some((start, list)) => {
            let values = list.trim_matches(['[', ']']).split(',').map(|v| 0.25 * v.trim().parse::<f64>().unwrap());
            format!("{start}torque_noise = {:?}", values.collect::<Vec<_>>())
        }
        None => line.to_owned(),
    };
    let text: Vec<String> = read("experiments/demo.toml").lines().map(quarter).collect();
    let text = text.join("\n").replacen("[signal]\n", &format!("[signal]\n{key}\n"), 1);
    let text =
        text.replacen("methods = [\"idim-ls\", \"idim-iv\", \"didim\"]", "methods = [\"idim-ls\", \"idim-iv\"]", 1);
    Experiment::from_texts(&root.join("experiments/demo.toml"), text, read("robots/tx40.toml"))
}

fn run(key: &str) -> Results {
    read(key).unwrap().run(Path::new(ROOT), &mut |_| {}).unwrap()
}

/// The results without samples near rest, as is the default.
fn without_rests() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| run(""))
}

/// The largest error of an estimate in its standard deviations with correlated errors.
fn largest_error(run: &RunResult) -> (f64, String) {
    let error = |p: &thetahat::results::ParameterResult| {
        let deviations = (p.estimate - p.true_value.unwrap()) / p.standard_deviation_robust.unwrap();
        (deviations.abs(), p.name.clone())
    };
    run.parameters.iter().map(error).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

#[test]
#[ignore = "long, each night"]
fn estimates_lose_the_bias_that_the_sign_of_small_velocities_makes() {
    let (with, without) = (run("mask = \"none\""), without_rests());
    for method in [Method::IDIM_LS, Method::IDIM_IV] {
        let [with, without] = [&with, without].map(|r| largest_error(r.run("nominal", method).unwrap()));
        println!("{method}: {with:?} with samples near rest, {without:?} without");
        assert!(without.0 < 4.0 && with.0 > 1.2 * without.0, "{method}: {with:?} {without:?}");
    }
    assert!(with.recordings[0].near_rest.is_none() && with.unmasked_comparison.is_none());
    let near_rest = without.recordings[0].near_rest.as_ref().unwrap();
    assert!(near_rest.left_out_percent.iter().all(|p| (1.0..40.0).contains(p)), "{near_rest:?}");
    let told = without.unmasked_comparison.as_ref().unwrap();
    let ls = with.run("nominal", Method::IDIM_LS).unwrap();
    // But for the ends of the window, which are parts of rows only where samples are left out.
    let of_every_sample = ls.relative_error_percent.unwrap();
    assert!((told.relative_error_percent / of_every_sample - 1.0).abs() < 0.05, "{told:?} {of_every_sample}");
    assert!(told.deviations.abs() > 1.0, "{told:?}");
}

#[test]
#[ignore = "long, each night"]
fn limits_can_be_stated_and_are_checked() {
    let mut experiment = read("mask = { velocity = 0.05, widened_s = 0.01 }").unwrap();
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    let results = experiment.run(Path::new(ROOT), &mut |_| {}).unwrap();
    let near_rest = results.recordings[0].near_rest.as_ref().unwrap();
    assert_eq!((near_rest.velocity.clone(), near_rest.widened_s), (vec![0.05; 6], 0.01));
    let refused = |key: &str| read(key).unwrap_err().to_string();
    let message = refused("mask = { velocity = 0, widened_s = 0.01 }");
    assert!(message.contains("[signal] mask.velocity is 0, expected a finite number above zero"), "{message}");
    let message = refused("mask = { velocity = 0.1, widened_s = -1 }");
    assert!(message.contains("[signal] mask.widened_s is -1, expected from 0 to 10 s"), "{message}");
}

/// The error on all samples is that of a prediction without a mask; the other leaves out the part that is stated.
#[test]
#[ignore = "long, each night"]
fn a_prediction_states_the_samples_that_its_error_leaves_out() {
    let (experiment, path) = (read("").unwrap(), Path::new("results.json"));
    let results = without_rests();
    let robot = IdentifiedRobot::of_results(path, results, &EstimateRequest::default()).unwrap();
    let predict = |robot: &IdentifiedRobot| {
        let recording = experiment.recordings(Path::new(ROOT)).unwrap().remove(0);
        robot.predict(recording).unwrap()
    };
    let masked = predict(&robot);
    let unmasked = predict(&robot.clone().with_filters(read("mask = \"none\"").unwrap().settings.signal));
    assert_eq!(masked.all_samples_error_percent, unmasked.relative_error_percent);
    assert_eq!(masked.joint_all_samples_error_percent, unmasked.joint_relative_error_percent);
    assert_eq!(unmasked.near_rest, [0.0; 6]);
    let left_out = &results.recordings[0].near_rest.as_ref().unwrap().left_out_percent;
    for (part, percent) in masked.near_rest.iter().zip(left_out) {
        assert!((100.0 * part - percent).abs() < 1e-9, "{part} {percent}");
    }
    assert!(masked.relative_error_percent < masked.all_samples_error_percent);
}
