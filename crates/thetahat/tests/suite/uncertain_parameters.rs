//! The note on uncertain parameters has the numbers of the table, and what a simulation needs is essential.

use std::path::Path;

use thetahat::{
    Experiment, Method,
    checks::{Code, Severity},
    preparation::{NamedChoice, ParameterChoice},
};
use thetahat_report::results::Finding;

/// The note named parameters by deviations of its own: fc2, which the table had at 15 %, and not others that it had above 30 %.
#[test]
fn the_note_names_the_parameters_that_the_table_has_above_thirty_percent() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/two_joint.toml");
    let folder = path.parent().unwrap();
    let mut experiment = Experiment::read(&path, folder).unwrap();
    experiment.settings.cases.clear();
    for method in [Method::IDIM_LS, Method::IDIM_WLS] {
        experiment.settings.estimation.methods = vec![method];
        let results = experiment.run(folder, &mut |_| {}).unwrap();
        let is_note = |f: &&Finding| f.code == Code::NotExcited && f.severity == Severity::Note;
        let after = results.findings[0].findings.iter().find(is_note).unwrap().clone();
        let percent =
            |name: &str| results.runs[0].parameter(name).unwrap().relative_standard_deviation_percent.unwrap();
        for parameter in &results.runs[0].parameters {
            let named = after.parameters.contains(&parameter.name);
            assert_eq!(named, percent(&parameter.name) > 30.0, "{} {}", parameter.name, percent(&parameter.name));
        }
        let before = experiment.check(folder).unwrap();
        assert_eq!(before[0].findings.iter().find(is_note), Some(&after));
        assert!(after.message.contains(method.name()), "{}", after.message);
    }
}

/// In noise that hides the motors' inertias, too, the elimination took them out, and no simulation could start.
#[test]
fn motor_inertias_are_essential_in_any_noise() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/two_joint.toml");
    let folder = path.parent().unwrap();
    let mut experiment = Experiment::read(&path, folder).unwrap();
    experiment.settings.cases.clear();
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    experiment.file.twin.as_mut().unwrap().sensors.torque_noise = vec![25.0, 25.0];
    let whole = experiment.run(folder, &mut |_| {}).unwrap();
    let percent = whole.runs[0].parameter("ia2").unwrap().relative_standard_deviation_percent.unwrap();
    assert!(percent > 30.0, "{percent}");
    let is_note = |f: &&Finding| f.code == Code::NotExcited && f.severity == Severity::Note;
    let note = whole.findings[0].findings.iter().find(is_note).unwrap();
    assert!(note.remedy.contains("essential") && note.remedy.contains("cross-validated error"), "{}", note.remedy);
    experiment.settings.parameters.estimate = ParameterChoice::Named(NamedChoice::Essential);
    let elimination = experiment.run(folder, &mut |_| {}).unwrap().elimination.unwrap();
    assert!(!elimination.eliminated.is_empty() && elimination.kept.iter().any(|name| name == "ia2"), "{elimination:?}");
}
