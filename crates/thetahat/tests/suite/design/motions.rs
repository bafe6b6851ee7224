//! Kinds of motions and criteria, and the files that are written of them.

use thetahat::{
    Series,
    base_parameters::BaseParameters,
    design::{Criterion, Information},
    dynamics::{Model, Sign},
};
use thetahat_testing::Folder;

use super::support::{DESIGN, assert_within_limits, key, moves, parse};

/// Every criterion makes its own number smaller than the others do.
#[test]
fn each_criterion_serves_its_own_purpose() {
    let run = |wanted: &str| {
        let text = DESIGN.replace("[motion]", &format!("[wanted]\n{wanted}\n[motion]"));
        parse(&text).unwrap().run(2).unwrap()
    };
    let deviation = |results: &thetahat::results::DesignResults, name: &str| {
        results.predicted.iter().find(|p| p.name == name).map(|p| p.standard_deviation).unwrap()
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
        Series::shaped(2, values.collect())
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

/// B-splines rest at both ends within their limits, as Fourier series do, and a search makes them much better.
#[test]
fn splines_hold_their_limits_and_rest_at_both_ends() {
    let text = DESIGN.replace("harmonics = 3", "kind = 'splines'\nsplines = 8");
    let design = parse(&text.replace("[noise]", "jerk = 60000\n[noise]")).unwrap();
    let results = design.run(2).unwrap();
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

#[test]
fn moves_hold_their_limits_and_end_where_they_start() {
    for jerk in ["", "jerk = 60000"] {
        let design = parse(&moves(jerk)).unwrap();
        let results = design.run(2).unwrap();
        assert_within_limits(&results);
        assert!(results.limits.iter().any(|l| l.part > 0.9), "{:?}", results.limits);
        let moves = results.moves.as_ref().unwrap();
        assert_eq!((moves.moves().len(), &moves.moves()[5].end[..]), (6, moves.start()));
        assert!(moves.end_s() <= 4.0 + 1e-9);
        let last = results.q.len() - 1;
        assert!(results.q.sample(0).iter().zip(results.q.sample(last)).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
        assert_eq!(design.run(1).unwrap().q, results.q);
    }
}

#[test]
fn files_are_written_and_name_the_robot() {
    let (design, folder) = (parse(DESIGN).unwrap(), Folder::new());
    let results = design.run(2).unwrap();
    let files = thetahat_report::report::write_design(&results, folder.path()).unwrap();
    assert_eq!(files.len(), thetahat_report::report::DESIGN_FILES.len() + thetahat_report::report::POINT_FILES.len());
    let trajectory = std::fs::read_to_string(folder.path().join("trajectory.csv")).unwrap();
    assert_eq!(trajectory.lines().count(), results.q.len() + 1);
    let yaml = std::fs::read_to_string(folder.path().join("trajectory.yaml")).unwrap();
    assert_eq!(yaml.lines().filter(|l| l.starts_with("- {positions: [")).count(), results.q.len());
    assert!(yaml.contains("joint_names: [\"shoulder\",\"elbow\"]"));
    // Three harmonics in 4 s: 0.75 Hz, and what the quintics add.
    assert!(results.spectrum.end_hz.iter().all(|hz| (0.5..3.0).contains(hz)), "{:?}", results.spectrum.end_hz);
    let page = std::fs::read_to_string(folder.path().join("design.html")).unwrap();
    for words in ["Frequencies of the motion", "the robot at its start", "position filter 40", "shoulder: rad, s, N m"]
    {
        assert!(page.contains(words), "{words}");
    }
}

/// Percentages are of the controller's rated velocities: half of them where these are twice the limits.
#[test]
fn percentages_are_of_rated_values() {
    let percents = |rated: &str| -> Vec<f64> {
        let (design, folder) = (parse(&(moves("") + rated)).unwrap(), Folder::new());
        thetahat_report::report::write_design(&design.run(2).unwrap(), folder.path()).unwrap();
        let text = std::fs::read_to_string(folder.path().join("moves.src")).unwrap();
        let percent = |line: &str| line.trim().strip_prefix("BAS(#VEL_PTP, ")?.trim_end_matches(')').parse().ok();
        text.lines().filter_map(percent).skip(1).collect()
    };
    let of_limits = percents("[rated]\nvelocity = [250, 350]\n");
    let of_rated = percents("[rated]\nvelocity = [500, 700]\n");
    assert!(!of_limits.is_empty() && of_limits.len() == of_rated.len());
    let is_half = |(whole, half): (&f64, &f64)| (0.5 * whole - half).abs() <= 1.0;
    assert!(of_limits.iter().zip(&of_rated).all(is_half), "{of_limits:?} {of_rated:?}");
}

/// What the prediction is of, and what is not checked, is said and written.
#[test]
fn a_design_says_what_it_does_not_check() {
    let results = parse(DESIGN).unwrap().run(2).unwrap();
    assert!(results.experiment.settings.contains("idim-iv = \"per-joint\""), "{}", results.experiment.settings);
    let shown = thetahat_report::report::design_text(&results, thetahat_report::report::TextWidth::default());
    assert!(shown.contains("Not checked: whether the robot touches"), "{shown}");
    let without: Vec<&str> = results.without_friction.iter().map(String::as_str).collect();
    assert_eq!(shown.contains("executed torques will be larger"), !without.is_empty(), "{shown}");
}

#[test]
fn moves_are_written_for_controllers() {
    let (design, folder) = (parse(&moves("")).unwrap(), Folder::new());
    let results = design.run(2).unwrap();
    let files = thetahat_report::report::write_design(&results, folder.path()).unwrap();
    assert_eq!(files.len(), thetahat_report::report::DESIGN_FILES.len() + thetahat_report::report::MOVE_FILES.len());
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
