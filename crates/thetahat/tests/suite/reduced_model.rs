//! The model from the triangular factors of a reduction, against the one from all samples.

use std::{path::Path, sync::OnceLock};

use thetahat::{
    Experiment, Method, Results,
    experiment::{EstimateRequest, IdentifiedRobot},
    reduction::{ReduceOptions, Reduction},
    results::{ModelResult, ReasonCode, VerdictReason},
};

/// Between values of the model, relative to the value, or to half of its interval if that is larger: its solver stops where the objective is
/// at most 1e-10 of itself too large; 1.1e-6 were found.
const EQUAL: f64 = 1e-5;
/// Between errors of fits that are compared, whose solver stops at 1e-7.
const EQUAL_COMPARED: f64 = 1e-5;
/// Between the velocities at which friction changes its sign, and between the errors: factors have columns between those that are tried
/// first as sums of these.
const EQUAL_TRANSITION: f64 = 0.05;
const EQUAL_ERROR: f64 = 0.01;

fn experiment() -> Experiment {
    with_least_squares(Experiment::demo().unwrap())
}

fn experiment_with_transition() -> Experiment {
    let read = |file: &str| std::fs::read_to_string(thetahat_testing::root().join(file)).unwrap();
    let text = format!("{}\n[model]\nfriction_transition = 0.005\n", read("experiments/demo.toml"));
    let path = Path::new("experiments/demo.toml");
    with_least_squares(Experiment::from_texts(path, text, read("robots/tx40.toml")).unwrap())
}

fn with_least_squares(mut experiment: Experiment) -> Experiment {
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    experiment.settings.estimation.weighting.clear();
    experiment.settings.cases.clear();
    experiment
}

fn identified() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| experiment().run(Path::new(""), &mut |_| {}).unwrap())
}

/// The rows alone, in pieces of so many samples.
fn reduced(piece_samples: usize) -> Reduction {
    let options = ReduceOptions { threads: 2, piece_samples, rows_only: true };
    experiment().reduce(Path::new(""), options, &mut |_| {}).unwrap()
}

fn solved() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| reduced(3000).solve().unwrap().results)
}

fn model(results: &Results) -> &ModelResult {
    results.model.as_ref().unwrap_or_else(|| panic!("{:?}", results.no_model))
}

fn assert_same(found: &ModelResult, expected: &ModelResult) {
    assert_eq!(
        (found.friction_transition, found.belief_weight),
        (expected.friction_transition, expected.belief_weight)
    );
    for (f, e) in found.parameters.iter().zip(&expected.parameters) {
        let size = e.interval_95.map_or(e.value.abs(), |[low, high]| e.value.abs().max(0.5 * (high - low)));
        assert!((f.value - e.value).abs() < EQUAL * size, "{}: {} {}", e.name, f.value, e.value);
        assert!((f.decided_percent - e.decided_percent).abs() < 0.01, "{}", e.name);
    }
    let errors = |model: &ModelResult| {
        let of = [&model.fit, model.unseen.as_ref().unwrap()].map(|error| {
            let joints = error.joints.iter().flat_map(|j| [j.percent, j.moving_percent, j.near_rest_percent]);
            [Some(error.percent)].into_iter().chain(joints).collect::<Vec<_>>()
        });
        of.concat()
    };
    for (f, e) in errors(found).into_iter().zip(errors(expected)) {
        let (f, e) = (f.unwrap(), e.unwrap());
        assert!((f / e - 1.0).abs() < EQUAL, "{f} % {e} %");
    }
}

#[test]
fn the_model_of_factors_is_nearly_that_of_all_samples() {
    let (found, expected) = (model(solved()), model(identified()));
    assert!((found.friction_transition / expected.friction_transition - 1.0).abs() < EQUAL_TRANSITION, "{found:?}");
    let percent = |model: &ModelResult| model.unseen.as_ref().unwrap().percent;
    assert!((percent(found) / percent(expected) - 1.0).abs() < EQUAL_ERROR, "{} {}", percent(found), percent(expected));
    for (f, e) in found.parameters.iter().zip(&expected.parameters).filter(|(_, e)| e.is_decided()) {
        let [low, high] = e.interval_95.unwrap();
        assert!(
            (f.value - e.value).abs() < 0.1 * (high - low),
            "{}: {} {} of {low} to {high}",
            e.name,
            f.value,
            e.value
        );
    }
    let first = expected.candidates.iter().take_while(|c| c.friction_transition != expected.friction_transition);
    for (f, e) in found.candidates.iter().zip(first) {
        assert_eq!((f.belief_weight, f.friction_transition), (e.belief_weight, e.friction_transition));
        assert!((f.unseen_square / e.unseen_square - 1.0).abs() < EQUAL_COMPARED, "{f:?} {e:?}");
    }
}

#[test]
#[ignore = "long, each night"]
fn the_model_of_factors_with_a_stated_transition_is_that_of_all_samples() {
    let experiment = experiment_with_transition();
    let identified = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    let options = ReduceOptions { threads: 2, piece_samples: 3000, rows_only: true };
    let solved = experiment.reduce(Path::new(""), options, &mut |_| {}).unwrap().solve().unwrap().results;
    assert_same(model(&solved), model(&identified));
}

/// Factors of many small pieces are those of few, and those that a file holds.
#[test]
#[ignore = "long, each night"]
fn pieces_and_the_file_change_nothing() {
    let reduction = reduced(997);
    assert_same(model(&reduction.solve().unwrap().results), model(solved()));
    let bytes = reduction.to_bytes().unwrap();
    assert_eq!(Reduction::from_bytes(&bytes, Path::new("a.reduction")).unwrap(), reduction);
}

/// The verdict is that of the identification but for causes, which are listed as not examined.
#[test]
fn what_only_samples_show_is_listed() {
    let of = |results: &Results| {
        let is_examined = |r: &&VerdictReason| r.code != ReasonCode::Cause;
        results.verdict_reasons.iter().filter(is_examined).map(|r| (r.code, r.verdict)).collect::<Vec<_>>()
    };
    assert_eq!(of(solved()), of(identified()));
    assert!(solved().not_examined.iter().any(|n| n.code == ReasonCode::Cause), "{:?}", solved().not_examined);
    assert!(model(solved()).causes.is_empty() && model(solved()).smallest_shown.is_empty());
}

/// Intervals are from stretches of time: those of decided values hold the truth as often as they say.
#[test]
#[ignore = "long, each night"]
fn intervals_hold_the_truth() {
    let decided = || model(solved()).parameters.iter().filter(|p| p.is_decided());
    let holds = |interval: [f64; 2], truth: f64| interval[0] <= truth && truth <= interval[1];
    let held = decided().filter(|p| holds(p.interval_95.unwrap(), p.true_value.unwrap())).count();
    let count = decided().count();
    assert!(count >= 25 && held as f64 >= 0.9 * count as f64, "{held} of {count}");
}

#[test]
fn predictions_and_exports_take_it() {
    let request = EstimateRequest { untrusted: true, ..EstimateRequest::default() };
    let robot = IdentifiedRobot::of_results(Path::new("results.json"), solved(), &request).unwrap();
    let standard: Vec<f64> = model(solved()).standard.iter().map(|p| p.value).collect();
    assert_eq!(robot.theta(), standard);
}
