//! The model of a twin with known parameters: what it predicts, which doors take it, and what it names.

use std::{path::Path, sync::OnceLock};

use thetahat::{
    Experiment, Identification, Method, Results, Robot, Series, Settings,
    experiment::{EstimateRequest, IdentifiedRobot},
    export::{ExportFormat, IdentifiedModel},
    preparation::{ParameterSelection, Recording},
    results::{ModelResult, Verdict},
};
use thetahat_model::{dynamics::Model, robot::TermDescription};
use thetahat_report::results::{CauseKind, ModelCause, ModelParameter, UseGrade};

fn experiment() -> Experiment {
    let mut experiment = Experiment::demo().unwrap();
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    experiment.settings.estimation.weighting.clear();
    experiment.settings.cases.clear();
    experiment
}

/// The recording with a tenth of its noise.
fn recording() -> Recording {
    static RECORDING: OnceLock<Recording> = OnceLock::new();
    let simulated = || {
        let mut experiment = experiment();
        let sensors = &mut experiment.file.twin.as_mut().unwrap().sensors;
        sensors.torque_noise.iter_mut().for_each(|noise| *noise *= 0.1);
        experiment.recordings(Path::new("")).unwrap().remove(0)
    };
    RECORDING.get_or_init(simulated).clone()
}

fn identify(recording: Recording) -> Results {
    let Experiment { robot, settings, .. } = experiment();
    Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap()
}

fn clean() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| experiment().run(Path::new(""), &mut |_| {}).unwrap())
}

fn model(results: &Results) -> &ModelResult {
    results.model.as_ref().unwrap_or_else(|| panic!("{:?}", results.no_model))
}

/// What exists as a robot can be exported, and predicts unseen motion about as well as the fit says.
#[test]
fn it_is_a_robot_that_predicts() {
    let (results, model) = (clean(), model(clean()));
    let (fit, unseen) = (model.fit.percent, model.unseen.as_ref().unwrap().percent);
    assert!(unseen < 1.5 * fit, "{unseen} % of unseen motion, {fit} % of the fit");
    let masses = model.standard.iter().filter(|p| p.unit == "kg" && p.name.starts_with('m'));
    assert!(masses.clone().count() == 6 && masses.clone().all(|p| p.value > 0.0), "{:?}", model.standard);
    // A motor inertia that turns often is decided by the recording, the products of inertia of the last link are not.
    let decided = |name: &str| model.parameters.iter().find(|p| p.name == name).unwrap().decided_percent;
    assert!(decided("ia3") > 99.0 && decided("xy6") < 20.0, "{:?}", model.parameters);
    assert_eq!(model.uses[0].for_what, UseGrade::PredictTorques);
    assert_eq!(model.uses[0].verdict, Verdict::Good, "{:?}", results.verdict_reasons);
    // The twin's own transition is 0.005 rad/s.
    assert!((0.004..0.008).contains(&model.friction_transition), "{:?}", model.candidates);
}

/// Each decided value is nearer to the truth than its interval's width, or no quotation could hold.
#[test]
fn decided_values_are_near_the_truth() {
    let decided = model(clean()).parameters.iter().filter(|p| p.is_decided());
    let near = |p: &&ModelParameter| {
        let [low, high] = p.interval_95.unwrap();
        (p.value - p.true_value.unwrap()).abs() <= high - low
    };
    let (count, held) = (decided.clone().count(), decided.filter(near).count());
    assert!(count >= 25 && held as f64 >= 0.95 * count as f64, "{held} of {count}");
}

/// The inertia of each joint, with that of its motor, lies as near to the truth as its deviation says.
#[test]
fn inertias_of_joints_have_their_deviations() {
    let experiment = experiment();
    let recording = experiment.recordings(Path::new("")).unwrap().remove(0);
    let (dynamics, truth) = (Model::new(&experiment.robot), recording.truth.as_ref().unwrap());
    let (q, step) = (&recording.position, recording.position.len().div_ceil(40));
    let squares = (0..q.len())
        .step_by(step)
        .map(|k| dynamics.joint_inertias(truth, q.sample(k)).unwrap().iter().map(|m| m * m).collect::<Vec<f64>>());
    let squares: Vec<Vec<f64>> = squares.collect();
    for (j, joint) in model(clean()).joints.iter().enumerate() {
        let truth = (squares.iter().map(|s| s[j]).sum::<f64>() / squares.len() as f64).sqrt();
        let off = 100.0 * (joint.inertia - truth).abs() / truth;
        // One percent is for the positions, which are not those of the window.
        assert!(off < 1.0 + 3.0 * joint.inertia_deviation_percent, "joint {}: {off} %, {joint:?}", j + 1);
        // From 20 % on simulations would be care.
        assert!(joint.inertia_deviation_percent < 20.0 && joint.speed.unwrap() > 0.1, "{joint:?}");
    }
    assert_eq!(model(clean()).joints.len(), 6);
}

/// By default predictions and exports take the model, and a run by its method's name.
#[test]
fn it_is_what_doors_take() {
    let of = |method| {
        let request = EstimateRequest { method, untrusted: true, ..EstimateRequest::default() };
        IdentifiedRobot::of_results(Path::new("results.json"), clean(), &request).unwrap()
    };
    let standard: Vec<f64> = model(clean()).standard.iter().map(|p| p.value).collect();
    assert_eq!(of(None).theta(), standard);
    assert!(of(None).origin().starts_with("the model"), "{}", of(None).origin());
    assert!(of(Some(Method::IDIM_LS)).model.is_none());
}

/// Fifteen samples late, 3 ms at 5 kHz.
#[test]
fn late_torques_are_named_with_their_delay() {
    let clean = recording();
    let torque = clean.torque.as_ref().unwrap();
    let late: Vec<f64> = (0..torque.len()).flat_map(|k| torque.sample(k.saturating_sub(15)).to_vec()).collect();
    let torque = Some(Series::from_values(torque.channels(), late).unwrap());
    let delay_s = 15.0 / clean.sample_rate_hz;
    let results = identify(Recording { torque, ..clean });
    let cause = &model(&results).causes[0];
    assert_eq!(cause.kind, CauseKind::LateTorque, "{:?}", model(&results).causes);
    // The twin stands still between its moves, where the filter rings: the size is a lower bound.
    let size = cause.size.unwrap();
    assert!(size > 0.0 && size < 1.2 * delay_s, "{size} s of {delay_s}");
}

/// Fifty samples late, 10 ms at 5 kHz, those of joint 2 alone.
#[test]
#[ignore = "long, each night"]
fn late_positions_of_a_joint_are_named_with_their_delay() {
    let clean = recording();
    let mut position = clean.position.clone();
    for k in 0..position.len() {
        position.sample_mut(k)[1] = clean.position.sample(k.saturating_sub(50))[1];
    }
    let causes = model(&identify(Recording { position, ..clean })).causes.clone();
    let size = size_of(&causes, CauseKind::LatePosition, "joint 2");
    assert!((size - 0.01).abs() < 0.003, "{causes:?}");
}

/// The causes of a recording whose torques were changed, sample by sample.
fn causes_of(change: impl Fn(&[f64], &mut [f64])) -> Vec<ModelCause> {
    let clean = recording();
    let mut torque = clean.torque.clone().unwrap();
    (0..torque.len()).for_each(|k| change(clean.position.sample(k), torque.sample_mut(k)));
    model(&identify(Recording { torque: Some(torque), ..clean })).causes.clone()
}

fn size_of(causes: &[ModelCause], kind: CauseKind, subject: &str) -> f64 {
    let cause = causes.iter().find(|c| c.kind == kind && c.subject == subject);
    cause.and_then(|c| c.size).unwrap_or_else(|| panic!("{causes:?}"))
}

#[test]
#[ignore = "long, each night"]
fn torques_that_sensors_and_springs_falsify_are_named_with_their_size() {
    let mixed = causes_of(|_, torque| torque[2] += 0.03 * torque[1]);
    let mixed = size_of(&mixed, CauseKind::Crosstalk, "joint 2 in joint 3");
    assert!((mixed - 0.03).abs() < 0.003, "{mixed}");

    let sprung = causes_of(|position, torque| torque[1] += 20.0 * position[1]);
    let sprung = size_of(&sprung, CauseKind::JointSpring, "joint 2");
    assert!((sprung - 20.0).abs() < 4.0, "{sprung}");

    let clean = recording().torque.unwrap().channel(0);
    let largest = clean.iter().fold(0.0, |largest: f64, torque| largest.max(torque.abs()));
    let falling = causes_of(|_, torque| torque[0] *= 1.0 + 0.1 * (torque[0] / largest).powi(2));
    let falling = size_of(&falling, CauseKind::FallingConstant, "joint 1");
    assert!(falling > 0.03 && falling < 0.2, "{falling}");
}

/// The motor of joint 3 turns with joint 2 too: its viscous friction, 0.4 N m s/rad, brakes what both turn.
#[test]
fn a_motor_that_turns_with_two_joints_is_named() {
    let mut twin = experiment();
    let text = include_str!("../../demo/tx40.toml").replace("[0, 0, 0, 0, 32, 32]", "[0, 0, 0, 0, 0, 32]");
    twin.robot = Robot::parse(&text, Path::new("tx40.toml")).unwrap();
    twin.settings.parameters = ParameterSelection::default();
    let described = twin.file.twin.as_mut().unwrap();
    described.parameters.retain(|name, _| name != "fcm6" && name != "fvm6");
    described.sensors.torque_noise.iter_mut().for_each(|noise| *noise *= 0.1);
    let clean = Recording { truth: None, ..twin.recordings(Path::new("")).unwrap().remove(0) };
    let mut torque = clean.torque.clone().unwrap();
    for k in 1..torque.len() - 1 {
        let [before, after] = [k - 1, k + 1].map(|k| clean.position.sample(k));
        let velocity = |j: usize| 0.5 * clean.sample_rate_hz * (after[j] - before[j]);
        let both = 0.4 * (velocity(1) + velocity(2));
        torque.sample_mut(k)[1..3].iter_mut().for_each(|tau| *tau += both);
    }
    let recordings = vec![Recording { torque: Some(torque), ..clean }];
    let results = Identification::new(&twin.robot, recordings, twin.settings).unwrap().run().unwrap();
    let causes = &model(&results).causes;
    let named = CauseKind::Coupling.with_subject("joints 2 and 3");
    assert!(causes.iter().any(|c| c.kind.with_subject(&c.subject) == named), "{causes:?}");
}

/// Torques of which those that are put in first would otherwise look like several other causes.
#[test]
#[ignore = "long, each night"]
fn torques_that_change_with_time_or_repeat_are_named() {
    let count = recording().position.len() as f64;
    let passed = std::cell::Cell::new(0.0);
    let drifting = causes_of(|_, torque| {
        passed.set(passed.get() + 1.0);
        torque.iter_mut().for_each(|t| *t *= 1.0 + 0.1 * passed.get() / count);
    });
    let drift = size_of(&drifting, CauseKind::GainDrift, "");
    assert!((drift - 0.1).abs() < 0.02, "{drift}");
    assert_eq!(drifting[0].kind, CauseKind::GainDrift, "{drifting:?}");

    let rippled = causes_of(|position, torque| torque[2] += 3.0 * (12.0 * position[2]).sin());
    let ripple = rippled.iter().find(|c| c.kind == CauseKind::TorqueRipple).unwrap_or_else(|| panic!("{rippled:?}"));
    let periods: f64 = ripple.subject.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!(ripple.subject.starts_with("joint 3, ") && (periods - 12.0).abs() < 0.5, "{}", ripple.subject);
}

/// The zero of joint 2 by 0.1 rad: the cause, or a rival that the recording cannot tell from it.
#[test]
fn a_wrong_encoder_zero_is_among_what_is_named() {
    let clean = recording();
    let mut position = clean.position.clone();
    (0..position.len()).for_each(|k| position.sample_mut(k)[1] += 0.1);
    let results = identify(Recording { position, ..clean });
    let zero = CauseKind::EncoderZero.with_subject("joint 2");
    let named = model(&results).causes.iter().flat_map(|c| {
        let own = c.kind.with_subject(&c.subject);
        [own].into_iter().chain(c.rivals.clone())
    });
    assert!(named.clone().any(|name| name == zero), "{:?}", named.collect::<Vec<_>>());
    assert_eq!(results.verdict, Some(Verdict::Care), "{:?}", results.verdict_reasons);
}

/// Equal errors of two gear ratios nearly hide each other: what shows alone is smaller than what shows with others, and
/// both at once are named.
#[test]
#[ignore = "long, each night"]
fn gear_ratios_that_hide_each_other_are_named_together() {
    let shown = &model(clean()).smallest_shown;
    let gear = shown.iter().find(|s| s.kind == CauseKind::GearRatio && s.subject == "joint 2").unwrap();
    let with_others = gear.size_with_others.unwrap();
    assert!(gear.size.is_some_and(|alone| with_others > alone), "{gear:?}");

    let recording = recording();
    let (mut position, mut torque) = (recording.position.clone(), recording.torque.clone().unwrap());
    for k in 0..position.len() {
        position.sample_mut(k)[1..3].iter_mut().for_each(|q| *q *= 1.0 + 2.0 * with_others);
        torque.sample_mut(k)[1..3].iter_mut().for_each(|t| *t /= 1.0 + 2.0 * with_others);
    }
    let results = identify(Recording { position, torque: Some(torque), ..recording });
    let causes = &model(&results).causes;
    assert!(causes.iter().any(|c| c.kind == CauseKind::GearRatio), "{causes:?}");
}

/// Friction of joint 2 that is 35 % larger in one direction and smaller in the other: so large an error is in the residual's own
/// deviations as well.
#[test]
fn friction_that_differs_by_direction_is_named_with_its_size() {
    let clean = recording();
    let larger = 0.35 * 3.0;
    let speed = |k: usize| {
        let position = |k: usize| clean.position.sample(k)[1];
        0.5 * clean.sample_rate_hz * (position(k + 1) - position(k - 1)).abs()
    };
    let mut torque = clean.torque.clone().unwrap();
    (1..torque.len() - 1).for_each(|k| torque.sample_mut(k)[1] += larger * speed(k));
    let results = identify(Recording { torque: Some(torque), ..recording() });
    let strongest = &model(&results).causes[0];
    assert_eq!((strongest.kind, strongest.subject.as_str()), (CauseKind::AsymmetricFriction, "joint 2"));
    let size = strongest.size.unwrap();
    assert!((size / larger - 1.0).abs() < 0.1, "{size} of {larger}");
}

/// The torque of joint 2 is 15 % too large.
#[test]
fn a_wrong_drive_gain_is_named_with_its_size() {
    let clean = recording();
    let mut torque = clean.torque.clone().unwrap();
    (0..torque.len()).for_each(|k| torque.sample_mut(k)[1] *= 1.15);
    let results = identify(Recording { torque: Some(torque), ..clean });
    let causes = &model(&results).causes;
    let gain = causes.iter().find(|c| c.kind == CauseKind::DriveGain && c.subject == "joint 2");
    let gain = gain.unwrap_or_else(|| panic!("{causes:?}"));
    let (size, deviation) = (gain.size.unwrap(), gain.standard_deviation.unwrap());
    assert!((size - 0.15).abs() < 3.0 * deviation && deviation < 0.05, "{size} +- {deviation}");
    assert_eq!(results.verdict, Some(Verdict::Care), "{:?}", results.verdict_reasons);
}

/// The torque sensor of joint 2 has another zero from the middle of the recording on.
#[test]
#[ignore = "long, each night"]
fn an_offset_that_jumps_is_named() {
    let Experiment { robot, mut settings, .. } = experiment();
    settings.signal.decimation = 20;
    let clean = recording();
    let mut torque = clean.torque.clone().unwrap();
    let length = torque.len();
    (length / 2..length).for_each(|k| torque.sample_mut(k)[1] += 5.0);
    let recording = Recording { torque: Some(torque), ..clean };
    let results = Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap();
    let causes = &model(&results).causes;
    assert!(causes.iter().any(|c| c.kind == CauseKind::OffsetDrift), "{causes:?}");
    assert!(results.verdict != Some(Verdict::Good), "{:?}", results.verdict_reasons);
}

/// A belt slips within 0.05 s: from then on the encoder of joint 2 has another zero, and the recording no step.
#[test]
#[ignore = "long, each night"]
fn an_encoder_that_slips_is_named_with_its_time() {
    let clean = recording();
    let mut position = clean.position.clone();
    let (start, slips) = (position.len() / 2, 0.05 * clean.sample_rate_hz);
    for k in start..position.len() {
        position.sample_mut(k)[1] += 0.06 * ((k - start) as f64 / slips).min(1.0);
    }
    let slipped_s = start as f64 / clean.sample_rate_hz;
    let length_s = position.len() as f64 / clean.sample_rate_hz;
    let results = identify(Recording { position, ..clean });
    let causes = &model(&results).causes;
    let slip = causes.iter().find(|c| c.kind == CauseKind::ZeroShift).unwrap_or_else(|| panic!("{causes:?}"));
    let time_s: f64 =
        slip.subject.strip_prefix("joint 2 at ").and_then(|t| t.strip_suffix(" s")).unwrap().parse().unwrap();
    assert!((time_s - slipped_s).abs() < length_s / 15.0, "{} of {slipped_s}", slip.subject);
    let (size, deviation) = (slip.size.unwrap().abs(), slip.standard_deviation.unwrap());
    assert!((size - 0.06).abs() < 2.5 * deviation && deviation < 0.012, "{slip:?}");
    assert_eq!(results.verdict, Some(Verdict::Care), "{:?}", results.verdict_reasons);
}

/// A recording of another robot's torques has a model that is not to be used.
#[test]
fn torques_that_do_not_belong_are_refused() {
    let clean = recording();
    let torque = clean.torque.as_ref().unwrap();
    let other: Vec<f64> = (0..torque.len())
        .flat_map(|k| {
            let t = k as f64 / clean.sample_rate_hz;
            (0..torque.channels()).map(move |j| (2.0 + j as f64) * (1.7 * t + j as f64).sin())
        })
        .collect();
    let torque = Some(Series::from_values(torque.channels(), other).unwrap());
    let results = identify(Recording { torque, ..clean });
    assert_eq!(results.verdict, Some(Verdict::DoNotUse), "{:?}", results.verdict_reasons);
    assert!(model(&results).uses.iter().all(|u| u.verdict == Verdict::DoNotUse));
}

/// A friction that a data sheet gives holds in the model, its export, and every sample of it.
#[test]
fn the_model_is_exported_as_it_is_and_samples_keep_what_is_given() {
    let mut experiment = experiment();
    let fv1 = clean().runs[0].parameter("fv1").unwrap().estimate;
    let known = format!("[[parameters.known]]\nkind = \"parameter\"\nname = \"fv1\"\nvalue = {fv1}\n");
    let stated: Settings = toml::from_str(&format!("{known}[signal]\ncutoff_hz = 50\ndecimation = 10\n")).unwrap();
    experiment.settings.parameters.known = stated.parameters.known;
    experiment.settings.parameters.physical = true;
    let results = experiment.run(Path::new(""), &mut |_| {}).unwrap();
    let request = EstimateRequest { untrusted: true, ..EstimateRequest::default() };
    let exported = IdentifiedModel::of_results(Path::new("results.json"), &results, &request).unwrap();
    let standard: Vec<f64> = model(&results).standard.iter().map(|p| p.value).collect();
    assert_eq!(exported.standard, standard);
    exported.export(ExportFormat::Urdf).unwrap().check().unwrap();
    let place = exported.identified.robot.parameter_table().index_of("fv1").unwrap();
    assert!((standard[place] - fv1).abs() < 1e-9 * fv1);
    for number in 1..=3 {
        let sample = exported.sample(number, 1).unwrap();
        assert!((sample.standard[place] - fv1).abs() < 1e-6 * fv1, "{} {fv1}", sample.standard[place]);
    }
    exported.covariance_json().unwrap();
}

/// Predicted torques of parts of a motion that begin and end while the robot moves: at their ends near the measured ones as well, where a
/// filter that reflects the motion was off by many times the torque.
#[test]
#[ignore = "long, each night"]
fn a_prediction_holds_to_the_ends_of_a_motion_that_does_not_rest_there() {
    let Experiment { robot, settings, .. } = experiment();
    let whole = recording();
    let identification = Identification::new(&robot, vec![whole.clone()], settings).unwrap();
    let results = identification.run().unwrap();
    let identified =
        IdentifiedRobot::of_identification(&identification, &results, &EstimateRequest::default()).unwrap();
    let torque = whole.torque.as_ref().unwrap();
    let (part, end) = (whole.position.len() / 2, whole.position.len() / 200);
    // Squared errors and torques at the ends of the parts, and between them.
    let mut sums = [[0.0; 2]; 2];
    for start in (0..part).step_by(part / 20) {
        let range = start..start + part;
        let measured = torque.window(range.clone());
        let position = whole.position.window(range);
        let predicted = identified.predict(Recording::new(whole.sample_rate_hz, position, measured.clone())).unwrap();
        for k in 0..part {
            let sum = &mut sums[usize::from((end..part - end).contains(&k))];
            for (found, tau) in predicted.torque.sample(k).iter().zip(measured.sample(k)) {
                sum[0] += (found - tau).powi(2);
                sum[1] += tau * tau;
            }
        }
    }
    let [ends, between] = sums.map(|[error, torque]| 100.0 * (error / torque).sqrt());
    println!("{ends} % at the ends, {between} % between them");
    assert!(ends < 3.0 * between, "{ends} % at the ends, {between} % between them");
}

/// The motor of a wrist is 10^5 times heavier than the description's link, which knows no motor: the torques decide.
#[test]
#[ignore = "long, each night"]
fn a_motor_that_is_much_heavier_than_its_link_is_found() {
    let Experiment { mut robot, settings, .. } = experiment();
    robot.a_priori.remove("ia6");
    robot.a_priori.iter_mut().filter(|(name, _)| name.ends_with('6')).for_each(|(_, value)| *value *= 1e-3);
    let results = Identification::new(&robot, vec![recording()], settings).unwrap().run().unwrap();
    let motor = model(&results).parameters.iter().find(|p| p.name == "ia6").unwrap();
    let error = motor.value / motor.true_value.unwrap() - 1.0;
    assert!(error.abs() < 0.03, "{motor:?}");
}

/// Friction in proportion to the load, which the description has not: the model has a term for it, and predictions use it.
#[test]
#[ignore = "long, each night"]
fn friction_that_the_description_lacks_is_a_term_of_the_model() {
    let load = TermDescription::LoadFriction { joints: None };
    let mut twin = experiment();
    twin.robot.add_terms(std::slice::from_ref(&load)).unwrap();
    let described = twin.file.twin.as_mut().unwrap();
    described.sensors.torque_noise.iter_mut().for_each(|noise| *noise *= 0.1);
    described.parameters.extend(["fl2", "fl3"].map(|name| (name.to_owned(), 0.1)));
    let recording = Recording { truth: None, ..twin.recordings(Path::new("")).unwrap().remove(0) };

    let Experiment { robot, settings, .. } = experiment();
    let identification = Identification::new(&robot, vec![recording.clone()], settings).unwrap();
    let results = identification.run().unwrap();
    let model = model(&results);
    assert_eq!(model.terms, [load], "{:?}", model.candidates);
    let value = |name: &str| model.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert!((value("fl2") / 0.1 - 1.0).abs() < 0.2 && (value("fl3") / 0.1 - 1.0).abs() < 0.2, "{:?}", model.parameters);
    let cause = model.causes.iter().find(|c| c.kind == CauseKind::LoadFriction).unwrap();
    assert!(cause.in_model && results.verdict == Some(Verdict::Care), "{:?}", results.verdict_reasons);

    let error = |method| {
        let request = EstimateRequest { method, untrusted: true, ..EstimateRequest::default() };
        let identified = IdentifiedRobot::of_identification(&identification, &results, &request).unwrap();
        identified.predict(recording.clone()).unwrap().all_samples_error_percent.unwrap()
    };
    let (with_term, without) = (error(None), error(Some(Method::IDIM_LS)));
    assert!(with_term < 0.7 * without, "{with_term} % with the term, {without} % without");
}

/// Friction that fades with the speed within the reversals: the model gets a term for it, and its own velocity of the transition.
#[test]
#[ignore = "long, each night"]
fn friction_that_fades_next_to_rest_is_a_term_of_the_model() {
    let clean = recording();
    let mut torque = clean.torque.clone().unwrap();
    for k in 1..torque.len() - 1 {
        let [before, after] = [k - 1, k + 1].map(|k| clean.position.sample(k).to_vec());
        for (j, tau) in torque.sample_mut(k).iter_mut().enumerate() {
            let dq = 0.5 * clean.sample_rate_hz * (after[j] - before[j]);
            *tau += 3.0 * (-(dq / 0.2).powi(2)).exp() * (dq / 0.01).tanh();
        }
    }
    let results = identify(Recording { torque: Some(torque), truth: None, ..clean });
    let model = model(&results);
    let fades = |term: &TermDescription| matches!(term, TermDescription::ExponentialStribeck { .. });
    assert!(model.terms.iter().any(fades), "{:?} {:?}", model.terms, model.causes);
    assert_eq!(results.verdict, Some(Verdict::Care), "{:?}", results.verdict_reasons);
}
