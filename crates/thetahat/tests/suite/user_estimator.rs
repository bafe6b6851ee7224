//! Estimators of the user's own: the rows that they are given, and what becomes of what they find.

use std::f64::consts::TAU;

use super::followed_twin::{RATE_HZ, controller, record, robot};
use thetahat::{
    Identification, Method, Results, Series, Settings,
    identification::{UserEstimate, UserEstimator, UserRegression},
    preparation::PreparationError,
};
use thetahat_ground::linear_algebra::PivotedQr;

/// Agreement of two ways to the same solution of least squares.
const SAME: f64 = 1e-8;

fn wave() -> Series {
    let of = |t: f64, j: f64| [0.31, 0.83, 1.37].map(|hz| 0.4 * (TAU * hz * t + 3.0 * hz + j).sin()).iter().sum();
    let time = (0..(6.0 * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect())
}

fn identification(weight: f64) -> Identification {
    let mut settings = Settings::new(20.0, 10).with_methods([Method::IDIM_LS, Method::IDIM_IV]);
    settings.controller = Some(controller());
    settings.simulation.sign_velocity_scale = 0.05;
    let reference = wave();
    let mut recording = record(&reference, 1e-5).with_reference(reference);
    recording.weight = weight;
    Identification::new(&robot(), vec![recording], settings).unwrap()
}

fn least_squares(rows: &UserRegression) -> UserEstimate {
    UserEstimate { theta: PivotedQr::new(&rows.x).solve(&rows.y), covariance: None }
}

/// IV (9): `(Z^T X)^-1 Z^T y`.
fn instrumental_variables(rows: &UserRegression) -> UserEstimate {
    let z = rows.z.as_ref().expect("IDIM-IV is among the methods");
    let theta = PivotedQr::new(&z.transposed_times(&rows.x)).solve(&z.transpose_times(&rows.y));
    UserEstimate { theta, covariance: None }
}

fn run() -> Results {
    let least_squares = UserEstimator::new("ls", |rows| Ok(least_squares(rows))).unwrap();
    let instrumental = UserEstimator::new("iv", |rows| Ok(instrumental_variables(rows))).unwrap();
    // A weight that all rows share changes no estimate.
    let identification = identification(3.0).with_estimator(least_squares).unwrap();
    identification.with_estimator(instrumental).unwrap().run().unwrap()
}

#[test]
fn what_the_methods_do_gives_what_the_methods_give() {
    let results = run();
    for (own, method) in results.user_runs.iter().zip([Method::IDIM_LS, Method::IDIM_IV]) {
        let run = results.run("nominal", method).unwrap();
        for (own, p) in own.parameters.iter().zip(&run.parameters) {
            let apart = (own.estimate - p.estimate).abs() / p.standard_deviation.unwrap();
            assert!(apart < SAME.sqrt(), "{method} {}: {apart}", p.name);
            assert_eq!((&own.name, own.true_value, own.interval_95), (&p.name, p.true_value, None));
        }
        let near = |a: f64, b: Option<f64>| (a / b.unwrap() - 1.0).abs() < SAME;
        assert!(near(own.relative_error_percent, run.relative_error_percent), "{method}");
        let unseen = own.cross_validation_relative_error_percent.unwrap();
        assert!(near(unseen, run.cross_validation_relative_error_percent), "{method}");
        assert!(own.has_instruments);
    }
}

#[test]
fn they_change_nothing_else_and_are_written_and_read() {
    let (with, without) = (run(), identification(3.0).run().unwrap());
    let text = |results: &Results| {
        let mut results = results.clone();
        results.user_runs.clear();
        results.runs.iter_mut().for_each(|run| run.seconds = 0.0);
        results.model.iter_mut().for_each(|model| model.seconds = 0.0);
        results.to_json().unwrap()
    };
    assert_eq!(text(&with), text(&without));
    assert!(!text(&without).contains("user_runs"));
    let read = Results::from_json("results.json".as_ref(), &with.to_json().unwrap()).unwrap();
    assert_eq!(read.user_runs[1].name, "iv");
    assert_eq!(read.user_runs[1].parameters[0].estimate, with.user_runs[1].parameters[0].estimate);
}

#[test]
fn a_failure_is_an_error_that_names_estimator_and_part() {
    let fails = |without: bool| {
        let all = std::sync::OnceLock::new();
        let estimator = UserEstimator::new("mine", move |rows| {
            let first = *all.get_or_init(|| rows.y.len()) == rows.y.len();
            if first == without { Ok(least_squares(rows)) } else { Err("no idea".into()) }
        });
        identification(1.0).with_estimator(estimator.unwrap()).unwrap().run().unwrap_err()
    };
    let (first, later) = (fails(false), fails(true));
    assert!(matches!(&first, PreparationError::Estimator { name, part, .. } if name == "mine" && part.is_empty()));
    assert_eq!(first.to_string(), "the estimator mine: no idea");
    assert_eq!(later.to_string(), "the estimator mine without part 1: no idea");
}

#[test]
fn two_of_one_name_are_refused() {
    let own = || UserEstimator::new("ls", |rows| Ok(least_squares(rows))).unwrap();
    let error = identification(1.0).with_estimator(own()).unwrap().with_estimator(own()).err().unwrap();
    assert_eq!(error.to_string(), "estimators is ls twice, expected names that differ");
}
