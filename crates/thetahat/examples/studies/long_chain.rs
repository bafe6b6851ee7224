//! Peak memory of IDIM-LS on a chain of many joints: `cargo run --release --example studies -- long_chain [JOINTS] [SAMPLES]`.
//!
//! The chain moves along sums of sines at 1 kHz; its torques are those of its a-priori parameters with noise. Forty joints
//! with 30,000 samples are to stay below 1 GB; the example ends with an error where they do not.

use std::{error::Error, fmt::Write, path::Path, time::Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Identification, Recording, Robot, Series, Settings,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
};

const SAMPLE_RATE_HZ: f64 = 1000.0;
/// Peak memory that forty joints with 30,000 samples may take, kB.
const LARGEST_KB: usize = 1_000_000;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = super::arguments().map(|a| a.parse::<usize>());
    let joints = arguments.next().transpose()?.unwrap_or(40);
    let samples = arguments.next().transpose()?.unwrap_or(30_000);
    let robot = chain(joints)?;
    let (positions, torques) = record(&robot, samples);
    let before_kb = peak_kb();
    let started = Instant::now();
    let settings = Settings::new(25.0, 20);
    let recording = Recording::new(SAMPLE_RATE_HZ, positions, torques);
    let results = Identification::new(&robot, vec![recording], settings)?.run()?;
    let run = &results.runs[0];
    println!(
        "{joints} joints, {samples} samples: {} rows, {} parameters, {:?} %, {:.1} s; peak memory {:?} kB, {:?} before",
        results.decimated_rows,
        run.parameters.len(),
        run.relative_error_percent,
        started.elapsed().as_secs_f64(),
        peak_kb(),
        before_kb,
    );
    match peak_kb() {
        Some(peak) if peak > LARGEST_KB => Err(format!("{peak} kB are more than {LARGEST_KB}").into()),
        _ => Ok(()),
    }
}

/// A chain whose axes turn by right angles, with a body and friction at each joint.
fn chain(joints: usize) -> Result<Robot, Box<dyn Error>> {
    let mut text = "name = \"chain\"\n".to_owned();
    for j in 0..joints {
        let alpha = if j % 2 == 0 { 90 } else { -90 };
        writeln!(text, "[[joint]]\nname = \"j{j}\"\nkind = \"revolute\"\nalpha_deg = {alpha}\na_m = 0.05\nd_m = 0.02")?;
    }
    writeln!(text, "[parameters]")?;
    for j in 1..=joints {
        writeln!(text, "m{j} = 0.5\nmx{j} = 0.02\nmy{j} = 0.01\nxx{j} = 0.002\nyy{j} = 0.004\nzz{j} = 0.004")?;
        writeln!(text, "ia{j} = 0.01\nfv{j} = 0.3\nfc{j} = 0.2")?;
    }
    Ok(Robot::parse(&text, Path::new("chain.toml"))?)
}

/// Positions and torques with noise.
fn record(robot: &Robot, samples: usize) -> (Series, Series) {
    let n = robot.coordinate_count();
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let mut workspace = Workspace::new(&model);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let waves: Vec<[[f64; 3]; 4]> = (0..n)
        .map(|_| [0; 4].map(|_| [rng.random_range(0.1..0.3), rng.random_range(0.5..6.0), rng.random_range(0.0..6.3)]))
        .collect();
    let (mut positions, mut torques) = (Series::zeros(samples, n), Series::zeros(samples, n));
    let (mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n]);
    for k in 0..samples {
        let t = k as f64 / SAMPLE_RATE_HZ;
        let q = positions.sample_mut(k);
        for (j, waves) in waves.iter().enumerate() {
            (q[j], dq[j], ddq[j]) = waves.iter().fold((0.0, 0.0, 0.0), |(q, dq, ddq), [a, w, p]| {
                let (s, c) = (w * t + p).sin_cos();
                (q + a * s, dq + a * w * c, ddq - a * w * w * s)
            });
        }
        let state = State::new(positions.sample(k), &dq);
        let tau = torques.sample_mut(k);
        model.inverse_dynamics(&parameters, state, &ddq, Sign::Exact, &mut workspace, tau);
        tau.iter_mut().for_each(|tau| *tau += rng.random_range(-0.05..0.05));
    }
    (positions, torques)
}

/// The largest resident memory of this process so far, if the system reports it.
fn peak_kb() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
