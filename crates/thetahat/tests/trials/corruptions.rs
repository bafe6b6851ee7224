//! The checks before the estimate against corrupted records: each corruption raises its finding, no clean record does.
//!
//! `docs/evidence/checks.md` holds the outcomes as a table, which is compared with what is found here. It is written by
//! `cargo run --release -p thetahat --example studies -- corruption_table DATA`.

use std::sync::OnceLock;

use super::corruption_suite::{
    corruptions::{Beside, Corruption, LATE, Unseen, all, late, of_controllers, unseen},
    record::{Record, Which, from_experiment, other_twin, quiet_twin, twin, tx40_with_reference},
    table::{Clean, cells, row, same},
};
use libtest_mimic::{Failed, Trial};
use thetahat::checks::{Code, Finding, Severity};
use thetahat_estimation::checks::{examine, measure};
use thetahat_testing::{each_night, ensure, has_shared, thinned};

/// Twins with other seeds, noise and trajectories.
const OTHER_TWINS: u64 = 20;

fn the_twin() -> &'static Clean {
    static TWIN: OnceLock<Clean> = OnceLock::new();
    TWIN.get_or_init(|| Clean::new(twin(|_| {})))
}

fn the_tx40() -> &'static Clean {
    static TX40: OnceLock<Clean> = OnceLock::new();
    TX40.get_or_init(|| Clean::new(tx40_with_reference(&thetahat_testing::root(), &thetahat_testing::data())))
}

fn emps(which: Which) -> Record {
    from_experiment(&thetahat_testing::root().join("experiments/emps.toml"), &thetahat_testing::data(), which)
}

fn the_emps() -> &'static Clean {
    static EMPS: OnceLock<Clean> = OnceLock::new();
    EMPS.get_or_init(|| Clean::new(emps(Which::Main(0))))
}

fn raises(record: fn() -> &'static Clean, corruption: &Corruption) -> Result<(), Failed> {
    record().outcome(corruption).map(|_| ()).map_err(Failed::from)
}

/// What the documentation says is not seen raises nothing: the day it does, the documentation is to be changed.
fn raises_nothing(record: &Clean, unseen: &Unseen) -> Result<(), Failed> {
    let text = std::fs::read_to_string(thetahat_testing::root().join("docs/evidence/checks.md"))?;
    ensure(text.contains(unseen.name) && text.contains(unseen.why), "not in docs/evidence/checks.md")?;
    is_clean(&record.changed(unseen.apply))
}

fn is_clean(findings: &[Finding]) -> Result<(), Failed> {
    let serious: Vec<String> = findings
        .iter()
        .filter(|f| f.severity < Severity::Note)
        .map(|f| format!("[{}] {}", f.code, f.message))
        .collect();
    ensure(serious.is_empty(), serious.join("\n"))
}

/// The drive signals of the EMPS hold from sample to sample, and its experiment does not say so.
fn holds(findings: &[Finding]) -> Result<(), Failed> {
    let [held, others @ ..] = findings else { return Err("nothing is found".into()) };
    ensure(held.code == Code::Lag && held.remedy.contains("held = true"), held.message.clone())?;
    is_clean(others)
}

fn clean_with_everything_beside(record: &Clean) -> Result<(), Failed> {
    for beside in [Beside::Nothing, Beside::Velocities, Beside::TimeStamps, Beside::Reference] {
        is_clean(record.findings(beside))?;
    }
    Ok(())
}

/// The same findings, in the same order, twice; severe ones first.
fn deterministic() -> Result<(), Failed> {
    let corruption = all().into_iter().find(|c| c.code == Code::StillPeriod).ok_or("no such corruption")?;
    let mut record = twin(|_| {});
    (corruption.apply)(&mut record);
    let (a, b) = (record.with_subject(examine), record.with_subject(examine));
    ensure(a == b, "two runs differ")?;
    ensure(a.is_sorted_by_key(|f| (f.severity, f.code, f.joint)), "not sorted")?;
    ensure(record.with_subject(measure).iter().all(|m| m.limit.is_finite()), "a measure without a limit")
}

/// Lags of a twin with little noise are estimated to a tenth of a sample.
fn lag_to_a_tenth() -> Result<(), Failed> {
    let clean = quiet_twin();
    for lag in [2.4, -3.7, 11.5] {
        let mut record = clean.clone();
        (1..=6).for_each(|j| late(&mut record.torque, j, lag));
        let findings = record.findings();
        let found = findings.iter().find(|f| f.code == Code::Lag).ok_or(format!("{lag}: not raised"))?;
        ensure((found.value - lag).abs() < 0.1, format!("{lag} samples are estimated as {}", found.value))?;
    }
    Ok(())
}

/// Beside noise, a lag moves the estimate by itself.
fn lag_of_the_suite(record: &Clean) -> Result<(), Failed> {
    let of = |name: &str| -> Result<f64, Failed> {
        let corruption = all().into_iter().find(|c| c.name == name).ok_or("no such corruption")?;
        Ok(record.outcome(&corruption)?.0.value)
    };
    let apart = of("all torques 60.3 samples late")? - of("all torques 60.3 samples early")?;
    ensure((apart / (2.0 * LATE) - 1.0).abs() < 0.03, format!("{apart} samples apart, expected {}", 2.0 * LATE))
}

/// Windows and values that no robot has end without a panic.
fn nothing_panics() -> Result<(), Failed> {
    let clean = twin(|_| {}).with(Beside::Velocities).with(Beside::TimeStamps).with(Beside::Reference);
    for window in [0..0, 5..6, 100..109, 100..130, 100..400, 1500..2600] {
        for decimation in [1, 10_000] {
            let mut record = clean.clone();
            (record.signal.window, record.signal.decimation) = (window.clone(), decimation);
            record.findings();
        }
    }
    for factor in [0.0, 1e-300, 1e200] {
        let mut record = clean.clone();
        record.signal.window = 1500..6500;
        record.position.values_mut().iter_mut().for_each(|q| *q *= factor);
        record.findings();
        record.torque.values_mut().iter_mut().for_each(|t| *t *= factor);
        record.time_s.iter_mut().flatten().for_each(|t| *t *= factor);
        record.findings();
    }
    Ok(())
}

/// Every row of the table in the documentation is what is found.
fn table_is_that_of_the_documentation(with_real: bool) -> Result<(), Failed> {
    let text = std::fs::read_to_string(thetahat_testing::root().join("docs/evidence/checks.md"))?;
    let printed = cells(&text, "## The corruption suite");
    let corruptions = all();
    ensure(printed.len() == corruptions.len(), format!("{} rows, {} corruptions", printed.len(), corruptions.len()))?;
    for (corruption, printed) in corruptions.iter().zip(printed) {
        let records: &[&Clean] = if with_real { &[the_twin(), the_tx40()] } else { &[the_twin()] };
        let found = row(corruption, records);
        let compared = if with_real { 5 } else { 3 };
        let agree = (0..compared).all(|c| same(&printed[c], &found[c]));
        ensure(agree, format!("found {found:?}, printed {printed:?}"))?;
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    let absent = !["datasets/tx40", "datasets/emps", "datasets/kuka_lwr4", "datasets/ur10"].into_iter().all(has_shared);
    if absent {
        eprintln!("\n*** SKIPPED: the tests on recorded data, which is absent (set THETAHAT_SHARED) ***\n");
    }
    let mut trials = Vec::new();
    let mut always =
        |name: String, run: Box<dyn FnOnce() -> Result<(), Failed> + Send>| trials.push(Trial::test(name, run));
    for corruption in thinned(all(), 0).chain(of_controllers()) {
        always(format!("twin: {}", corruption.name), Box::new(move || raises(the_twin, &corruption)));
    }
    for case in unseen() {
        always(format!("twin: not seen: {}", case.name), Box::new(move || raises_nothing(the_twin(), &case)));
    }
    always("twin: clean".into(), Box::new(|| clean_with_everything_beside(the_twin())));
    for number in thinned((0..OTHER_TWINS).collect(), 0) {
        always(
            format!("twin {number} with other noise and moves: clean"),
            Box::new(move || is_clean(&other_twin(number).findings())),
        );
    }
    always("twin: findings are sorted and the same every time".into(), Box::new(deterministic));
    always("twin: nothing panics".into(), Box::new(nothing_panics));
    always("twin: lag to a tenth of a sample".into(), Box::new(lag_to_a_tenth));
    always("twin: lag beside noise".into(), Box::new(|| lag_of_the_suite(the_twin())));
    let mut recorded = |name: String, run: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        trials.push(Trial::test(name, run).with_ignored_flag(absent));
    };
    for corruption in thinned(all(), 1) {
        recorded(format!("TX40: {}", corruption.name), Box::new(move || raises(the_tx40, &corruption)));
    }
    for case in unseen() {
        recorded(format!("TX40: not seen: {}", case.name), Box::new(move || raises_nothing(the_tx40(), &case)));
    }
    for corruption in of_controllers() {
        recorded(format!("EMPS: {}", corruption.name), Box::new(move || raises(the_emps, &corruption)));
    }
    recorded("TX40: clean".into(), Box::new(|| clean_with_everything_beside(the_tx40())));
    recorded(
        "EMPS: its torques hold, and nothing else".into(),
        Box::new(|| holds(the_emps().findings(Beside::Nothing))),
    );
    recorded(
        "EMPS with pulses: its torques hold, and nothing else".into(),
        Box::new(|| holds(&emps(Which::Validation(0)).findings())),
    );
    recorded("TX40: lag beside noise".into(), Box::new(|| lag_of_the_suite(the_tx40())));
    let table = move || table_is_that_of_the_documentation(!absent);
    trials.extend(each_night(vec![Trial::test("table of the documentation", table)]));
    trials
}
