//! Advice on a twin whose simulator is exact and whose filtered velocity is wrong at rest.

use std::path::Path;

use thetahat::{experiment::Experiment, identification::Method, results::Comparison};

/// The band-pass and the sign of small velocities move IV by several standard deviations, and DIDIM by none: the simulator
/// is not to be blamed.
#[test]
fn an_exact_simulator_beside_a_wrong_measured_motion_is_not_blamed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/emps_twin.toml");
    let experiment = Experiment::read(&path, path.parent().unwrap()).unwrap();
    let results = experiment.run(path.parent().unwrap(), &mut |_| {}).unwrap();
    let test = results.diagnostics[0].biased_simulator.as_ref().unwrap();
    assert_eq!(test.verdict, Comparison::Undecided, "{test:?}");
    let advice = &results.advice[0];
    assert_eq!(advice.take, None, "{advice:?}");
    assert!(!advice.distrust.contains(&Method::DIDIM) && !advice.text.contains("later"), "{advice:?}");
    let away = |method: Method, name: &str| {
        let found = results.run("nominal", method).unwrap().parameter(name).unwrap();
        (found.estimate - found.true_value.unwrap()) / found.standard_deviation_robust.unwrap()
    };
    assert!(away(Method::DIDIM, "fv1").abs() < 2.0 && away(Method::IDIM_IV, "fv1").abs() > 2.5);
}
