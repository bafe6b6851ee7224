use std::sync::OnceLock;

use super::twin::{Log, RATE_HZ, STILL_AT, Twin, largest_difference, largest_error, run_of, truth};
use crate::{Experiment, Results, experiment::ExperimentError};
use thetahat_estimation::{checks::Code, signal::delayed};
use thetahat_ground::series::Series;
use thetahat_report::results::{ModelParameter, RecordingStep, Remedy, RemedySignal, RemedyStep, Verdict};

const KEYS: &str = "[signal]\ncutoff_hz = 15\ndecimation = 8\n\n[estimation]\nmethods = [\"idim-ls\"]\n";

/// Friction of the remedied twin against the truth: the noise of the torques gives 2 %.
const NEAR_TRUTH: f64 = 0.06;
/// Estimates of the remedied twin against those of the twin without the fault, half widths of an interval.
const SAME: f64 = 0.3;
/// The same where the remedy is a number that was estimated, whose own deviation the intervals do not have.
const NEARLY_SAME: f64 = 1.0;
/// The same of a ratio.
const RATIO: f64 = 6.0;

fn codes(results: &Results) -> Vec<&str> {
    // Parameters that are hardly excited can be left out of any recording.
    results.remedies.iter().map(|remedy| remedy.code.as_str()).filter(|code| *code != "not-excited").collect()
}

fn remedy<'r>(results: &'r Results, code: &str) -> &'r Remedy {
    let found = results.remedies.iter().find(|remedy| remedy.code == code);
    found.unwrap_or_else(|| panic!("{code} is not among {:?}; {:?}", codes(results), results.verdict_reasons))
}

/// The results without a fault.
fn clean() -> &'static Results {
    static CLEAN: OnceLock<Results> = OnceLock::new();
    CLEAN.get_or_init(|| {
        let twin = Twin::new();
        let results = twin.run(&twin.experiment(KEYS));
        assert!(codes(&results).is_empty(), "{:?}", codes(&results));
        assert!(largest_error(&results) < NEAR_TRUTH, "{}", largest_error(&results));
        results
    })
}

/// Runs a twin with a fault, and again with the remedies of these codes; returns both.
fn mended(fault: impl FnOnce(&mut Log), wanted: &[&str], same: f64) -> (Results, Results) {
    let clean = clean();
    let twin = Twin::new().with(fault);
    let experiment = twin.experiment(KEYS);
    let before = twin.run(&experiment);
    wanted.iter().for_each(|code| {
        remedy(&before, code);
    });
    let others: Vec<&str> = codes(&before).into_iter().filter(|code| !wanted.contains(code)).collect();
    assert!(others.is_empty(), "other than {wanted:?}: {others:?}");
    let after = twin.remedied(&experiment, &before, wanted);
    let (error, difference) = (largest_error(&after), largest_difference(&after, clean));
    println!(
        "{wanted:?}: friction off by {error:.3}, before {:.3}; {difference:.3} half widths",
        largest_error(&before)
    );
    println!("before: {:.3} half widths", largest_difference(&before, clean));
    assert!(error < NEAR_TRUTH, "{wanted:?}: friction is off by {error}");
    assert!(difference < same, "{wanted:?}: {difference} half widths from the twin without the fault");
    assert!(codes(&after).is_empty(), "{:?}", codes(&after));
    (before, after)
}

fn scale(series: &mut Series, joint: usize, factor: f64) {
    (0..series.len()).for_each(|k| series.sample_mut(k)[joint] *= factor);
}

fn exchange_torques(log: &mut Log) {
    (0..log.torque.len()).for_each(|k| log.torque.sample_mut(k).swap(1, 2));
}

#[test]
#[ignore = "long, each night"]
fn exchanged_torques_are_exchanged_back() {
    let (before, _) = mended(exchange_torques, &["joints-swapped-2-3"], SAME);
    assert_eq!(remedy(&before, "joints-swapped-2-3").label, "Exchange the torques of joints 2 and 3");
    let reason = before.verdict_reasons.iter().find(|r| r.remedies.contains(&"joints-swapped-2-3".to_owned()));
    assert!(reason.is_some(), "{:?}", before.verdict_reasons);
}

/// Channels 1 to 3 are those of joints 2, 3 and 1.
#[test]
#[ignore = "long, each night"]
fn joints_in_a_circle_are_put_in_order() {
    let fault = |log: &mut Log| {
        for series in [&mut log.position, &mut log.torque] {
            (0..series.len()).for_each(|k| series.sample_mut(k)[..3].rotate_left(1));
        }
    };
    let (before, _) = mended(fault, &["joints-swapped"], SAME);
    assert_eq!(remedy(&before, "joints-swapped").label, "Take joints in the order 3, 1, 2, 4, 5, 6, 7");
}

#[test]
#[ignore = "long, each night"]
fn a_joint_that_turns_the_other_way_is_reversed() {
    let fault = |log: &mut Log| {
        scale(&mut log.position, 3, -1.0);
        scale(&mut log.torque, 3, -1.0);
    };
    mended(fault, &["position-sign-4"], SAME);
}

/// What a driver takes out of the torques is in no setting: it is named, and there is no remedy.
fn named_without_remedy(twin: &Twin, code: Code, words: &str) {
    let results = twin.run(&twin.experiment(KEYS));
    let is_named =
        results.findings.iter().flat_map(|r| &r.findings).any(|f| f.code == code && f.message.contains(words));
    assert!(is_named, "{:?}", results.findings);
    assert!(codes(&results).is_empty(), "{:?}", codes(&results));
    assert_eq!(results.verdict, Some(Verdict::DoNotUse));
}

#[test]
fn friction_that_a_driver_compensates_too_much_is_no_wrong_sign() {
    let compensated = |j: usize, dq: f64, _: f64| -1.3 * (3.0 * dq + 2.0 * dq.signum()) / (j + 1) as f64;
    named_without_remedy(&Twin::with_friction(&compensated), Code::NegativeFriction, "more friction out of them");
}

#[test]
#[ignore = "long, each night"]
fn weight_that_a_driver_compensates_by_a_model_of_its_own_is_named() {
    let twin = Twin::with_friction(&|_, _, gravity| -0.85 * gravity);
    named_without_remedy(&twin, Code::GravityDirection, "better with 15 % of gravity");
}

#[test]
#[ignore = "long, each night"]
fn torques_with_the_opposite_sign_are_reversed_together() {
    let fault = |log: &mut Log| log.torque.values_mut().iter_mut().for_each(|t| *t = -*t);
    let (before, _) = mended(fault, &["torque-sign"], SAME);
    let remedy = remedy(&before, "torque-sign");
    assert_eq!(remedy.label, "Reverse the torque of all joints");
    let change = &remedy.changes[0];
    assert_eq!(
        (change.key.as_str(), change.after.as_deref(), change.before.as_deref()),
        ("recording.torque.gain", Some("-1.0"), None)
    );
}

#[test]
#[ignore = "long, each night"]
fn one_torque_with_the_opposite_sign_is_reversed() {
    mended(|log| scale(&mut log.torque, 3, -1.0), &["torque-sign-4"], SAME);
}

#[test]
#[ignore = "long, each night"]
fn one_position_with_the_opposite_sign_is_reversed() {
    mended(|log| scale(&mut log.position, 2, -1.0), &["position-sign-3"], SAME);
}

/// The check takes position and torque of joint 2 for reversed, and finds that much is left.
#[test]
#[ignore = "long, each night"]
fn a_correction_that_leaves_much_is_no_remedy() {
    let twin = Twin::new().with(|log| scale(&mut log.position, 1, -1.0));
    let results = twin.run(&twin.experiment(KEYS));
    assert!(results.findings.iter().flat_map(|r| &r.findings).any(|f| f.code == Code::PositionSign));
    assert!(codes(&results).is_empty(), "{:?}", codes(&results));
}

#[test]
fn two_faults_are_mended_together() {
    let fault = |log: &mut Log| {
        exchange_torques(log);
        scale(&mut log.torque, 4, -1.0);
    };
    mended(fault, &["joints-swapped-2-3", "torque-sign-5"], SAME);
}

#[test]
fn degrees_get_their_unit() {
    let fault = |log: &mut Log| log.position.values_mut().iter_mut().for_each(|q| *q = q.to_degrees());
    let (before, _) = mended(fault, &["position-scale"], SAME);
    assert_eq!(remedy(&before, "position-scale").label, "Unit of position: deg");
}

#[test]
#[ignore = "long, each night"]
fn torques_a_thousand_times_too_large_get_their_unit() {
    let fault = |log: &mut Log| log.torque.values_mut().iter_mut().for_each(|t| *t *= 1e3);
    let (before, after) = mended(fault, &["a-priori-scale"], SAME);
    assert_eq!(remedy(&before, "a-priori-scale").label, "Unit of torque: mN m");
    let is_said = after.verdict_reasons.iter().any(|reason| reason.text.contains("the unit of the torque is a guess"));
    assert!(is_said && after.verdict == Some(Verdict::Care), "{:?}", after.verdict_reasons);
}

/// A current in mA of 1.4 N m/A has no unit that the masses show.
#[test]
fn torques_that_are_currents_get_no_unit() {
    let twin = Twin::new().with(|log| log.torque.values_mut().iter_mut().for_each(|t| *t *= 700.0));
    let results = twin.run(&twin.experiment(KEYS));
    assert!(results.findings.iter().flat_map(|r| &r.findings).any(|f| f.code == Code::APrioriScale));
    assert!(codes(&results).is_empty(), "{:?}", codes(&results));
}

#[test]
#[ignore = "long, each night"]
fn late_torques_get_their_delay() {
    let fault = |log: &mut Log| {
        let early = log.torque.clone();
        (3..early.len()).for_each(|k| log.torque.sample_mut(k).copy_from_slice(early.sample(k - 3)));
    };
    let (before, _) = mended(fault, &["lag"], NEARLY_SAME);
    let remedy = remedy(&before, "lag");
    let delay: f64 = remedy.changes[0].after.as_ref().unwrap().parse().unwrap();
    assert!((delay - 3.0 / RATE_HZ).abs() < 0.1 / RATE_HZ, "{delay}");
    assert!(remedy.label.starts_with("Torque 1") && remedy.label.ends_with(" ms late"), "{}", remedy.label);
}

#[test]
#[ignore = "long, each night"]
fn torques_of_another_clock_get_their_delay() {
    let late = 80;
    let fault = |log: &mut Log| {
        let early = log.torque.clone();
        (late..early.len()).for_each(|k| log.torque.sample_mut(k).copy_from_slice(early.sample(k - late)));
    };
    let (before, _) = mended(fault, &["lag"], NEARLY_SAME);
    let delay: f64 = remedy(&before, "lag").changes[0].after.as_ref().unwrap().parse().unwrap();
    assert!((delay - late as f64 / RATE_HZ).abs() < 0.1 / RATE_HZ, "{delay}");
    assert_eq!(before.verdict, Some(Verdict::DoNotUse), "{:?}", before.verdict_reasons);
}

/// Someone pushes the arm twice: its first joints hold against it.
#[test]
#[ignore = "long, each night"]
fn times_of_an_external_force_are_left_out() {
    let fault = |log: &mut Log| {
        for (from, length) in [(6.0, 0.8), (13.0, 0.5)] {
            let pushed = |t: f64| (std::f64::consts::PI * ((t - from) / length).clamp(0.0, 1.0)).sin();
            for k in 0..log.torque.len() {
                let push = pushed(log.time[k]);
                log.torque.sample_mut(k).iter_mut().take(3).for_each(|torque| *torque += 20.0 * push);
            }
        }
    };
    let (before, _) = mended(fault, &["external-force"], NEARLY_SAME);
    let remedy = remedy(&before, "external-force");
    let RemedyStep::LeaveOutTimes { times } = &remedy.steps[0].step else { panic!("{:?}", remedy.steps) };
    let holds = |from: f64, to: f64| times.iter().any(|time| time[0] <= from && time[1] >= to && to - from < 1.5);
    assert!(times.len() == 2 && holds(6.1, 6.7) && holds(13.1, 13.4), "{times:?}");
}

/// A recorder's range ends at three quarters of the largest torque of joint 2; noise follows.
#[test]
#[ignore = "long, each night"]
fn times_at_which_a_torque_is_clipped_are_left_out() {
    let fault = |log: &mut Log| {
        let range = 0.75 * log.torque.channel(1).iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        for k in 0..log.torque.len() {
            let noise = 1e-3 * range * (12.9898 * k as f64).sin() * (78.233 * k as f64).cos();
            let torque = &mut log.torque.sample_mut(k)[1];
            *torque = torque.clamp(-range, range) + noise;
        }
    };
    let (before, after) = mended(fault, &["torque-saturated-2"], NEARLY_SAME);
    assert_eq!((before.verdict, after.verdict), (Some(Verdict::DoNotUse), Some(Verdict::Good)));
}

#[test]
#[ignore = "long, each night"]
fn torques_that_are_held_are_said_to_be() {
    let fault = |log: &mut Log| log.torque = delayed(&log.torque, &vec![-0.5; log.torque.channels()]);
    let (before, _) = mended(fault, &["lag"], NEARLY_SAME);
    assert_eq!(remedy(&before, "lag").label, "Torque held until the next sample");
}

/// The ratio is an estimate: the runs take it as exact, the intervals of the model have its deviation.
#[test]
fn a_wrong_gear_ratio_that_the_model_names_is_corrected() {
    let fault = |log: &mut Log| {
        scale(&mut log.position, 1, 1.02);
        scale(&mut log.torque, 1, 1.0 / 1.02);
    };
    let (before, after) = mended(fault, &["gear-ratio-2"], RATIO);
    let [model, clean] = [&after, clean()].map(|results| results.model.as_ref().unwrap());
    assert_eq!(model.estimated_sizes, ["gear-ratio-2"]);
    let holds = |(own, clean): &(&ModelParameter, &ModelParameter)| {
        let [low, high] = own.interval_95.unwrap();
        low <= clean.value && clean.value <= high
    };
    let held = model.parameters.iter().zip(&clean.parameters).filter(holds).count();
    assert!(held as f64 >= 0.95 * clean.parameters.len() as f64, "{held} of {}", clean.parameters.len());
    let torque = remedy(&before, "gear-ratio-2").changes.iter().find(|c| c.key == "recording.torque.gain").unwrap();
    let gains: Vec<f64> =
        torque.after.as_ref().unwrap().trim_matches(['[', ']']).split(", ").map(|g| g.parse().unwrap()).collect();
    assert!((gains[1] - 1.02).abs() < 0.003 && gains[0] == 1.0, "{gains:?}");
}

/// Half a degree about y.
#[test]
#[ignore = "long, each night"]
fn a_tilted_base_gets_its_gravity() {
    let tilt = 0.5_f64.to_radians();
    let twin = Twin::with_gravity([9.81 * tilt.sin(), 0.0, -9.81 * tilt.cos()]);
    let experiment = twin.experiment(KEYS);
    let before = twin.run(&experiment);
    let after = twin.remedied(&experiment, &before, &["gravity-direction"]);
    assert_eq!(after.model.as_ref().unwrap().estimated_sizes, ["gravity-direction"]);
    let after_x = remedy(&before, "gravity-direction").changes[0].after.as_ref().unwrap();
    let found: f64 = after_x.trim_matches(['[', ']']).split(", ").next().unwrap().parse().unwrap();
    assert!((found - 9.81 * tilt.sin()).abs() < 0.01, "{after_x}");
    // On a tilted base the first joint has parameters of its weight: names of the others stay.
    let [wrong, mended] = [&before, &after].map(largest_error);
    assert!(mended < NEAR_TRUTH, "{wrong} {mended}");
    assert!(codes(&after).is_empty(), "{:?}", codes(&after));
}

#[test]
#[ignore = "long, each night"]
fn a_spring_that_nobody_described_gets_its_term() {
    let twin = Twin::new().with(|log: &mut Log| {
        for k in 0..log.torque.len() {
            log.torque.sample_mut(k)[2] += 5.0 * log.position.sample(k)[2];
        }
    });
    let experiment = twin.experiment(KEYS);
    let before = twin.run(&experiment);
    let after = twin.remedied(&experiment, &before, &["joint-spring-3"]);
    let run = after.runs.first().unwrap();
    let stiffness = run.parameters.iter().find(|p| p.name == "k3").unwrap();
    let [low, high] = stiffness.interval_95.unwrap();
    assert!(low < 5.0 && 5.0 < high && high - low < 1.0, "{stiffness:?}");
    assert!(codes(&after).is_empty(), "{:?}", codes(&after));
}

/// Inertias and friction take a wrong rate up, but not next to the weight of the same links.
#[test]
fn times_that_are_twice_as_long_are_named() {
    let twin = Twin::new().with(|log: &mut Log| log.time.iter_mut().for_each(|time| *time *= 2.0));
    let results = twin.run(&twin.experiment(KEYS));
    let finding = results.findings.iter().flat_map(|r| &r.findings).find(|f| f.code == Code::TimeScale);
    let finding = finding.unwrap_or_else(|| panic!("{:?}", results.verdict_reasons));
    assert!(finding.message.contains("if 100.0 Hz were 2"), "{}", finding.message);
    assert_eq!(results.verdict, Some(Verdict::DoNotUse), "{:?}", results.verdict_reasons);
    assert!(clean().findings.iter().flat_map(|r| &r.findings).all(|f| f.code != Code::TimeScale));
}

/// A filter looks like a delay until its delay is stated; what is late afterwards is of the filter.
#[test]
fn a_filter_of_the_torques_is_undone() {
    let time_constant_s = 0.03;
    let gain = 1.0 - (-1.0 / (time_constant_s * RATE_HZ)).exp();
    let twin = Twin::new().with(|log: &mut Log| {
        for k in 1..log.torque.len() {
            let last = log.torque.sample(k - 1).to_vec();
            log.torque.sample_mut(k).iter_mut().zip(last).for_each(|(now, last)| *now = last + gain * (*now - last));
        }
    });
    let mut experiment = twin.experiment(KEYS);
    for code in ["lag", "torque-filter", "lag"] {
        let results = twin.run(&experiment);
        assert_eq!(
            codes(&results),
            [code],
            "{:?} {:?}",
            results.verdict_reasons,
            results.model.as_ref().unwrap().causes
        );
        assert_eq!(results.verdict, Some(Verdict::Care), "{:?}", results.verdict_reasons);
        experiment = twin.read(experiment.with_remedies(&results.remedies, &[code.to_owned()]).unwrap());
    }
    let results = twin.run(&experiment);
    let late_s = results.model.as_ref().unwrap().causes.iter().filter_map(|cause| cause.size).sum::<f64>();
    let found = experiment.file.recording[0].torque.as_ref().unwrap().low_pass_s.unwrap();
    assert!(late_s.abs() * RATE_HZ < 0.3, "{late_s} s");
    assert!(((found + late_s) / time_constant_s - 1.0).abs() < 0.05, "{found} s and {late_s} s");
    assert!(codes(&results).is_empty(), "{:?}", codes(&results));
    assert!(largest_error(&results) < NEAR_TRUTH, "{}", largest_error(&results));
}

/// Fifteen milliseconds of seven joints' one.
#[test]
#[ignore = "long, each night"]
fn a_torque_of_one_joint_that_is_late_gets_its_delay() {
    let fault = |log: &mut Log| {
        let delays: Vec<f64> = (0..log.torque.channels()).map(|j| if j == 3 { 3.0 } else { 0.0 }).collect();
        log.torque = delayed(&log.torque, &delays);
    };
    let (before, _) = mended(fault, &["lag-4"], NEARLY_SAME);
    let label = &remedy(&before, "lag-4").label;
    assert!(label.starts_with("Torque of joint 4 1") && label.ends_with("ms late"), "{label}");
}

/// The friction that the load adds is a parameter of its own: 0.1 of the torque of gravity.
#[test]
#[ignore = "long, each night"]
fn friction_of_the_load_gets_its_term() {
    let twin = Twin::with_friction(&|_, dq, gravity| 0.1 * gravity.abs() * dq.signum());
    let experiment = twin.experiment(KEYS);
    let before = twin.run(&experiment);
    remedy(&before, "load-friction");
    let after = twin.remedied(&experiment, &before, &["load-friction"]);
    let run = after.runs.first().unwrap();
    let load = run.parameters.iter().find(|p| p.name.starts_with("fl2")).unwrap();
    assert!((load.estimate - 0.1).abs() < 0.01, "{}", load.estimate);
    assert!(largest_error(&after) < NEAR_TRUTH, "{}", largest_error(&after));
    assert!(!codes(&after).contains(&"load-friction"));
}

#[test]
#[ignore = "long, each night"]
fn a_filter_that_removes_motion_is_raised() {
    let twin = Twin::new();
    let experiment = twin.experiment(&KEYS.replace("cutoff_hz = 15", "cutoff_hz = 0.6 # low"));
    let before = twin.run(&experiment);
    let after = twin.remedied(&experiment, &before, &["cutoff-low"]);
    let errors = [&before, &after, clean()].map(largest_error);
    println!("{errors:?}");
    assert!(errors[1] < NEAR_TRUTH && errors[1] < 0.5 * errors[0], "{errors:?}");
}

#[test]
#[ignore = "long, each night"]
fn samples_stamped_on_arrival_are_taken_as_equally_spaced() {
    // Stamps that jitter by more are taken so when they are read.
    let fault = |log: &mut Log| {
        let late = |k: usize| 0.2 * ((k * 7919) % 101) as f64 / 101.0 / RATE_HZ;
        log.time.iter_mut().enumerate().for_each(|(k, t)| *t += late(k));
    };
    let (before, _) = mended(fault, &["clock-jitter"], SAME);
    let keys: Vec<&str> = remedy(&before, "clock-jitter").changes.iter().map(|c| c.key.as_str()).collect();
    assert_eq!(keys, ["recording.time", "recording.sample_rate_hz"]);
}

#[test]
#[ignore = "long, each night"]
fn rests_are_left_out() {
    let twin = Twin::new().with(|log| {
        let n = log.position.channels();
        let rest = |series: &Series| -> Series {
            let first = series.sample(0).to_vec();
            let values = (0..800).flat_map(|_| first.clone()).chain(series.values().iter().copied()).collect();
            Series::shaped(n, values)
        };
        (log.position, log.torque) = (rest(&log.position), rest(&log.torque));
        log.time = (0..log.position.len()).map(|k| k as f64 / RATE_HZ).collect();
    });
    let experiment =
        twin.experiment(&KEYS.replace("decimation = 8", "decimation = 8\nmask = \"none\"\nwindow_start_s = 0.1"));
    let before = twin.run(&experiment);
    remedy(&before, "still-period");
    let after = twin.remedied(&experiment, &before, &["still-period"]);
    assert!(largest_error(&after) < largest_error(&before).max(NEAR_TRUTH), "{}", largest_error(&after));
    assert!(!codes(&after).contains(&"still-period"));
}

#[test]
fn an_unknown_code_is_refused_with_those_that_there_are() {
    let twin = Twin::new().with(exchange_torques);
    let experiment: Experiment = twin.experiment(KEYS);
    let results = twin.run(&experiment);
    let error = experiment.with_remedies(&results.remedies, &["lag".to_owned()]).unwrap_err();
    assert!(matches!(&error, ExperimentError::UnknownRemedy { code, known, .. } if code == "lag" && !known.is_empty()));
    assert!(error.to_string().contains("joints-swapped-2-3 (Exchange the torques of joints 2 and 3)"), "{error}");
}

/// A joint that is held still is locked where it is, and its columns are left out.
#[test]
#[ignore = "long, each night"]
fn a_joint_that_does_not_move_is_locked() {
    let twin = Twin::with_still_joint(5);
    let experiment = twin.experiment(KEYS);
    let before = twin.run(&experiment);
    let remedy = remedy(&before, "joint-still-6");
    assert_eq!(remedy.label, "Lock joint 6");
    let after = twin.remedied(&experiment, &before, &["joint-still-6"]);
    assert_eq!(after.robot_locked.len(), 1);
    assert!((after.robot_locked[0].value - STILL_AT).abs() < 1e-6, "{:?}", after.robot_locked);
    let run = after.runs.first().unwrap();
    for (name, value) in truth().filter(|(name, _)| !name.ends_with('6') && !name.ends_with('7')) {
        let found = run.parameter(&name).unwrap().estimate;
        assert!((found / value - 1.0).abs() < NEAR_TRUTH, "{name}: {found}, not {value}");
    }
    // The locked joint is no joint any more: joint 7 is the sixth.
    assert!(!codes(&after).iter().any(|code| code.starts_with("joint-still")), "{:?}", codes(&after));
}

/// Leaving out what is hardly excited makes the error on parts left out no larger, and leaves the other values.
#[test]
fn parameters_that_are_not_essential_are_left_out() {
    // Whether the error falls is chance where the motion is rich: a part of the recording is taken in which it does.
    let of_part = |end: usize| {
        let twin = Twin::new().with(|log| {
            (log.position, log.torque) = (log.position.window(0..end), log.torque.window(0..end));
            log.time.truncate(end);
        });
        let experiment = twin.experiment(KEYS);
        let before = twin.run(&experiment);
        before.remedies.iter().any(|remedy| remedy.code == "not-excited").then_some((twin, experiment, before))
    };
    let (twin, experiment, before) = (6..16).find_map(|part| of_part(250 * part)).expect("a part with the remedy");
    let before = &before;
    let remedy = remedy(before, "not-excited");
    assert!(remedy.label.starts_with("Leave out "), "{}", remedy.label);
    let after = twin.remedied(&experiment, before, &["not-excited"]);
    let error = |results: &Results| run_of(results).cross_validation_relative_error_percent.unwrap();
    assert!(error(&after) <= 1.01 * error(before), "{}, before {}", error(&after), error(before));
    assert!(largest_error(&after) < NEAR_TRUTH, "{}", largest_error(&after));
    assert!(run_of(&after).parameters.len() < run_of(before).parameters.len());
}

/// The remedies of a results.json from elsewhere cannot write more than a comment and the keys of their steps.
#[test]
fn a_hostile_remedy_stays_in_its_comment() {
    let twin = Twin::new();
    let experiment = twin.experiment(KEYS);
    let step = |step: RemedyStep| RecordingStep {
        recording: Some("1".to_owned()),
        held_back: false,
        with_reference: false,
        with_velocity: false,
        step,
    };
    let remedy = |code: &str, steps| Remedy {
        code: code.to_owned(),
        label: "a\n[signal]\ncutoff_hz = 1".to_owned(),
        found: "b\nrobot = \"/etc/passwd\"".to_owned(),
        finding: None,
        also: Vec::new(),
        cause: None,
        changes: Vec::new(),
        steps,
    };
    let code = "c\nrobot = 1";
    let text = experiment
        .with_remedies(
            &[remedy(code, vec![step(RemedyStep::Delay { delay_s: 0.01, joints: Vec::new() })])],
            &[code.to_owned()],
        )
        .unwrap();
    let [before, after]: [toml::Table; 2] = [&experiment.text, &text].map(|text| toml::from_str(text).unwrap());
    let mut expected = before;
    expected["recording"]["torque"].as_table_mut().unwrap().insert("delay_s".to_owned(), 0.01.into());
    assert_eq!(after, expected);
    for wrong in [
        RemedyStep::OrderJoints { signal: RemedySignal::Torque, order: vec![0, 1, 2, 3, 4, 5, 6] },
        RemedyStep::OrderJoints { signal: RemedySignal::Both, order: vec![99, 2, 3, 4, 5, 6, 1] },
        RemedyStep::OrderJoints { signal: RemedySignal::Both, order: vec![2, 1] },
        RemedyStep::Scale { position: vec![2.0], torque: Vec::new() },
        RemedyStep::LockJoint { joint: 0, name: "j1".to_owned(), value: 0.0 },
        RemedyStep::CorrectReference { delay_s: vec![0.0], scale: Vec::new(), offset: Vec::new() },
    ] {
        let error = experiment.with_remedies(&[remedy("x", vec![step(wrong)])], &["x".to_owned()]).unwrap_err();
        assert!(matches!(error, ExperimentError::NoRemedy { .. }), "{error}");
    }
}
