//! Several recordings in one identification, on a joint whose torque is known in closed form:
//! tau = ia ddq + fv dq + fc sign(dq) + off.

use std::{fmt::Write as _, path::Path};

use thetahat::Results;
use thetahat::checks::{Code, Severity};
use thetahat::{Experiment, experiment::ExperimentError};
use thetahat_testing::Folder;

const ROBOT: &str = "name = 'joint'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
const SIGNAL: &str = "[signal]\ncutoff_hz = 60\ndecimation = 10\nmask = 'none'\n[estimation]\nmethods = ['idim-ls']\n";
const RATE: f64 = 1000.0;
/// ia, fv, fc, off.
const TRUTH: [f64; 4] = [0.7, 3.0, 1.5, 0.2];
/// What band-pass and central differences leave of a noise-free motion, relative.
const FILTER: f64 = 2e-3;

/// A folder of recordings.
struct Recordings(Folder);

impl Recordings {
    fn new() -> Self {
        Self(Folder::new())
    }

    /// Writes 8 s of a motion of two sines, with the offset of the torque and the times as given.
    fn write(&self, name: &str, slow_hz: f64, off: f64, time: impl Fn(usize) -> f64) {
        let mut text = "t,q,tau\n".to_owned();
        for k in 0..8000 {
            let t = time(k);
            let (w, v) = (2.0 * std::f64::consts::PI * slow_hz, 2.0 * std::f64::consts::PI * 1.7);
            let q = (w * t).sin() + 0.3 * (v * t).cos();
            let dq = w * (w * t).cos() - 0.3 * v * (v * t).sin();
            let ddq = -w * w * (w * t).sin() - 0.3 * v * v * (v * t).cos();
            let tau = TRUTH[0] * ddq + TRUTH[1] * dq + TRUTH[2] * dq.signum() + off;
            writeln!(text, "{t:.12},{q:.15},{tau:.15}").unwrap();
        }
        self.0.write(name, text);
    }

    fn identify(&self, recordings: &str) -> Result<Results, ExperimentError> {
        let text = format!("title = 't'\nrobot = 'joint.toml'\n{recordings}{SIGNAL}");
        let experiment = Experiment::from_texts(Path::new("several.toml"), text, ROBOT.to_owned())?;
        experiment.run(self.0.path(), &mut |_| {})
    }
}

fn even(k: usize) -> f64 {
    k as f64 / RATE
}

fn recording(table: &str, file: &str, extra: &str) -> String {
    format!(
        "{table}\nsample_rate_hz = {RATE}\nposition = {{ file = '{file}', columns = ['q'], unit = 'rad' }}\n\
         torque = {{ file = '{file}', columns = ['tau'], unit = 'N m' }}\n{extra}\n"
    )
}

fn estimates(results: &Results) -> Vec<f64> {
    results.runs[0].parameters.iter().map(|p| p.estimate).collect()
}

/// The motor inertia is regrouped with the link's own, so the parameters are zz1r (or ia), fv, fc, off in table order.
fn assert_truth(results: &Results, off: f64, tolerance: f64) {
    let found = estimates(results);
    let [ia, fv, fc, _] = TRUTH;
    let expected = [ia, fv, fc, off];
    // A horizontal axis is not excited by gravity here: the axis is vertical.
    assert_eq!(found.len(), expected.len(), "{:?}", results.runs[0].parameters);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance * expected.abs().max(1.0), "{found} {expected}");
    }
}

#[test]
fn one_table_and_an_array_of_one_are_the_same() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    let table = folder.identify(&recording("[recording]", "a.csv", "")).unwrap();
    let array = folder.identify(&recording("[[recording]]", "a.csv", "")).unwrap();
    assert_eq!(estimates(&table), estimates(&array));
    assert_truth(&table, TRUTH[3], FILTER);
}

#[test]
fn the_same_recording_twice_gives_the_same_estimates_and_smaller_deviations() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    let one = folder.identify(&recording("[[recording]]", "a.csv", "")).unwrap();
    let twice = [recording("[[recording]]", "a.csv", ""), recording("[[recording]]", "a.csv", "")].concat();
    let two = folder.identify(&twice).unwrap();
    let (rows, parameters) = (one.decimated_rows as f64, TRUTH.len() as f64);
    assert_eq!(two.decimated_rows, 2 * one.decimated_rows);
    assert_eq!(two.samples_used, 2 * one.samples_used);
    for (a, b) in one.runs[0].parameters.iter().zip(&two.runs[0].parameters) {
        assert!((a.estimate - b.estimate).abs() < 1e-10);
        // s^2 (X^T X)^-1: the residual doubles, its freedom goes from n - p to 2 n - p, and X^T X doubles.
        let ratio = b.standard_deviation.unwrap() / a.standard_deviation.unwrap();
        let expected = ((rows - parameters) / (2.0 * rows - parameters)).sqrt();
        assert!((ratio - expected).abs() < 1e-6, "{ratio} {expected}");
    }
}

/// Two recordings with different offsets: the estimate of the offset is their weighted mean, with squared weights.
#[test]
fn weights_draw_the_estimate_to_their_recording() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, 0.0, even);
    folder.write("b.csv", 0.4, 1.0, even);
    for weight in [1.0_f64, 3.0] {
        let second = recording("[[recording]]", "b.csv", &format!("weight = {weight}"));
        let results = folder.identify(&[recording("[[recording]]", "a.csv", ""), second].concat()).unwrap();
        assert_truth(&results, weight.powi(2) / (1.0 + weight.powi(2)), 5.0 * FILTER);
        assert_eq!(results.recordings[1].weight, weight);
    }
}

#[test]
fn a_recording_is_left_out_in_turn() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    folder.write("b.csv", 0.55, TRUTH[3], even);
    let both = [recording("[[recording]]", "a.csv", ""), recording("[[recording]]", "b.csv", "")].concat();
    let run = &folder.identify(&both).unwrap().runs[0];
    let error = run.cross_validation_relative_error_percent.unwrap();
    assert!(error >= run.relative_error_percent.unwrap() && error < 1.0, "{error}");
}

#[test]
fn several_recordings_are_held_back() {
    let folder = Recordings::new();
    for (name, hz) in [("a.csv", 0.4), ("b.csv", 0.5), ("c.csv", 0.6)] {
        folder.write(name, hz, TRUTH[3], even);
    }
    let validation =
        [recording("[[validation]]", "b.csv", "name = 'second'"), recording("[[validation]]", "c.csv", "")];
    let results = folder.identify(&(recording("[recording]", "a.csv", "") + &validation.concat())).unwrap();
    let names: Vec<&str> = results.validation_recordings.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["second", "2"]);
    assert!(results.runs[0].cross_validation_relative_error_percent.unwrap() < 1.0);
}

#[test]
fn a_recording_has_its_own_window() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    let own = recording("[recording]", "a.csv", "window_start_s = 1.0\nwindow_end_s = 3.0");
    let results = folder.identify(&own).unwrap();
    assert_eq!((results.samples_used, results.recordings[0].window_s), (2000, [1.0, 3.0]));
}

/// Stamps that jitter by up to 30 % of a step. The remedy was to resample the record, which the program does.
#[test]
fn jittering_stamps_are_resampled() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], |k| (k as f64 + 0.15 * (2.3 * k as f64).sin()) / RATE);
    let with_time = recording("[recording]", "a.csv", "")
        .replace(&format!("sample_rate_hz = {RATE}"), "time = { file = 'a.csv', columns = ['t'], unit = 's' }");
    let results = folder.identify(&with_time).unwrap();
    let resampling = results.recordings[0].resampling.unwrap();
    assert!((0.2..0.31).contains(&resampling.largest_deviation), "{resampling:?}");
    assert_truth(&results, TRUTH[3], FILTER);
    let found = results.findings[0].findings.iter().find(|f| f.code == Code::ClockJitter).unwrap();
    assert!(found.message.contains("the recording is resampled to equal steps by its stamps"), "{}", found.message);
    assert_eq!((found.severity, found.remedy.as_str()), (Severity::Note, "nothing to do"));
    let strict = with_time.replace("time =", "largest_jitter = 0.1\ntime =");
    assert!(folder.identify(&strict).unwrap_err().to_string().contains("largest_jitter"));
}

#[test]
fn recordings_of_different_rates_are_refused() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    let slow = recording("[[recording]]", "a.csv", "").replace("1000", "500");
    let message = folder.identify(&(recording("[[recording]]", "a.csv", "") + &slow)).unwrap_err().to_string();
    assert!(message.contains("sample rate") && message.contains("500"), "{message}");
}

#[test]
fn what_is_wrong_inside_an_array_is_named_with_its_line() {
    let folder = Recordings::new();
    let wrong = recording("[[recording]]", "a.csv", "").replace("position", "positions");
    let message = folder.identify(&wrong).unwrap_err().to_string();
    assert!(message.contains("line 5") && message.contains("`positions`"), "{message}");
}

/// Torques that are recorded 2.3 ms late, by a number of samples that is not whole, are moved to where they belong.
#[test]
fn a_signal_that_is_late_is_moved() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    folder.write("late.csv", 0.4, TRUTH[3], |k| (k as f64 - 2.3) / RATE);
    let late =
        recording("[recording]", "a.csv", "").replace("torque = { file = 'a.csv'", "torque = { file = 'late.csv'");
    let told = late.replace("columns = ['tau']", "delay_s = 0.0023, columns = ['tau']");
    let of = |text: &str| folder.identify(text).unwrap();
    let (wrong, right) = (of(&late), of(&told));
    assert_truth(&right, TRUTH[3], 2.0 * FILTER);
    let error = |results: &Results| results.runs[0].relative_error_percent.unwrap();
    assert!(error(&wrong) > 5.0 * error(&right), "{} {}", error(&wrong), error(&right));
    let early = told.replace("0.0023", "-0.05");
    let results = of(&early);
    assert!(results.samples_used < right.samples_used && error(&results) > error(&right));
    let message = folder.identify(&told.replace("0.0023", "100")).unwrap_err().to_string();
    assert!(message.contains("[recording] delay_s is 100, expected from -60 to 60 s"), "{message}");
}

/// A rate that the times in the file contradict is a problem.
#[test]
fn a_rate_that_the_times_contradict_is_a_problem() {
    let folder = Recordings::new();
    folder.write("a.csv", 0.4, TRUTH[3], even);
    let results = folder.identify(&recording("[recording]", "a.csv", "").replace("1000", "800")).unwrap();
    let found = results.findings[0].findings.iter().find(|f| f.code.name() == "rate-contradicted").unwrap();
    assert_eq!(found.message, "sample_rate_hz is 800 Hz, but the times in column \"t\" give 1000.000000 Hz");
    assert!(results.findings[0].has_problem());
    let right = folder.identify(&recording("[recording]", "a.csv", "")).unwrap();
    assert!(right.findings[0].findings.iter().all(|f| f.code.name() != "rate-contradicted"));
}
