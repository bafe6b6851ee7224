//! From recorded logs to estimates by `init` and `identify`, with no edit between them.

mod field;

use libtest_mimic::{Arguments, Failed};
use thetahat::{Results, identification::Status};
use thetahat_testing::{Folder, data, each_night, ensure, project, run, succeeded, trials_on_shared_data};

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

/// Runs `init` on some recordings of the shared data, and then `identify` as it is told to.
fn identified(robot: &str, recordings: &[&str], more: &[&str]) -> Result<Results, Failed> {
    let folder = Folder::new();
    let paths: Vec<String> = recordings.iter().map(|name| data().join(name).display().to_string()).collect();
    let arguments = ["init", "--robot", robot].into_iter().chain(paths.iter().flat_map(|p| ["--recording", p]));
    let said = succeeded(&run(PROGRAM, folder.path(), arguments.chain(more.iter().copied())));
    let next = said.lines().find(|line| line.trim().starts_with("thetahat identify"));
    let next = next.ok_or_else(|| Failed::from(format!("init names no next command:\n{said}")))?;
    succeeded(&run(PROGRAM, folder.path(), next.trim().split(' ').skip(1).chain(["--out", "results"])));
    Ok(Results::read(&folder.path().join("results/results.json"))?)
}

/// The methods that init proposes converge, and the one that is advised is within a relative error, percent.
fn is_within(limit: f64, results: &Results) -> Result<(), Failed> {
    let take = results.advice[0].recommended.ok_or("no method is advised")?;
    for name in ["idim-wls", "idim-iv"] {
        let run = results.runs.iter().find(|r| r.method.name() == name).ok_or("init did not propose it")?;
        ensure(run.status == Status::Converged, format!("{name}: {:?}", run.reason))?;
        let error = run.relative_error_percent.unwrap_or(f64::NAN);
        ensure(run.method != take || error <= limit, format!("{name}: {error} %, and {limit} % at most"))?;
    }
    Ok(())
}

fn lwr4() -> Result<(), Failed> {
    let robot = data().join("kuka_lwr4/kuka_lwr4.urdf").display().to_string();
    is_within(2.6, &identified(&robot, &["kuka_lwr4/measurements_2.npz", "kuka_lwr4/measurements_3.npz"], &[])?)
}

fn ur10() -> Result<(), Failed> {
    let robot = project("robots/ur10.toml").display().to_string();
    is_within(7.0, &identified(&robot, &["ur10/ur10_exciting_trajectory.db3"], &[])?)
}

/// The name of the torques' file says a current, and they are torques.
fn tx40() -> Result<(), Failed> {
    let robot = project("robots/tx40.toml").display().to_string();
    let recordings = ["tx40/pos_read_data.csv", "tx40/curr_data.csv"];
    is_within(5.8, &identified(&robot, &recordings, &["--rate", "5000"])?)
}

fn main() {
    let files = ["datasets/kuka_lwr4", "datasets/ur10", "datasets/tx40"];
    let mut trials = each_night(trials_on_shared_data(&files, vec![("tx40", tx40), ("lwr4", lwr4), ("ur10", ur10)]));
    trials.extend(field::trials());
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}
