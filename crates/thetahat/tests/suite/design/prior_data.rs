//! Recordings, results and experiments that are there before.

use std::path::Path;

use thetahat::{
    Experiment,
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

/// The model of an identification is the a-priori robot of the next design, and its covariance is known before: times add to it, and
/// torques of the user's own motion are known better after than before.
#[test]
fn results_are_known_before_with_their_model() {
    let folder = Folder::new();
    let (design, alone, experiment) = rehearsal(&folder, &with_controller());
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    folder.write("results.json", results.to_json().unwrap());
    // The elbow alone.
    let work = (0..2000).map(|k| format!("0.1,{}\n", 0.8 * (0.02 * f64::from(k)).sin()));
    folder.write("work.csv", format!("q_1,q_2\n{}", work.collect::<String>()));
    let wanted = "[wanted]\nmotion = { file = 'work.csv', columns = ['q_1', 'q_2'], unit = 'rad' }\ntorque_percent = 0.05\n\
                  half_width_percent = 0.5\n";
    let next = with_controller().replace("[motion]", &format!("prior = ['results.json']\n{wanted}[motion]"));
    let next = Design::parse(&next, &design.path).unwrap();
    let model = results.model.as_ref().unwrap();
    for parameter in &model.standard {
        assert_eq!(next.robot.a_priori.get(&parameter.name), Some(&parameter.value));
    }
    let known = next.run(2).unwrap();
    let shown = thetahat_report::report::design_text(&known, thetahat_report::report::TextWidth::DEFAULT);
    let shown = shown.replace('\n', " ");
    assert!(known.knows_earlier && shown.contains("With what the earlier recordings know"), "{shown}");
    let torques = known.wanted_torques.as_ref().unwrap();
    println!("{torques:?}");
    assert!(torques.percent < torques.before_percent.unwrap());
    // The motion was recorded once, for 4 s: what it brings within 2 s is known. Without it 10 % are wanted, which takes less by the square.
    let of = |name: &str| known.predicted.iter().find(|p| p.name == name).and_then(|p| p.seconds);
    let without = |seconds: f64| seconds * (10.0_f64 / 0.5).powi(2);
    let times = alone.predicted.iter().filter_map(|p| Some((without(p.seconds?), of(&p.name)?)));
    let times: Vec<(f64, f64)> = times.collect();
    println!("seconds without and with the earlier recording: {times:.3?}");
    let [brought, others]: [Vec<_>; 2] = [true, false].map(|is| times.iter().filter(|t| (t.0 < 2.0) == is).collect());
    assert!(!brought.is_empty() && brought.iter().all(|(_, with)| *with == 0.0), "{times:?}");
    assert!(!others.is_empty() && others.iter().all(|(_, with)| *with > 0.0), "{times:?}");
    // The criterion of these torques beats the default one in them.
    let torque = |criterion: &str| {
        let text = with_controller().replace("[motion]", &format!("{}criterion = '{criterion}'\n[motion]", wanted));
        Design::parse(&text, &design.path).unwrap().run(2).unwrap().wanted_torques.unwrap().percent
    };
    let [by_volume, by_torque] = ["d", "torque"].map(torque);
    println!("torques known to {by_volume:.4} % by D, to {by_torque:.4} % by their own criterion");
    assert!(by_torque < by_volume);
    let missing = with_controller().replace("[motion]", "[wanted]\ncriterion = 'torque'\n[motion]");
    let error = Design::parse(&missing, &design.path).unwrap().run(1).unwrap_err();
    assert!(error.to_string().contains("[wanted] motion"), "{error}");
    let mut without = results;
    without.model = None;
    folder.write("results.json", without.to_json().unwrap());
    let text = with_controller().replace("[motion]", "prior = ['results.json']\n[motion]");
    assert!(matches!(Design::parse(&text, &design.path), Err(DesignError::NoModel { .. })));
}

/// The intervals of a recording stand next to the predicted ones, with what differs where they are wider.
#[test]
fn a_recording_is_compared_with_its_prediction() {
    use thetahat_report::{
        report::{TextWidth, predicted_intervals_text},
        results::PredictedIntervals,
    };
    let folder = Folder::new();
    let (_, _, experiment) = rehearsal(&folder, &with_controller());
    let predicted = PredictedIntervals::read(&folder.path().join("out/predicted.csv")).unwrap();
    let text = |experiment: &Experiment| {
        let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
        let compared = predicted.against(&results, "nominal", None).unwrap();
        let logs = compared.parameters.iter().map(|interval| interval.times_wider().ln());
        let mean = (logs.sum::<f64>() / compared.parameters.len() as f64).exp();
        (mean, compared.parameters.len(), predicted_intervals_text(&compared, TextWidth::DEFAULT).replace('\n', " "))
    };
    let (mean, count, shown) = text(&experiment);
    println!("{mean:.3} times as wide as predicted");
    assert!((0.85..1.18).contains(&mean) && count == 13 && !shown.contains("residual of"), "{shown}");
    let noisy = experiment.text.replace("torque_noise = [0.1, 0.1]", "torque_noise = [0.3, 0.3]");
    assert!(noisy != experiment.text);
    folder.write("out/noisy.toml", noisy);
    let (mean, _, shown) = text(&Experiment::read(&folder.path().join("out/noisy.toml"), Path::new("")).unwrap());
    assert!((2.4..3.6).contains(&mean) && shown.contains("times the predicted noise"), "{mean} {shown}");
    folder.write("other.csv", "time_s,q\n0,1\n");
    let error = PredictedIntervals::read(&folder.path().join("other.csv")).unwrap_err();
    assert!(error.to_string().contains("is not the predicted.csv of a design"), "{error}");
}
