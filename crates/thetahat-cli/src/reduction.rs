//! The commands `reduce` and `solve`.

use std::{error::Error, path::Path};

use thetahat::{
    Experiment,
    reduction::{
        IntervalSource, ReduceOptions, ReduceProgress, ReducedRecording, Reduction, Solution, estimates_of_results,
    },
    report::Published,
    results::NotExamined,
};
use thetahat_ground::output::{FileKind, OutputGuard};
use thetahat_report::report;

use crate::{
    arguments,
    inputs::{read_experiment, threads},
    progress::{Counter, Progress},
    shown::{Remark, show},
    terminal::{Ending, print},
};

pub fn reduce(request: &arguments::Reduce) -> Result<Ending, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&request.described)?;
    let inputs = experiment.input_files(&data).into_iter().chain(request.instruments_from.clone());
    let guard = OutputGuard::new(inputs, request.force.force).of_robot(&experiment.robot.name);
    guard.file(&request.out, FileKind::Reduction)?;
    let (threads, rows_only) = (threads(request.threads), request.rows_only);
    let options = ReduceOptions { threads, rows_only, ..Default::default() };
    let instruments =
        request.instruments_from.as_ref().map(|path| estimates_of_results(path, &experiment)).transpose()?;
    let mut counter = Counter::new("pieces");
    let mut report_progress = |ReduceProgress { recording, recordings, done, to_do }| {
        counter.show(done, to_do, format!("recording {recording} of {recordings}, "));
    };
    let reduction = experiment.reduce_with_instruments(&data, instruments.as_ref(), options, &mut report_progress)?;
    drop(counter);
    reduction.write(&request.out)?;
    let recordings: String = reduction.recordings.iter().map(line).collect();
    let out = request.out.display();
    print(&format!("{recordings}written: {out}\nThen: thetahat solve {out}\n"))?;
    Ok(Ending::Good)
}

/// A line on a reduced recording.
fn line(r: &ReducedRecording) -> String {
    let [start, end] = r.window_s;
    let near_rest = r.near_rest.as_ref().map_or_else(String::new, |near_rest| {
        let most = near_rest.left_out_percent.iter().copied().fold(0.0, f64::max);
        format!(", samples near rest left out (up to {most:.1} % of a joint's)")
    });
    format!(
        "recording {}: {} samples at {} Hz, {start:.4} to {end:.4} s, {} rows of each joint{near_rest}{}\n",
        r.name,
        r.samples,
        r.sample_rate_hz,
        r.rows,
        if r.samples_kept.is_some() { ", samples kept" } else { "" }
    )
}

pub fn solve(request: &arguments::Solve) -> Result<Ending, Box<dyn Error>> {
    let guard = OutputGuard::new(request.reductions.iter().cloned(), request.output.force.force);
    request.output.out.iter().try_for_each(|directory| guard.folder(directory, report::files()))?;
    request.merged.iter().try_for_each(|file| guard.file(file, FileKind::Reduction))?;
    let reduction = Reduction::read_all(&request.reductions)?;
    let mut progress = Progress::new();
    let solution = reduction.solve_with_progress(&mut |stage| progress.show(stage))?;
    drop(progress);
    let published = published(&reduction);
    request.merged.iter().try_for_each(|path| reduction.write(path))?;
    show(
        &solution.results,
        published.as_ref(),
        &request.output,
        &Remark { note: &note(&solution, request.merged.as_deref()), apply: None },
    )
}

/// Where the intervals come from, what was not examined, and where the merged reductions are.
fn note(solution: &Solution, merged: Option<&Path>) -> String {
    let intervals = match solution.intervals {
        IntervalSource::Rows => String::new(),
        IntervalSource::Stretches(stretches) => format!(
            "\nIntervals from {stretches} stretches of time, cluster-robust; identify takes them from the correlation of rows, \
             and they differ (docs/manual/long_recordings.md).\n"
        ),
        IntervalSource::None => "\nNo intervals: no estimate, or fewer than two stretches of time.\n".to_owned(),
    };
    let line = |n: &NotExamined| format!("not examined: {}: {}\n", n.code, n.why);
    let not_examined: String = solution.results.not_examined.iter().map(line).collect();
    let written = merged.map(|path| format!("\nwritten: {}\n", path.display())).unwrap_or_default();
    format!("{intervals}{not_examined}{written}")
}

/// The published figures that the experiment names, if the file still exists.
fn published(reduction: &Reduction) -> Option<Published> {
    let (text, robot) = (reduction.experiment_description.clone(), reduction.robot_description.clone());
    let experiment = Experiment::from_texts(Path::new(&reduction.experiment_name), text, robot).ok()?;
    Published::read(&experiment.published_path()?).ok()
}
