//! An experiment without a cut-off: positions by the smoother, and rows with white noise.

use thetahat::{Experiment, Method, Results, identification::Status};
use thetahat_testing::{Folder, project};

/// Standard deviations from the truth that none of so few normal numbers exceeds in 99.9 % of all cases.
const DEVIATIONS: f64 = 3.9;

const CUTOFF: &str = "[signal]\ncutoff_hz = 40\n";
const SMOOTHER: &str =
    "[estimation]\nmethods = ['idim-ls', 'idim-iv', 'idim-piv']\n\n[signal]\nposition = 'smoother'\n";

/// The experiment of the two-joint arm with the smoother in the place of a cut-off.
fn smoothed() -> Results {
    let folder = Folder::new();
    let read = |path: &str| std::fs::read_to_string(project(path)).unwrap();
    folder.write("robots/two_joint.toml", read("robots/two_joint.toml"));
    let text = read("experiments/two_joint.toml");
    assert!(text.contains(CUTOFF));
    folder.write("experiments/two_joint.toml", text.replace(CUTOFF, SMOOTHER));
    let file = folder.path().join("experiments/two_joint.toml");
    Experiment::read(&file, folder.path()).unwrap().run(folder.path(), &mut |_| {}).unwrap()
}

#[test]
fn the_smoother_finds_the_parameters_without_a_cutoff() {
    let results = smoothed();
    for method in [Method::IDIM_IV, Method::IDIM_PIV] {
        let run = results.run("nominal", method).unwrap();
        assert_eq!(run.status, Status::Converged, "{method}: {:?}", run.reason);
        for p in &run.parameters {
            let (truth, sd) = (p.true_value.unwrap(), p.standard_deviation_robust.unwrap());
            assert!((p.estimate - truth).abs() < DEVIATIONS * sd, "{method} {}: {} of {truth}", p.name, p.estimate);
        }
    }
    let notes: Vec<&String> = results.recordings.iter().flat_map(|recording| &recording.notes).collect();
    assert!(notes.iter().any(|note| note.contains("smoother")), "{notes:?}");
}
