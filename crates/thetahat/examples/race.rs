//! Our stages on the TX40 record beside those of a baseline in Python, in one run and on one thread.
//!
//! `cargo run --release -p thetahat --example race -- DATA [PYTHON BASELINE.py]`: see `docs/speed.md`.

use std::{collections::BTreeMap, error::Error, path::Path, process::Command, time::Instant};

use thetahat::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    experiment::Experiment,
    identification::{Assembly, Divisor, idim_ls},
    recording::read_channels,
    signal::{Decimator, Padding, SecondOrderSections, central_difference, zero_phase},
    simulation::{ClosedLoop, OutputGrid, Reference, SimulatorBias},
    trajectory::reconstruct,
};

/// Runs of each stage, of which the fastest counts.
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (data, baseline) = match &arguments[..] {
        [data] => (data, None),
        [data, python, script] => (data, Some((python, script))),
        _ => return Err("usage: race DATA [PYTHON BASELINE.py]".into()),
    };
    let theirs = baseline.map(|(python, script)| run_baseline(python, script)).transpose()?;
    let ours = our_stages(Path::new(data))?;
    println!("{:<34}{:>12}{:>12}{:>9}", "stage", "baseline s", "thetahat s", "ratio");
    for (name, seconds) in ours {
        let stages = |stages: &BTreeMap<String, f64>| -> f64 { stages_of(name).iter().map(|s| stages[*s]).sum() };
        match theirs.as_ref().map(stages) {
            Some(t) => println!("{name:<34}{t:>12.4}{seconds:>12.4}{:>9.1}", t / seconds),
            None => println!("{name:<34}{:>12}{seconds:>12.4}", "-"),
        }
    }
    Ok(())
}

const LOADING: &str = "loading";
const IDENTIFICATION: &str = "LS identification after loading";
const SIMULATION: &str = "closed-loop simulation";

/// The baseline's stages that make up one of ours.
fn stages_of(name: &str) -> &'static [&'static str] {
    match name {
        LOADING => &["load"],
        IDENTIFICATION => &["band-pass", "regressor", "decimate", "least squares"],
        _ => &["closed-loop simulation (RK45)"],
    }
}

fn run_baseline(python: &str, script: &str) -> Result<BTreeMap<String, f64>, Box<dyn Error>> {
    let output = Command::new(python).args([script, "--simulate"]).output()?;
    let text = String::from_utf8(output.stdout)?;
    let line = |line: &str| {
        let (name, seconds) = line.trim_end().rsplit_once(' ')?;
        Some((name.trim().to_owned(), seconds.parse().ok()?))
    };
    Ok(text.lines().filter_map(line).collect())
}

/// The fastest of several runs, and the result of the last.
fn fastest<T>(mut stage: impl FnMut() -> Result<T, Box<dyn Error>>) -> Result<(f64, T), Box<dyn Error>> {
    let mut best = f64::INFINITY;
    let mut result = None;
    for _ in 0..RUNS {
        let started = Instant::now();
        result = Some(stage()?);
        best = best.min(started.elapsed().as_secs_f64());
    }
    result.map(|r| (best, r)).ok_or_else(|| "no run".into())
}

fn our_stages(data: &Path) -> Result<Vec<(&'static str, f64)>, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/tx40_paper.toml");
    let experiment = Experiment::read(&root, Path::new(""))?;
    let recording = experiment.file.recording.first().ok_or("no recording")?;
    let transmission = &experiment.robot.transmission;
    let (loading, (q, tau)) = fastest(|| {
        let position = transmission.joint_positions(&read_channels(&recording.position, data)?);
        Ok((position, transmission.joint_torques(&read_channels(&recording.torque, data)?)))
    })?;
    let rate = 5000.0;
    let window = 300..37_100;
    let model = Model::new(&experiment.robot);
    let base = BaseParameters::of(&model, &experiment.file.parameters.exclude)?;
    let assembly = Assembly::new(&model, &base.columns(), Decimator::new(100, window.len())?);
    let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, rate)?;
    let (identification, (dq, fit)) = fastest(|| {
        let qf = zero_phase(&filter, &q, Padding::Matlab)?;
        let dq = central_difference(&qf, rate);
        let ddq = central_difference(&dq, rate);
        let cut = |s: &thetahat::series::Series| s.window(window.clone());
        let x = assembly.observation_matrix(&cut(&qf), &cut(&dq), &cut(&ddq), Sign::Exact)?;
        let y = assembly.measurement_vector(&cut(&tau))?;
        Ok((dq, idim_ls(&x, &y, None, Divisor::default())?))
    })?;
    let reference = Reference::Moves(reconstruct(&q, &dq, rate)?.moves);
    let closed_loop = ClosedLoop {
        model: &model,
        transmission,
        controller: experiment.file.controller.as_ref().ok_or("no controller")?,
        reference: &reference,
        added_signal: None,
        bias: SimulatorBias::NONE,
        solver: experiment.file.simulation.solver,
        sign_velocity_scale: experiment.file.simulation.sign_velocity_scale,
    };
    let theta = base.to_standard(&fit.theta);
    let inertia = closed_loop.motor_inertia(&theta, 7.42);
    let grid = OutputGrid { start_s: 0.06, sample_rate_hz: rate, samples: window.len() };
    let (simulation, motion) = fastest(|| Ok(closed_loop.simulate(&theta, &inertia, &grid)?))?;
    eprintln!("LS relative error {:.4} %; simulation {:?}", fit.relative_error_percent, motion.counts);
    Ok(vec![(LOADING, loading), (IDENTIFICATION, identification), (SIMULATION, simulation)])
}
