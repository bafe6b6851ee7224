//! Sweeps behind moves.

use thetahat::{
    Series,
    base_parameters::BaseParameters,
    design::{Criterion, DesignError, Information},
    dynamics::{Model, Sign},
};
use thetahat_testing::Folder;

use super::collision::COLLISION;
use super::support::{DESIGN, assert_within_limits, key, parse};

/// Behind the moves each joint sweeps there and back, alone, at velocities of a geometric row that it keeps; friction is told better
/// than by moves alone of the same duration.
#[test]
fn sweeps_keep_their_velocities() {
    let kind = "kind = 'moves'\nmoves = 6\nstart = [0, 20]";
    let text = |more: &str| {
        DESIGN.replace("harmonics = 3", &format!("{kind}{more}")).replace("duration_s = 4", "duration_s = 16")
    };
    let design = parse(&text("\nsweeps = 3\nsweep_s = 0.8\nrest_s = 0.02")).unwrap();
    let results = design.run(2).unwrap();
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
    assert_eq!(design.run(1).unwrap().q, results.q);
    // The criterion counts the sweeps as the record will: all samples at which a joint moves.
    let model = Model::new(&design.robot);
    let base = BaseParameters::of(&model, &[]).unwrap();
    let rows_of = |joint: usize, samples: usize| {
        let kept: Vec<usize> = (0..samples).filter(|&k| results.dq.sample(k)[joint] != 0.0).collect();
        let pick = |s: &Series| Series::shaped(2, kept.iter().flat_map(|&k| s.sample(k).to_vec()).collect());
        let [q, dq, ddq] = [&results.q, &results.dq, &results.ddq].map(pick);
        let noise = if joint == 0 { [0.1, f64::INFINITY] } else { [f64::INFINITY, 0.1] };
        Information::new(&model, &base.columns(), &noise).of([&q, &dq, &ddq], 1.0, Sign::Exact)
    };
    let all = results.q.len();
    let value = Criterion::D.value(&rows_of(0, all).plus(&rows_of(1, all), 1.0)).unwrap();
    let moves_end = (sweeps[0].law.start_s * 500.0) as usize;
    let alone = Criterion::D.value(&rows_of(0, moves_end).plus(&rows_of(1, moves_end), 1.0)).unwrap();
    let found = results.starts[0].found;
    println!("criterion {found} of the search, {value} of the samples, {alone} of those of the moves");
    // The search sums at Gauss points and with a smoothed sign: within 2 % of each of 13 deviations. The sweeps tell more than that.
    assert!((value - found).abs() < 0.5 && value < alone - 2.0, "{value} {found} {alone}");
    let folder = Folder::new();
    thetahat_report::report::write_design(&results, folder.path()).unwrap();
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

/// Sweeps of the arm that hangs beside a wall.
fn beside_a_wall(start: &str, torque: &str) -> String {
    DESIGN
        .replace("harmonics = 3", &format!("kind = 'moves'\nmoves = 6\nsweeps = 2\nsweep_s = 0.8\nstart = {start}"))
        .replace("duration_s = 4", "duration_s = 14")
        .replace("torque = [60, 25]", &format!("torque = {torque}"))
        .replace("[noise]", &format!("{}\n[noise]", COLLISION.replace("[250, 0, 0]", "[420, 0, 0]")))
}

/// The shoulder sweeps as far as the wall leaves it room: the tip, 700 mm from the axis with a radius of 30 mm, keeps 20 mm from the wall
/// at 420 mm, and 4 mm more.
#[test]
fn a_sweep_ends_before_a_wall() {
    let design = parse(&beside_a_wall("[-85, 0]", "[60, 25]")).unwrap();
    let results = design.run(2).unwrap();
    assert_within_limits(&results);
    let ends: Vec<f64> = results.moves.as_ref().unwrap().moves()[6..10].iter().map(|m| m.end[0].to_degrees()).collect();
    let farthest = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let expected = -((420.0_f64 - 20.0 - 4.0 - 30.0) / 700.0).acos().to_degrees();
    println!("the shoulder sweeps to {farthest:.2} degrees of {expected:.2}");
    assert!(farthest <= expected && farthest > expected - 0.5, "{ends:?}, expected {expected}");
    assert!(results.collision.as_ref().unwrap().pairs.iter().all(|pair| pair.distance >= 0.02));
}

#[test]
fn sweeps_without_room_are_named() {
    // The outstretched arm is in the wall.
    let error = parse(&beside_a_wall("[0, 0]", "[60, 25]")).unwrap_err();
    let named = matches!(&*error, DesignError::NoRoomToSweep { joint, pair, .. } if joint == "shoulder" && pair == "elbow and wall");
    assert!(named && error.to_string().contains("from 0.0000 to 0.0000 degrees"), "{error}");
    // The elbow carries its forearm of 2.9 N m while the shoulder speeds up.
    let error = parse(&beside_a_wall("[-85, 0]", "[60, 2.5]")).unwrap().run(1).unwrap_err();
    let DesignError::Infeasible { joint, place, needed, .. } = &error else { panic!("{error}") };
    assert!(joint == "elbow" && needed.abs() > 2.5, "{error}");
    assert!(place.starts_with("in the sweep of shoulder at -") && place.ends_with("degrees"), "{error}");
    assert!(error.to_string().contains("choose another [motion] start, or a shorter sweep_s"), "{error}");
}
