//! Kinds of defects by robot: each is refused or named as the table of `docs/evidence/checks.md` says, and clean records are silent.
//!
//! The table is written by `cargo run --release -p thetahat --example studies -- defect_table`.

use std::sync::OnceLock;

use super::corruption_suite::{
    arms::{ARMS, Arm},
    defects::{Defect, Outcome, defects},
    pairs::{Pair, PairDefect, beside_one_another, pair_defects, payload},
    record::{Record, Which, from_experiment},
    robots::Specimen,
    table::cells,
};
use libtest_mimic::{Failed, Trial};
use thetahat::{
    Identification, Recording, Results, Settings,
    checks::{Code, Finding, Severity},
    results::Verdict,
};
use thetahat_estimation::checks::compare;
use thetahat_testing::{each_night, ensure, has_shared, thinned};

/// The findings of this suite: clean records raise none of them.
const CODES: [Code; 10] = [
    Code::TorqueIdle,
    Code::TorqueNoise,
    Code::JointDither,
    Code::APrioriScale,
    Code::WorseThanMean,
    Code::WrongRobot,
    Code::GainDrift,
    Code::FrictionDrift,
    Code::SameRecording,
    Code::RecordingsContradict,
];

fn record_of(specimen: Specimen) -> &'static Record {
    static RECORDS: [OnceLock<Record>; Specimen::ALL.len()] = [const { OnceLock::new() }; Specimen::ALL.len()];
    let place = Specimen::ALL.iter().position(|s| *s == specimen).unwrap_or_default();
    RECORDS[place].get_or_init(|| specimen.record())
}

fn silent(findings: &[Finding]) -> Result<(), Failed> {
    let own =
        |f: &&Finding| f.severity < Severity::Note && (CODES.contains(&f.code) || f.code == Code::TorqueQuantised);
    let found: Vec<String> = findings.iter().filter(own).map(|f| format!("[{}] {}", f.code, f.message)).collect();
    ensure(found.is_empty(), found.join("\n"))
}

/// The cell of the documentation's table.
fn printed(name: &str, specimen: Specimen) -> Result<String, Failed> {
    let text = std::fs::read_to_string(thetahat_testing::root().join("docs/evidence/checks.md"))?;
    let rows = cells(&text, "## What becomes of each defect");
    let row = rows.into_iter().find(|r| r[0] == name).ok_or(format!("no row {name} in docs/evidence/checks.md"))?;
    let column = Specimen::ALL.iter().position(|s| *s == specimen).unwrap_or_default();
    Ok(row[column + 1].clone())
}

fn as_printed(name: &str, specimen: Specimen, outcome: &Outcome, findings: &[Finding]) -> Result<(), Failed> {
    let (found, printed) = (outcome.cell(), printed(name, specimen)?);
    ensure(found == printed, format!("found {found}, printed {printed}\n{}", lines(findings)))
}

fn lines(findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(|f| format!("{} [{}] {}", f.severity, f.code, f.message)).collect();
    lines.join("\n")
}

fn of_one(specimen: Specimen, defect: &Defect) -> Result<(), Failed> {
    let mut spoiled = record_of(specimen).clone();
    (defect.apply)(&mut spoiled);
    let findings = spoiled.findings();
    let outcome = Outcome::of(&findings, defect.codes);
    let is_excused = defect.unseen.iter().any(|u| u.0 == specimen);
    ensure(is_excused || outcome != Outcome::NotSeen, format!("not seen\n{}", lines(&findings)))?;
    as_printed(defect.name, specimen, &outcome, &findings)
}

fn of_two(specimen: Specimen, defect: &PairDefect) -> Result<(), Failed> {
    let mut pair = Pair::halves(record_of(specimen));
    (defect.apply)(&mut pair);
    let findings = pair.findings();
    let outcome = Outcome::of(&findings, &[defect.code]);
    let is_excused = defect.unseen.iter().any(|u| u.0 == specimen);
    ensure(is_excused || outcome != Outcome::NotSeen, format!("not seen\n{}", lines(&findings)))?;
    as_printed(defect.name, specimen, &outcome, &findings)
}

fn clean(record: &Record) -> Result<(), Failed> {
    silent(&record.findings())?;
    let mut pair = Pair::halves(record);
    silent(&pair.findings())?;
    pair.held_back = true;
    silent(&pair.findings())
}

/// Two recordings of others that belong together.
fn recorded_pair(file: &str, second: Which) -> Result<(), Failed> {
    let read = |which| {
        let path = thetahat_testing::root().join("experiments").join(file);
        from_experiment(&path, &thetahat_testing::data(), which)
    };
    let held_back = matches!(second, Which::Validation(_));
    silent(&Pair { first: read(Which::Main(0)), second: read(second), held_back }.findings())
}

/// A robot repeats its motion, and not the noise of its torques.
fn repeated_motion() -> Result<(), Failed> {
    let arm = ARMS[0];
    let again = Arm { noise_seed: 77, ..arm };
    silent(&Pair { first: arm.record(), second: again.record(), held_back: false }.findings())
}

/// Of three recordings, the one that differs is named with what changed.
fn the_one_that_differs_is_named() -> Result<(), Failed> {
    let [first, second, mut third] = [21, 22, 23].map(|seed| Arm { seed, noise_seed: seed, ..ARMS[10] }.record());
    payload(&mut third);
    let found = beside_one_another(&[("a", &first, false), ("b", &second, false), ("c", &third, false)], compare);
    ensure(found.len() == 1 && found[0].code == Code::RecordingsContradict, format!("{found:?}"))?;
    ensure(found[0].message.contains("c differs from a, b, which agree, mainly in m"), found[0].message.clone())?;
    let found = beside_one_another(&[("a", &first, false), ("b", &second, false), ("c", &third, true)], compare);
    ensure(found.len() == 1 && found[0].severity == Severity::Warning, format!("{found:?}"))?;
    ensure(found[0].message.contains("c, which is held back, differs from the others"), found[0].message.clone())
}

fn identified(record: &Record) -> Results {
    let settings = Settings::new(record.signal.cutoff_hz, record.signal.decimation);
    let recording = Recording::new(record.rate_hz, record.position.clone(), record.torque.clone());
    Identification::new(&record.robot, vec![recording], settings).unwrap().run().unwrap()
}

fn spoiled(specimen: Specimen, name: &str) -> Record {
    let defect = defects().into_iter().find(|d| d.name == name).unwrap();
    let mut record = record_of(specimen).clone();
    (defect.apply)(&mut record);
    record
}

/// "Take idim-ls" was said of the description of another robot.
fn nothing_is_taken_of_another_robot() -> Result<(), Failed> {
    let results = identified(&spoiled(Specimen::SevenAxes, "the description of another robot"));
    let advice = &results.advice[0];
    ensure(advice.recommended.is_none() && results.verdict == Some(Verdict::DoNotUse), format!("{advice:?}"))?;
    let start = "Take none of these estimates: the recordings have a problem that makes them false (wrong-robot in recording 1)";
    ensure(advice.text.starts_with(start), advice.text.clone())
}

/// The numbers of one joint are not taken, those of the others are.
fn a_joint_of_noise_is_named() -> Result<(), Failed> {
    let results = identified(&spoiled(Specimen::SevenAxes, "torque 2 is noise"));
    let advice = &results.advice[0];
    ensure(advice.recommended.is_some() && results.verdict == Some(Verdict::DoNotUse), format!("{advice:?}"))?;
    ensure(advice.text.contains("Do not take the parameters of joint 2 (torque-noise"), advice.text.clone())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    let absent = !["datasets/tx40", "datasets/emps", "datasets/kuka_lwr4", "datasets/ur10"].into_iter().all(has_shared);
    if absent {
        eprintln!("\n*** SKIPPED: the tests on recorded data, which is absent (set THETAHAT_SHARED) ***\n");
    }
    let mut trials = Vec::new();
    for (group, specimen) in Specimen::ALL.into_iter().enumerate() {
        let mut add = |name: &str, run: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
            let trial = Trial::test(format!("{}: {name}", specimen.name()), run);
            trials.push(trial.with_ignored_flag(absent && specimen.is_recorded()));
        };
        add("clean", Box::new(move || clean(record_of(specimen))));
        for defect in thinned(defects(), group) {
            add(defect.name, Box::new(move || of_one(specimen, &defect)));
        }
        for defect in thinned(pair_defects(), group) {
            add(defect.name, Box::new(move || of_two(specimen, &defect)));
        }
    }
    for arm in ARMS {
        let name = format!("clean: {} at {} Hz, {:?}", arm.robot, arm.rate_hz, arm.law);
        trials.push(Trial::test(name, move || clean(&arm.record())));
    }
    for (file, second) in [("kuka_lwr4.toml", Which::Main(1)), ("emps.toml", Which::Validation(0))] {
        let trial = Trial::test(format!("clean pair: {file}"), move || recorded_pair(file, second));
        trials.push(trial.with_ignored_flag(absent));
    }
    trials.push(Trial::test("clean pair: a motion that is repeated", repeated_motion));
    trials.push(Trial::test("of three recordings, the one that differs", the_one_that_differs_is_named));
    trials.extend(each_night(vec![
        Trial::test("advice: another robot", nothing_is_taken_of_another_robot),
        Trial::test("advice: a joint of noise", a_joint_of_noise_is_named),
    ]));
    trials
}
