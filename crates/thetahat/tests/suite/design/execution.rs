//! What a controller makes of a motion, and what it is led by.

use thetahat::results::DesignResults;
use thetahat_report::{
    report::{TextWidth, design_text, write_design},
    results::LimitUse,
};
use thetahat_testing::Folder;

use super::support::{DESIGN, key, moves, parse, with_controller};

fn largest(uses: &[LimitUse]) -> f64 {
    uses.iter().map(|used| used.part).fold(0.0, f64::max)
}

fn shown(results: &DesignResults) -> String {
    design_text(results, TextWidth::DEFAULT).replace('\n', " ")
}

fn run(text: &str) -> DesignResults {
    parse(text).unwrap().run(2).unwrap()
}

/// A loop that overshoots keeps velocities and torques within their limits, which the motion then uses less.
#[test]
fn limits_hold_in_the_loop_of_a_stated_controller() {
    let underdamped = with_controller().replace("damping = 1.0", "damping = 0.25").replace("[10]", "[4]");
    for text in [with_controller(), underdamped] {
        let results = run(&text);
        let [designed, executed] = [&results.limits, &results.executed.uses].map(|uses| largest(uses));
        println!("designed {designed:.4}, executed {executed:.4}");
        assert!(results.executed.is_stated && executed <= 1.0 && executed > 0.5 && designed <= 1.0);
        let shown = shown(&results);
        assert!(shown.contains("Simulated once under the controller, the robot stays within"), "{shown}");
    }
}

/// Without a controller a usual one is assumed, and said to be.
#[test]
fn an_assumed_controller_is_named() {
    let results = run(DESIGN);
    assert!(!results.executed.is_stated && results.executed.uses.len() == 4, "{:?}", results.executed);
    let shown = shown(&results);
    assert!(shown.contains("a usual PD loop of 10 Hz, since [controller] is missing"), "{shown}");
}

/// Accelerations of moves rise over 50 ms, or a twentieth of a move, where no jerk is stated.
#[test]
fn corners_of_moves_are_limited_in_jerk() {
    let results = run(&moves(""));
    let shortest = results.moves.as_ref().unwrap().moves().iter().map(|m| m.law.t3_s).fold(f64::INFINITY, f64::min);
    // Six moves in 4 s: a twentieth is 33 ms.
    assert!((shortest - 4.0 / 6.0 / 20.0).abs() < 1e-9, "{shortest}");
}

/// Points are the motion itself at another rate, in degrees in the table and in rad in the program.
#[test]
fn points_are_the_motion_at_a_stated_rate() {
    let results = run(&DESIGN.replace("sample_rate_hz = 500", "sample_rate_hz = 500\npoints_hz = 100"));
    let folder = Folder::new();
    write_design(&results, folder.path()).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let table: Vec<Vec<f64>> = read("points.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|value| value.parse().unwrap()).collect())
        .collect();
    assert_eq!(table.len(), 401);
    for (k, row) in table.iter().enumerate() {
        let q = results.q.sample(5 * k);
        assert!((row[0] - 0.01 * k as f64).abs() < 1e-9);
        assert!(row[1..].iter().zip(q).all(|(degrees, q)| (degrees.to_radians() - q).abs() < 1e-7), "{k}");
    }
    let script = read("points.script");
    assert_eq!(script.lines().filter(|line| line.starts_with("  servoj([")).count(), 400);
    assert!(script.contains("  t = 0.01\n") && script.ends_with("  stopj(0.5)\nend\n"));
    let json: serde_json::Value = serde_json::from_str(&read("trajectory.json")).unwrap();
    assert_eq!(json["points"].as_array().unwrap().len(), 401);
    assert_eq!(key("sample_rate_hz = 500", "sample_rate_hz = 500\npoints_hz = 0"), "points_hz");
}
