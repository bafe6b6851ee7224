//! `[parameters] physical = true` on twins of a two-joint arm: consistent estimates, what is fixed and known, findings.

use std::path::Path;

use thetahat::{
    Experiment, Method, Results, experiment::ExperimentError, preparation::PreparationError, results::RunResult,
};
use thetahat_report::results::{Code, ConsistentEstimate, PhysicalResult, Severity};

/// As `robots/two_joint.toml`, which lies outside the package.
const ROBOT: &str = r#"
name = "two-joint arm"
friction = "symmetric"
[[joint]]
name = "shoulder"
kind = "revolute"
alpha_deg = 90
[[joint]]
name = "elbow"
parent = "shoulder"
kind = "revolute"
a_m = 0.4
[transmission]
matrix = [[50, 0], [0, 50]]
[parameters]
m1 = 4
mx1 = 0.8
yy1 = 0.24
zz1 = 0.24
xx1 = 0.02
ia1 = 0.3
fv1 = 2
fc1 = 0.8
m2 = 2
mx2 = 0.3
yy2 = 0.07
zz2 = 0.07
xx2 = 0.01
ia2 = 0.1
fv2 = 1
fc2 = 0.4
"#;

fn experiment(true_parameters: &str, parameters: &str, methods: &str) -> Result<Experiment, ExperimentError> {
    let text = format!(
        r#"
title = "twin"
robot = "two_joint.toml"
[twin]
sample_rate_hz = 1000
points = [[0, 0], [60, -70], [-40, 50], [80, 20], [-20, -80], [30, 60], [0, 0]]
max_velocity = [120, 150]
acceleration_time_s = 0.15
smoothing_time_s = 0.05
rest_s = 0.2
unlisted = "a-priori"
parameters = {{ {true_parameters} }}
sensors = {{ encoder_counts_per_turn = 100000, torque_noise = [0.3, 0.15], torque_ripple = [0, 0], ripple_per_turn = 6, seed = 3 }}
[signal]
cutoff_hz = 25
decimation = 20
[parameters]
{parameters}
[estimation]
methods = [{methods}]
[controller]
law = "pd"
bandwidth_hz = [10]
velocity_feed_forward = 1.0
acceleration_feed_forward = 1.0
"#
    );
    Experiment::from_texts(Path::new("twin.toml"), text, ROBOT.to_owned())
}

fn run(true_parameters: &str, parameters: &str, methods: &str) -> Results {
    experiment(true_parameters, parameters, methods).unwrap().run(Path::new(""), &mut |_| {}).unwrap()
}

fn physical(run: &RunResult) -> &PhysicalResult {
    run.physical.as_ref().unwrap()
}

fn estimate(run: &RunResult) -> &ConsistentEstimate {
    physical(run).estimate.as_ref().unwrap_or_else(|| panic!("{:?}", physical(run).reason))
}

fn standard(e: &ConsistentEstimate, name: &str) -> f64 {
    e.standard.iter().find(|p| p.name == name).unwrap().estimate
}

#[test]
fn every_method_gets_a_consistent_estimate_that_the_twin_does_not_reject() {
    let results = run("", "physical = true", "'idim-ls', 'idim-wls', 'idim-iv', 'didim'");
    assert_eq!(results.runs.len(), 4);
    for run in &results.runs {
        let (e, method) = (estimate(run), run.method);
        assert!(e.converged && e.smallest_eigenvalue > 0.0, "{method}");
        assert_ne!(physical(run).rejects(), Some(true), "{method}: {:?}", e.test);
        // IV does not minimise its residual, the others do.
        let least = if method == Method::IDIM_IV { 0.99 } else { 1.0 - 1e-9 };
        assert!(e.squared_residual > least * e.squared_residual_free, "{method}");
        assert!(e.squared_residual < 1.05 * e.squared_residual_free, "{method}");
        assert_eq!(e.parameters.len(), run.parameters.len());
        for p in &e.parameters {
            let [low, high] = p.interval_95.unwrap();
            assert!((low..=high).contains(&p.estimate), "{method} {}", p.name);
        }
        for name in ["ia1", "ia2", "fv1", "fv2", "fc1", "fc2", "m1", "m2"] {
            assert!(standard(e, name) > 0.0, "{method} {name}");
        }
    }
}

#[test]
fn without_the_key_nothing_is_estimated_and_the_free_estimates_are_the_same() {
    let (with, without) = (run("", "physical = true", "'idim-ls'"), run("", "", "'idim-ls'"));
    assert!(physical(&without.runs[0]).estimate.is_none());
    let values = |r: &Results| r.runs[0].parameters.iter().map(|p| p.estimate).collect::<Vec<_>>();
    assert_eq!(values(&with), values(&without));
    let json = serde_json::to_value(&without.runs[0]).unwrap();
    assert!(json["physical"]["consistent"].is_boolean() && json["physical"]["inconsistent"].is_array());
    assert!(json["physical"]["smallest_eigenvalue"].is_number() && json["physical"].get("estimate").is_none());
}

#[test]
fn what_is_fixed_and_known_holds() {
    let known = "physical = true\nfix = { m2 = 1.7, fv1 = 2.0 }\n[[parameters.known]]\nkind = 'total-mass'\nkg = [5, 5.5]\n\
                 [[parameters.known]]\nkind = 'mirror-plane'\nlink = 1\nnormal = 'z'\n\
                 [[parameters.known]]\nkind = 'centre-of-mass'\nlink = 1\nlower_m = [0.1, -0.02, 0]\nupper_m = [0.3, 0.02, 0]\n";
    let results = run("", known, "'idim-ls', 'idim-iv'");
    for run in &results.runs {
        let e = estimate(run);
        assert_eq!((standard(e, "m2"), standard(e, "fv1"), standard(e, "xz1")), (1.7, 2.0, 0.0));
        let total = standard(e, "m1") + standard(e, "m2");
        assert!((5.0..5.5).contains(&total), "{total}");
        let x = standard(e, "mx1") / standard(e, "m1");
        assert!((0.1..0.3).contains(&x), "{x}");
        assert_eq!(e.known.len(), 5);
        assert!(e.known.contains(&"m2 = 1.7 (fixed)".to_owned()), "{:?}", e.known);
    }
}

#[test]
fn friction_that_drives_is_found_and_rejected() {
    let results = run("fv2 = -0.8", "physical = true", "'idim-ls'");
    let run = &results.runs[0];
    let problem = physical(run).findings.iter().find(|f| f.severity == Severity::Problem).unwrap();
    assert_eq!(
        (problem.code, problem.joint, &problem.parameters[..]),
        (Code::NotPhysical, Some(2), &["fv2".to_owned()][..])
    );
    assert!(
        problem.message.contains("fv2 is negative") && problem.remedy.contains("sign of the torque"),
        "{problem:?}"
    );
    assert!(!physical(run).consistent && physical(run).inconsistent.contains(&"fv2".to_owned()));
    assert!(physical(run).deviations.unwrap() > 10.0);
    assert_eq!(physical(run).rejects(), Some(true));
    let e = estimate(run);
    let fv2 = e.parameters.iter().find(|p| p.name == "fv2").unwrap();
    assert!(fv2.estimate >= 0.0 && fv2.estimate < 1e-3 && fv2.reference_value.unwrap() < -0.7, "{fv2:?}");
    assert!(e.at_boundary.contains(&"fv2".to_owned()));
    assert!(e.squared_residual > 1.1 * e.squared_residual_free);
    let clean = physical(&self::run("", "", "'idim-ls'").runs[0]).findings.clone();
    assert!(clean.iter().all(|f| f.severity == Severity::Note), "{clean:?}");
}

#[test]
fn cross_validation_takes_the_weight_that_predicts_best() {
    let results = run("", "physical = true\nprior = { weight = 'cross-validation' }", "'idim-ls'");
    let e = estimate(&results.runs[0]);
    let best = e.weights_tried.iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert_eq!((e.weights_tried.len(), e.prior_weight), (7, best[0]));
    let euclidean = run("", "physical = true\nprior = { kind = 'euclidean', weight = 1e9 }", "'idim-ls'");
    let e = estimate(&euclidean.runs[0]);
    assert!((standard(e, "m1") - 4.0).abs() < 1e-3 && (standard(e, "mx2") - 0.3).abs() < 1e-3);
}

#[test]
fn bad_input_is_refused_by_its_place() {
    let refused = |parameters: &str| experiment("", parameters, "'idim-ls'").unwrap_err();
    let says = |parameters: &str, words: &[&str]| {
        let error = refused(parameters).to_string();
        assert!(words.iter().all(|w| error.contains(w)), "{error}");
    };
    says("physical = true\nfix = { m9 = 1 }", &["[parameters] fix.m9", "no standard parameter `m9`"]);
    says("known = [{ kind = 'mass', link = 2, kg = 1 }]", &["[parameters] physical = true is missing"]);
    says("fix = { m9 = 1 }", &["[parameters] fix.m9", "no standard parameter `m9`"]);
    says("fix = { m2 = 1 }\nexclude = ['m2']", &["[parameters] fix is m2", "not excluded"]);
    says("physical = true\nestimate = 'essential'", &["[parameters] estimate", "\"base\""]);
    says("physical = true\nfix = { m2 = -1 }", &["[parameters] fix and known", "link 2"]);
    says("physical = true\nprior = { weight = 0 }", &["[parameters] prior.weight"]);
    says("physical = true\nprior = { weight = 'guess' }", &["cross-validation"]);
    says("physical = true\nknown = [{ kind = 'mass', link = 3, kg = 1 }]", &["number 1", "m3"]);
    says("physical = true\nknown = [{ kind = 'mirror-plane', link = 0, normal = 'x' }]", &["no link 0"]);
    says("physical = true\nknown = [{ kind = 'weight', kg = 1 }]", &["unknown variant `weight`", "total-mass"]);
    let sum = "physical = true\nfix = { m1 = 1, m2 = 1 }\nknown = [{ kind = 'total-mass', kg = 3 }]";
    says(sum, &["contradicts"]);
    let error = refused("physical = true\nfix = { fc1 = -1 }");
    assert!(
        matches!(error, ExperimentError::Preparation { source: PreparationError::Consistency { .. }, .. }),
        "{error}"
    );
}
