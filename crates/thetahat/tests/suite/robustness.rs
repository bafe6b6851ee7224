//! IV and DIDIM on twins of three robots, from three starts, with simulated loops of half, once and twice the true bandwidth:
//! the small form of `examples/robustness`. And IV without a stated controller, or with gains of start values that no robot
//! has.

#[path = "../../examples/studies/robustness/arguments.rs"]
mod arguments;
#[path = "../../examples/studies/robustness/cells.rs"]
mod cells;
use super::twins;

use arguments::{Arguments, FACTORS};
use cells::{Cell, Start, run_cells, settings};
use thetahat::{Identification, Method, identification::Status, preparation::Gains, results::RunResult};
use twins::{
    reference::Kind,
    robots::robots,
    twin::{NOISE, RATE_HZ, Sampling, Twin},
};

/// Largest error in deviations that an honest interval allows.
const WITHIN: f64 = 4.0;

fn arguments(robot: &str) -> Arguments {
    // DIDIM settles slowly on the SCARA's 5 s: 20 iterations do not always suffice.
    let methods = if robot == "SCARA" { vec![Method::IDIM_IV] } else { vec![Method::IDIM_IV, Method::DIDIM] };
    Arguments { data: None, quick: true, methods, robot: robot.to_owned(), seed: 1, factors: FACTORS[1..4].to_vec() }
}

fn twin_of(robot: &str) -> Twin {
    let arguments = arguments(robot);
    let sampling = Sampling { kind: Kind::Periodic, duration_s: arguments.duration_s(), rate_hz: RATE_HZ };
    Twin::new(robots(&arguments.robot, arguments.data.as_deref()).unwrap().remove(0), sampling, arguments.seed).unwrap()
}

fn iv(twin: &Twin, start: Start, change: impl FnOnce(&mut thetahat::Settings)) -> RunResult {
    let mut settings = settings(&[Method::IDIM_IV], 1.0);
    change(&mut settings);
    let recording = twin.record(NOISE[0], 5);
    Identification::new(&start.robot(twin), vec![recording], settings).unwrap().run().unwrap().runs.remove(0)
}

#[test]
#[ignore = "long, each night"]
fn iv_and_didim_converge_from_every_start() {
    for robot in ["two_joint", "SCARA", "seven axes"] {
        let cells = run_cells(&twin_of(robot), &arguments(robot)).unwrap();
        let describe = |c: &Cell| {
            let Cell { robot, method, factor, iterations, seconds, reason, .. } = c;
            let start = c.start.name();
            format!("{robot} {method} x{factor} {start}: {iterations} iterations, {seconds:.1} s, {reason}")
        };
        let failed: Vec<String> = cells.iter().filter(|c| !c.has_converged()).map(describe).collect();
        assert!(failed.is_empty(), "{failed:?}");
        let errors = cells.iter().filter(|c| c.method == Method::IDIM_IV).filter_map(|c| c.largest_error.as_ref());
        let (within, beyond): (Vec<_>, Vec<_>) = errors.partition(|(e, _)| *e <= WITHIN);
        assert!(20 * beyond.len() <= within.len() + beyond.len(), "{robot}: {beyond:?}");
    }
}

/// The twin follows its reference with feed-forward, so that no lag tells a bandwidth.
#[test]
fn without_a_controller_one_is_guessed_and_iv_converges() {
    let run = iv(&twin_of("seven axes"), Start::CadWithErrors, |s| s.controller = None);
    assert_eq!(run.status, Status::Converged, "{:?}", run.reason);
    assert!(run.notes.iter().any(|n| n.contains("is a guess, a PD loop of 10 Hz")), "{:?}", run.notes);
}

/// Nothing is known of this robot's masses: gains that are kept would be zero.
#[test]
fn kept_gains_of_start_values_that_are_no_robots_are_those_of_guessed_links() {
    let run = iv(&twin_of("seven axes"), Start::MotorInertias, |s| s.estimation.gains = Gains::Kept);
    assert_eq!(run.status, Status::Converged, "{:?}", run.reason);
}
