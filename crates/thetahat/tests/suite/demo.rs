//! The demonstration holds what it predicts: known parameters are found, and a biased simulator misleads DIDIM alone.

use std::{path::Path, sync::OnceLock};

use thetahat::{Experiment, Method, Results, identification::Status, results::Verdict, simulation::BiasKind};
use thetahat_report::results::{Advice, BiasedSimulatorResult, Comparison};

fn results() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| Experiment::demo().unwrap().run(Path::new(""), &mut |_| {}).unwrap())
}

/// Shown parameters within three standard deviations of the truth.
fn within_three(case: &str, method: Method) -> usize {
    let run = results().run(case, method).unwrap();
    assert_eq!(run.status, Status::Converged, "{case} {}", method.name());
    let shown: Vec<_> = run.parameters.iter().filter(|p| p.shown).collect();
    assert_eq!(shown.len(), 28);
    let close = |estimate: f64, truth: f64, deviation: f64| (estimate - truth).abs() <= 3.0 * deviation;
    shown.iter().filter(|p| close(p.estimate, p.true_value.unwrap(), p.standard_deviation.unwrap())).count()
}

#[test]
fn nominal_all_three_methods_find_the_truth() {
    for method in [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM] {
        let found = within_three("nominal", method);
        assert!(found >= 26, "{}: {found} of 28", method.name());
        let error = results().run("nominal", method).unwrap().relative_error_percent.unwrap();
        assert!((4.5..=5.5).contains(&error), "{}: {error} %", method.name());
    }
}

#[test]
fn with_a_biased_simulator_iv_still_does_and_didim_does_not() {
    let iv = within_three("gear_ratio_0.9", Method::IDIM_IV);
    let didim = within_three("gear_ratio_0.9", Method::DIDIM);
    assert!(iv >= 26, "idim-iv: {iv} of 28");
    assert!(didim < 26, "didim: {didim} of 28");
}

fn simulator_test(case: &str) -> &'static BiasedSimulatorResult {
    let diagnosis = results().diagnostics.iter().find(|d| d.case == case).unwrap();
    diagnosis.biased_simulator.as_ref().unwrap()
}

fn advice(case: &str) -> &'static Advice {
    results().advice.iter().find(|a| a.case == case).unwrap()
}

#[test]
fn the_exact_simulator_passes() {
    let test = simulator_test("nominal");
    // The band-pass of the measured motion, which the simulated one does not have, stands out of what noise is left.
    assert!(!test.verdict.distrusts() && test.average_difference < 0.1, "{test:?}");
    assert!(test.explanations.is_empty());
    let advice = advice("nominal");
    assert_eq!((advice.recommended, advice.distrust.as_slice()), (Some(Method::IDIM_IV), &[][..]), "{advice:?}");
}

/// The estimates are outside what a robot can have by three deviations, which noise makes of one of so many conditions.
#[test]
fn the_verdict_is_good_where_links_are_outside_by_noise() {
    assert_eq!((results().verdict, results().verdict_reasons.len()), (Some(Verdict::Good), 0));
    let physical = results().run("nominal", Method::IDIM_IV).and_then(|run| run.physical.as_ref()).unwrap();
    assert!(!physical.consistent && physical.deviations.is_some_and(|d| d > 2.0 && d < 3.5), "{physical:?}");
}

#[test]
fn the_biased_simulator_is_found_and_measured() {
    let test = simulator_test("gear_ratio_0.9");
    assert_eq!(test.verdict, Comparison::Alarm, "{test:?}");
    let best = test.explanations[0];
    assert_eq!(best.kind, BiasKind::GearRatio);
    let (value, deviation) = best.simulator_to_true.zip(best.standard_deviation).unwrap();
    assert!((value - 0.9).abs() < 3.0 * deviation, "{best:?}");
    assert!(deviation < 0.003 && best.explained_percent > 98.0, "{best:?}");
    let advice = advice("gear_ratio_0.9");
    assert_eq!(
        (advice.recommended, advice.distrust.as_slice()),
        (Some(Method::IDIM_IV), &[Method::DIDIM][..]),
        "{advice:?}"
    );
}

#[test]
#[ignore = "long, each night"]
fn the_same_run_gives_the_same_numbers() {
    let mut experiment = Experiment::demo().unwrap();
    experiment.settings.cases.clear();
    let again = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    for method in [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM] {
        let estimates = |r: &Results| -> Vec<u64> {
            r.run("nominal", method).unwrap().parameters.iter().map(|p| p.estimate.to_bits()).collect()
        };
        assert_eq!(estimates(results()), estimates(&again), "{}", method.name());
    }
    let (first, second) = (&results().diagnostics[0], &again.diagnostics[0]);
    assert_eq!(format!("{first:?}"), format!("{second:?}"));
}

/// A package cannot hold files from outside its folder, so that the demonstration's two files lie in it a second time.
#[test]
fn the_package_holds_the_same_demonstration_as_the_repository() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |file: &str| std::fs::read_to_string(package.join(file)).unwrap();
    assert_eq!(text("demo/demo.toml"), text("../../experiments/demo.toml"));
    assert_eq!(text("demo/tx40.toml"), text("../../robots/tx40.toml"));
}
