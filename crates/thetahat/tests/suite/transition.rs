//! The velocity at which friction changes its sign, where it is none of those that are tried first.

use thetahat::{Identification, Method, Settings, results::Verdict};

use crate::lasting::{recording, robot};

const TRANSITION: f64 = 0.05;

#[test]
fn a_transition_between_those_that_are_tried_first_is_found() {
    let robot = robot();
    let settings = Settings::new(20.0, 4).with_methods([Method::IDIM_WLS]);
    let recording = recording(&robot, [0.0, TRANSITION, 0.02]);
    let results = Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap();
    let model = results.model.as_ref().unwrap();
    let found = model.friction_transition;
    assert!((found / TRANSITION - 1.0).abs() < 0.05, "{found}");
    let tried = model.candidates.iter().filter(|c| [0.03, 0.1].contains(&c.friction_transition));
    let taken = model.candidates.iter().find(|c| c.friction_transition == found).unwrap();
    assert!(tried.into_iter().all(|c| taken.unseen_square < 0.5 * c.unseen_square), "{:?}", model.candidates);
    assert!(model.causes.is_empty() && results.verdict == Some(Verdict::Good), "{:?}", results.verdict_reasons);
}
