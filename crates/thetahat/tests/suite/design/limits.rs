//! Limits that hold, of joints that turn, slide and follow.

use thetahat::{
    design::{Design, DesignError},
    results::DesignResults,
};
use thetahat_report::results::Limited;
use thetahat_testing::Folder;

use super::support::{DESIGN, assert_within_limits, key, parse};

#[test]
fn a_torque_below_gravity_is_infeasible_and_named() {
    // The arm's own weight takes 9 N m of the shoulder.
    let design = parse(&DESIGN.replace("torque = [60, 25]", "torque = [0.5, 25]")).unwrap();
    let error = design.run(2).unwrap_err();
    let named = matches!(&error, DesignError::Infeasible { joint, quantity: "torque", .. } if joint == "shoulder");
    assert!(named && error.to_string().contains("0.5000 N m and the motion needs"), "{error}");
}

/// Limits hold at 1 kHz, the motion rests at both ends, and no number depends on the threads.
#[test]
fn limits_hold_and_the_motion_rests_at_both_ends() {
    let design = parse(DESIGN).unwrap();
    let results = design.run(2).unwrap();
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
    assert_eq!(design.run(1).unwrap().q, results.q);
}

/// From starts near a limit each search finds a motion that is much better than the one that it began with.
#[test]
fn a_motion_may_start_near_a_limit() {
    for start in ["[0, 117]", "[-88, 117.5]"] {
        let text = DESIGN.replace("harmonics = 3\nstarts = 2", &format!("harmonics = 3\nstarts = 4\nstart = {start}"));
        let results = parse(&text).unwrap().run(2).unwrap();
        assert_within_limits(&results);
        assert_eq!(results.starts.len(), 4);
        println!("{start}: {:?}", results.starts);
        assert!(results.starts.iter().all(|s| s.found < s.first - 4.0), "{start}: {:?}", results.starts);
        let text = results.q.sample(0).iter().map(|q| format!("{:.1}", q.to_degrees())).collect::<Vec<_>>().join(", ");
        assert!(start == "[0, 117]" && text == "0.0, 117.0" || text == "-88.0, 117.5", "{text}");
    }
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
    let results = design.run(1).unwrap();
    let largest = (0..results.q.len()).map(|k| results.q.sample(k)[1]).fold(0.0, f64::max);
    assert!((0.03..=0.039).contains(&largest), "{largest}");
}

/// A lift, fingers and an arm on it, with limits of everything and a start off the middle.
#[test]
#[ignore = "long, each night"]
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
             power = [40, 3, 12]\n[uncertainty]\nfriction_percent = 0\nmotor_inertia_percent = 0\n[noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 20\ndecimation = 5\n"
        )
    };
    for kind in ["harmonics = 3", "kind = 'moves'\nmoves = 5"] {
        let design = Design::parse(&text(kind), &folder.path().join("design.toml")).unwrap();
        let results = design.run(2).unwrap();
        assert_eq!(results.limits.len(), 18, "three joints with six limits");
        assert_within_limits(&results);
        println!("{kind}: {:?} {:?}", results.starts, results.limits.iter().map(|l| l.part).collect::<Vec<_>>());
        let start = results.q.sample(0);
        let expected = [0.06, 0.01, 80f64.to_radians()];
        assert!(start.iter().zip(expected).all(|(q, e)| (q - e).abs() < 1e-9), "{start:?}");
        assert!(results.starts.iter().all(|s| s.found < s.first - 1.0), "{:?}", results.starts);
        let of_power = |l: &&thetahat_report::results::LimitUse| l.quantity == Limited::Power;
        assert!(results.limits.iter().filter(of_power).any(|l| l.part > 0.8), "{:?}", results.limits);
    }
}

/// A description without friction: torques hold with friction of 30 % of their limits at the largest velocities as well, by a formula
/// that shares nothing with the library's.
#[test]
fn torques_hold_with_friction_that_the_description_lacks() {
    let folder = Folder::with("lift.urdf", lift_and_fingers("").replace("<dynamics damping='5' friction='2'/>", ""));
    let text = "title = 'lift'\nrobot = 'lift.urdf'\nduration_s = 4\nsample_rate_hz = 1000\n[motion]\nharmonics = 3\nstarts = 2\n\
                [limits]\nacceleration = [3000, 1500]\ntorque = [80, 20]\n[uncertainty]\nmotor_inertia_percent = 0\n\
                [noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 20\ndecimation = 5\n";
    let most = |text: &str| {
        let results = Design::parse(text, &folder.path().join("design.toml")).unwrap().run(2).unwrap();
        assert_eq!(results.without_friction, ["lift", "left"]);
        let (tau, dq) = (results.torque.channel(0), results.dq.channel(0));
        let executed = |(tau, dq): (&f64, &f64)| (tau + 0.15 * 80.0 * (dq.signum() + dq / 0.2)).abs();
        tau.iter().zip(&dq).map(executed).fold(0.0, f64::max)
    };
    let without = text.replace("[uncertainty]\n", "[uncertainty]\nfriction_percent = 0\n");
    let (with, without) = (most(text), most(&without));
    assert!(with <= 80.0 && without > 80.0, "{with} {without}");
}

/// A motion that is repeated, to the digit, within the same limits and with as much information in each period.
#[test]
fn a_motion_is_repeated_in_its_periods() {
    let once = parse(&DESIGN.replace("duration_s = 4", "duration_s = 2")).unwrap();
    let twice = parse(&DESIGN.replace("[motion]", "[motion]\nperiods = 2")).unwrap();
    let [once, twice] = [once, twice].map(|design| design.run(2).unwrap());
    assert_within_limits(&twice);
    let half = once.q.len() - 1;
    assert_eq!(twice.q.len(), 2 * half + 1);
    let difference = |k: usize| (twice.q.sample(k)[0] - twice.q.sample(k + half)[0]).abs();
    assert!((0..=half).all(|k| difference(k) < 1e-12), "{:?}", (0..=half).map(difference).fold(0.0, f64::max));
    // Twice the information on as many parameters: the criterion falls by their number times log 2.
    let [one, two] = [&once, &twice].map(|results| results.starts[0].found);
    let gain = (one - two) / 2f64.ln();
    assert!((gain - once.predicted.len() as f64).abs() < 1e-6, "{gain}");
}

/// Torques hold for robots that are 30 % heavier here or there: those of the expected one stay as much smaller.
#[test]
#[ignore = "long, each night"]
fn torques_hold_for_robots_that_are_drawn() {
    let text = DESIGN.replace("torque = [60, 25]", "torque = [22, 6]");
    let most = |results: &DesignResults, joint| {
        let uses = results.limits.iter().find(|l| l.coordinate == joint && l.quantity == Limited::Torque).unwrap();
        let own = results.torque.channel(joint).into_iter().map(f64::abs).fold(0.0, f64::max);
        (own, uses.reached[1].max(-uses.reached[0]))
    };
    let alone = parse(&text).unwrap().run(2).unwrap();
    let uncertain = text.replace("[noise]", "[uncertainty]\ndraws = 12\npercent = 30\n[noise]");
    let drawn = parse(&uncertain).unwrap().run(2).unwrap();
    for (joint, limit) in [(0, 22.0), (1, 6.0)] {
        let ((own, reached), (own_alone, reached_alone)) = (most(&drawn, joint), most(&alone, joint));
        println!("joint {joint}: {own:.3} of {reached:.3} N m, {own_alone:.3} without draws");
        assert!(reached <= limit && (reached_alone - own_alone).abs() < 0.02 * limit);
        // No parameter is more than 30 % larger, so that no torque is.
        assert!(own < 0.9 * reached && reached <= 1.3 * own * 1.02, "{own} {reached}");
    }
    assert!(drawn.starts[0].found > alone.starts[0].found + 0.5, "room that is kept costs information");
    let text = thetahat_report::report::design_text(&drawn, thetahat_report::report::TextWidth::DEFAULT);
    assert!(text.contains("12 random"), "{text}");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 12\n[noise]"), "[uncertainty] draws");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 2\npercent = 100\n[noise]"), "[uncertainty] percent");
    assert_eq!(key("[noise]", "[uncertainty]\ndraws = 101\npercent = 5\n[noise]"), "[uncertainty] draws");
}
