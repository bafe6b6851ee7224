//! Situations that people met and reported in public: each ends with the value that is right, not with a wording.

use std::path::PathBuf;

use libtest_mimic::{Failed, Trial};
use thetahat::{Results, results::Verdict};
use thetahat_report::results::{CauseKind, ModelCause, ModelParameter, ModelResult};
use thetahat_testing::{Folder, Named, ensure, project, refused, run, shared, succeeded, trials_on_shared_data};

use crate::PROGRAM;

/// Friction of the UR3 of the cases: viscous, N m s/rad, and Coulomb, N m.
const UR3: [(&str, f64); 6] = [("fv1", 8.0), ("fv2", 8.0), ("fv3", 5.0), ("fc1", 6.0), ("fc2", 6.0), ("fc3", 4.0)];

pub(crate) fn trials() -> Vec<Trial> {
    let tests: Vec<Named> = vec![
        ("field_decimal", a_slipped_decimal_is_named),
        ("field_zero_inertia", masses_stay_within_a_factor_of_two),
        ("field_zero_effort", a_limit_of_zero_is_said),
        ("field_transmissions", transmissions_are_used_or_refused),
        ("field_joint_states", joint_states_are_read_by_name),
        ("field_text", text_is_read_as_tools_write_it),
        ("field_wrapped", wrapped_angles_are_unwrapped),
        ("field_clocks", gaps_copies_and_coarse_clocks),
        ("field_no_torque", a_leg_without_torques),
        ("field_legs_page", the_commands_of_the_page_for_legs_run),
        ("field_strokes", strokes_give_friction),
        ("field_weights", known_weights_give_the_gain),
        ("field_encoder_zero", a_wrong_zero_is_named),
    ];
    trials_on_shared_data(&["field"], tests)
}

/// A case with a folder for what is written.
struct Case {
    inputs: PathBuf,
    folder: Folder,
}

impl Case {
    fn new(name: &str) -> Self {
        Self { inputs: shared().join("field").join(name), folder: Folder::new() }
    }

    fn path(&self, file: &str) -> String {
        self.inputs.join(file).display().to_string()
    }

    /// The results of `init` and `identify`, nothing edited.
    fn proposed(&self, robot: &str, recording: &str, more: &[&str]) -> Result<Results, Failed> {
        let (robot, recording) = (self.path(robot), self.path(recording));
        let arguments = ["init", "--robot", &robot, "--recording", &recording, "--force"];
        let said = succeeded(&run(PROGRAM, self.folder.path(), arguments.into_iter().chain(more.iter().copied())));
        let next = said.lines().find(|line| line.trim().starts_with("thetahat identify"));
        let next = next.ok_or_else(|| Failed::from(format!("init names no next command:\n{said}")))?;
        self.identified(next.trim().split(' ').skip(2))
    }

    /// The results of an experiment of the case, whatever its verdict.
    fn of_experiment(&self, file: &str) -> Result<Results, Failed> {
        let (experiment, data) = (self.path(file), self.inputs.display().to_string());
        self.identified([experiment.as_str(), "--data", &data])
    }

    fn identified<'a>(&self, arguments: impl IntoIterator<Item = &'a str>) -> Result<Results, Failed> {
        let all = ["identify"].into_iter().chain(arguments).chain(["--out", "results", "--force"]);
        let output = run(PROGRAM, self.folder.path(), all);
        ensure(output.status.code().is_some_and(|code| code < 2), String::from_utf8_lossy(&output.stderr))?;
        Ok(Results::read(&self.folder.path().join("results/results.json"))?)
    }
}

fn model(results: &Results) -> Result<&ModelResult, Failed> {
    results.model.as_ref().ok_or_else(|| Failed::from(format!("no model: {:?}", results.no_model)))
}

/// Values of the model within a relative tolerance.
fn are_near(results: &Results, right: &[(&str, f64)], tolerance: f64) -> Result<(), Failed> {
    for (name, value) in right {
        let found = model(results)?.parameters.iter().find(|p| p.name == *name).map_or(f64::NAN, |p| p.value);
        ensure((found - value).abs() <= tolerance * value.abs(), format!("{name}: {found} for {value}"))?;
    }
    Ok(())
}

fn a_slipped_decimal_is_named() -> Result<(), Failed> {
    let results = Case::new("02-izz-decimal").of_experiment("experiment.toml")?;
    let reasons = format!("{:?}", results.verdict_reasons);
    ensure(results.verdict == Some(Verdict::Care) && reasons.contains("line 5"), reasons)
}

fn masses_stay_within_a_factor_of_two() -> Result<(), Failed> {
    for name in ["03-zero-inertia", "03-zero-inertia/zero", "03-zero-inertia/control"] {
        let results = Case::new(name).of_experiment("experiment.toml")?;
        for (mass, a_priori) in [("m1", 2.1), ("m2", 2.175)] {
            let found = model(&results)?.standard_value(mass).unwrap_or(f64::NAN);
            ensure(found > 0.5 * a_priori && found < 2.0 * a_priori, format!("{name}: {mass} {found}"))?;
        }
        let said = format!("{:?}", results.findings).contains("line 5");
        ensure(said || name.ends_with("control"), format!("{name}: the inertia is not named"))?;
    }
    Ok(())
}

fn a_limit_of_zero_is_said() -> Result<(), Failed> {
    let case = Case::new("04-zero-effort");
    let said = refused(&run(PROGRAM, case.folder.path(), ["design", &case.path("design.toml"), "--out", "design"]));
    ensure(said.contains("states 0"), said)
}

fn transmissions_are_used_or_refused() -> Result<(), Failed> {
    let case = Case::new("08-dangling-transmission");
    let said = refused(&run(PROGRAM, case.folder.path(), ["model", &case.path("dangling.urdf")]));
    ensure(said.contains("line 8") && said.contains("typo"), said)?;
    for experiment in ["log.toml", "motor.toml"] {
        are_near(&case.of_experiment(experiment)?, &[("yy1r", 0.7687)], 0.002)?;
    }
    Ok(())
}

fn joint_states_are_read_by_name() -> Result<(), Failed> {
    let case = Case::new("15-jointstate-order-nan");
    for recording in ["order.mcap", "two.mcap", "simzero.mcap"] {
        let results = case.proposed("mm.urdf", recording, &[])?;
        ensure(results.verdict == Some(Verdict::Good), format!("{recording}: {:?}", results.verdict_reasons))?;
    }
    let (robot, unknown) = (case.path("mm.urdf"), case.path("naneffort.mcap"));
    let said =
        refused(&run(PROGRAM, case.folder.path(), ["init", "--robot", &robot, "--recording", &unknown, "--force"]));
    ensure(said.contains("torso_lift_joint.effort"), said)
}

fn text_is_read_as_tools_write_it() -> Result<(), Failed> {
    let case = Case::new("16-rostopic-csv");
    let files = ["date", "one_header", "plotjuggler", "ps", "ros1", "ros2", "thousands", "two_headers", "hms"];
    for file in files {
        let results = case.proposed("ur3.urdf", &format!("{file}.csv"), &[])?;
        are_near(&results, &UR3, 0.02).map_err(|failed| Failed::from(format!("{file}: {failed:?}")))?;
    }
    Ok(())
}

fn wrapped_angles_are_unwrapped() -> Result<(), Failed> {
    let case = Case::new("17-wrapped-angles");
    let right = case.proposed("k.urdf", "unwrapped.csv", &[])?;
    let is_precise = |p: &&ModelParameter| {
        p.interval_95.is_some_and(|[low, high]| p.is_decided() && high - low <= 0.4 * p.value.abs())
    };
    let precise = model(&right)?.parameters.iter().filter(is_precise);
    let right: Vec<(&str, f64)> = precise.map(|p| (p.name.as_str(), p.value)).collect();
    for recording in ["pm.csv", "deg360.csv"] {
        let results = case.proposed("k.urdf", recording, &[])?;
        ensure(results.verdict == Some(Verdict::Good), format!("{recording}: {:?}", results.verdict_reasons))?;
        are_near(&results, &right, 0.01)?;
    }
    Ok(())
}

fn gaps_copies_and_coarse_clocks() -> Result<(), Failed> {
    let case = Case::new("22-missing-duplicate");
    for recording in ["missing.csv", "dup.csv", "coarse.csv"] {
        let desired = ["--torque", "target_moment_0,target_moment_1,target_moment_2"];
        let results = case.proposed("ur3.urdf", recording, &desired)?;
        ensure(results.verdict == Some(Verdict::Good), format!("{recording}: {:?}", results.verdict_reasons))?;
        are_near(&results, &UR3, 0.02)?;
    }
    Ok(())
}

fn a_leg_without_torques() -> Result<(), Failed> {
    let case = Case::new("24-pace-no-torque");
    let results = case.proposed("leg.urdf", "log.csv", &["--kp", "60", "--kd", "2"])?;
    let right = [("fv1", 0.3), ("fv2", 0.4), ("fv3", 0.2), ("fc1", 0.35), ("fc2", 0.45), ("fc3", 0.3)];
    let run = results.runs.iter().find(|run| run.method.name() == "cloe").ok_or("init does not propose cloe")?;
    for (name, value) in right {
        let found = run.parameter(name).map_or(f64::NAN, |p| p.estimate);
        ensure((found - value).abs() <= 0.05 * value, format!("{name}: {found} for {value}"))?;
    }
    Ok(())
}

/// The commands of docs/manual/legs.md run unchanged; `.ci/legs` runs its Python as well.
fn the_commands_of_the_page_for_legs_run() -> Result<(), Failed> {
    let case = Case::new("24-pace-no-torque");
    for file in ["leg.urdf", "log.csv"] {
        case.folder.copy(&case.inputs.join(file));
    }
    let page = std::fs::read_to_string(project("docs/manual/legs.md"))?;
    for command in page.lines().filter_map(|line| line.strip_prefix("$ thetahat ")) {
        let output = run(PROGRAM, case.folder.path(), command.split(' '));
        let said = String::from_utf8_lossy(&output.stderr);
        ensure(output.status.code().is_some_and(|code| code < 2), format!("{command}: {said}"))?;
    }
    for (file, part) in [
        ("leg.xml", "integrator=\"RK4\""),
        ("leg_pace.json", "\"delay_mode\": \"command\""),
        ("leg_isaac.json", "\"IdealPDActuatorCfg\""),
    ] {
        ensure(case.folder.text(file).contains(part), format!("{file} has no {part}"))?;
    }
    Ok(())
}

fn strokes_give_friction() -> Result<(), Failed> {
    let results = Case::new("25-friction-only").of_experiment("experiment.toml")?;
    are_near(&results, &UR3, 0.02)?;
    ensure(results.verdict != Some(Verdict::DoNotUse), format!("{:?}", results.verdict_reasons))
}

fn known_weights_give_the_gain() -> Result<(), Failed> {
    let results = Case::new("28-servo-known-weights").of_experiment("pay.toml")?;
    let factor = results.drive_gains.first().and_then(|gain| gain.factor).unwrap_or(f64::NAN);
    ensure((factor - 0.92).abs() < 0.005, format!("{factor}"))?;
    let first = results.verdict_reasons.first().map(|reason| reason.code.name());
    ensure(first == Some("drive-gain"), format!("{:?}", results.verdict_reasons))
}

/// The zero of joint 2 is in the named set, and the values that it moves have intervals that hold the truth.
fn a_wrong_zero_is_named() -> Result<(), Failed> {
    let case = Case::new("29-encoder-bias");
    let right = case.of_experiment("experiment.toml")?;
    let wrong = case.of_experiment("e2.toml")?;
    let zero = CauseKind::EncoderZero.with_subject("joint 2");
    let named = |cause: &ModelCause| cause.kind.with_subject(&cause.subject) == zero || cause.rivals.contains(&zero);
    ensure(model(&wrong)?.causes.iter().any(named), format!("{:?}", model(&wrong)?.causes))?;
    for (right, wrong) in model(&right)?.parameters.iter().zip(&model(&wrong)?.parameters) {
        let Some([low, high]) = wrong.interval_95.filter(|_| wrong.is_decided()) else { continue };
        let holds = low <= right.value && right.value <= high;
        ensure(holds, format!("{}: {} outside {low} to {high}", right.name, right.value))?;
    }
    Ok(())
}
