//! Reducing and solving is identifying: on the demonstration's twin, and on the recorded EMPS and TX40.

mod common;

use std::path::{Path, PathBuf};

use common::ensure;
use libtest_mimic::Failed;
use thetahat::{
    experiment::{Experiment, RunResult},
    identification::Method,
    reduction::{ReduceOptions, Reduction},
};

/// Relative to the estimate, and to its standard deviation where that is larger.
const EQUAL: f64 = 1e-9;
/// The same between reductions of one record.
const EQUAL_PIECES: f64 = 1e-10;

fn experiment(name: &str) -> Experiment {
    Experiment::read(&common::root().join("experiments").join(name), &common::data()).unwrap()
}

fn reduce(experiment: &Experiment, threads: usize, piece_samples: usize) -> Reduction {
    experiment.reduce(&common::data(), ReduceOptions { threads, piece_samples }, &mut |_| {}).unwrap()
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

fn equals_identify(mut experiment: Experiment) -> Result<(), Failed> {
    experiment.file.estimation.methods = vec![Method::IdimLs];
    experiment.file.case.clear();
    let results = experiment.run(&common::data(), &mut |_| {})?;
    let expected = results.run("nominal", Method::IdimLs).unwrap();
    let whole = reduce(&experiment, 1, 1 << 16);
    let solved = whole.solve()?.results;
    ensure(solved.samples_used == results.samples_used, "as many samples")?;
    ensure(solved.decimated_rows == results.decimated_rows, "as many rows")?;
    same(&solved.runs[0], expected, EQUAL)?;
    for piece_samples in [100, 3000, 8191] {
        let pieces = reduce(&experiment, 2, piece_samples).solve()?.results;
        same(&pieces.runs[0], &solved.runs[0], EQUAL_PIECES)?;
        for (p, s) in pieces.runs[0].parameters.iter().zip(&solved.runs[0].parameters) {
            let [a, b] = [p, s].map(|p| p.standard_deviation_robust.unwrap());
            close(a, b, b, 1e-6, &format!("robust sd of {}", s.name))?;
        }
    }
    Ok(())
}

fn the_demonstration() -> Result<(), Failed> {
    equals_identify(Experiment::demo()?)
}

fn emps() -> Result<(), Failed> {
    equals_identify(experiment("emps.toml"))
}

fn tx40() -> Result<(), Failed> {
    equals_identify(experiment("tx40_paper.toml"))
}

fn tx40_essential() -> Result<(), Failed> {
    equals_identify(experiment("tx40_essential.toml"))
}

/// The window is the moving part, which a first pass finds.
fn tx40_moving_part() -> Result<(), Failed> {
    let mut experiment = experiment("tx40_paper.toml");
    experiment.file.signal.window_start_s = None;
    experiment.file.signal.window_end_s = None;
    equals_identify(experiment)
}

fn kuka() -> Result<(), Failed> {
    equals_identify(experiment("kuka_lwr4.toml"))
}

fn threads_change_no_byte() -> Result<(), Failed> {
    let experiment = experiment("tx40_paper.toml");
    let file = |threads: usize| -> Vec<u8> {
        let path: PathBuf = std::env::temp_dir().join(format!("thetahat-threads-{threads}-{}", std::process::id()));
        reduce(&experiment, threads, 3000).write(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(Reduction::read(&path).unwrap(), reduce(&experiment, 1, 3000));
        std::fs::remove_file(&path).unwrap();
        bytes
    };
    let one = file(1);
    ensure(one == file(2) && one == file(5), "the same bytes")?;
    ensure(Path::new("/").exists(), "")
}

fn main() {
    common::run_with_shared_data(vec![
        ("the demonstration", the_demonstration),
        ("EMPS", emps),
        ("TX40", tx40),
        ("TX40, essential parameters", tx40_essential),
        ("TX40, moving part", tx40_moving_part),
        ("KUKA", kuka),
        ("threads change no byte", threads_change_no_byte),
    ])
}
