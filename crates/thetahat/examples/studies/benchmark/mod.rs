//! Every figure of `docs/evidence/speed.md`, with the peers in the same run:
//!
//! ```text
//! pip install pin==4.1.0 numpy scipy pandas
//! taskset -c 0 cargo run --release -p thetahat --example studies -- benchmark DATA [PYTHON BASELINE.py] [--hour]
//! ```
//!
//! DATA is the folder that holds `tx40/`. Without Python, only this library is timed. With `--hour` the streaming rows
//! cover a whole hour; run it without taskset, so that it has two cores, and with 4.4 GB free for temporary files.

mod growth;
mod kernels;
use super::long_recording::twin as long_recording;
mod peers;
mod stages;
mod streaming;
mod table;
#[path = "../../../../thetahat-estimation/benches/tx40/mod.rs"]
mod tx40;

use std::{error::Error, hint::black_box, path::Path, time::Instant};

use self::peers::Peers;
use self::table::Row;
use thetahat::{Experiment, report::Published};
use thetahat_report::report;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = super::arguments().collect();
    if let [flag, experiment, threads] = &arguments[..]
        && flag == streaming::CHILD
    {
        return streaming::child(Path::new(experiment), threads.parse()?);
    }
    let hour = arguments.pop_if(|last| last == "--hour").is_some();
    let (data, peers) = match &arguments[..] {
        [data] => (Path::new(data), Peers::none()),
        [data, python, baseline] => (Path::new(data), Peers::run(python, Path::new(baseline), Path::new(data))?),
        _ => return Err("usage: benchmark DATA [PYTHON BASELINE.py] [--hour]".into()),
    };
    let mut rows = kernels::rows(&peers)?;
    rows.extend(stages::rows(data, &peers)?);
    rows.push(whole_paper(data)?);
    table::print(&rows);
    streaming::print(hour)?;
    growth::print()
}

/// The paper's three methods and two cases, from the files to the report.
fn whole_paper(data: &Path) -> Result<Row, Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/tx40_paper.toml");
    let directory = std::env::temp_dir().join(format!("thetahat_benchmark_{}", std::process::id()));
    let (seconds, _) = fastest(3, || {
        let experiment = Experiment::read(&file, data)?;
        let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
        let results = experiment.run(data, &mut |_| {})?;
        black_box(report::text::all(&results, published.as_ref(), report::TextWidth::DEFAULT));
        Ok(report::write_all(&results, published.as_ref(), &directory)?)
    })?;
    std::fs::remove_dir_all(&directory)?;
    Ok(Row::limit("whole paper: 3 methods, 2 cases, report", seconds, 2.0))
}

/// The seconds of the fastest of several runs, and the result of the last.
fn fastest<T>(runs: usize, mut stage: impl FnMut() -> Result<T, Box<dyn Error>>) -> Result<(f64, T), Box<dyn Error>> {
    let mut best = f64::INFINITY;
    let mut result = None;
    for _ in 0..runs {
        let started = Instant::now();
        result = Some(stage()?);
        best = best.min(started.elapsed().as_secs_f64());
    }
    result.map(|r| (best, r)).ok_or_else(|| "no run".into())
}
