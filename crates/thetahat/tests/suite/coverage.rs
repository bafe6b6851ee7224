//! The 95 % intervals have the stated coverage where the assumptions of the methods hold: a short form of
//! `examples/coverage`, whose tables are in `docs/evidence/coverage.md`.

#[path = "../../examples/studies/coverage/noise.rs"]
mod noise;
#[path = "../../examples/studies/coverage/stage.rs"]
mod stage;
#[path = "../../examples/studies/coverage/tally.rs"]
mod tally;
#[path = "../../examples/studies/coverage/trial.rs"]
mod trial;
#[path = "../../examples/studies/coverage/twin.rs"]
mod twin;

use noise::{Colour, Level, Noise};
use stage::Stage;
use tally::{INTERVAL, Tally, run_seeds};
use thetahat::Method;
use trial::{ASSUMED, Estimate, Outcome, Scope, Trials, place};
use twin::Twin;

const SEEDS: u64 = 60;
/// What holds of 500 seeds: 93 to 97 %.
const TOLERANCE: f64 = 0.02;
/// Standard errors of the pooled coverage that come on top for fewer seeds.
const STANDARD_ERRORS: f64 = 2.0;

/// `measured_every`: seeds with errors in X take long on the TX40. `through`: methods whose X through the filters is exact enough.
fn check(twin: &Twin, measured_every: u64, through: &[Method]) {
    for colour in Colour::ALL {
        let noise = Noise { level: Level::High, colour };
        let scope = Scope { measured_every, stages: &[Stage::Derivative], simulated_every: None };
        let outcomes = run_seeds(&Trials::new(twin, noise, scope).unwrap(), SEEDS, 2).unwrap();
        let holds = |method: &str, of: &dyn Fn(&Outcome) -> Option<&Estimate>| {
            let tally = Tally::new(outcomes.iter().map(of)).unwrap();
            let (found, error) = (tally.pooled(INTERVAL), tally.pooled_error(INTERVAL));
            let what = format!("{} {} {method}: {found:.3} ± {error:.3}", twin.name, colour.name());
            println!("{what}");
            assert!((found - 0.95).abs() < TOLERANCE + STANDARD_ERRORS * error, "{what}");
            // Correlated rows are what the classical intervals do not know of.
            assert!(colour == Colour::White || tally.pooled(0) < 0.85, "{what}: classical {}", tally.pooled(0));
        };
        for (m, method) in ASSUMED.into_iter().enumerate() {
            holds(method, &|o| o.assumed[m].as_ref());
        }
        for &method in through {
            holds(&format!("{method} through the filters"), &|o| o.chain[place(method, Stage::Derivative)].as_ref());
        }
    }
}

#[test]
#[ignore = "long, each night"]
fn intervals_of_the_tx40_hold_the_truth() {
    check(&Twin::tx40().unwrap(), 6, &[Method::IDIM_LS, Method::IDIM_IV]);
}

#[test]
#[ignore = "long, each night"]
fn intervals_of_emps_hold_the_truth() {
    check(&Twin::emps().unwrap(), 1, &[Method::IDIM_IV]);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let twin = Twin::emps().unwrap();
    let noise = Noise { level: Level::Low, colour: Colour::Coloured };
    let trials =
        Trials::new(&twin, noise, Scope { measured_every: 2, stages: &Stage::ALL, simulated_every: None }).unwrap();
    assert_eq!(run_seeds(&trials, 7, 1).unwrap(), run_seeds(&trials, 7, 3).unwrap());
}
