//! Designs: what is refused, limits that hold, and promises that are kept.

use std::path::Path;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use thetahat::{
    Identification, Recording, Robot, Settings,
    base_parameters::BaseParameters,
    design::{Criterion, Design, DesignError, ExpectedRecord, Information},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    experiment::Experiment,
    preparation::PreparationError,
    reduction::ReduceOptions,
    results::{DesignResults, Limited, PromisedParameter},
    series::Series,
};
use thetahat_testing::{Folder, project};

/// A planar arm of two joints.
const DESIGN: &str = "title = 'two joints'\nrobot = 'two_joint.toml'\nduration_s = 4\nsample_rate_hz = 500\n\
    [motion]\nharmonics = 3\nstarts = 2\n\
    [limits]\nposition = [[-90, 90], [-120, 120]]\nvelocity = [250, 350]\nacceleration = [1500, 2000]\ntorque = [60, 25]\n\
    [noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 40\ndecimation = 10\n";

fn parse(text: &str) -> Result<Design, Box<DesignError>> {
    Design::parse(text, &project("robots/design.toml")).map_err(Box::new)
}

fn refused(from: &str, to: &str) -> Box<DesignError> {
    assert!(DESIGN.contains(from), "{from}");
    match parse(&DESIGN.replace(from, to)) {
        Err(error) => error,
        Ok(_) => panic!("{to} is taken"),
    }
}

/// The key of a value that is refused.
fn key(from: &str, to: &str) -> String {
    let error = refused(from, to);
    key_of(*error)
}

fn key_of(error: DesignError) -> String {
    let text = error.to_string();
    let DesignError::Preparation { source: PreparationError::Value { key, .. }, .. } = error else { panic!("{text}") };
    key
}

/// The samples of a design are within the limits that it names, and as large as it says.
fn assert_within_limits(results: &DesignResults) {
    for limit in &results.limits {
        let channel = |series: &Series| series.channel(limit.coordinate);
        let values = match limit.quantity {
            Limited::Position => channel(&results.q),
            Limited::Velocity => channel(&results.dq),
            Limited::Acceleration => channel(&results.ddq),
            Limited::Jerk => differences(&channel(&results.ddq), results.sample_rate_hz),
            Limited::Torque => channel(&results.torque),
            Limited::Power => {
                channel(&results.torque).iter().zip(channel(&results.dq)).map(|(tau, v)| tau * v).collect()
            }
        };
        let [least, most] = [f64::min, f64::max].map(|better| values.iter().copied().reduce(better).unwrap());
        let [lower, upper] = limit.limit;
        assert!(least >= lower && most <= upper, "{limit:?}: from {least} to {most}");
        let slack = 0.02 * (upper - lower);
        assert!(least >= limit.reached[0] - slack && most <= limit.reached[1] + slack, "{limit:?}: {least} {most}");
        assert!(least <= limit.reached[0] + slack && most >= limit.reached[1] - slack, "{limit:?}: {least} {most}");
    }
}

/// Mean slopes between samples.
fn differences(values: &[f64], rate_hz: f64) -> Vec<f64> {
    values.windows(2).map(|pair| (pair[1] - pair[0]) * rate_hz).collect()
}

#[test]
fn values_that_cannot_be_used_are_named() {
    assert_eq!(key("torque = 0.1", "torque = 0"), "[noise] torque");
    assert_eq!(key("torque = 0.1", "torque = [0.1]"), "[noise] torque");
    assert_eq!(key("torque = 0.1", ""), "[noise]");
    assert_eq!(key("torque = 0.1", "torque = 0.1\nresults = 'results.json'"), "[noise]");
    assert_eq!(key("duration_s = 4", "duration_s = 0.2"), "duration_s");
    assert_eq!(key("duration_s = 4", "duration_s = -1"), "duration_s");
    assert_eq!(key("velocity = [250, 350]", "velocity = [250, 350, 1]"), "[limits] velocity");
    assert_eq!(key("acceleration = [1500, 2000]", "acceleration = 0"), "[limits] acceleration");
    assert_eq!(key("harmonics = 3", "harmonics = 0"), "[motion] harmonics");
    assert_eq!(key("harmonics = 3", "harmonics = 3\nstart = [0]"), "[motion] start");
    assert_eq!(key("harmonics = 3", "harmonics = 3\nstart = [0, 121]"), "[motion] start");
    // In the file's units, and with what the margin of 2 % leaves.
    let error = refused("harmonics = 3", "harmonics = 3\nstart = [0, 119]").to_string();
    assert!(
        error.contains("[motion] start is 119, expected from -117.6000 to 117.6000 degrees for joint elbow"),
        "{error}"
    );
    assert_eq!(key("[noise]", "[wanted]\ncriterion = 'chosen'\n[noise]"), "[wanted] parameters");
}

#[test]
fn limits_that_contradict_are_named_with_their_joint() {
    let error = refused("[[-90, 90]", "[[90, -90]");
    assert!(matches!(&*error, DesignError::Contradiction { joint, .. } if joint == "shoulder"), "{error}");
    let error = refused("[-120, 120]", "[30, 30]");
    assert!(matches!(&*error, DesignError::Contradiction { joint, .. } if joint == "elbow"), "{error}");
    let text = error.to_string();
    assert!(text.contains("runs from 30.0000 to 30.0000 degrees") && text.contains("[locked]"), "{error}");
}

#[test]
fn a_robot_without_limits_needs_them() {
    for (limit, quantity) in [
        ("position = [[-90, 90], [-120, 120]]\n", "position"),
        ("velocity = [250, 350]\n", "velocity"),
        ("acceleration = [1500, 2000]\n", "acceleration"),
    ] {
        let error = refused(limit, "");
        assert!(matches!(&*error, DesignError::NoLimit { quantity: found, .. } if *found == quantity), "{error}");
    }
}

#[test]
fn what_is_no_design_is_refused_with_its_line() {
    let error = refused("harmonics = 3", "harmonic = 3");
    assert!(matches!(&*error, DesignError::Syntax { .. }) && error.to_string().contains("harmonic"), "{error}");
    assert!(matches!(Design::read(Path::new("nowhere.toml")), Err(DesignError::Unreadable { .. })));
    let error =
        parse(&DESIGN.replace("starts = 2", "starts = 2\n[wanted]\ncriterion = 'chosen'\nparameters = ['zz9']"));
    assert!(matches!(error.unwrap().run(1, &mut |_| {}), Err(DesignError::BaseParameters { .. })));
}

#[test]
fn a_torque_below_gravity_is_infeasible_and_named() {
    // The arm's own weight takes 9 N m of the shoulder.
    let design = parse(&DESIGN.replace("torque = [60, 25]", "torque = [0.5, 25]")).unwrap();
    let error = design.run(2, &mut |_| {}).unwrap_err();
    let named = matches!(&error, DesignError::Infeasible { joint, quantity: "torque", .. } if joint == "shoulder");
    assert!(named && error.to_string().contains("it is 0.5000 N m"), "{error}");
}

/// Limits hold at 1 kHz, the motion rests at both ends, and no number depends on the threads.
#[test]
fn limits_hold_and_the_motion_rests_at_both_ends() {
    let design = parse(DESIGN).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    let quantities: Vec<Limited> = results.limits.iter().filter(|l| l.coordinate == 1).map(|l| l.quantity).collect();
    assert_eq!(quantities, [Limited::Position, Limited::Velocity, Limited::Acceleration, Limited::Torque]);
    assert_eq!(results.limits[4].limit, [-120.0, 120.0].map(f64::to_radians));
    assert_within_limits(&results);
    assert!(results.limits.iter().any(|l| l.part > 0.9), "{:?}", results.limits);
    let last = results.q.len() - 1;
    for (series, tolerance) in [(&results.dq, 1e-9), (&results.ddq, 1e-8)] {
        assert!(series.sample(0).iter().chain(series.sample(last)).all(|v| v.abs() < tolerance));
    }
    assert!(results.q.sample(0).iter().zip(results.q.sample(last)).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
    assert_eq!(design.run(1, &mut |_| {}).unwrap().q, results.q);
}

/// Every criterion makes its own number smaller than the others do.
#[test]
fn each_criterion_serves_its_own_purpose() {
    let run = |wanted: &str| {
        let text = DESIGN.replace("[motion]", &format!("[wanted]\n{wanted}\n[motion]"));
        parse(&text).unwrap().run(2, &mut |_| {}).unwrap()
    };
    let deviation = |results: &thetahat::results::DesignResults, name: &str| {
        results.promised.iter().find(|p| p.name == name).map(|p| p.standard_deviation).unwrap()
    };
    let volume = run("criterion = 'd'");
    let chosen = run("criterion = 'chosen'\nparameters = ['fc1']");
    assert!(deviation(&chosen, "fc1") < 0.97 * deviation(&volume, "fc1"));
    let model = Model::new(&parse(DESIGN).unwrap().robot);
    let information = Information::new(&model, &BaseParameters::of(&model, &[]).unwrap().columns(), &[0.1, 0.1]);
    let of = |motion: [&Series; 3]| information.of(motion, 1.0, Sign::Exact);
    // Each parameter's unit changes the torques at random states by the noise, as in the design, but for its random numbers.
    let wave = |[one, other]: [f64; 2], w: f64| {
        let values = (0..1000).flat_map(|k| [one * (w * f64::from(k)).sin(), other * (1.7 * w * f64::from(k)).cos()]);
        Series::from_values(2, values.collect())
    };
    let states = [wave([1.5, 2.0], 0.37), wave([4.0, 6.0], 0.91), wave([26.0, 35.0], 1.33)];
    let m = of(states.each_ref());
    let weights: Vec<f64> = (0..m.rows()).map(|i| m.at(i, i)).collect();
    for (name, criterion) in
        [("a", Criterion::A { weights: weights.clone() }), ("worst", Criterion::Worst { weights: weights.clone() })]
    {
        let found = run(&format!("criterion = '{name}'"));
        assert_within_limits(&found);
        let [own, other] = [&found, &volume].map(|r| criterion.value(&of([&r.q, &r.dq, &r.ddq])).unwrap());
        println!("{name}: {own} of its own motion, {other} of that of d");
        assert!(own < other - 0.01, "{name}: {own} {other}");
    }
}

/// From starts near a limit each search finds a motion that is much better than the one that it began with.
#[test]
fn a_motion_may_start_near_a_limit() {
    for start in ["[0, 117]", "[-88, 117.5]"] {
        let text = DESIGN.replace("harmonics = 3\nstarts = 2", &format!("harmonics = 3\nstarts = 4\nstart = {start}"));
        let results = parse(&text).unwrap().run(2, &mut |_| {}).unwrap();
        assert_within_limits(&results);
        assert_eq!(results.starts.len(), 4);
        println!("{start}: {:?}", results.starts);
        assert!(results.starts.iter().all(|s| s.found < s.first - 4.0), "{start}: {:?}", results.starts);
        let text = results.q.sample(0).iter().map(|q| format!("{:.1}", q.to_degrees())).collect::<Vec<_>>().join(", ");
        assert!(start == "[0, 117]" && text == "0.0, 117.0" || text == "-88.0, 117.5", "{text}");
    }
}

#[test]
fn files_are_written_and_name_the_robot() {
    let (design, folder) = (parse(DESIGN).unwrap(), Folder::new());
    let results = design.run(2, &mut |_| {}).unwrap();
    let files = thetahat::report::write_design(&results, folder.path()).unwrap();
    assert_eq!(files.len(), thetahat::report::DESIGN_FILES.len());
    let trajectory = std::fs::read_to_string(folder.path().join("trajectory.csv")).unwrap();
    assert_eq!(trajectory.lines().count(), results.q.len() + 1);
    let yaml = std::fs::read_to_string(folder.path().join("trajectory.yaml")).unwrap();
    assert_eq!(yaml.lines().filter(|l| l.starts_with("- {positions: [")).count(), results.q.len());
    assert!(yaml.contains("joint_names: [\"shoulder\",\"elbow\"]"));
    // Three harmonics in 4 s: 0.75 Hz, and what the quintics add.
    assert!(results.spectrum.end_hz.iter().all(|hz| (0.5..3.0).contains(hz)), "{:?}", results.spectrum.end_hz);
    let page = std::fs::read_to_string(folder.path().join("design.html")).unwrap();
    for words in
        ["Frequencies of the motion", "the robot where it starts", "position filter 40", "shoulder: rad, s, N m"]
    {
        assert!(page.contains(words), "{words}");
    }
}

/// The design with its controller, whose loop is simulated.
fn with_controller() -> String {
    format!(
        "{DESIGN}[controller]\nlaw = 'pd'\nbandwidth_hz = [10]\ndamping = 1.0\nvelocity_feed_forward = 1.0\n\
         acceleration_feed_forward = 1.0\n"
    )
}

/// The twin of a design's rehearsal, in a folder beside the robot.
fn rehearsal(folder: &Folder, text: &str) -> (Design, thetahat::results::DesignResults, Experiment) {
    folder.write("two_joint.toml", std::fs::read(project("robots/two_joint.toml")).unwrap());
    let design = Design::parse(text, &folder.path().join("design.toml")).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    let out = folder.path().join("out");
    thetahat::report::write_design(&results, &out).unwrap();
    let experiment = Experiment::read(&out.join("rehearsal.toml"), Path::new("")).unwrap();
    (design, results, experiment)
}

/// The rehearsal is recorded with the noise of the design, of positions too; without a controller, under a usual one.
#[test]
fn a_rehearsal_has_the_noise_of_the_design() {
    let folder = Folder::new();
    let text = DESIGN.replace("torque = 0.1", "torque = 0.1\nposition = 0.01");
    let (_, promised, experiment) = rehearsal(&folder, &text);
    let (_, quiet, _) = rehearsal(&folder, DESIGN);
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    let run = results.runs.iter().find(|run| run.method.name() == promised.method).unwrap();
    let ratio = |other: &DesignResults| {
        let of = |p: &PromisedParameter| {
            let [low, high] = run.parameter(&p.name).unwrap().interval_95.unwrap();
            (0.5 * (high - low) / p.half_width_95).ln()
        };
        (other.promised.iter().map(of).sum::<f64>() / other.promised.len() as f64).exp()
    };
    let [of_own, of_quiet] = [ratio(&promised), ratio(&quiet)];
    println!(
        "intervals of the rehearsal {of_own:.2} times as wide as promised, {of_quiet:.2} without noise of positions"
    );
    assert!((0.75..1.33).contains(&of_own) && of_quiet > 2.0, "{of_own} {of_quiet}");
}

/// A noise that hides some parameters: a motion for them alone would show them better.
#[test]
fn what_stays_unknown_has_a_remedy() {
    let design = parse(&DESIGN.replace("torque = 0.1", "torque = 40")).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    let is_unknown = |p: &&PromisedParameter| p.a_priori != 0.0 && p.half_width_95 >= p.a_priori.abs();
    let unknown: Vec<&PromisedParameter> = results.promised.iter().filter(is_unknown).collect();
    let times: Vec<f64> = results.promised.iter().filter_map(|p| p.by_own_motion).collect();
    println!("{times:?}");
    assert!(!unknown.is_empty() && unknown.len() < results.promised.len());
    assert_eq!(times.len(), unknown.len());
    assert!(times.iter().map(|t| t.ln()).sum::<f64>() > 0.0, "{times:?}");
    let text = thetahat::report::design_text(&results, thetahat::report::TextWidth::DEFAULT);
    assert!(text.contains("What would show them") && text.contains(&format!("{} after", unknown[0].name)), "{text}");
}

/// Records of the Monte Carlo: the deviation of each estimate is then known to 3.5 %.
const RECORDS: u64 = 400;

/// The deviations of estimates from many records of the closed loop are those that were promised: within 15 % for 95 % of the
/// parameters.
#[test]
fn the_promise_is_kept_by_records_of_the_closed_loop() {
    let folder = Folder::new();
    let (design, results, experiment) = rehearsal(&folder, &with_controller());
    assert!(results.is_closed_loop);
    let motion = experiment.twin_motion(experiment.file.twin.as_ref().unwrap()).unwrap().motion;
    let record = ExpectedRecord {
        robot: &design.robot,
        settings: &design.settings,
        sample_rate_hz: 500.0,
        q: &motion.q,
        tau: &motion.tau,
        torque_noise: &[0.1, 0.1],
        torque_spectrum: None,
        position_noise: &[0.0, 0.0],
    };
    let path = Path::new("design.toml");
    let estimates: Vec<Vec<f64>> = (0..RECORDS).map(|k| record.estimate(path, 99, k).unwrap().fit.theta).collect();
    let n = RECORDS as f64;
    let mut kept = 0;
    for (i, promised) in results.promised.iter().enumerate() {
        let mean = estimates.iter().map(|e| e[i]).sum::<f64>() / n;
        let found = (estimates.iter().map(|e| (e[i] - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let ratio = found / promised.standard_deviation;
        println!(
            "{}: promised {:.3e}, found {found:.3e}, ratio {ratio:.3}",
            promised.name, promised.standard_deviation
        );
        kept += usize::from((ratio - 1.0).abs() < 0.15);
    }
    let all = results.promised.len();
    assert!(kept as f64 >= 0.95 * all as f64, "{kept} of {all}");
}

/// What a reduction tells is known: the same motion adds less to it, and another robot's is refused.
#[test]
fn recordings_at_hand_are_known_before() {
    let folder = Folder::new();
    let (_, alone, experiment) = rehearsal(&folder, &with_controller());
    let reduction = experiment.reduce(Path::new(""), ReduceOptions::default(), &mut |_| {}).unwrap();
    reduction.write(&folder.path().join("a.reduction")).unwrap();
    let text = with_controller().replace("[motion]", "prior = ['a.reduction']\n[motion]");
    let design = Design::parse(&text, &folder.path().join("design.toml")).unwrap();
    let both = design.run(2, &mut |_| {}).unwrap();
    // Twice the information in each of 13 directions is 13 log 2 = 9 nats; another motion adds more to what is known.
    let gain = alone.starts[0].found - both.starts[0].found;
    assert!((8.0..20.0).contains(&gain), "{gain}");
    // The motion of the design tells as much as the last one does once more, or more.
    let repeated = both.repeated.unwrap();
    assert!(both.starts[0].found < repeated + 1.0, "{} {repeated}", both.starts[0].found);
    let other = Design::parse(&text.replace("[signal]", "[parameters]\nexclude = ['off1']\n[signal]"), &design.path);
    assert!(matches!(other.unwrap().run(1, &mut |_| {}), Err(DesignError::OtherRobot { .. })));
    // The same names with another length between the axes.
    let longer = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    assert!(longer.contains("a_m = 0.4"));
    folder.write("longer.toml", longer.replace("a_m = 0.4", "a_m = 0.8"));
    let other = Design::parse(&text.replace("two_joint.toml", "longer.toml"), &design.path);
    assert!(matches!(other.unwrap().run(1, &mut |_| {}), Err(DesignError::OtherRobot { .. })));
}

/// A lift with two fingers, of which the right one follows the left one 1 mm ahead.
fn lift_and_fingers(more: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.1 0.02 0.03'/><mass value='2'/>\
             <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\n"
        )
    };
    let joint = |name: &str, [parent, child]: [&str; 2], [axis, upper]: [&str; 2], more: &str| {
        format!(
            "<joint name='{name}' type='prismatic'><parent link='{parent}'/><child link='{child}'/><axis xyz='{axis}'/>\
             <limit lower='0' upper='{upper}' velocity='0.2' effort='200'/><dynamics damping='5' friction='2'/>{more}</joint>\n"
        )
    };
    let follows = "<mimic joint='left' multiplier='1' offset='0.001'/>";
    format!(
        "<robot name='lift'>\n<link name='base'/>\n{}{}{}{}{}{}{more}</robot>\n",
        link("carriage"),
        link("left_finger"),
        link("right_finger"),
        joint("lift", ["base", "carriage"], ["0 0 1", "0.35"], ""),
        joint("left", ["carriage", "left_finger"], ["0 1 0", "0.04"], ""),
        joint("right", ["carriage", "right_finger"], ["0 -1 0", "0.04"], follows),
    )
}

/// Where a joint follows another, the limits of both hold.
#[test]
fn followers_hold_their_limits() {
    let folder = Folder::with("lift.urdf", lift_and_fingers(""));
    let text = "title = 'fingers'\nrobot = 'lift.urdf'\nduration_s = 4\nsample_rate_hz = 500\n[motion]\nharmonics = 3\nstarts = 1\n\
                [limits]\nacceleration = 3000\n[noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 20\ndecimation = 5\n";
    let design = Design::parse(text, &folder.path().join("design.toml")).unwrap();
    let results = design.run(1, &mut |_| {}).unwrap();
    let largest = (0..results.q.len()).map(|k| results.q.sample(k)[1]).fold(0.0, f64::max);
    assert!((0.03..=0.039).contains(&largest), "{largest}");
}

/// A lift, fingers and an arm on it, with limits of everything and a start off the middle.
#[test]
fn all_limits_of_a_lift_with_an_arm_hold() {
    let arm = "<link name='arm'><inertial><origin xyz='0.2 0.01 0.02'/><mass value='3'/>\
               <inertia ixx='0.02' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\n\
               <joint name='elbow' type='revolute'><parent link='carriage'/><child link='arm'/><axis xyz='0 1 0'/>\
               <limit lower='-1' upper='2' velocity='3' effort='40'/><dynamics damping='1' friction='0.5'/></joint>\n";
    let folder = Folder::with("lift.urdf", lift_and_fingers(arm));
    let text = |kind: &str| {
        format!(
            "title = 'lift'\nrobot = 'lift.urdf'\nduration_s = 4\nsample_rate_hz = 1000\n[motion]\n{kind}\nstarts = 2\n\
             start = [60, 10, 80]\n[limits]\nacceleration = [3000, 1500, 900]\njerk = [60000, 40000, 20000]\n\
             power = [40, 3, 12]\n[noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 20\ndecimation = 5\n"
        )
    };
    for kind in ["harmonics = 3", "kind = 'moves'\nmoves = 5"] {
        let design = Design::parse(&text(kind), &folder.path().join("design.toml")).unwrap();
        let results = design.run(2, &mut |_| {}).unwrap();
        assert_eq!(results.limits.len(), 18, "three joints with six limits");
        assert_within_limits(&results);
        println!("{kind}: {:?} {:?}", results.starts, results.limits.iter().map(|l| l.part).collect::<Vec<_>>());
        let start = results.q.sample(0);
        let expected = [0.06, 0.01, 80f64.to_radians()];
        assert!(start.iter().zip(expected).all(|(q, e)| (q - e).abs() < 1e-9), "{start:?}");
        assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
        let of_power = |l: &&thetahat::results::LimitUse| l.quantity == Limited::Power;
        assert!(results.limits.iter().filter(of_power).any(|l| l.part > 0.8), "{:?}", results.limits);
    }
}

/// What the identification of the record could not do is refused before the search.
#[test]
fn what_cannot_be_identified_is_refused() {
    let settings = |estimate: &str| format!("[parameters]\nestimate = {estimate}\n[signal]");
    assert_eq!(key("[signal]", &settings("'essential'")), "[parameters] estimate");
    assert_eq!(key("[signal]", &settings("['zz1r', 'fc1']")), "[parameters] estimate");
    assert_eq!(key("cutoff_hz = 40", "cutoff_hz = 260"), "[signal] cutoff_hz");
    assert_eq!(key("duration_s = 4", "duration_s = 4.0009"), "duration_s times sample_rate_hz");
    assert_eq!(
        key("duration_s = 4\nsample_rate_hz = 500", "duration_s = 2000\nsample_rate_hz = 100"),
        "duration_s times sample_rate_hz"
    );
    let robot = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    let term = "[[term]]\nkind = 'channel-viscous'\njoints = ['shoulder']\nchannel = 'temperature'\nreference = 20\n";
    let folder = Folder::with("two_joint.toml", format!("{robot}\n{term}"));
    let error = Design::parse(DESIGN, &folder.path().join("design.toml")).unwrap_err();
    assert_eq!(key_of(error), "[[term]]");
}

/// A planar arm that moves from posture to posture.
fn moves(jerk: &str) -> String {
    DESIGN.replace("harmonics = 3", "kind = 'moves'\nmoves = 6").replace("[noise]", &format!("{jerk}\n[noise]"))
}

#[test]
fn moves_hold_their_limits_and_end_where_they_start() {
    for jerk in ["", "jerk = 60000"] {
        let design = parse(&moves(jerk)).unwrap();
        let results = design.run(2, &mut |_| {}).unwrap();
        assert_within_limits(&results);
        assert!(results.limits.iter().any(|l| l.part > 0.9), "{:?}", results.limits);
        let moves = results.moves.as_ref().unwrap();
        assert_eq!((moves.moves().len(), &moves.moves()[5].end[..]), (6, moves.start()));
        assert!(moves.end_s() <= 4.0 + 1e-9);
        let last = results.q.len() - 1;
        assert!(results.q.sample(0).iter().zip(results.q.sample(last)).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
        assert_eq!(design.run(1, &mut |_| {}).unwrap().q, results.q);
    }
}

#[test]
fn moves_are_written_for_controllers() {
    let (design, folder) = (parse(&moves("")).unwrap(), Folder::new());
    let results = design.run(2, &mut |_| {}).unwrap();
    let files = thetahat::report::write_design(&results, folder.path()).unwrap();
    assert_eq!(files.len(), thetahat::report::DESIGN_FILES.len() + thetahat::report::MOVE_FILES.len());
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    for (file, start) in [
        ("moves.src", "  PTP {A1 "),
        ("moves.mod", "    MoveAbsJ [["),
        ("moves.script", "  movej(["),
        ("moves.val3", "  movej(j"),
    ] {
        assert_eq!(read(file).lines().filter(|line| line.starts_with(start)).count(), 7, "{file}");
    }
    // The first target in degrees and in rad, and speeds of the leading axis that are within the limits.
    let (first, moves) = (&results.moves.as_ref().unwrap().moves()[0], results.moves.as_ref().unwrap());
    let degrees = first.end[0].to_degrees();
    assert!(read("moves.src").contains(&format!("PTP {{A1 {degrees:.4}, A2 ")));
    assert!(read("moves.script").contains(&format!("movej([{:.6}, {:.6}], a=", first.end[0], first.end[1])));
    let seconds = first.law.t1_s + first.law.t2_s + first.law.t3_s;
    assert!(read("moves.mod").contains(&format!("\\T:={seconds:.4}, fine")));
    let json: serde_json::Value = serde_json::from_str(&read("moves.json")).unwrap();
    assert_eq!(json["moves"].as_array().unwrap().len(), moves.moves().len());
    let json: serde_json::Value = serde_json::from_str(&read("trajectory.json")).unwrap();
    assert_eq!(json["points"].as_array().unwrap().len(), results.q.len());
}

#[test]
fn keys_of_the_other_kind_of_motion_are_refused() {
    assert_eq!(key("harmonics = 3", "harmonics = 3\nmoves = 4"), "[motion] moves");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nharmonics = 3"), "[motion] harmonics");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nmoves = 1"), "[motion] moves");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nsmoothing_s = 0"), "[motion] smoothing_s");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nrest_s = 1"), "duration_s");
}

/// Capsules of the arm, whose joints are 0.4 m apart or so, and a wall beside it.
const COLLISION: &str = "[collision]\nmargin = 20\ncapsules = [{ link = 'shoulder', from = [0, 0, 0], to = [300, 0, 0], radius = 40 },\n\
    { link = 'elbow', from = [0, 0, 0], to = [300, 0, 0], radius = 30 }]\n\
    obstacles = [{ kind = 'plane', name = 'wall', point = [250, 0, 0], normal = [-1, 0, 0] }]\n";

fn with_collision(from: &str, to: &str) -> String {
    assert!(COLLISION.contains(from), "{from}");
    DESIGN.replace("[noise]", &format!("{}\n[noise]", COLLISION.replace(from, to)))
}

/// No sample at 1 kHz is nearer to the wall than the margin, by another way than the design's: points of the segments that
/// are tried.
#[test]
fn shapes_stay_apart() {
    let design = parse(&with_collision("[250, 0, 0]", "[420, 0, 0]")).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    let collision = results.collision.as_ref().unwrap();
    assert!(collision.pairs.iter().all(|pair| pair.distance >= 0.02), "{collision:?}");
    assert!(collision.pairs[0].distance < 0.03, "{collision:?}");
    assert!(!collision.has_way && collision.uncovered.is_empty());
    let least = collision.least.iter().map(|[_, distance]| *distance).fold(f64::INFINITY, f64::min);
    assert!(collision.least.len() == 4001 && least == collision.pairs[0].distance, "{least}");
    assert_eq!(design.run(1, &mut |_| {}).unwrap().q, results.q);
}

#[test]
fn shapes_that_cannot_be_used_are_named() {
    let key = |from: &str, to: &str| match parse(&with_collision(from, to)) {
        Err(error) => key_of(*error),
        Ok(_) => panic!("{to} is taken"),
    };
    assert_eq!(key("margin = 20", "margin = -1"), "[collision] margin");
    assert_eq!(key("margin = 20", "margin = 20\nhome = [0]"), "[collision] home");
    assert_eq!(key("margin = 20", "margin = 20\nignore = [['shoulder', 'floor']]"), "[collision] ignore");
    assert_eq!(key("link = 'elbow'", "link = 'hand'"), "[collision] capsules, the 2. link");
    assert_eq!(key("radius = 30", "radius = 0"), "[collision] capsules, the 2. radius");
    assert_eq!(key("normal = [-1, 0, 0]", "normal = [0, 0, 0]"), "[collision] obstacles, the 1. normal");
    let error = parse(&with_collision("kind = 'plane'", "kind = 'ball'")).unwrap_err();
    assert!(error.to_string().contains("ball"), "{error}");
}

/// A home behind the wall: the way from it is looked at too.
#[test]
fn the_way_from_home_is_covered() {
    let text = with_collision("[250, 0, 0]", "[420, 0, 0]");
    let design = parse(&text.replace("margin = 20", "margin = 20\nhome = [0, 0]")).unwrap();
    let error = design.run(2, &mut |_| {}).unwrap_err();
    assert!(
        matches!(&error, DesignError::TooNear { second, when, .. } if second == "wall" && when.contains("home")),
        "{error}"
    );
}

/// Results of an identification stand beside what is promised, and those of nothing like it are refused.
#[test]
fn results_at_hand_are_compared_with() {
    let folder = Folder::new();
    let (_, alone, experiment) = rehearsal(&folder, &with_controller());
    assert!(alone.compared.is_none() && alone.repeated.is_none());
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    folder.write("results.json", results.to_json().unwrap());
    let text = with_controller().replace("[motion]", "compare = 'results.json'\n[motion]");
    let design = Design::parse(&text, &folder.path().join("design.toml")).unwrap();
    let both = design.run(2, &mut |_| {}).unwrap();
    // The record is of the same motion and noise: its intervals are those that were promised, but for their own scatter.
    let times: Vec<f64> = both.promised.iter().filter_map(|p| p.times_smaller()).collect();
    assert_eq!(times.len(), both.promised.len());
    let mean = (times.iter().map(|t| t.ln()).sum::<f64>() / times.len() as f64).exp();
    assert!((0.8..1.25).contains(&mean), "{mean}");
    let text = thetahat::report::design_text(&both, thetahat::report::TextWidth::DEFAULT);
    assert!(text.contains("times as narrow"), "{text}");
    // The residual of that record is the noise of the design: a design with it promises the same.
    let with_noise = |file: &str| with_controller().replace("torque = 0.1", &format!("results = '{file}'"));
    let from_residual = Design::parse(&with_noise("results.json"), &design.path).unwrap().run(2, &mut |_| {}).unwrap();
    let ratio = |(a, b): (&PromisedParameter, &PromisedParameter)| (a.half_width_95 / b.half_width_95).ln();
    let mean = from_residual.promised.iter().zip(&alone.promised).map(ratio).sum::<f64>() / alone.promised.len() as f64;
    println!("with the noise of the residual {:.3} times as wide", mean.exp());
    assert!(mean.abs() < 0.15, "{mean}");
    folder.write("joints.json", results.to_json().unwrap().replace("\"elbow\"", "\"hand\""));
    let error = Design::parse(&with_noise("joints.json"), &design.path).unwrap_err();
    assert!(matches!(&error, DesignError::NoNoise { .. }) && error.to_string().contains("joints.json"), "{error}");
    let other = with_controller().replace("[motion]", "compare = 'nowhere.json'\n[motion]");
    let error = Design::parse(&other, &design.path).unwrap().run(1, &mut |_| {}).unwrap_err();
    assert!(matches!(&error, DesignError::Results(_)) && error.to_string().contains("nowhere.json"), "{error}");
}

/// B-splines rest at both ends within their limits, as Fourier series do, and a search makes them much better.
#[test]
fn splines_hold_their_limits_and_rest_at_both_ends() {
    let text = DESIGN.replace("harmonics = 3", "kind = 'splines'\nsplines = 8");
    let design = parse(&text.replace("[noise]", "jerk = 60000\n[noise]")).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    assert_within_limits(&results);
    let last = results.q.len() - 1;
    for series in [&results.dq, &results.ddq] {
        assert!(series.sample(0).iter().chain(series.sample(last)).all(|v| v.abs() < 1e-8));
    }
    assert!(results.q.sample(0).iter().zip(results.q.sample(last)).all(|(a, b)| (a - b).abs() < 1e-9));
    println!("{:?}", results.starts);
    assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
    assert!(results.limits.iter().any(|l| l.part > 0.9), "{:?}", results.limits);
    assert_eq!(key("harmonics = 3", "kind = 'splines'\nharmonics = 3"), "[motion] harmonics");
    assert_eq!(key("harmonics = 3", "splines = 8"), "[motion] splines");
    assert_eq!(key("harmonics = 3", "kind = 'splines'\nsplines = 1"), "[motion] splines");
    assert_eq!(key("harmonics = 3", "kind = 'splines'\nsplines = 8\nrest_s = 0.1"), "[motion] rest_s");
}

/// A point of 1.5 kg behind the elbow.
const PAYLOAD: &str = "[[payload]]\nname = 'disc'\njoint = 'elbow'\nmass_kg = 1.5\ncentre_m = [0.3, 0, 0]\n";

fn with_payload() -> String {
    format!("{DESIGN}{PAYLOAD}")
}

/// The torques of a motion by a robot.
fn torques(robot: &Robot, results: &DesignResults) -> Series {
    let model = Model::new(robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters());
    let (mut tau, mut workspace) = (Series::zeros(results.q.len(), 2), Workspace::new(&model));
    for k in 0..results.q.len() {
        let state = State::new(results.q.sample(k), results.dq.sample(k));
        let ddq = results.ddq.sample(k);
        model.inverse_dynamics(&parameters, state, ddq, Sign::Exact, &mut workspace, tau.sample_mut(k));
    }
    tau
}

/// The torques are those of an arm whose last link has the point mass in its own parameters, the limits hold with it and without
/// it, and the intervals are those of a record without it: what is known is taken off.
#[test]
fn a_payload_is_in_the_torques_and_not_in_the_intervals() {
    let design = parse(&with_payload()).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    assert_within_limits(&results);
    let mut text = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    for (own, loaded) in [
        ("m2 = 2", "m2 = 3.5"),
        ("mx2 = 0.3", "mx2 = 0.75"),
        ("yy2 = 0.07", "yy2 = 0.205"),
        ("zz2 = 0.07", "zz2 = 0.205"),
    ] {
        assert!(text.contains(own), "{own}");
        text = text.replace(own, loaded);
    }
    let loaded = torques(&Robot::parse(&text, Path::new("loaded.toml")).unwrap(), &results);
    let far = loaded.values().iter().zip(results.torque.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 1e-9, "{far}");
    let unloaded = torques(&design.robot, &results);
    let most = |tau: &Series, joint| tau.channel(joint).into_iter().map(f64::abs).fold(0.0, f64::max);
    for (joint, limit) in [(0, 60.0), (1, 25.0)] {
        assert!(most(&unloaded, joint) < limit && most(&loaded, joint) < limit);
        assert!((most(&loaded, joint) - most(&unloaded, joint)).abs() > 1.0);
    }
    let settings = Settings { payloads: Vec::new(), ..design.settings.clone() };
    let record = ExpectedRecord {
        robot: &design.robot,
        settings: &settings,
        sample_rate_hz: 500.0,
        q: &results.q,
        tau: &unloaded,
        torque_noise: &[0.1, 0.1],
        torque_spectrum: None,
        position_noise: &[0.0, 0.0],
    };
    let without = record.promise(Path::new("design.toml"), 1, 2).unwrap();
    for (with, half) in results.promised.iter().zip(&without.half_width_95) {
        assert!((with.half_width_95 / half - 1.0).abs() < 0.02, "{}: {} {half}", with.name, with.half_width_95);
    }
    let text = thetahat::report::design_text(&results, thetahat::report::TextWidth::DEFAULT);
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("Payload disc of 1.500 kg: limits hold with it and without it."), "{text}");
}

/// The gains of drives from many pairs of records, one with the payload and one without, scatter as it was promised.
#[test]
fn gains_are_promised_as_pairs_of_records_tell_them() {
    let design = parse(&with_payload()).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    let unloaded = torques(&design.robot, &results);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut noisy = |tau: &Series| {
        let noise = (0..tau.values().len()).map(|_| 0.1 * Distribution::<f64>::sample(&StandardNormal, &mut rng));
        Series::from_values(2, tau.values().iter().zip(noise).map(|(t, e)| t + e).collect())
    };
    let pairs = 40;
    let gains: Vec<Vec<f64>> = (0..pairs)
        .map(|_| {
            let record = |tau: Series| Recording::new(500.0, results.q.clone(), tau);
            let carried = Recording { payload: Some("disc".to_owned()), ..record(noisy(&results.torque)) };
            let recordings = vec![record(noisy(&unloaded)), carried];
            let found = Identification::new(&design.robot, recordings, design.settings.clone()).unwrap().run().unwrap();
            found.drive_gains.iter().map(|gain| gain.factor.unwrap()).collect()
        })
        .collect();
    let promised = &results.payload.as_ref().unwrap().gains;
    assert_eq!(promised.iter().map(|g| g.joint.as_str()).collect::<Vec<_>>(), ["shoulder", "elbow"]);
    for (joint, promised) in promised.iter().enumerate() {
        let mean = gains.iter().map(|g| g[joint]).sum::<f64>() / f64::from(pairs);
        let square = gains.iter().map(|g| (g[joint] - mean).powi(2)).sum::<f64>() / f64::from(pairs - 1);
        let found = 100.0 * 1.96 * square.sqrt();
        let half = promised.half_width_percent.unwrap();
        println!("{}: promised {half:.3} %, found {found:.3} %, mean {mean:.5}", promised.joint);
        assert!((found / half - 1.0).abs() < 0.35 && (mean - 1.0).abs() < 0.01 * half, "{half} {found} {mean}");
    }
}

/// The whole way with a payload: the twin carries it, and the experiment takes it off.
#[test]
fn a_rehearsal_carries_the_payload() {
    let folder = Folder::new();
    let (design, results, rehearsal) = rehearsal(&folder, &with_payload());
    let out = folder.path().join("out");
    thetahat::report::write_record(&rehearsal.record_twin().unwrap(), &out.join("recording.csv")).unwrap();
    let experiment = Experiment::read(&out.join("experiment.toml"), Path::new("")).unwrap();
    let found = experiment.run(&out, &mut |_| {}).unwrap();
    let run = found.runs.iter().find(|run| run.method.name() == results.method).unwrap();
    let holds = |p: &&PromisedParameter| {
        let [low, high] = run.parameter(&p.name).unwrap().interval_95.unwrap();
        (low..=high).contains(&p.a_priori)
    };
    let kept = results.promised.iter().filter(holds).count();
    assert!(kept + 2 >= results.promised.len(), "{kept} of {}", results.promised.len());
    assert!(run.parameter("mx2").is_some_and(|p| (p.estimate - 0.3).abs() < 0.05), "the payload is taken off");
    assert_eq!(design.settings.payloads.len(), 1);
}

#[test]
fn payloads_that_cannot_be_carried_are_refused() {
    let key = |from: &str, to: &str| {
        let text = with_payload();
        assert!(text.contains(from), "{from}");
        key_of(*parse(&text.replace(from, to)).unwrap_err())
    };
    assert_eq!(key("mass_kg = 1.5\ncentre_m = [0.3, 0, 0]\n", ""), "[[payload]] disc: mass_kg");
    assert_eq!(key("joint = 'elbow'", "joint = 'hand'"), "[[payload]] disc: joint");
    assert_eq!(key("[[payload]]", &format!("{}[[payload]]", PAYLOAD.replace("disc", "other"))), "[[payload]]");
    assert_eq!(
        key("[[payload]]", "[estimation]\nmethods = ['idim-ls', 'idim-iv']\n[[payload]]"),
        "[estimation] methods"
    );
}

/// Torques hold for robots that are 30 % heavier here or there: those of the expected one stay as much smaller.
#[test]
fn torques_hold_for_robots_that_are_drawn() {
    let text = DESIGN.replace("torque = [60, 25]", "torque = [22, 6]");
    let most = |results: &DesignResults, joint| {
        let uses = results.limits.iter().find(|l| l.coordinate == joint && l.quantity == Limited::Torque).unwrap();
        let own = results.torque.channel(joint).into_iter().map(f64::abs).fold(0.0, f64::max);
        (own, uses.reached[1].max(-uses.reached[0]))
    };
    let alone = parse(&text).unwrap().run(2, &mut |_| {}).unwrap();
    let uncertain = text.replace("[noise]", "[uncertainty]\ndraws = 12\npercent = 30\n[noise]");
    let drawn = parse(&uncertain).unwrap().run(2, &mut |_| {}).unwrap();
    for (joint, limit) in [(0, 22.0), (1, 6.0)] {
        let ((own, reached), (own_alone, reached_alone)) = (most(&drawn, joint), most(&alone, joint));
        println!("joint {joint}: {own:.3} of {reached:.3} N m, {own_alone:.3} without draws");
        assert!(reached <= limit && (reached_alone - own_alone).abs() < 0.02 * limit);
        // No parameter is more than 30 % larger, so that no torque is.
        assert!(own < 0.9 * reached && reached <= 1.3 * own * 1.02, "{own} {reached}");
    }
    assert!(drawn.starts[0].found > alone.starts[0].found + 0.5, "room that is kept costs information");
    let text = thetahat::report::design_text(&drawn, thetahat::report::TextWidth::DEFAULT);
    assert!(text.contains("12 robots"), "{text}");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 12\n[noise]"), "[uncertainty] draws");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 2\npercent = 100\n[noise]"), "[uncertainty] percent");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 101\npercent = 5\n[noise]"), "[uncertainty] draws");
}

/// An experiment is identified, and its intervals stand beside those that are promised as those of its results do.
#[test]
fn an_experiment_at_hand_is_compared_with() {
    let folder = Folder::new();
    let (design, _, experiment) = rehearsal(&folder, &with_controller());
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    folder.write("results.json", results.to_json().unwrap());
    let with = |file: &str| {
        let text = with_controller().replace("[motion]", &format!("compare = '{file}'\n[motion]"));
        Design::parse(&text, &design.path).unwrap()
    };
    let of_results = with("results.json").run(2, &mut |_| {}).unwrap();
    let of_experiment = with("out/rehearsal.toml");
    assert!(of_experiment.input_files().iter().any(|file| file.ends_with("out/trajectory.csv")));
    let of_experiment = of_experiment.run(2, &mut |_| {}).unwrap();
    assert_eq!(of_experiment.compared, of_results.compared);
    for (a, b) in of_experiment.promised.iter().zip(&of_results.promised) {
        assert!(a.compared.is_some() && a.times_smaller() == b.times_smaller(), "{}", a.name);
    }
    let out = folder.path().join("page");
    thetahat::report::write_design(&of_experiment, &out).unwrap();
    let page = std::fs::read_to_string(out.join("design.html")).unwrap();
    assert!(page.contains("promised interval") && page.contains("of two joints"), "the legend of both");
    let error = with("nowhere.toml").run(1, &mut |_| {}).unwrap_err();
    assert!(matches!(&error, DesignError::Experiment(_)) && error.to_string().contains("nowhere.toml"), "{error}");
}

/// Behind the moves each joint sweeps there and back, alone, at velocities of a geometric row that it keeps; friction is told better
/// than by moves alone of the same duration.
#[test]
fn sweeps_keep_their_velocities() {
    let kind = "kind = 'moves'\nmoves = 6\nstart = [0, 20]";
    let text = |more: &str| {
        DESIGN.replace("harmonics = 3", &format!("{kind}{more}")).replace("duration_s = 4", "duration_s = 16")
    };
    let design = parse(&text("\nsweeps = 3\nsweep_s = 0.8\nrest_s = 0.02")).unwrap();
    let results = design.run(2, &mut |_| {}).unwrap();
    assert_within_limits(&results);
    let moves = results.moves.as_ref().unwrap();
    assert_eq!(moves.moves().len(), 6 + 2 * 2 * 3);
    let sweeps = &moves.moves()[6..];
    let speed_of = |number: usize| {
        let joint = number / 6;
        let (from, to) = (&moves.moves()[5 + number].end, &sweeps[number].end);
        assert_eq!(from[1 - joint], to[1 - joint], "the other joint rests");
        (to[joint] - from[joint]) / sweeps[number].law.t1_s
    };
    for joint in 0..2 {
        let speeds: Vec<f64> = (0..6).map(|i| speed_of(6 * joint + i)).collect();
        assert!(speeds.chunks(2).all(|pair| (pair[0] + pair[1]).abs() < 1e-12), "there and back: {speeds:?}");
        let row = [speeds[2] / speeds[0], speeds[4] / speeds[2]];
        assert!(row.iter().all(|ratio| (ratio - 20f64.sqrt()).abs() < 1e-9), "{speeds:?}");
        // In the samples too: half of the way or more is at this velocity.
        let law = sweeps[6 * joint + 4].law;
        let [first, last] = [law.start_s + law.t2_s + law.t3_s, law.start_s + law.t1_s].map(|t| (500.0 * t) as usize);
        assert!(last > first + 50);
        for k in first + 1..last {
            assert!((results.dq.sample(k)[joint] - speeds[4]).abs() < 1e-9 && results.dq.sample(k)[1 - joint] == 0.0);
        }
    }
    let last = results.q.len() - 1;
    assert!(results.q.sample(last).iter().zip([0.0, 20f64.to_radians()]).all(|(a, b)| (a - b).abs() < 1e-9));
    assert_eq!(design.run(1, &mut |_| {}).unwrap().q, results.q);
    // The criterion counts the sweeps as the record will: all samples at which a joint moves.
    let model = Model::new(&design.robot);
    let base = BaseParameters::of(&model, &[]).unwrap();
    let rows_of = |joint: usize| {
        let kept: Vec<usize> = (0..results.q.len()).filter(|&k| results.dq.sample(k)[joint] != 0.0).collect();
        let pick = |s: &Series| Series::from_values(2, kept.iter().flat_map(|&k| s.sample(k).to_vec()).collect());
        let [q, dq, ddq] = [&results.q, &results.dq, &results.ddq].map(pick);
        let noise = if joint == 0 { [0.1, f64::INFINITY] } else { [f64::INFINITY, 0.1] };
        Information::new(&model, &base.columns(), &noise).of([&q, &dq, &ddq], 1.0, Sign::Exact)
    };
    let value = Criterion::D.value(&rows_of(0).plus(&rows_of(1), 1.0)).unwrap();
    println!("criterion {} of the search, {value} of the samples", results.starts[0].found);
    assert!((value - results.starts[0].found).abs() < 0.2, "{value} {}", results.starts[0].found);
    let folder = Folder::new();
    thetahat::report::write_design(&results, folder.path()).unwrap();
    let page = std::fs::read_to_string(folder.path().join("design.html")).unwrap();
    assert!(results.sweeps == 12 && page.contains("6 moves and 12 sweeps"));
}

#[test]
fn sweeps_that_cannot_be_made_are_refused() {
    let moves = |more: &str| format!("kind = 'moves'\nmoves = 6\nstart = [0, 20]\n{more}");
    assert_eq!(key("harmonics = 3", "harmonics = 3\nsweeps = 2"), "[motion] sweeps");
    assert_eq!(key("harmonics = 3", &moves("sweeps = 21")), "[motion] sweeps");
    assert_eq!(key("harmonics = 3", &moves("sweep_s = 1")), "[motion] sweeps");
    assert_eq!(key("harmonics = 3", &moves("sweeps = 2").replace("start = [0, 20]", "")), "[motion] start");
    assert_eq!(key("harmonics = 3", &moves("sweeps = 2\nsweep_slowest = 0")), "[motion] sweep_slowest");
    assert_eq!(key("harmonics = 3", &moves("sweeps = 2\nsweep_s = 0")), "[motion] sweep_s");
    assert_eq!(key("harmonics = 3", &moves("sweeps = 4")), "duration_s");
}
