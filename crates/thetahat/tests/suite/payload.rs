//! Payloads and drive gains on twins with known truth: seven axes from a URDF, and the UR10.
//!
//! The truth of a payload is a set of point masses; their parameters are summed up here, not by the code under test.

use thetahat::{
    Identification, Method, Recording, Results, Robot, Series, Settings,
    base_parameters::BaseParameters,
    consistency::completed_a_priori,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    preparation::{Payload, PayloadFrame},
    results::Verdict,
};
use thetahat_estimation::simulation::{SignalNoise, random_numbers};
use thetahat_model::consistency::pseudo_inertia;
use thetahat_testing::project;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 4000;
/// Point masses of the payload, kg, in its frame, m.
const POINTS: [(f64, [f64; 3]); 6] = [
    (0.8, [0.05, 0.0, 0.10]),
    (0.7, [-0.03, 0.06, 0.12]),
    (0.9, [0.0, -0.05, 0.05]),
    (0.6, [0.02, 0.02, 0.20]),
    (0.5, [-0.06, -0.02, 0.09]),
    (0.5, [0.03, 0.04, 0.02]),
];
/// Where the frame of the payload stands in that of the last link: turned by 90 degrees about x, then moved.
const FRAME: PayloadFrame = PayloadFrame { xyz_m: [0.01, -0.02, 0.08], rpy_deg: [90.0, 0.0, 0.0] };

/// A point of the payload in the frame of the last link.
fn in_link([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 0.01, -z - 0.02, y + 0.08]
}

/// The ten parameters of points, in the library's order.
fn of_points(place: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 10] {
    let mut sum = [0.0; 10];
    for (m, point) in POINTS {
        let [x, y, z] = place(point);
        let one = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y, x, y, z, 1.0];
        sum.iter_mut().zip(one).for_each(|(s, v)| *s += m * v);
    }
    sum
}

/// A twin whose torques are known in every sample.
struct Twin {
    robot: Robot,
    unloaded: [Vec<f64>; 2],
    loaded: Vec<f64>,
    positions: [Series; 2],
    speed: f64,
}

impl Twin {
    fn new(file: &str) -> Self {
        Self::at_speed(file, 1.0)
    }

    /// The same path at a part of its speed, sampled as much slower.
    fn at_speed(file: &str, speed: f64) -> Self {
        let robot = Robot::read(&project(file)).unwrap();
        let model = Model::new(&robot);
        let table = robot.parameter_table();
        let mut theta = completed_a_priori(&robot, None);
        for joint in 1..=robot.joints.len() {
            for (name, value) in [("fv", 3.0), ("fc", 2.0), ("off", 0.3), ("ia", 0.5)] {
                let value = value / joint as f64;
                let place = table.index_of(&format!("{name}{joint}")).unwrap();
                theta[place] = if theta[place] == 0.0 { value } else { theta[place] };
            }
        }
        let mut with_load = theta.clone();
        let last = table.index_of(&format!("xx{}", robot.joints.len())).unwrap();
        with_load[last..last + 10].iter_mut().zip(of_points(in_link)).for_each(|(t, p)| *t += p);
        let n = robot.coordinate_count();
        let paths = [0, 1].map(|record| motion(n, record, speed));
        let torque = |record: usize, theta: &[f64]| {
            let theta = DynamicParameters::sorted(&model, theta);
            let [q, dq, ddq] = &paths[record];
            let mut workspace = Workspace::new(&model);
            let mut tau = vec![0.0; n * SAMPLES];
            for (k, tau) in tau.chunks_mut(n).enumerate() {
                let state = State::new(q.sample(k), dq.sample(k));
                model.inverse_dynamics(&theta, state, ddq.sample(k), Sign::Exact, &mut workspace, tau);
            }
            tau
        };
        let unloaded = [torque(0, &theta), torque(1, &theta)];
        let loaded = torque(1, &with_load);
        let positions = paths.map(|[q, _, _]| q);
        Self { robot, unloaded, loaded, positions, speed }
    }

    /// Two recordings, the second with the payload, of drives whose torque is `factor` times what is recorded.
    fn recordings(&self, seed: u64, factors: &[f64]) -> Vec<Recording> {
        let mut random = random_numbers(seed, 0);
        let n = self.robot.coordinate_count();
        let deviations: Vec<f64> = (0..n).map(|j| NOISE / (1.0 + j as f64)).collect();
        let mut series = |torque: &[f64]| {
            let torque = Series::shaped(n, torque.to_vec());
            let mut noisy = SignalNoise::White(&deviations).added_to(torque, &mut random);
            noisy.values_mut().iter_mut().enumerate().for_each(|(i, tau)| *tau /= factors[i % n]);
            noisy
        };
        let without =
            Recording::new(RATE_HZ * self.speed, self.positions[0].clone(), series(&self.unloaded[0])).named("without");
        let with = Recording::new(RATE_HZ * self.speed, self.positions[1].clone(), series(&self.loaded)).named("with");
        vec![without, Recording { payload: Some("load".to_owned()), ..with }]
    }

    fn run(&self, payload: Payload, seed: u64, factors: &[f64]) -> Results {
        let settings = Settings::new(20.0 * self.speed, 10).with_methods([Method::IDIM_LS]).with_payloads([payload]);
        Identification::new(&self.robot, self.recordings(seed, factors), settings).unwrap().run().unwrap()
    }
}

/// Noise of the first joint, N m; joint k has 1 / k of it.
const NOISE: f64 = 2.0;

/// A path of sines at a part of its speed: position, velocity, acceleration.
fn motion(joints: usize, record: usize, speed: f64) -> [Series; 3] {
    let mut all = [0, 1, 2].map(|_| Series::zeros(SAMPLES, joints));
    for k in 0..SAMPLES {
        let t = k as f64 / RATE_HZ;
        for j in 0..joints {
            let place = (j + joints * record) as f64;
            for (amplitude, rate) in [(0.5, 0.9 + 0.13 * place), (0.25, 2.3 + 0.21 * place), (0.1, 4.1 - 0.17 * place)]
            {
                let phase = rate * t + 1.3 * place;
                let rate = rate * speed;
                all[0].sample_mut(k)[j] += amplitude * phase.sin();
                all[1].sample_mut(k)[j] += amplitude * rate * phase.cos();
                all[2].sample_mut(k)[j] -= amplitude * rate * rate * phase.sin();
            }
        }
    }
    all
}

fn unknown() -> Payload {
    Payload { name: "load".to_owned(), joint: None, frame: FRAME, mass_kg: None, centre_m: None, inertia_kgm2: None }
}

/// The truth as a user would give it: mass, centre, inertia about the centre.
fn known() -> Payload {
    let [.., mx, my, mz, m] = of_points(|p| p);
    let c = [mx / m, my / m, mz / m];
    let [xx, xy, xz, yy, yz, zz, ..] = of_points(|[x, y, z]| [x - c[0], y - c[1], z - c[2]]);
    Payload { mass_kg: Some(m), centre_m: Some(c), inertia_kgm2: Some([xx, xy, xz, yy, yz, zz]), ..unknown() }
}

/// How often intervals hold the truth.
#[derive(Default)]
struct Coverage {
    inside: usize,
    of: usize,
}

impl Coverage {
    fn add(&mut self, truth: f64, interval: Option<[f64; 2]>) {
        let [low, high] = interval.expect("an interval");
        self.of += 1;
        self.inside += usize::from(low <= truth && truth <= high);
    }

    /// 93 to 97 %, with two standard errors of the seeds that are tried; the quantities of a seed are correlated, so that
    /// the seeds alone count.
    fn check(&self, what: &str, seeds: u64) {
        let part = self.inside as f64 / self.of as f64;
        println!("{what}: {} of {} = {part:.3}", self.inside, self.of);
        let error = (0.05 * 0.95 / seeds as f64).sqrt();
        assert!((part - 0.95).abs() < 0.02 + 2.0 * error, "{what}: {part}");
    }
}

/// Seeds of the coverage: four, 20 each night, and `THETAHAT_SEEDS=100` for the figures of docs/evidence/payload.md.
fn seeds() -> u64 {
    std::env::var("THETAHAT_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(4)
}

fn payload_is_found(file: &str) {
    let twin = Twin::new(file);
    let truth = of_points(|p| p);
    let ones = vec![1.0; twin.robot.coordinate_count()];
    let mut coverage = Coverage::default();
    for seed in 0..seeds() {
        let results = twin.run(unknown(), seed, &ones);
        assert!(results.drive_gains.is_empty());
        // The robot is identified from the recording without it alone.
        assert_eq!(results.recordings.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["without"]);
        let [payload] = &results.payloads[..] else { panic!("{:?}", results.payloads) };
        assert_eq!(
            (payload.recordings.len(), payload.joint.as_str()),
            (1, twin.robot.joints.last().unwrap().name.as_str())
        );
        for (parameter, truth) in payload.parameters.iter().zip(truth) {
            coverage.add(truth, parameter.interval_95);
        }
        let mass = payload.parameters[9].estimate.unwrap();
        assert!((mass / truth[9] - 1.0).abs() < 0.05, "{mass}");
        let centre = payload.centre_m.unwrap();
        assert!((0..3).all(|i| (centre[i] - truth[6 + i] / truth[9]).abs() < 0.01), "{centre:?}");
        let body = payload.physical.as_ref().unwrap();
        let body = pseudo_inertia(body[..].try_into().unwrap());
        assert!(body.smallest_eigenvalue() > 0.0);
    }
    coverage.check(&format!("payload on {file}"), seeds());
}

fn gains_are_found(file: &str) {
    let twin = Twin::new(file);
    let n = twin.robot.coordinate_count();
    let truth: Vec<f64> = (0..n).map(|j| 0.8 + 0.1 * j as f64).collect();
    let mut coverage = Coverage::default();
    for seed in 0..seeds() {
        let results = twin.run(known(), seed, &truth);
        assert!(results.payloads.is_empty() && results.verdict == Some(Verdict::DoNotUse));
        for (gain, truth) in results.drive_gains.iter().zip(&truth) {
            match gain.factor {
                Some(_) => coverage.add(*truth, gain.interval_95),
                None => assert!(gain.reason.is_some()),
            }
        }
        let found = results.drive_gains.iter().filter(|g| g.factor.is_some()).count();
        assert!(found + 2 >= n, "{:?}", results.drive_gains);
    }
    coverage.check(&format!("gains on {file}"), seeds());
}

#[test]
#[ignore = "long, each night"]
fn a_payload_of_seven_axes() {
    payload_is_found("robots/seven_axes.urdf");
}

#[test]
#[ignore = "long, each night"]
fn a_payload_of_the_ur10() {
    payload_is_found("robots/ur10.toml");
}

#[test]
#[ignore = "long, each night"]
fn gains_of_seven_axes() {
    gains_are_found("robots/seven_axes.urdf");
}

#[test]
#[ignore = "long, each night"]
fn gains_of_the_ur10() {
    gains_are_found("robots/ur10.toml");
}

/// With the right gains, a known payload leaves no trace in the estimates of the robot.
#[test]
#[ignore = "long, each night"]
fn a_known_payload_moves_to_the_left_side() {
    let twin = Twin::new("robots/seven_axes.urdf");
    let ones = vec![1.0; 7];
    let with = twin.run(known(), 1, &ones);
    assert!(with.drive_gains.iter().all(|g| !g.contradicts()), "{:?}", with.drive_gains);
    let mut recordings = twin.recordings(1, &ones);
    let noise: Vec<f64> = recordings[1].torque.as_ref().unwrap().values().to_vec();
    let bare = noise.iter().zip(&twin.loaded).zip(&twin.unloaded[1]).map(|((s, l), u)| s - l + u).collect();
    recordings[1].torque = Some(Series::shaped(7, bare));
    recordings[1].payload = None;
    let settings = Settings::new(20.0, 10).with_methods([Method::IDIM_LS]);
    let without = Identification::new(&twin.robot, recordings, settings).unwrap().run().unwrap();
    for (a, b) in with.runs[0].parameters.iter().zip(&without.runs[0].parameters) {
        let deviation = b.standard_deviation_robust.unwrap();
        assert!((a.estimate - b.estimate).abs() < 0.1 * deviation, "{}: {} {}", a.name, a.estimate, b.estimate);
    }
}

/// In slow motion the payload has weight alone, which a vertical first axis does not feel.
#[test]
#[ignore = "long, each night"]
fn joints_that_the_payload_does_not_load_are_named() {
    let twin = Twin::at_speed("robots/ur10.toml", 0.05);
    let results = twin.run(known(), 3, &[1.2; 6]);
    let [first, others @ ..] = &results.drive_gains[..] else { panic!("no gains") };
    assert!(first.factor.is_none() && first.reason.as_ref().unwrap().contains("payload"), "{first:?}");
    for gain in &others[..3] {
        let [low, high] = gain.interval_95.unwrap_or_else(|| panic!("{gain:?}"));
        assert!(low < 1.2 && 1.2 < high && high - low < 0.3, "{gain:?}");
    }
    let text = thetahat_report::report::text::all(&results, None, thetahat_report::report::TextWidth::DEFAULT);
    let row = text.lines().find(|line| line.starts_with("shoulder_pan_joint ")).unwrap();
    assert!(row.contains("not identifiable"), "{text}");
    assert!(text.contains("PROBLEM: the torques of shoulder_lift_joint"), "{text}");
}

#[test]
fn what_cannot_be_is_refused() {
    let twin = Twin::new("robots/seven_axes.urdf");
    let ones = vec![1.0; 7];
    let settings =
        |payloads: Vec<Payload>| Settings::new(20.0, 10).with_methods([Method::IDIM_LS]).with_payloads(payloads);
    let says = |recordings: Vec<Recording>, settings: Settings| {
        Identification::new(&twin.robot, recordings, settings).err().unwrap().to_string()
    };
    let recordings = || twin.recordings(0, &ones);
    assert_eq!(
        says(recordings(), settings(vec![])),
        "recording with: payload is load, expected one of [[payload]]: none"
    );
    let loaded = || vec![recordings().remove(1)];
    assert!(says(loaded(), settings(vec![unknown()])).contains("a recording without it"));
    let iv = settings(vec![known()]).with_methods([Method::IDIM_LS, Method::IDIM_IV]);
    assert!(
        says(recordings(), iv)
            .contains("methods is idim-iv, expected idim-ls or idim-wls where a recording has a payload")
    );
    assert!(says(recordings(), settings(vec![known(), known()])).contains("a name of its own"));
}

/// A parameter at a value is not estimated, and what it was regrouped into gives up its part: the torques stay.
#[test]
#[ignore = "long, each night"]
fn a_parameter_at_a_value_moves_to_the_left_side() {
    let twin = Twin::new("robots/seven_axes.urdf");
    let recordings = || vec![twin.recordings(5, &[1.0; 7]).remove(0)];
    let run = |fix: &[(&str, f64)]| {
        let mut settings = Settings::new(20.0, 10).with_methods([Method::IDIM_LS]);
        settings.parameters.fix = fix.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        Identification::new(&twin.robot, recordings(), settings).unwrap().run().unwrap().runs.remove(0)
    };
    let free = run(&[]);
    // A mass that the motion does not separate from others, at any value.
    let model = Model::new(&twin.robot);
    let base = BaseParameters::of(&model, &[]).unwrap();
    let m3 = model.parameter_table().index_of("m3").unwrap();
    let mass = run(&[("m3", 5.0)]);
    assert_eq!(mass.parameters.len(), free.parameters.len());
    for (k, parameter) in base.parameters().iter().enumerate() {
        let part: f64 = parameter.regrouped.iter().filter(|(i, _)| *i == m3).map(|(_, c)| 5.0 * c).sum();
        let (a, b) = (mass.parameters[k].estimate + part, free.parameters[k].estimate);
        assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{}: {a} {b}", parameter.name);
    }
    // One that is a base parameter, at its true value.
    let friction = run(&[("fv2", 1.5)]);
    assert!(friction.parameter("fv2").is_none() && friction.parameters.len() + 1 == free.parameters.len());
    for parameter in &friction.parameters {
        let other = free.parameter(&parameter.name).unwrap();
        let deviation = other.standard_deviation_robust.unwrap();
        assert!((parameter.estimate - other.estimate).abs() < 3.0 * deviation, "{}", parameter.name);
        assert!(parameter.standard_deviation.unwrap() < 1.01 * other.standard_deviation.unwrap(), "{}", parameter.name);
    }
}

#[test]
fn methods_that_compare_whole_signals_have_no_fixed_parameters() {
    let robot = Robot::read(&project("robots/seven_axes.urdf")).unwrap();
    let mut settings = Settings::new(20.0, 10).with_methods([Method::CLIE]);
    settings.parameters.fix = [("fv2".to_owned(), 1.5)].into();
    let error = Identification::new(&robot, Vec::new(), settings).err().unwrap().to_string();
    assert!(error.contains("methods is clie") && error.contains("[parameters] fix"), "{error}");
}
