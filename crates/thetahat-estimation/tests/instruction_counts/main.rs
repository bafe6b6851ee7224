//! Instructions of the hot kernels, counted by valgrind and compared with those in `counts.toml`: a guard
//! against code that has become slower without anybody noticing. Unlike times, they do not depend on how busy the machine is.
//!
//! `THETAHAT_UPDATE_COUNTS=1 cargo test --release -p thetahat-estimation --test instruction_counts` writes the file anew. Without
//! valgrind, optimisation or the vector instructions of the stored counts, the tests count as ignored.

#[path = "../../benches/tx40/mod.rs"]
mod tx40;

use std::{collections::BTreeMap, error::Error, hint::black_box, path::PathBuf, process::Command};

use libtest_mimic::{Arguments, Failed, Trial};
use thetahat_estimation::{
    identification::Assembly,
    signal::Decimator,
    trajectory::{MotionLimits, plan},
};
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Sign;
use tx40::{DDQ, DQ, Q, SIGN, Tx40, motion, state};

/// Part of a count by which it may grow.
const TOLERANCE: f64 = 0.05;
/// Calls of the shorter and of the longer run, whose difference is free of what comes before and behind.
const CALLS: [usize; 2] = [64, 256];
/// Names the kernel that this process is to run, and how often.
const KERNEL: &str = "THETAHAT_COUNTED_KERNEL";

type Kernel = (&'static str, fn(usize) -> Result<(), Box<dyn Error>>);

const KERNELS: [Kernel; 8] = [
    ("inverse_dynamics", inverse_dynamics),
    ("mass_matrix", mass_matrix),
    ("forward_dynamics", forward_dynamics),
    ("regressor", regressor),
    ("regressor_in_batches", regressor_in_batches),
    ("forward_dynamics_in_batches", forward_dynamics_in_batches),
    ("observation_matrix", observation_matrix),
    ("reference", reference),
];

fn main() -> Result<(), Box<dyn Error>> {
    if let Ok(asked) = std::env::var(KERNEL) {
        let (name, calls) = asked.split_once(':').ok_or("NAME:CALLS")?;
        let (_, kernel) = KERNELS.iter().find(|(known, _)| *known == name).ok_or("no such kernel")?;
        return kernel(calls.parse()?);
    }
    let absent = reason_to_skip();
    if let Some(reason) = &absent {
        eprintln!("\n*** SKIPPED: {} instruction counts: {reason} ***\n", KERNELS.len());
    } else if std::env::var_os("THETAHAT_UPDATE_COUNTS").is_some() {
        return update();
    }
    let trial = |(name, _): Kernel| Trial::test(name, move || check(name)).with_ignored_flag(absent.is_some());
    libtest_mimic::run(&Arguments::from_args(), KERNELS.map(trial).into()).exit()
}

fn reason_to_skip() -> Option<&'static str> {
    let valgrind = Command::new("valgrind").arg("--version").output().is_ok_and(|o| o.status.success());
    if cfg!(debug_assertions) {
        Some("this is not a release build")
    } else if !valgrind {
        Some("valgrind is not installed (apt-get install valgrind)")
    } else if has_vectors_of_four() {
        None
    } else {
        Some("this processor has other vector instructions than the one that they were counted on (AVX2)")
    }
}

#[cfg(target_arch = "x86_64")]
fn has_vectors_of_four() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_vectors_of_four() -> bool {
    false
}

fn file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/instruction_counts/counts.toml")
}

fn check(name: &'static str) -> Result<(), Failed> {
    let stored: BTreeMap<String, f64> = toml::from_str(&std::fs::read_to_string(file())?)?;
    let stored = stored.get(name).ok_or_else(|| format!("{name} is not in {}", file().display()))?;
    let found = instructions(name)?;
    println!("{name}: {found:.0} instructions, {:+.1} %", 100.0 * (found / stored - 1.0));
    if found <= stored * (1.0 + TOLERANCE) {
        return Ok(());
    }
    Err(format!("{name} takes {found:.0} instructions, {stored:.0} are stored; see the top of this file").into())
}

fn update() -> Result<(), Box<dyn Error>> {
    let mut text = "# Instructions per call, or per sample of a batch: see instruction_counts.rs.\n".to_owned();
    for (name, _) in KERNELS {
        text += &format!("{name} = {:.0}\n", instructions(name)?);
    }
    print!("{text}");
    Ok(std::fs::write(file(), text)?)
}

/// Instructions of one call.
fn instructions(name: &str) -> Result<f64, Box<dyn Error>> {
    let [few, many] = CALLS.map(|calls| total(name, calls));
    Ok((many? - few?) / (CALLS[1] - CALLS[0]) as f64)
}

/// Instructions of this program while it runs a kernel so often.
fn total(name: &str, calls: usize) -> Result<f64, Box<dyn Error>> {
    let program = std::env::current_exe()?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program);
    let output = command.env(KERNEL, format!("{name}:{calls}")).output()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let count = text.lines().find_map(|line| line.split_once("Collected :")).and_then(|(_, n)| n.trim().parse().ok());
    count.ok_or_else(|| format!("valgrind printed no count:\n{text}").into())
}

fn inverse_dynamics(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut tau = [0.0; 6];
    for _ in 0..calls {
        model.inverse_dynamics(&parameters, state(), &DDQ, SIGN, &mut workspace, black_box(&mut tau));
    }
    Ok(())
}

fn mass_matrix(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut m = [0.0; 36];
    for _ in 0..calls {
        model.mass_matrix(&parameters, black_box(&Q), &mut workspace, black_box(&mut m));
    }
    Ok(())
}

fn forward_dynamics(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut ddq = [0.0; 6];
    for _ in 0..calls {
        let ddq = black_box(&mut ddq);
        model.forward_dynamics(&parameters, state(), &DDQ, SIGN, &mut workspace, ddq)?;
    }
    Ok(())
}

fn regressor(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, mut workspace, regressor, .. } = Tx40::new()?;
    let mut phi = vec![0.0; regressor.entries().len()];
    for _ in 0..calls {
        regressor.evaluate(&model, state(), &DDQ, Sign::Exact, &mut workspace, black_box(&mut phi));
    }
    Ok(())
}

/// The motion is the longest of all, so that making it counts for nothing.
fn most() -> [Series; 3] {
    motion(CALLS[1])
}

fn regressor_in_batches(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, regressor, .. } = Tx40::new()?;
    let ([q, dq, ddq], entries) = (most(), regressor.entries().len());
    let mut phi = vec![0.0; CALLS[1] * entries];
    let phi = &mut phi[..calls * entries];
    regressor.evaluate_samples(&model, [black_box(&q), &dq, &ddq], 0..calls, Sign::Exact, phi);
    black_box(phi);
    Ok(())
}

fn forward_dynamics_in_batches(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, parameters, .. } = Tx40::new()?;
    let [q, dq, tau] = most().map(|series| series.window(0..calls));
    let motion = [black_box(&q), &dq, &tau];
    black_box(model.forward_dynamics_series(&parameters, motion, SIGN).map_err(|(_, error)| error)?);
    Ok(())
}

/// With its decimation by 10.
fn observation_matrix(calls: usize) -> Result<(), Box<dyn Error>> {
    let Tx40 { model, .. } = Tx40::new()?;
    let [q, dq, ddq] = most().map(|series| series.window(0..calls));
    let assembly = Assembly::new(&model, &(0..60).collect::<Vec<_>>(), Decimator::new(10, calls)?);
    black_box(assembly.observation_matrix(&q, &dq, &ddq, Sign::Exact)?);
    Ok(())
}

fn reference(calls: usize) -> Result<(), Box<dyn Error>> {
    let max_velocity = vec![2.0; 6];
    let limits = MotionLimits { max_velocity, acceleration_time_s: 0.1, smoothing_time_s: 0.03, dwell_s: 0.0 };
    let moves = plan(Q.to_vec(), &[DQ.to_vec()], &limits, 0.0)?;
    let [mut q, mut dq, mut ddq] = [[0.0; 6]; 3];
    for k in 0..calls {
        let t = moves.end_s() * k as f64 / CALLS[1] as f64;
        moves.evaluate(black_box(t), black_box(&mut q), &mut dq, &mut ddq);
    }
    Ok(())
}
