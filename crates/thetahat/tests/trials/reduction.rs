//! Reducing and solving is identifying: on the demonstration's twin, and on the recorded EMPS and TX40.

use std::{collections::BTreeMap, path::Path};

use libtest_mimic::{Failed, Trial};
use thetahat::{
    Experiment, Method, Results,
    experiment::{EstimateRequest, IdentifiedRobot},
    identification::Status,
    preparation::{Mask, NamedMask, StatedMask},
    reduction::{ReduceOptions, Reduction},
    results::{ParameterResult, ReasonCode, RunResult, VerdictReason},
};
use thetahat_testing::{Folder, each_night, ensure};

/// Relative to the estimate, and to its standard deviation where that is larger.
const EQUAL: f64 = 1e-9;
/// Between errors of the model, and between its values relative to the value, or to half of its interval if that is larger: its solver stops
/// where the objective is at most 1e-10 of itself too large; 1.2e-6 were found.
const EQUAL_MODEL: f64 = 1e-5;
/// The same where errors repeat with the motion, which `identify` sees in their correlation at every lag: 0.025 were found.
const EQUAL_REPEATED: f64 = 0.05;
/// Between velocities at which friction changes its sign, of which a reduction has columns of a few and takes sums of them for others; then
/// between values of the model, and between its errors.
const EQUAL_TRANSITION: f64 = 0.05;
const EQUAL_BETWEEN: f64 = 0.1;
const EQUAL_ERROR: f64 = 0.01;
/// The same for IV, whose matrix Z^T X has a larger condition number.
const EQUAL_IV: f64 = 1e-8;
/// Simulated in pieces or as a whole, with other steps of the integration, in standard deviations: 0.0096 were found.
const IV_IN_PIECES: f64 = 0.02;
/// Between ends of intervals, relative to their width, where the rows are kept.
const EQUAL_INTERVALS: f64 = 1e-5;
/// The same between reductions of one record: rounding of filters that start elsewhere, through two derivatives.
const EQUAL_PIECES: f64 = 5e-10;
/// Samples of a piece: at most the margin of its filters, some, and nearly all of a recording.
const SIZES: [usize; 3] = [100, 3000, 8191];
/// In the suite, where each size costs as much as the identification.
const ONE_SIZE: [usize; 1] = [3000];

/// An experiment with the mask that it states, or else near rest.
fn experiment(name: &str) -> Experiment {
    let path = thetahat_testing::root().join("experiments").join(name);
    Experiment::read(&path, &thetahat_testing::data()).unwrap()
}

fn masked(mut experiment: Experiment, mask: Mask) -> Experiment {
    experiment.settings.signal.mask = mask;
    experiment
}

fn near_rest(experiment: Experiment) -> Experiment {
    masked(experiment, Mask::Named(NamedMask::NearRest))
}

fn every_sample(experiment: Experiment) -> Experiment {
    masked(experiment, Mask::Named(NamedMask::None))
}

fn reduce(experiment: &Experiment, threads: usize, piece_samples: usize) -> Reduction {
    experiment
        .reduce(&thetahat_testing::data(), ReduceOptions { threads, piece_samples, rows_only: true }, &mut |_| {})
        .unwrap()
}

fn close(a: f64, b: f64, size: f64, tolerance: f64, what: &str) -> Result<(), Failed> {
    ensure((a - b).abs() <= tolerance * size, format!("{what}: {a} against {b}, {:e}", (a - b).abs() / size))
}

fn same(found: &RunResult, expected: &RunResult, tolerance: f64) -> Result<(), Failed> {
    ensure(found.parameters.len() == expected.parameters.len(), "as many parameters")?;
    for (f, e) in found.parameters.iter().zip(&expected.parameters) {
        let deviation = e.standard_deviation.unwrap();
        close(f.estimate, e.estimate, e.estimate.abs().max(deviation), tolerance, &e.name)?;
        close(f.standard_deviation.unwrap(), deviation, deviation, tolerance, &format!("sd of {}", e.name))?;
    }
    let error = |run: &RunResult| run.relative_error_percent.unwrap();
    close(error(found), error(expected), error(expected), tolerance, "relative error")?;
    let condition = |run: &RunResult| run.condition_number.unwrap();
    close(condition(found), condition(expected), condition(expected), 1e-6, "condition number")?;
    let joints = found.joint_relative_error_percent.iter().zip(&expected.joint_relative_error_percent);
    joints.into_iter().try_for_each(|(f, e)| close(f.unwrap(), e.unwrap(), e.unwrap(), tolerance, "error of a joint"))
}

fn equals_identify(experiment: Experiment) -> Result<(), Failed> {
    equals_identify_to(experiment, Some(EQUAL_MODEL), &ONE_SIZE)
}

/// With a tolerance of the model, absent if its choice is left to chance, and in pieces of such sizes.
fn equals_identify_to(mut experiment: Experiment, of_model: Option<f64>, sizes: &[usize]) -> Result<(), Failed> {
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    experiment.settings.cases.clear();
    let results = experiment.run(&thetahat_testing::data(), &mut |_| {})?;
    let expected = results.run("nominal", Method::IDIM_LS).unwrap();
    let whole = reduce(&experiment, 1, 1 << 16);
    let solved = whole.solve()?.results;
    ensure(solved.samples_used == results.samples_used, "as many samples")?;
    ensure(solved.decimated_rows == results.decimated_rows, "as many rows")?;
    same_mask(&solved, &results)?;
    same(&solved.runs[0], expected, EQUAL)?;
    same_intervals(&solved.runs[0], expected)?;
    same_verdict(&solved, &results, of_model)?;
    for &piece_samples in sizes {
        let pieces = reduce(&experiment, 2, piece_samples).solve()?.results;
        same(&pieces.runs[0], &solved.runs[0], EQUAL_PIECES)?;
        same_intervals(&pieces.runs[0], expected)?;
        same_verdict(&pieces, &results, of_model)?;
        for (p, s) in pieces.runs[0].parameters.iter().zip(&solved.runs[0].parameters) {
            let [a, b] = [p, s].map(|p| p.standard_deviation_robust.unwrap());
            close(a, b, b, 1e-6, &format!("robust sd of {}", s.name))?;
        }
    }
    Ok(())
}

fn same_intervals(found: &RunResult, expected: &RunResult) -> Result<(), Failed> {
    for (f, e) in found.parameters.iter().zip(&expected.parameters) {
        let ([low, high], [from, to]) = (f.interval_95.ok_or("no interval")?, e.interval_95.ok_or("no interval")?);
        close(low, from, to - from, EQUAL_INTERVALS, &format!("lower end of {}", e.name))?;
        close(high, to, to - from, EQUAL_INTERVALS, &format!("upper end of {}", e.name))?;
    }
    Ok(())
}

/// The verdict on the estimates with its reasons, and what cross-validation says; recordings that are held back are not reduced, and that
/// is listed.
fn same_verdict(found: &Results, expected: &Results, of_model: Option<f64>) -> Result<(), Failed> {
    of_model.map_or(Ok(()), |tolerance| same_model(found, expected, tolerance))?;
    let about = |r: &VerdictReason| (r.code, r.verdict, r.subject.clone());
    let request = EstimateRequest { untrusted: true, method: Some(Method::IDIM_LS), ..EstimateRequest::default() };
    let of_estimates = |results: &Results| {
        let without = Results { model: None, verdict: None, verdict_reasons: Vec::new(), ..results.clone() };
        IdentifiedRobot::of_results(Path::new("results.json"), &without, &request)
    };
    let [found_on, expected_on] = [of_estimates(found)?, of_estimates(expected)?];
    let [f, e] = [&found_on, &expected_on].map(|on| on.verdict_reasons.iter().map(about).collect::<Vec<_>>());
    let are_same = found_on.verdict == expected_on.verdict && f == e;
    ensure(are_same, format!("{:?} {f:?} against {:?} {e:?}", found_on.verdict, expected_on.verdict))?;
    if !expected.validation_recordings.is_empty() {
        let is_listed = found.not_examined.iter().any(|n| n.code == ReasonCode::CrossValidation);
        return ensure(is_listed, "held-back recordings are listed as not examined");
    }
    let unseen = |r: &Results| r.runs[0].cross_validation_relative_error_percent.ok_or("no cross-validation");
    close(unseen(found)?, unseen(expected)?, unseen(expected)?, 1e-7, "cross-validation")
}

/// The model, where it has no torque term that only samples ask for: its choice, values and errors.
fn same_model(found: &Results, expected: &Results, tolerance: f64) -> Result<(), Failed> {
    let (Some(f), Some(e)) = (&found.model, &expected.model) else {
        let are_both_absent = found.model.is_none() && expected.model.is_none();
        return ensure(are_both_absent, format!("a model or none: {:?} {:?}", found.no_model, expected.no_model));
    };
    if !e.terms.is_empty() {
        return Ok(());
    }
    let transition = e.friction_transition;
    close(f.friction_transition, transition, transition, EQUAL_TRANSITION, "transition")?;
    let is_between = f.friction_transition != transition;
    let (tolerance, of_error) = if is_between { (EQUAL_BETWEEN, EQUAL_ERROR) } else { (tolerance, tolerance) };
    ensure(f.belief_weight == e.belief_weight, "the same belief")?;
    for (f, e) in f.parameters.iter().zip(&e.parameters) {
        let size = e.interval_95.map_or(e.value.abs(), |[low, high]| e.value.abs().max(0.5 * (high - low)));
        close(f.value, e.value, size, tolerance, &format!("{} of the model", e.name))?;
    }
    close(f.fit.percent, e.fit.percent, e.fit.percent, of_error, "error of the model")?;
    match (&f.unseen, &e.unseen) {
        (Some(f), Some(e)) => close(f.percent, e.percent, e.percent, of_error, "unseen error of the model"),
        (f, e) => ensure(f.is_none() && e.is_none(), "an unseen error or none"),
    }
}

/// The masks near rest, and how long torques hold.
fn same_mask(found: &Results, expected: &Results) -> Result<(), Failed> {
    for (f, e) in found.recordings.iter().zip(&expected.recordings) {
        ensure(f.torque_hold_s == e.torque_hold_s, "as long a hold")?;
        ensure(f.near_rest.is_some() == e.near_rest.is_some(), "a mask or none")?;
        let Some((f, e)) = f.near_rest.as_ref().zip(e.near_rest.as_ref()) else { continue };
        close(f.widened_s, e.widened_s, e.widened_s, EQUAL, "widened")?;
        for (f, e) in f.velocity.iter().zip(&e.velocity) {
            close(*f, *e, *e, EQUAL, "limit")?;
        }
        for (f, e) in f.left_out_percent.iter().zip(&e.left_out_percent) {
            close(*f, *e, 100.0, EQUAL, "left out")?;
        }
    }
    Ok(())
}

fn the_demonstration() -> Result<(), Failed> {
    equals_identify(near_rest(Experiment::demo()?))
}

fn the_demonstration_in_all_sizes() -> Result<(), Failed> {
    let stated = Mask::Stated(StatedMask { velocity: 0.05, widened_s: 0.03 });
    let near_rest = Mask::Named(NamedMask::NearRest);
    [Mask::Named(NamedMask::None), near_rest, stated]
        .into_iter()
        .try_for_each(|mask| equals_identify_to(masked(Experiment::demo()?, mask), Some(EQUAL_MODEL), &SIZES))
}

/// A limit below which some joints are for more than four fifths of the time: they keep all samples, and their rows are made
/// a second time.
fn joints_that_hardly_move() -> Result<(), Failed> {
    let experiment = masked(Experiment::demo()?, Mask::Stated(StatedMask { velocity: 1.8, widened_s: 0.1 }));
    let solved = reduce(&experiment, 1, 3000).solve()?.results;
    let left_out = &solved.recordings[0].near_rest.as_ref().ok_or("no mask")?.left_out_percent;
    ensure(left_out.contains(&0.0) && left_out.iter().any(|percent| *percent > 10.0), format!("{left_out:?}"))?;
    equals_identify(experiment)
}

fn emps() -> Result<(), Failed> {
    equals_identify_to(experiment("emps.toml"), Some(EQUAL_REPEATED), &SIZES)?;
    equals_identify_to(near_rest(experiment("emps.toml")), Some(EQUAL_REPEATED), &SIZES)
}

/// With torques that hold and without samples near rest.
fn emps_aligned() -> Result<(), Failed> {
    let experiment = experiment("emps_aligned.toml");
    ensure(experiment.settings.signal.mask == Mask::Named(NamedMask::NearRest), "a mask near rest")?;
    equals_identify_to(experiment, Some(EQUAL_REPEATED), &SIZES)
}

fn tx40() -> Result<(), Failed> {
    equals_identify(near_rest(experiment("tx40_paper.toml")))
}

fn tx40_in_all_sizes() -> Result<(), Failed> {
    let paper = || experiment("tx40_paper.toml");
    [paper(), near_rest(paper())].into_iter().try_for_each(|e| equals_identify_to(e, Some(EQUAL_MODEL), &SIZES))
}

fn tx40_essential() -> Result<(), Failed> {
    equals_identify(experiment("tx40_essential.toml"))
}

/// The window is the moving part, which a first pass finds.
fn tx40_moving_part() -> Result<(), Failed> {
    let mut experiment = experiment("tx40_paper.toml");
    experiment.settings.signal.window_start_s = None;
    experiment.settings.signal.window_end_s = None;
    equals_identify(experiment.clone())?;
    equals_identify(near_rest(experiment))
}

/// Its errors repeat, and its transitions predict within 0.1 % of one another: the choice between them differs.
fn kuka() -> Result<(), Failed> {
    equals_identify_to(every_sample(experiment("kuka_lwr4.toml")), None, &ONE_SIZE)?;
    equals_identify_to(near_rest(experiment("kuka_lwr4.toml")), None, &ONE_SIZE)
}

/// Instruments from the last iterate before the end of an identification give its estimate.
fn equals_last_step(mut experiment: Experiment) -> Result<(), Failed> {
    experiment.settings.estimation.methods = vec![Method::IDIM_IV];
    experiment.settings.cases.clear();
    let results = experiment.run(&thetahat_testing::data(), &mut |_| {})?;
    let expected = results.run("nominal", Method::IDIM_IV).unwrap();
    let before = &expected.convergence[expected.convergence.len() - 2].estimates;
    let named: BTreeMap<String, f64> =
        expected.parameters.iter().zip(before).map(|(p, v)| (p.name.clone(), *v)).collect();
    let options = ReduceOptions { threads: 2, piece_samples: 3000, rows_only: true };
    let reduction =
        experiment.reduce_with_instruments(&thetahat_testing::data(), Some(&named), options, &mut |_| {})?;
    let solved = reduction.solve()?.results;
    let iv = solved.run("nominal", Method::IDIM_IV).unwrap();
    same(iv, expected, EQUAL_IV)?;
    same_mask(&solved, &results)?;
    ensure(iv.status == Status::Converged, format!("{:?}", iv.reason))?;
    let ls = reduce(&experiment, 1, 3000).solve()?.results;
    same(solved.run("nominal", Method::IDIM_LS).unwrap(), &ls.runs[0], EQUAL_PIECES)
}

fn iv_of_the_demonstration() -> Result<(), Failed> {
    equals_last_step(every_sample(Experiment::demo()?))?;
    equals_last_step(near_rest(Experiment::demo()?))
}

fn iv_of_emps() -> Result<(), Failed> {
    equals_last_step(experiment("emps.toml"))
}

fn iv_of_emps_aligned() -> Result<(), Failed> {
    equals_last_step(experiment("emps_aligned.toml"))
}

fn iv_of_tx40() -> Result<(), Failed> {
    equals_last_step(experiment("tx40_paper.toml"))
}

/// The demonstration's record with its reference, as a file that is read and simulated in pieces.
fn recorded_demonstration(folder: &Path, mask: &str, held: bool) -> Experiment {
    let demo = Experiment::demo().unwrap();
    let twin = demo.file.twin.as_ref().unwrap();
    let (record, followed) = (demo.record_twin().unwrap(), demo.twin_motion(twin).unwrap().reference);
    let moves = followed.moves().unwrap();
    let columns = |name: &str| (1..=6).map(|j| format!("{name}{j}")).collect::<Vec<_>>();
    let mut text = [columns("q"), columns("tau"), columns("r")].concat().join(",") + "\n";
    let [mut r, mut dr, mut ddr] = [[0.0; 6]; 3];
    for k in 0..record.position.len() {
        moves.evaluate(k as f64 / record.sample_rate_hz, &mut r, &mut dr, &mut ddr);
        let values = record.position.sample(k).iter().chain(record.torque.sample(k)).chain(&r);
        text += &(values.map(f64::to_string).collect::<Vec<_>>().join(",") + "\n");
    }
    std::fs::write(folder.join("record.csv"), text).unwrap();
    let (_, rest) = demo.text.split_once("[signal]").unwrap();
    let (rest, _) = rest.split_once("[[case]]").unwrap();
    let source = |name: &str, unit: &str, held: bool| {
        format!("{{ file = 'record.csv', columns = {:?}, unit = '{unit}', held = {held} }}", columns(name))
    };
    let text = format!(
        "title = 'recorded'\nrobot = 'tx40.toml'\n[recording]\nsample_rate_hz = {}\nposition = {}\ntorque = {}\n\
         reference = {}\n[signal]\nmask = '{mask}'{rest}",
        record.sample_rate_hz,
        source("q", "rad", false),
        source("tau", "N m", held),
        source("r", "rad", false),
    );
    Experiment::from_texts(&folder.join("recorded.toml"), text, demo.robot_text).unwrap()
}

/// IV with a simulation in pieces, each started 2 s early, agrees with IV from one simulation of the whole record to
/// two hundredths of a standard deviation.
fn iv_in_pieces() -> Result<(), Failed> {
    ["none", "near-rest"].into_iter().zip([false, true]).try_for_each(|(mask, held)| iv_in_pieces_with(mask, held))
}

fn iv_in_pieces_with(mask: &str, held: bool) -> Result<(), Failed> {
    let folder = Folder::new();
    let mut experiment = recorded_demonstration(folder.path(), mask, held);
    experiment.settings.estimation.methods = vec![Method::IDIM_IV];
    let results = experiment.run(folder.path(), &mut |_| {})?;
    let expected = results.run("nominal", Method::IDIM_IV).unwrap();
    let before = &expected.convergence[expected.convergence.len() - 2].estimates;
    let named: BTreeMap<String, f64> =
        expected.parameters.iter().zip(before).map(|(p, v)| (p.name.clone(), *v)).collect();
    let options = ReduceOptions { threads: 2, piece_samples: 9000, rows_only: true };
    let solved =
        experiment.reduce_with_instruments(folder.path(), Some(&named), options, &mut |_| {})?.solve()?.results;
    let iv = solved.run("nominal", Method::IDIM_IV).unwrap();
    let apart =
        |(f, e): (&ParameterResult, &ParameterResult)| (f.estimate - e.estimate).abs() / e.standard_deviation.unwrap();
    let worst = iv.parameters.iter().zip(&expected.parameters).map(apart).fold(0.0, f64::max);
    println!("pieces against the whole: {worst:.1e} standard deviations at the most");
    ensure(worst < IV_IN_PIECES, format!("{worst} standard deviations"))
}

fn threads_change_no_byte() -> Result<(), Failed> {
    let experiment = experiment("tx40_paper.toml");
    let file = |threads: usize| -> Vec<u8> {
        let folder = Folder::new();
        reduce(&experiment, threads, 3000).write(&folder.at("reduction")).unwrap();
        assert_eq!(Reduction::read(&folder.at("reduction")).unwrap(), reduce(&experiment, 1, 3000));
        folder.bytes("reduction")
    };
    let one = file(1);
    ensure(one == file(2) && one == file(5), "the same bytes")
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    const DATA: [&str; 3] = ["datasets/emps", "datasets/tx40", "datasets/kuka_lwr4"];
    let mut trials = thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![("the demonstration", the_demonstration), ("IV of EMPS", iv_of_emps)],
    );
    trials.extend(each_night(thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("the demonstration, in all sizes", the_demonstration_in_all_sizes),
            ("joints that hardly move", joints_that_hardly_move),
            ("TX40", tx40),
            ("TX40, in all sizes", tx40_in_all_sizes),
            ("IV in pieces", iv_in_pieces),
            ("TX40, essential parameters", tx40_essential),
            ("TX40, moving part", tx40_moving_part),
            ("IV of the demonstration", iv_of_the_demonstration),
            ("EMPS", emps),
            ("EMPS, aligned", emps_aligned),
            ("KUKA", kuka),
            ("IV of EMPS, aligned", iv_of_emps_aligned),
            ("IV of TX40", iv_of_tx40),
            ("threads change no byte", threads_change_no_byte),
        ],
    )));
    trials
}
