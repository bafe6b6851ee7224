//! Windows that reach the ends of a recording that moves there.

use std::path::Path;

use thetahat::{Identification, Method, Recording, Results, Robot, Series, Settings};

const ROBOT: &str = "name = 'joint'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
const RATE: f64 = 500.0;
const SAMPLES: usize = 5000;
/// Of an estimate, relative: 6.5e-4 is found up to the ends, and 0.32 where the distorted samples are in the window.
const LARGEST_ERROR: f64 = 2e-3;
/// zz1r, fv1, fc1, off1.
const TRUTH: [f64; 4] = [0.7, 3.0, 1.5, 0.2];

/// Two sines without noise, which start and end with an acceleration.
fn recording() -> Recording {
    let (mut q, mut tau) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        let t = k as f64 / RATE + 0.1;
        let (w, v) = (4.0, 11.0);
        q.push((w * t).sin() + 0.3 * (v * t).cos());
        let dq = w * (w * t).cos() - 0.3 * v * (v * t).sin();
        let ddq = -w * w * (w * t).sin() - 0.3 * v * v * (v * t).cos();
        tau.push(TRUTH[0] * ddq + TRUTH[1] * dq + TRUTH[2] * dq.signum() + TRUTH[3]);
    }
    Recording::new(RATE, Series::shaped(1, q), Series::shaped(1, tau))
}

fn identified(start_s: f64, end_s: f64) -> Results {
    let robot = Robot::parse(ROBOT, Path::new("joint.toml")).unwrap();
    let mut settings = Settings::new(10.0, 10);
    (settings.signal.window_start_s, settings.signal.window_end_s) = (Some(start_s), Some(end_s));
    Identification::new(&robot, vec![recording()], settings).unwrap().run().unwrap()
}

/// The position filter takes the acceleration at the ends for zero: two periods of the cut-off, 0.2 s, are left out there.
#[test]
fn a_window_up_to_the_ends_gives_the_estimates_of_one_inside() {
    let [all, inside] = [identified(0.0, 10.0), identified(1.0, 9.0)];
    assert_eq!(all.recordings[0].window_s, [0.2, 9.8]);
    assert_eq!(inside.recordings[0].window_s, [1.0, 9.0]);
    let notes = |r: &Results| r.recordings[0].notes.iter().filter(|n| n.contains("in motion")).count();
    assert_eq!([notes(&all), notes(&inside)], [2, 0]);
    let error = |r: &Results| {
        let run = r.run("nominal", Method::IDIM_LS).unwrap();
        let errors = run.parameters.iter().zip(TRUTH).map(|(p, truth)| (p.estimate / truth - 1.0).abs());
        errors.fold(0.0, f64::max)
    };
    let [of_all, of_inside] = [error(&all), error(&inside)];
    println!("largest relative error: {of_all:.1e} up to the ends, {of_inside:.1e} inside");
    assert!(of_all < LARGEST_ERROR && of_inside < LARGEST_ERROR, "{of_all} {of_inside}");
}
