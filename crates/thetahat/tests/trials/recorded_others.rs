//! KUKA LWR4+ (URDF, NumPy archives, two recordings) and UR10 (standard Denavit-Hartenberg, a ROS 2 bag): relative errors
//! and friction, from their experiment files.

use libtest_mimic::{Failed, Trial};
use thetahat::{
    ControllerDescription, Experiment, Method, Results,
    identification::Status,
    preparation::{Mask, NamedMask},
    results::{ReasonCode, Verdict},
};
use thetahat_model::robot::INERTIAL;
use thetahat_report::results::UseGrade;
use thetahat_testing::{each_night, ensure};

/// The estimates of others from these records differ by their filters: 15 % of each.
const FRICTION: f64 = 0.15;

fn identify(name: &str) -> Results {
    let experiment =
        Experiment::read(&thetahat_testing::root().join("experiments").join(name), &thetahat_testing::data()).unwrap();
    experiment.run(&thetahat_testing::data(), &mut |_| {}).unwrap()
}

fn ensure_error(results: &Results, limit: f64) -> Result<(), Failed> {
    let error = results.runs[0].relative_error_percent.unwrap();
    ensure(error <= limit, format!("relative error {error} %, at most {limit} %"))
}

fn ensure_friction(results: &Results, kind: &str, expected: &[f64]) -> Result<(), Failed> {
    for (j, expected) in expected.iter().enumerate() {
        let name = format!("{kind}{}", j + 1);
        let found = results.runs[0].parameter(&name).unwrap().estimate;
        let close = (found - expected).abs() <= FRICTION * expected;
        ensure(close, format!("{name}: {found}, others {expected}"))?;
    }
    Ok(())
}

/// 1.86 % weighted, by others; unweighted at most 2.1 %.
fn kuka_error() -> Result<(), Failed> {
    let results = identify("kuka_lwr4.toml");
    ensure_error(&results, 2.1)?;
    ensure(results.recordings.len() == 2, "two recordings")
}

/// The 43 base inertial parameters of the KUKA; five motor inertias are apart from them.
fn kuka_parameters() -> Result<(), Failed> {
    let results = identify("kuka_lwr4.toml");
    let inertial: Vec<&str> = INERTIAL.iter().map(|q| q.name()).collect();
    let kind = |name: &str| name.trim_end_matches('r').trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    let names = results.runs[0].parameters.iter().map(|p| kind(&p.name));
    let count = names.filter(|k| inertial.contains(&k.as_str())).count();
    ensure(count == 43, format!("{count} inertial base parameters"))
}

fn ur10_error() -> Result<(), Failed> {
    ensure_error(&identify("ur10.toml"), 6.6)
}

/// fv about 20.6 25.1 9.3 3.3 3.3 3.3, fc about 11.9 13.7 7.6 2.8 2.3 2.5.
/// The others' estimates are from all samples, those near rest among them.
fn ur10_friction() -> Result<(), Failed> {
    let path = thetahat_testing::root().join("experiments/ur10.toml");
    let mut experiment = Experiment::read(&path, &thetahat_testing::data()).unwrap();
    experiment.settings.signal.mask = Mask::Named(NamedMask::None);
    let results = experiment.run(&thetahat_testing::data(), &mut |_| {}).unwrap();
    ensure_friction(&results, "fv", &[20.6, 25.1, 9.3, 3.3, 3.3, 3.3])?;
    ensure_friction(&results, "fc", &[11.9, 13.7, 7.6, 2.8, 2.3, 2.5])
}

/// IV beside LS, with no other key, or with a PD loop stated.
fn identify_by_iv(name: &str, bandwidth_hz: Option<f64>) -> Results {
    let path = thetahat_testing::root().join("experiments").join(name);
    let mut experiment = Experiment::read(&path, &thetahat_testing::data()).unwrap();
    experiment.settings.estimation.methods.push(Method::IDIM_IV);
    experiment.settings.controller = bandwidth_hz.map(ControllerDescription::pd);
    experiment.run(&thetahat_testing::data(), &mut |_| {}).unwrap()
}

fn ensure_iv(name: &str, bandwidth_hz: Option<f64>, limit: f64) -> Result<(), Failed> {
    let results = identify_by_iv(name, bandwidth_hz);
    let iv = &results.runs[1];
    let error = iv.relative_error_percent.unwrap();
    ensure(iv.status == Status::Converged, format!("{bandwidth_hz:?} Hz: {:?} {:?}", iv.status, iv.reason))?;
    ensure(error <= limit, format!("{bandwidth_hz:?} Hz: {error} %, at most {limit} %"))?;
    let guessed = iv.notes.iter().any(|n| n.contains("guess"));
    ensure(guessed == bandwidth_hz.is_none(), format!("notes {:?}", iv.notes))?;
    let origin = results.recordings[0].reference.as_ref().map(|r| r.origin.as_str());
    ensure(origin == Some("filtered"), format!("reference {origin:?}"))
}

fn kuka_iv() -> Result<(), Failed> {
    [None, Some(5.0), Some(20.0)].into_iter().try_for_each(|hz| ensure_iv("kuka_lwr4.toml", hz, 2.1))
}

fn ur10_iv() -> Result<(), Failed> {
    [None, Some(5.0), Some(20.0), Some(80.0)].into_iter().try_for_each(|hz| ensure_iv("ur10.toml", hz, 3.3))
}

/// Recordings that others published estimates from ask for care: every one has a residual that is no noise, and a model that
/// predicts their torques.
fn verdicts() -> Result<(), Failed> {
    for name in ["tx40_paper.toml", "emps.toml", "kuka_lwr4.toml", "ur10.toml"] {
        let results = identify(name);
        let codes: Vec<ReasonCode> = results.verdict_reasons.iter().map(|r| r.code).collect();
        let said = format!("{name}: {:?}", results.verdict_reasons);
        let is_doubted = codes.iter().any(|c| matches!(c, ReasonCode::CorrelatedResidual | ReasonCode::Cause));
        ensure(results.verdict == Some(Verdict::Care) && is_doubted, &*said)?;
        let uses = &results.model.as_ref().unwrap().uses;
        ensure(uses[0].for_what == UseGrade::PredictTorques && uses[0].verdict == Verdict::Good, format!("{uses:?}"))?;
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    const DATA: [&str; 2] = ["datasets/kuka_lwr4", "datasets/ur10"];
    let mut trials = thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("kuka_is_fitted_to_two_percent", kuka_error),
            ("kuka_has_43_inertial_parameters", kuka_parameters),
            ("ur10_is_fitted_to_seven_percent", ur10_error),
            ("the_verdict_on_recordings_of_others_is_care", verdicts),
        ],
    );
    trials.extend(each_night(thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("kuka_by_iv_converges_with_any_controller", kuka_iv),
            ("ur10_by_iv_converges_with_any_controller", ur10_iv),
            ("ur10_has_the_friction_that_others_found", ur10_friction),
        ],
    )));
    trials
}
