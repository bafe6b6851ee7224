//! Recordings, results and experiments that are there before.

use std::path::Path;

use thetahat::{
    design::{Design, DesignError},
    reduction::ReduceOptions,
};
use thetahat_report::results::PredictedParameter;
use thetahat_testing::{Folder, project};

use super::support::{rehearsal, with_controller};

/// What a reduction tells is known: the same motion adds less to it, and another robot's is refused.
#[test]
fn recordings_at_hand_are_known_before() {
    let folder = Folder::new();
    let (_, alone, experiment) = rehearsal(&folder, &with_controller());
    let reduction = experiment.reduce(Path::new(""), ReduceOptions::default(), &mut |_| {}).unwrap();
    reduction.write(&folder.path().join("a.reduction")).unwrap();
    let text = with_controller().replace("[motion]", "prior = ['a.reduction']\n[motion]");
    let design = Design::parse(&text, &folder.path().join("design.toml")).unwrap();
    let both = design.run(2).unwrap();
    // Twice the information in each of 13 directions is 13 log 2 = 9 nats; another motion adds more to what is known.
    let gain = alone.starts[0].found - both.starts[0].found;
    assert!((8.0..20.0).contains(&gain), "{gain}");
    // The motion of the design tells as much as the last one does once more, or more.
    let repeated = both.repeated.unwrap();
    assert!(both.starts[0].found < repeated + 1.0, "{} {repeated}", both.starts[0].found);
    let other = Design::parse(&text.replace("[signal]", "[parameters]\nexclude = ['off1']\n[signal]"), &design.path);
    assert!(matches!(other.unwrap().run(1), Err(DesignError::OtherRobot { .. })));
    // The same names with another length between the axes.
    let longer = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    assert!(longer.contains("a_m = 0.4"));
    folder.write("longer.toml", longer.replace("a_m = 0.4", "a_m = 0.8"));
    let other = Design::parse(&text.replace("two_joint.toml", "longer.toml"), &design.path);
    assert!(matches!(other.unwrap().run(1), Err(DesignError::OtherRobot { .. })));
}

/// Results of an identification stand beside what is predicted, and those of nothing like it are refused.
#[test]
fn results_at_hand_are_compared_with() {
    let folder = Folder::new();
    let (_, alone, experiment) = rehearsal(&folder, &with_controller());
    assert!(alone.compared.is_none() && alone.repeated.is_none());
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    folder.write("results.json", results.to_json().unwrap());
    let text = with_controller().replace("[motion]", "compare = 'results.json'\n[motion]");
    let design = Design::parse(&text, &folder.path().join("design.toml")).unwrap();
    let both = design.run(2).unwrap();
    // The record is of the same motion and noise: its intervals are those that were predicted, but for their own scatter.
    let times: Vec<f64> = both.predicted.iter().filter_map(|p| p.times_smaller()).collect();
    assert_eq!(times.len(), both.predicted.len());
    let mean = (times.iter().map(|t| t.ln()).sum::<f64>() / times.len() as f64).exp();
    assert!((0.8..1.25).contains(&mean), "{mean}");
    let text = thetahat_report::report::design_text(&both, thetahat_report::report::TextWidth::DEFAULT);
    assert!(text.contains("times as narrow"), "{text}");
    // The residual of that record is the noise of the design: a design with it predicts the same.
    let with_noise = |file: &str| with_controller().replace("torque = 0.1", &format!("results = '{file}'"));
    let from_residual = Design::parse(&with_noise("results.json"), &design.path).unwrap().run(2).unwrap();
    let ratio = |(a, b): (&PredictedParameter, &PredictedParameter)| (a.half_width_95 / b.half_width_95).ln();
    let mean =
        from_residual.predicted.iter().zip(&alone.predicted).map(ratio).sum::<f64>() / alone.predicted.len() as f64;
    println!("with the noise of the residual {:.3} times as wide", mean.exp());
    assert!(mean.abs() < 0.15, "{mean}");
    folder.write("joints.json", results.to_json().unwrap().replace("\"elbow\"", "\"hand\""));
    let error = Design::parse(&with_noise("joints.json"), &design.path).unwrap_err();
    assert!(matches!(&error, DesignError::NoNoise { .. }) && error.to_string().contains("joints.json"), "{error}");
    let other = with_controller().replace("[motion]", "compare = 'nowhere.json'\n[motion]");
    let error = Design::parse(&other, &design.path).unwrap().run(1).unwrap_err();
    assert!(matches!(&error, DesignError::Results(_)) && error.to_string().contains("nowhere.json"), "{error}");
}

/// An experiment is identified, and its intervals stand beside those that are predicted as those of its results do.
#[test]
fn an_experiment_at_hand_is_compared_with() {
    let folder = Folder::new();
    let (design, _, experiment) = rehearsal(&folder, &with_controller());
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    folder.write("results.json", results.to_json().unwrap());
    let with = |file: &str| {
        let text = with_controller().replace("[motion]", &format!("compare = '{file}'\n[motion]"));
        Design::parse(&text, &design.path).unwrap()
    };
    let of_results = with("results.json").run(2).unwrap();
    let of_experiment = with("out/rehearsal.toml");
    assert!(of_experiment.input_files().iter().any(|file| file.ends_with("out/trajectory.csv")));
    let of_experiment = of_experiment.run(2).unwrap();
    assert_eq!(of_experiment.compared, of_results.compared);
    for (a, b) in of_experiment.predicted.iter().zip(&of_results.predicted) {
        assert!(a.compared.is_some() && a.times_smaller() == b.times_smaller(), "{}", a.name);
    }
    let out = folder.path().join("page");
    thetahat_report::report::write_design(&of_experiment, &out).unwrap();
    let page = std::fs::read_to_string(out.join("design.html")).unwrap();
    assert!(page.contains("predicted interval") && page.contains("of two joints"), "the legend of both");
    let error = with("nowhere.toml").run(1).unwrap_err();
    assert!(matches!(&error, DesignError::Experiment(_)) && error.to_string().contains("nowhere.toml"), "{error}");
}
