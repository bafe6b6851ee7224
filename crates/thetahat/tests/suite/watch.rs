//! A watched arm of two joints whose friction, payload or torque changes. Its torques are those of the model of `robots/two_joint.toml`, with
//! noise that is correlated in time; what changes is added here, from its own formula.

use std::{f64::consts::TAU, sync::LazyLock};

use thetahat::{
    Experiment, Robot,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    experiment::{EstimateRequest, PredictionRequest},
    results::NOMINAL,
    watch::{GrowingText, Watch, WatchOptions, WatchedRobot, recorded_samples},
};
use thetahat_report::results::{WatchChange, WatchDrift, WatchEvent, WatchSummary};
use thetahat_testing::{Folder, project};

const RATE_HZ: f64 = 200.0;
/// Deviation of the torques' noise, N m, and the correlation of neighbours.
const NOISE: f64 = 0.15;
const CORRELATION: f64 = 0.5;
/// Time of settling, and time at which something changes, s.
const SETTLE_S: f64 = 20.0;
const CHANGE_S: f64 = 40.0;
/// Slowest of the velocities over which the sign of the friction turns, rad/s.
const TRANSITION: f64 = 0.01;
/// Identified friction of joint 2, as in the robot's file.
const FRICTION: [f64; 2] = [1.0, 0.4];

/// What is added to the torques of an instant: time, velocities and accelerations to torques.
type Change<'a> = &'a dyn Fn(f64, [f64; 2], [f64; 2], [f64; 2]) -> [f64; 2];

fn robot() -> Robot {
    let path = project("robots/two_joint.toml");
    Robot::read(&path).unwrap()
}

/// Position, velocity and acceleration of a joint: three sines that do not repeat.
fn wave(t: f64, joint: usize) -> [f64; 3] {
    let parts = [[0.6, 0.13], [0.35, 0.31], [0.2, 0.53]];
    parts.iter().fold([0.0; 3], |[q, dq, ddq], [a, hz]| {
        let (w, phase) = (TAU * hz * (1.0 + 0.17 * joint as f64), 2.0 * joint as f64 + 5.0 * hz);
        let (sine, cosine) = (w * t + phase).sin_cos();
        [q + a * sine, dq + a * w * cosine, ddq - a * w * w * sine]
    })
}

/// A log of so many seconds.
fn log(seconds: f64, seed: u64, change: Change<'_>) -> String {
    let model = Model::new(&robot());
    let parameters = DynamicParameters::new(&model, &robot().a_priori_parameters()).unwrap();
    let mut workspace = Workspace::new(&model);
    let mut uniform = thetahat_testing::noise();
    // The sum of three has variance one. Other seeds begin elsewhere.
    let mut white = || (0..3).map(|_| uniform()).sum::<f64>();
    (0..10_000 * seed).for_each(|_| _ = white());
    let mut noise = [0.0; 2];
    let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
    for k in 0..(seconds * RATE_HZ) as usize {
        let t = k as f64 / RATE_HZ;
        let waves = [wave(t, 0), wave(t, 1)];
        let [q, dq, ddq] = [0, 1, 2].map(|i| [waves[0][i], waves[1][i]]);
        let mut tau = [0.0; 2];
        let sign = Sign::smooth(TRANSITION);
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, sign, &mut workspace, &mut tau);
        let added = change(t, q, dq, ddq);
        for j in 0..2 {
            noise[j] = CORRELATION * noise[j] + (1.0 - CORRELATION * CORRELATION).sqrt() * NOISE * white();
            tau[j] += added[j] + noise[j];
        }
        text += &format!("{t:.3},{},{},{},{}\n", q[0], q[1], tau[0], tau[1]);
    }
    text
}

const EXPERIMENT: &str = r#"title = "watched"
robot = "robot.toml"
[recording]
time = { file = "log.csv", columns = ["t"], unit = "s" }
position = { file = "log.csv", columns = ["q1", "q2"], unit = "rad" }
torque = { file = "log.csv", columns = ["tau1", "tau2"], unit = "N m" }
[signal]
cutoff_hz = 12
decimation = 10
[estimation]
methods = ["idim-ls"]
"#;

/// A folder with `out/results.json`.
static IDENTIFIED: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::with("log.csv", log(30.0, 1, &|_, _, _, _| [0.0; 2]));
    folder.write("robot.toml", std::fs::read(project("robots/two_joint.toml")).unwrap());
    folder.write("experiment.toml", EXPERIMENT);
    let experiment = Experiment::read(&folder.at("experiment.toml"), folder.path()).unwrap();
    let results = experiment.run(folder.path(), &mut |_| ()).unwrap();
    folder.write("out/results.json", results.to_json().unwrap());
    folder
});

fn watched_robot() -> WatchedRobot {
    WatchedRobot::read(&IDENTIFIED.at("out/results.json"), &EstimateRequest::default()).unwrap()
}

fn request(folder: &Folder) -> PredictionRequest {
    PredictionRequest {
        results: IDENTIFIED.at("out/results.json"),
        recording: folder.at("watched.csv"),
        torque_file: None,
        position: Vec::new(),
        torque: Vec::new(),
        time: None,
        time_unit: None,
        window_s: None,
        case: NOMINAL.to_owned(),
        method: None,
    }
}

fn options() -> WatchOptions {
    WatchOptions { settle_s: SETTLE_S, ..WatchOptions::default() }
}

/// The alarms of a log, and its summary.
fn alarms(text: &str) -> (Vec<WatchEvent>, WatchSummary) {
    let folder = Folder::with("watched.csv", text);
    let robot = watched_robot();
    let (rate_hz, samples) = recorded_samples(&robot, &request(&folder)).unwrap();
    let mut watch = Watch::new(robot, rate_hz, options(), "watched.csv".as_ref()).unwrap();
    let mut events = Vec::new();
    for sample in samples {
        events.extend(watch.push(&sample).unwrap());
    }
    events.retain(WatchEvent::is_alarm);
    (events, watch.finish().unwrap())
}

fn drifts(events: &[WatchEvent]) -> Vec<&WatchDrift> {
    events.iter().filter_map(|event| if let WatchEvent::Drift(drift) = event { Some(drift) } else { None }).collect()
}

fn holds(change: &WatchChange, truth: f64) -> bool {
    let [low, high] = change.interval_95;
    low <= truth && truth <= high && (low > 0.0 || high < 0.0 || truth == 0.0)
}

#[test]
fn an_arm_that_does_not_change_raises_no_alarm() {
    let (events, summary) = alarms(&log(400.0, 2, &|_, _, _, _| [0.0; 2]));
    assert_eq!(events, []);
    assert!(summary.watched_s > 379.0 && summary.gaps == 0, "{summary:?}");
    // The residual is the noise.
    assert!(summary.residual.rms.iter().flatten().all(|rms| *rms < 1.2 * NOISE), "{summary:?}");
    let outside = summary.changes.iter().filter(|change| !holds(change, 0.0)).count();
    assert_eq!(outside, 0, "{:?}", summary.changes);
}

#[test]
fn friction_that_grows_by_a_tenth_is_named() {
    let [fv, fc] = FRICTION;
    let more = |t: f64, _, dq: [f64; 2], _| {
        let part = if t < CHANGE_S { 0.0 } else { 0.1 };
        [0.0, part * (fv * dq[1] + fc * (dq[1] / TRANSITION).tanh())]
    };
    let (events, summary) = alarms(&log(100.0, 3, &more));
    let found = drifts(&events);
    assert_eq!((events.len(), found.len()), (1, 1), "{events:?}");
    assert!(found[0].cause == "friction of joint 2 (elbow)" && found[0].rivals.is_empty(), "{found:?}");
    assert!((found[0].began_s - CHANGE_S).abs() < 5.0 && found[0].time_s < CHANGE_S + 20.0, "{found:?}");
    let total = |name: &str| summary.changes.iter().find(|change| change.parameter == name).unwrap();
    assert!((total("fv2").change - 0.1 * fv).abs() < 0.03 && (total("fc2").change - 0.1 * fc).abs() < 0.03);
    assert!(total("fv2").percent.is_some_and(|percent| (percent - 10.0).abs() < 3.0), "{summary:?}");
}

/// A point at the elbow's frame: its torques from Lagrange's equations.
#[test]
fn a_payload_is_named_with_its_mass() {
    const MASS: f64 = 0.5;
    const UPPER: f64 = 0.4;
    const AT: f64 = 0.2;
    let loaded = |t: f64, q: [f64; 2], dq: [f64; 2], ddq: [f64; 2]| {
        if t < CHANGE_S {
            return [0.0; 2];
        }
        let (c2, s2) = (q[1].cos(), q[1].sin());
        let (m12, m22) = (AT * AT + UPPER * AT * c2, AT * AT);
        let m11 = UPPER * UPPER + AT * AT + 2.0 * UPPER * AT * c2;
        let h = UPPER * AT * s2;
        let weight = [UPPER * q[0].cos() + AT * (q[0] + q[1]).cos(), AT * (q[0] + q[1]).cos()];
        let inertia = [m11 * ddq[0] + m12 * ddq[1], m12 * ddq[0] + m22 * ddq[1]];
        let speeds = [-h * (2.0 * dq[0] * dq[1] + dq[1] * dq[1]), h * dq[0] * dq[0]];
        [0, 1].map(|j| MASS * (inertia[j] + speeds[j] + 9.81 * weight[j]))
    };
    let (events, summary) = alarms(&log(100.0, 4, &loaded));
    let found = drifts(&events);
    assert_eq!(found.iter().map(|drift| drift.cause.as_str()).collect::<Vec<_>>(), ["payload"], "{events:?}");
    assert!(found[0].time_s < CHANGE_S + 5.0, "{found:?}");
    let first = |name: &str| summary.changes.iter().find(|change| change.parameter == name).unwrap();
    assert!(holds(first("mx"), MASS * AT) && holds(first("m"), MASS), "{:?}", summary.changes);
}

#[test]
fn a_push_is_an_event_and_no_change() {
    let pushed = |t: f64, _, _, _| if (CHANGE_S..CHANGE_S + 0.2).contains(&t) { [0.0, 4.0] } else { [0.0; 2] };
    let (events, _) = alarms(&log(100.0, 5, &pushed));
    let [WatchEvent::Collision(collision)] = events.as_slice() else { panic!("{events:?}") };
    assert_eq!(collision.joint, 2);
    assert!((collision.began_s - CHANGE_S).abs() < 0.1 && (1.0..5.0).contains(&collision.torque), "{collision:?}");
    assert!(collision.time_s < CHANGE_S + 1.0, "{collision:?}");
}

/// A change while nothing was logged is found from what comes after.
#[test]
fn gaps_are_left_out() {
    let whole = log(100.0, 6, &|t, _, _, _| [if t < CHANGE_S { 0.0 } else { 1.0 }, 0.0]);
    let is_kept = |line: &&str| {
        let time: f64 = line.split(',').next().and_then(|t| t.parse().ok()).unwrap_or(0.0);
        !(CHANGE_S - 1.0..CHANGE_S + 1.0).contains(&time)
    };
    let text: String = whole.lines().filter(is_kept).map(|line| format!("{line}\n")).collect();
    let (events, summary) = alarms(&text);
    assert_eq!(summary.gaps, 1);
    assert_eq!(
        drifts(&events).first().map(|drift| drift.cause.as_str()),
        Some("offset of joint 1 (shoulder)"),
        "{events:?}"
    );
}

#[test]
fn text_that_grows_has_the_samples_of_its_file() {
    let text = log(25.0, 7, &|_, _, _, _| [0.0; 2]);
    let folder = Folder::with("watched.csv", &text);
    let robot = watched_robot();
    let (rate_hz, whole) = recorded_samples(&robot, &request(&folder)).unwrap();
    let mut growing = GrowingText::new(&robot, &request(&folder)).unwrap();
    let mut samples = Vec::new();
    for piece in text.as_bytes().chunks(777) {
        samples.extend(growing.read(piece, false).unwrap());
    }
    samples.extend(growing.read(b"", true).unwrap());
    assert!((growing.rate_hz().unwrap() / rate_hz - 1.0).abs() < 1e-6);
    let whole: Vec<_> = whole.collect();
    assert_eq!(samples.len(), whole.len());
    for (sample, whole) in samples.iter().zip(&whole) {
        assert!((sample.time_s - whole.time_s).abs() < 1e-9);
        assert_eq!((&sample.position, &sample.torque), (&whole.position, &whole.torque));
    }
}
