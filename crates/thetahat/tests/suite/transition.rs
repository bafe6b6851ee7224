//! The velocity at which friction changes its sign, where it is none of those that are tried first.

use thetahat::{Identification, Method, Recording, Robot, Settings, results::Verdict, robot::JointKind};

use crate::lasting::{motion, recording, robot};

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

/// A robot whose second joint slides, and a recording with friction that is written here, not by the model.
fn with_a_slide([turning, sliding]: [f64; 2]) -> (Robot, Recording) {
    let mut robot = robot();
    robot.joints[1].kind = JointKind::Prismatic;
    let mut frictionless = robot.clone();
    let coulomb = ["fc1", "fc2"].map(|name| frictionless.a_priori.insert(name.to_owned(), 0.0).unwrap());
    let mut recording = recording(&frictionless, [0.0, 1.0, 0.02]);
    let torque = recording.torque.as_mut().unwrap();
    for k in 0..torque.len() {
        let signs = motion(k)[1].into_iter().zip([turning, sliding]).map(|(dq, v)| (dq / v).tanh());
        torque.sample_mut(k).iter_mut().zip(signs.zip(coulomb)).for_each(|(tau, (sign, fc))| *tau += fc * sign);
    }
    (robot, recording)
}

#[test]
fn joints_that_slide_have_a_transition_of_their_own() {
    let [turning, sliding] = [0.05, 0.004];
    let (robot, recording) = with_a_slide([turning, sliding]);
    let settings = Settings::new(20.0, 4).with_methods([Method::IDIM_WLS]);
    let results = Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap();
    let model = results.model.as_ref().unwrap();
    let found = [model.friction_transition, model.friction_transition_sliding.unwrap()];
    assert!((found[0] / turning - 1.0).abs() < 0.05 && (found[1] / sliding - 1.0).abs() < 0.1, "{found:?}");
    assert!(model.causes.is_empty() && results.verdict == Some(Verdict::Good), "{:?}", results.verdict_reasons);
}

#[test]
fn stated_transitions_stay() {
    let (robot, recording) = with_a_slide([0.05, 0.004]);
    let mut settings = Settings::new(20.0, 4).with_methods([Method::IDIM_WLS]);
    settings.model.friction_transition_sliding = Some(0.01);
    let alone = Identification::new(&robot, vec![recording.clone()], settings.clone()).err().unwrap();
    assert!(alone.to_string().contains("friction_transition_sliding"), "{alone}");
    settings.model.friction_transition = Some(0.02);
    let results = Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap();
    let model = results.model.as_ref().unwrap();
    assert_eq!((model.friction_transition, model.friction_transition_sliding), (0.02, Some(0.01)));
}
