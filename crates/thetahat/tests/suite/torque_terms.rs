//! Torque terms of a robot's description, from twins with known truth: every method finds their parameters.

use std::{f64::consts::TAU, path::Path};

use thetahat::{
    ControllerDescription, Identification, Method, Recording, Results, Robot, Series, Settings,
    dynamics::Model,
    identification::Status,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatorBias, Solver},
};
use thetahat_estimation::simulation::{Job, simulate_all};
use thetahat_model::robot::TermDescription;

pub(super) const RATE_HZ: f64 = 500.0;
pub(super) const SCALE: f64 = 0.005;

/// Two joints, whose terms and further a-priori values come behind.
const ROBOT: &str = r#"
name = "two joints"
gravity = [0.0, -9.81, 0.0]
[[joint]]
name = "shoulder"
kind = "revolute"
[[joint]]
name = "elbow"
kind = "revolute"
a_m = 0.5
[transmission]
matrix = [[50, 0], [0, 30]]
"#;
const VALUES: &str = "[parameters]\nzz1 = 1.2\nmx1 = 0.8\nm2 = 1.5\nmx2 = 0.5\nzz2 = 0.4\nia1 = 0.3\nia2 = 0.2\n\
                      fv1 = 1.1\nfc1 = 1.6\nfv2 = 0.7\nfc2 = 0.9\n";

pub(super) fn robot(terms: &str, values: &str) -> Robot {
    Robot::parse(&format!("{ROBOT}{terms}{VALUES}{values}"), Path::new("two.toml")).unwrap()
}

pub(super) fn controller() -> ControllerDescription {
    toml::from_str("law = 'pd'\nbandwidth_hz = [15]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0")
        .unwrap()
}

/// Waves of three harmonics, slow ones among them: much of Stribeck friction is at small velocities.
fn wave(seconds: f64) -> Series {
    let of = |t: f64, j: f64| -> f64 {
        let slow = 1.0 + 0.7 * (TAU * 0.05 * t).sin();
        slow * [1.0, 2.0, 3.0].map(|h| 0.4 * (TAU * 0.25 * h * t + h * h + j).sin() / h).iter().sum::<f64>()
    };
    let time = (0..(seconds * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect())
}

/// White noise from a linear congruential generator, the sum of four uniform numbers.
fn noisy(series: &Series, deviation: f64) -> Series {
    let mut state = 7_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut noise = || 3_f64.sqrt() * deviation * (uniform() + uniform() + uniform() + uniform());
    Series::shaped(series.channels(), series.values().iter().map(|v| v + noise()).collect())
}

/// The record of a twin of a robot with its a-priori parameters; `channel` is recorded along.
fn record(robot: &Robot, seconds: f64, channel: Option<(&str, &Series)>) -> Recording {
    record_in_loop(robot, &controller(), seconds, channel)
}

/// The same in the loop of a controller.
pub(super) fn record_in_loop(
    robot: &Robot,
    controller: &ControllerDescription,
    seconds: f64,
    channel: Option<(&str, &Series)>,
) -> Recording {
    let (model, theta) = (Model::new(robot), robot.a_priori_parameters());
    let reference = wave(seconds);
    let followed = Reference::Sampled(SampledReference::new(reference.clone(), RATE_HZ));
    let side_by_side = channel.map(|(_, s)| Series::side_by_side(&[s.channel(0), s.channel(0)]));
    let closed_loop = ClosedLoop {
        model: &model,
        transmission: &robot.transmission,
        controller,
        reference: &followed,
        added_signal: None,
        channels: side_by_side.as_ref().map(|s| (s, RATE_HZ)),
        bias: SimulatorBias::NONE,
        solver: Solver::Adaptive { relative_tolerance: 1e-7, absolute_tolerance: 1e-9 },
        sign_velocity_scale: SCALE,
    };
    let motor_inertia = closed_loop.motor_inertia(&theta, seconds);
    let grid = OutputGrid { start_s: 0.0, sample_rate_hz: RATE_HZ, samples: reference.len() };
    let job = Job { closed_loop, theta: &theta, motor_inertia: &motor_inertia, grid };
    let motion = simulate_all(&[job]).remove(0).unwrap();
    let recording = Recording::new(RATE_HZ, noisy(&motion.q, 2e-5), noisy(&motion.tau, 0.05)).with_reference(reference);
    let recording = Recording { truth: Some(theta), ..recording };
    channel.map_or(recording.clone(), |(name, series)| recording.with_channel(name, series.clone()))
}

pub(super) fn settings(methods: &[Method]) -> Settings {
    let mut settings = Settings::new(30.0, 10).with_methods(methods.iter().copied()).with_controller(controller());
    settings.simulation.sign_velocity_scale = SCALE;
    settings
}

/// The estimates of parameters by a method lie within some deviations of the truth, which is known to some percent.
fn assert_found(results: &Results, method: Method, names: &[&str], percent: f64) {
    let run = results.run("nominal", method).unwrap();
    assert_eq!(run.status, Status::Converged, "{method}: {:?}", run.reason);
    for name in names {
        let p = run
            .parameter(name)
            .unwrap_or_else(|| panic!("{name} of {:?}", run.parameters.iter().map(|p| &p.name).collect::<Vec<_>>()));
        let (truth, sd) = (p.true_value.unwrap(), p.standard_deviation_robust.unwrap());
        let error = (p.estimate - truth).abs();
        println!("{method} {name}: {} of {truth}, deviation {sd:.2e}", p.estimate);
        assert!(
            error < 100f64.recip() * percent * truth.abs(),
            "{method} {name}: {} of {truth}, sd {sd:.2e}",
            p.estimate
        );
    }
}

const SPRING_AND_STRIBECK: &str = r#"
[[term]]
kind = "joint-spring"
joints = ["elbow"]
rest_deg = 30
[[term]]
kind = "exponential-stribeck"
velocity = 0.2
exponent = 1
"#;

#[test]
fn springs_and_stribeck_friction_are_found_by_every_method() {
    let truth = robot(SPRING_AND_STRIBECK, "k2 = 6.0\nfs1 = 1.2\nfs2 = 0.8\n");
    let recording = record(&truth, 40.0, None);
    // The start knows nothing of the terms.
    let start = robot(SPRING_AND_STRIBECK, "");
    let methods = [Method::IDIM_LS, Method::IDIM_WLS, Method::IDIM_IV, Method::DIDIM, Method::CLIE];
    let results = Identification::new(&start, vec![recording], settings(&methods)).unwrap().run().unwrap();
    for method in methods {
        let percent = if method == Method::IDIM_LS || method == Method::IDIM_WLS { 12.0 } else { 5.0 };
        assert_found(&results, method, &["k2", "fs1", "fs2", "fc1", "fv2"], percent);
    }
}

const MANY: &str = r#"
[[term]]
kind = "spring"
name = "balancer"
from = { point_m = [-0.2, 0.5, 0.0] }
to = { link_of = "shoulder", point_m = [0.3, 0.1, 0.0] }
free_length_m = 0.4
[[term]]
kind = "hydraulic"
name = "cylinder"
from = { link_of = "shoulder", point_m = [0.1, 0.2, 0.0] }
to = { link_of = "elbow", point_m = [0.25, 0.1, 0.0] }
direction = "push"
length_m = 0.7
gas_length_m = 0.5
exponent = 1.2
[[term]]
kind = "motor-harmonics"
joints = ["elbow"]
harmonics = [1]
[[term]]
kind = "polynomial-viscous"
joints = ["shoulder"]
[[term]]
kind = "load-friction"
[[term]]
kind = "expression"
name = "coupled"
joint = "elbow"
expression = "sin(3*q1) * cos(q)"
unit = "N m"
"#;

#[test]
#[ignore = "long, each night"]
fn every_kind_of_term_is_found_by_iv() {
    let values = "k_balancer = 40.0\nf_cylinder = 30.0\nhs1_2 = 0.4\nhc1_2 = -0.3\nfvq1 = 0.5\nfl1 = 0.06\nfl2 = 0.08\n\
                  coupled = 1.5\n";
    let truth = robot(MANY, values);
    let recording = record(&truth, 40.0, None);
    let methods = [Method::IDIM_LS, Method::IDIM_IV];
    // Load friction takes the a-priori masses.
    let results = Identification::new(&robot(MANY, ""), vec![recording], settings(&methods)).unwrap().run().unwrap();
    let names = ["k_balancer", "f_cylinder", "hs1_2", "hc1_2", "fvq1", "fl1", "fl2", "coupled"];
    assert_found(&results, Method::IDIM_LS, &names, 20.0);
    assert_found(&results, Method::IDIM_IV, &names, 10.0);
}

const TEMPERATURE: &str = r#"
[[term]]
kind = "channel-viscous"
channel = "temperature"
reference = 30
[[term]]
kind = "expression"
name = "warm"
joint = "elbow"
expression = "s * (temperature - 30)"
"#;

#[test]
#[ignore = "long, each night"]
fn friction_that_follows_a_recorded_temperature_is_found() {
    let values = "fv_temperature1 = -0.02\nfv_temperature2 = -0.01\nwarm = -0.012\n";
    let truth = robot(TEMPERATURE, values);
    let seconds = 40.0;
    let of_time = |k: usize| 20.0 + 40.0 * (1.0 - (-(k as f64) / RATE_HZ / 15.0).exp());
    let temperature = Series::shaped(1, (0..(seconds * RATE_HZ) as usize).map(of_time).collect());
    let recording = record(&truth, seconds, Some(("temperature", &temperature)));
    let methods = [Method::IDIM_LS, Method::IDIM_IV, Method::CLIE];
    let start = robot(TEMPERATURE, "");
    let identify = |recording, methods: &[Method]| Identification::new(&start, vec![recording], settings(methods));
    let results = identify(recording.clone(), &methods).unwrap().run().unwrap();
    for method in methods {
        assert_found(&results, method, &["fv_temperature1", "fv_temperature2", "warm", "fv1", "fc2"], 10.0);
    }
    let without = Recording { channels: Default::default(), ..recording };
    let refused = |result: Result<Identification, _>| result.map(|_| ()).unwrap_err();
    assert_eq!(
        refused(identify(without, &methods)).to_string(),
        "recording 1: channels.temperature is missing, expected the recorded channel that a [[term]] of the robot takes"
    );
}

#[test]
fn terms_of_accelerations_are_estimated_and_not_simulated() {
    let terms = "[[term]]\nkind = \"expression\"\nname = \"slip\"\njoint = \"elbow\"\nexpression = \"abs(ddq)\"\n";
    let recording = Recording { truth: None, ..record(&robot("", ""), 20.0, None) };
    let with_term = robot(terms, "");
    let identify = |methods: &[Method]| Identification::new(&with_term, vec![recording.clone()], settings(methods));
    let results = identify(&[Method::IDIM_LS]).unwrap().run().unwrap();
    let slip = results.run("nominal", Method::IDIM_LS).unwrap().parameter("slip").unwrap();
    assert!(slip.estimate.abs() < 5.0 * slip.standard_deviation_robust.unwrap(), "{slip:?}");
    assert_eq!(
        identify(&[Method::IDIM_IV]).map(|_| ()).unwrap_err().to_string(),
        "methods is idim-iv, expected idim-ls or idim-wls: the torque term of slip depends on ddq, which idim-iv does not \
         simulate"
    );
}

#[test]
fn descriptions_are_data() {
    let robot = robot(SPRING_AND_STRIBECK, "");
    assert_eq!(robot.term_descriptions.len(), 2);
    assert!(
        matches!(robot.term_descriptions[1], TermDescription::ExponentialStribeck { velocity, .. } if velocity == 0.2)
    );
    assert_eq!(robot.with_terms(&[]).unwrap().parameter_table().len(), robot.parameter_table().len() - 3);
}

const SPRING: &str = "[[term]]\nkind = \"joint-spring\"\njoints = [\"elbow\"]\nrest_deg = 30\n";

fn compared(robot: &Robot, recording: Recording) -> Results {
    let mut settings = settings(&[Method::IDIM_LS]);
    settings.estimation.compare_terms = true;
    Identification::new(robot, vec![recording], settings).unwrap().run().unwrap()
}

#[test]
#[ignore = "long, each night"]
fn a_law_that_fits_is_recommended_and_no_other() {
    let recording = record(&robot(SPRING_AND_STRIBECK, "k2 = 6.0\nfs1 = 1.2\nfs2 = 0.8\n"), 40.0, None);
    let recording = Recording { truth: None, ..recording };
    let results = compared(&robot(SPRING, ""), recording.clone());
    let comparison = results.term_comparison.as_ref().unwrap();
    println!("{}", thetahat_report::report::text::all(&results, None, thetahat_report::report::TextWidth::DEFAULT));
    for joint in &comparison.joints {
        let recommended: Vec<_> = joint.laws.iter().filter(|law| law.recommended).collect();
        assert_eq!(recommended.len(), 1, "{}: {:?}", joint.joint, joint.laws);
        // Both laws that fall with the velocity describe it, and the record does not tell them apart.
        let law = |name: &str| joint.laws.iter().find(|law| law.law == name).unwrap().criterion_change;
        assert!(recommended[0].law.ends_with("stribeck"), "{:?}", joint.laws);
        assert!(law("exponential-stribeck") - recommended[0].criterion_change < 10.0, "{:?}", joint.laws);
        // Without the samples near rest a friction by load takes some of what falls with the velocity, far less than the law.
        assert!(law("motor-harmonics") > 0.0 && law("load-friction") > -10.0, "{:?}", joint.laws);
        assert!(recommended[0].description.starts_with("[[term]]\nkind = \""));
    }
    // What is recommended can be pasted, and then nothing else is.
    let pasted: Vec<&str> = comparison
        .joints
        .iter()
        .flat_map(|j| &j.laws)
        .filter(|l| l.recommended)
        .map(|l| l.description.as_str())
        .collect();
    let accepted = robot(&format!("{SPRING}{}", pasted.join("\n")), "");
    let results = compared(&accepted, recording);
    let again = results.term_comparison.as_ref().unwrap();
    println!("{}", thetahat_report::report::text::all(&results, None, thetahat_report::report::TextWidth::DEFAULT));
    let left = again.joints.iter().flat_map(|j| &j.laws).filter(|l| l.recommended).count();
    assert_eq!(left, 0, "{again:?}");
}

#[test]
#[ignore = "long, each night"]
fn constants_are_profiled() {
    let recording = record(&robot(SPRING_AND_STRIBECK, "k2 = 6.0\nfs1 = 1.2\nfs2 = 0.8\n"), 40.0, None);
    let recording = Recording { truth: None, ..recording };
    let asked = SPRING_AND_STRIBECK.replace("velocity = 0.2\nexponent = 1\n", "velocity = 0.05\nprofile = true\n");
    let identification =
        Identification::new(&robot(&asked, ""), vec![recording], settings(&[Method::IDIM_LS])).unwrap();
    let results = identification.run().unwrap();
    for found in &results.profiled_terms {
        println!("{found:?}");
        assert!((found.velocity / 0.2 - 1.0).abs() < 0.3 && (found.exponent - 1.0).abs() < 0.5, "{found:?}");
        assert!(!found.at_limit);
    }
    assert_eq!(results.profiled_terms.len(), 2);
}
