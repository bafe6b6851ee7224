//! A long recording from its file to the estimate, each in its own process, so that the memory of each is measured.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

use thetahat::{Experiment, reduction::ReduceOptions};

use super::{
    long_recording::{Kind, Twin},
    table::verdict,
};

/// The first argument of a process that is measured.
pub const CHILD: &str = "--reduce";

const THREADS: usize = 2;
/// Three minutes, and one hour, at 5 kHz.
const SHORT: usize = 900_000;
const HOUR: usize = 18_000_000;
const HOUR_S: f64 = 60.0;
const HOUR_MB: f64 = 500.0;
/// Times a second that Linux counts processor time.
const TICKS: f64 = 100.0;

/// Time and memory of a process; not a number if the system does not report it.
pub struct Measured {
    pub wall_s: f64,
    pub processor_s: f64,
    pub memory_mb: f64,
    cores: f64,
    parameters: f64,
}

/// Prints the rows of three minutes, or of one hour.
pub fn print(hour: bool) -> Result<(), Box<dyn Error>> {
    let samples = if hour { HOUR } else { SHORT };
    let head = format!("file to estimate, {THREADS} threads, {samples} samples");
    println!("\n{head:<50}{:>8}{:>12}{:>14}{:>10}", "cores", "wall clock", "processor", "memory");
    let twin = Twin::new()?;
    for kind in [Kind::Csv, Kind::Npy] {
        let record = Record::new(&twin, kind, samples)?;
        let measured = record.measure(THREADS)?;
        println!("{}", measured.line(kind, hour));
    }
    Ok(())
}

impl Measured {
    fn line(&self, kind: Kind, hour: bool) -> String {
        let Self { wall_s, processor_s, memory_mb, cores, parameters } = self;
        let name = format!("reduce and solve from {kind}, {parameters} parameters");
        let [processor, memory] = [(processor_s, "s"), (memory_mb, "MB")].map(|(v, unit)| known(*v, unit));
        let line = format!("{name:<50}{cores:>8}{:>12}{processor:>14}{memory:>10}", known(*wall_s, "s"));
        if !hour {
            return format!("{line}  an hour of such: {:.0} s", wall_s * (HOUR / SHORT) as f64);
        }
        let (time, room) = (verdict(*wall_s <= HOUR_S), verdict(*memory_mb <= HOUR_MB));
        format!("{line}  {HOUR_S} s {time}, {HOUR_MB} MB {room}")
    }
}

fn known(value: f64, unit: &str) -> String {
    if value.is_nan() { "not measured".to_owned() } else { format!("{value:.1} {unit}") }
}

/// A recording on the disk, deleted at the end.
pub struct Record {
    folder: PathBuf,
    experiment: PathBuf,
}

impl Record {
    pub fn new(twin: &Twin, kind: Kind, samples: usize) -> Result<Self, Box<dyn Error>> {
        let folder = std::env::temp_dir().join(format!("thetahat_benchmark_{}_{kind}_{samples}", std::process::id()));
        let mut record = Self { experiment: PathBuf::new(), folder };
        record.experiment = twin.write(kind, &record.folder, samples)?;
        Ok(record)
    }

    /// Reduces and solves it in a process of its own.
    pub fn measure(&self, threads: usize) -> Result<Measured, Box<dyn Error>> {
        let mut command = Command::new(std::env::current_exe()?);
        let output = command.args(["benchmark", CHILD]).arg(&self.experiment).arg(threads.to_string()).output()?;
        if !output.status.success() {
            return Err(format!("{}: {}", self.experiment.display(), String::from_utf8_lossy(&output.stderr)).into());
        }
        let text = String::from_utf8(output.stdout)?;
        let numbers = text.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        let [wall_s, processor_s, memory_mb, cores, parameters] = numbers[..] else {
            return Err("five figures".into());
        };
        Ok(Measured { wall_s, processor_s, memory_mb, cores, parameters })
    }
}

impl Drop for Record {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// What the process of [`Record::measure`] does: its figures on one line.
pub fn child(experiment: &Path, threads: usize) -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let folder = experiment.parent().ok_or("a folder")?;
    let options = ReduceOptions { threads, ..Default::default() };
    let solution = Experiment::read(experiment, folder)?.reduce(folder, options, &mut |_| {})?.solve()?;
    let wall_s = started.elapsed().as_secs_f64();
    let cores = std::thread::available_parallelism().map_or(f64::NAN, |n| n.get() as f64);
    let parameters = solution.results.runs[0].parameters.len();
    let [processor_s, memory_mb] = [processor_s(), memory_mb()].map(|value| value.unwrap_or(f64::NAN));
    println!("{wall_s} {processor_s} {memory_mb} {cores} {parameters}");
    Ok(())
}

/// Processor time of all threads, in the program and in the system for it.
fn processor_s() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // After the name, which is in brackets, the third field comes first.
    let (_, fields) = text.rsplit_once(')')?;
    let ticks: Option<Vec<f64>> = fields.split_whitespace().skip(11).take(2).map(|field| field.parse().ok()).collect();
    Some(ticks?.iter().sum::<f64>() / TICKS)
}

/// The most memory that the process has held.
fn memory_mb() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes: f64 =
        text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0 / 1e6)
}
