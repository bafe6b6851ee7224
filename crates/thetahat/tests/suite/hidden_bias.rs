//! Errors that no interval holds, put into the record of a twin: what is said of them beforehand against what they do.

use std::f64::consts::TAU;

use super::followed_twin::{RATE_HZ, controller, record, robot};
use thetahat::{Identification, Method, Recording, Results, Series, Settings};
use thetahat_report::results::{HiddenBias, HiddenError};

const SECONDS: f64 = 16.0;
const METHODS: [Method; 2] = [Method::IDIM_LS, Method::IDIM_IV];
/// Torques are late by so many samples, and a joint has so much more friction at rest.
const SAMPLES: usize = 1;
const FRICTION: f64 = 0.5;
const JOINT: usize = 2;

/// A wave that does not repeat, of three sines for each joint.
fn wave() -> Series {
    let of = |t: f64, j: f64| {
        [0.31, 0.83, 1.37].map(|hz| 0.4 * (TAU * hz * t + 3.0 * hz + j).sin() / (0.5 + hz)).iter().sum()
    };
    let time = (0..(SECONDS * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect())
}

fn identify(recording: Recording) -> Results {
    let mut settings = Settings::new(20.0, 10).with_methods(METHODS);
    settings.controller = Some(controller());
    settings.simulation.sign_velocity_scale = 0.05;
    Identification::new(&robot(), vec![recording], settings).unwrap().run().unwrap()
}

/// The same record with its torques later.
fn late(clean: &Recording) -> Recording {
    let torque = clean.torque.as_ref().unwrap();
    let later = (0..torque.len()).flat_map(|k| torque.sample(k.saturating_sub(SAMPLES)).to_vec()).collect();
    Recording { torque: Some(Series::shaped(2, later)), ..clean.clone() }
}

/// The same record with friction of a joint that grows near rest, over the velocity of the recorded positions.
fn with_friction_near_rest(clean: &Recording) -> Recording {
    let mut torque = clean.torque.clone().unwrap();
    let position = clean.position.channel(JOINT - 1);
    // Over 21 samples: the noise of the positions is none of the velocity then.
    let velocity = |k: usize| {
        let (before, after) = (k.saturating_sub(10), (k + 10).min(position.len() - 1));
        (position[after] - position[before]) * RATE_HZ / (after - before) as f64
    };
    let peak = (0..position.len()).map(|k| velocity(k).abs()).fold(0.0, f64::max);
    for k in 0..position.len() {
        let relative = velocity(k) / (0.1 * peak);
        torque.sample_mut(k)[JOINT - 1] += FRICTION * relative.signum() * (-relative * relative).exp();
    }
    Recording { torque: Some(torque), ..clean.clone() }
}

fn bias(results: &Results, method: Method, error: HiddenError) -> HiddenBias {
    let run = results.run("nominal", method).unwrap();
    let is_it = |b: &&HiddenBias| b.error == error && b.joint.is_none_or(|joint| joint == JOINT);
    run.hidden_bias.iter().find(is_it).unwrap().clone()
}

/// Says of the clean record how far an error of this size would move a parameter, and compares with the record that has it.
fn assert_foretold(disturbed: &Results, clean: &Results, (error, size): (HiddenError, f64)) {
    for method in METHODS {
        let said = bias(clean, method, error);
        let [from, to] = said.size_interval_95;
        let (of_clean, half) = (0.5 * (from + to), 0.5 * (to - from));
        assert!(of_clean.abs() < 0.1 * size && half < 0.3 * size, "{method} {error:?}: the clean record has {said:?}");
        let farther = if from.abs() > to.abs() { from } else { to };
        let [was, is] =
            [clean, disturbed].map(|r| r.run("nominal", method).unwrap().parameter(&said.parameter).unwrap());
        let foretold = said.deviations * size / farther;
        let moved = (is.estimate - was.estimate) / was.standard_deviation_robust.unwrap();
        assert!(moved.abs() > 3.0, "{method} {error:?}: {moved}");
        assert!((moved / foretold - 1.0).abs() < 0.1, "{method} {error:?}: {moved} where {foretold} was foretold");
        let [from, to] = bias(disturbed, method, error).size_interval_95;
        let found = 0.5 * (from + to) - of_clean;
        assert!((found / size - 1.0).abs() < 0.1, "{method} {error:?}: {found} is found of {size}");
    }
}

#[test]
fn errors_move_the_estimates_as_foretold_and_are_bounded_by_the_residual() {
    let reference = wave();
    let clean_record = record(&reference, 1e-6).with_reference(reference);
    let clean = identify(clean_record.clone());
    let delay_s = SAMPLES as f64 / RATE_HZ;
    assert_foretold(&identify(late(&clean_record)), &clean, (HiddenError::LateTorque, delay_s));
    let disturbed = identify(with_friction_near_rest(&clean_record));
    assert_foretold(&disturbed, &clean, (HiddenError::FrictionNearRest, FRICTION));
}
