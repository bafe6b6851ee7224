//! Growth of the work with the joints, of chains of 6 to 30, and with the samples.

use std::{error::Error, hint::black_box, path::Path};

use thetahat::{
    Robot, Series,
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
    signal::Decimator,
};

use super::{
    fastest,
    long_recording::{Kind, Twin},
    streaming::Record,
    tx40::{SIGN, Tx40, motion},
};

const JOINTS: [usize; 5] = [6, 12, 18, 24, 30];
const SAMPLES: [usize; 4] = [10_000, 20_000, 40_000, 80_000];
const STREAMED: [usize; 4] = [225_000, 450_000, 900_000, 1_800_000];
const CALLS: usize = 500;

/// Figures by size, and the exponents of the best fits `figure = c size^exponent`.
pub fn print() -> Result<(), Box<dyn Error>> {
    joints()?;
    head("samples", &SAMPLES);
    let seconds = SAMPLES.map(observation_matrix).into_iter().collect::<Result<Vec<_>, _>>()?;
    line("observation matrix, decimated, us", &SAMPLES, &seconds, 1e6);
    streamed()
}

fn joints() -> Result<(), Box<dyn Error>> {
    let chains = JOINTS.map(|n| Chain::new(n).and_then(|chain| chain.seconds()));
    let chains = chains.into_iter().collect::<Result<Vec<_>, _>>()?;
    head("joints", &JOINTS);
    let names = [
        ("inverse dynamics, us", 1e6),
        ("forward dynamics, us", 1e6),
        ("regressor, all columns, us", 1e6),
        ("base parameters, ms", 1e3),
    ];
    for (i, (name, per)) in names.into_iter().enumerate() {
        line(name, &JOINTS, &chains.iter().map(|chain| chain[i]).collect::<Vec<_>>(), per);
    }
    Ok(())
}

/// From NumPy arrays to the estimate, on one thread.
fn streamed() -> Result<(), Box<dyn Error>> {
    let twin = Twin::new()?;
    let of = |samples: usize| Record::new(&twin, Kind::Npy, samples)?.measure(1);
    let measured = STREAMED.map(of).into_iter().collect::<Result<Vec<_>, _>>()?;
    head("samples", &STREAMED);
    line("reduce and solve, s", &STREAMED, &measured.iter().map(|m| m.wall_s).collect::<Vec<_>>(), 1.0);
    line("of which processor, s", &STREAMED, &measured.iter().map(|m| m.processor_s).collect::<Vec<_>>(), 1.0);
    line("most memory, MB", &STREAMED, &measured.iter().map(|m| m.memory_mb).collect::<Vec<_>>(), 1.0);
    Ok(())
}

fn head(name: &str, sizes: &[usize]) {
    let sizes: String = sizes.iter().map(|n| format!("{n:>10}")).collect();
    println!("\n{name:<34}{sizes}{:>10}", "exponent");
}

fn line(name: &str, sizes: &[usize], figures: &[f64], per: f64) {
    let exponent = exponent(sizes, figures);
    let figures: String = figures.iter().map(|s| format!("{:>10.3}", s * per)).collect();
    println!("{name:<34}{figures}{exponent:>10.2}");
}

/// The exponent of growth: the slope of log(figure) over log(size).
fn exponent(sizes: &[usize], figures: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let x: Vec<f64> = sizes.iter().map(|n| (*n as f64).ln()).collect();
    let y: Vec<f64> = figures.iter().map(|s| s.ln()).collect();
    let (mx, my) = (mean(&x), mean(&y));
    let products: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    products / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>()
}

struct Chain {
    model: Model,
    parameters: DynamicParameters,
    state: [Vec<f64>; 3],
}

impl Chain {
    /// Joints about axes at right angles, links of 0.2 m and 2 kg.
    fn new(joints: usize) -> Result<Self, Box<dyn Error>> {
        let joint = |j: usize| {
            let parent = if j == 1 { String::new() } else { format!("parent = \"joint_{}\"\n", j - 1) };
            let alpha = if j.is_multiple_of(2) { 90 } else { -90 };
            format!("[[joint]]\nname = \"joint_{j}\"\n{parent}kind = \"revolute\"\nalpha_deg = {alpha}\na_m = 0.2\n\n")
        };
        let body = |j: usize| format!("m{j} = 2\nmx{j} = 0.2\nxx{j} = 0.01\nyy{j} = 0.03\nzz{j} = 0.03\nia{j} = 0.1\n");
        let motors = |i: usize| (1..=joints).map(move |j| if i == j { "50, " } else { "0, " }).collect::<String>();
        let text = format!(
            "name = \"chain\"\nfriction = \"symmetric\"\n\n{}[transmission]\nmatrix = [{}]\n\n[parameters]\n{}",
            (1..=joints).map(joint).collect::<String>(),
            (1..=joints).map(|i| format!("[{}],\n", motors(i))).collect::<String>(),
            (1..=joints).map(body).collect::<String>(),
        );
        let robot = Robot::parse(&text, Path::new("chain.toml"))?;
        let model = Model::new(&robot);
        let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
        let state = [0.7, 1.3, 2.1].map(|f| (0..joints).map(|j| (f * j as f64 + f).sin()).collect());
        Ok(Self { model, parameters, state })
    }

    /// Seconds of inverse dynamics, forward dynamics, regressor and base parameters.
    fn seconds(&self) -> Result<[f64; 4], Box<dyn Error>> {
        let Self { model, parameters, state: [q, dq, ddq] } = self;
        let (mut workspace, mut out) = (Workspace::new(model), vec![0.0; q.len()]);
        let inverse = per_call(|| {
            model.inverse_dynamics(parameters, black_box(State::new(q, dq)), ddq, SIGN, &mut workspace, &mut out);
            Ok(())
        })?;
        let forward = per_call(|| {
            Ok(model.forward_dynamics(parameters, black_box(State::new(q, dq)), ddq, SIGN, &mut workspace, &mut out)?)
        })?;
        let regressor = Regressor::new(model, &(0..model.parameter_table().len()).collect::<Vec<_>>());
        let motion = [q, dq, ddq].map(|x| Series::shaped(x.len(), x.repeat(16)));
        let mut phi = vec![0.0; 16 * regressor.entries().len()];
        let batch = per_call(|| {
            let [q, dq, ddq] = &motion;
            regressor.evaluate_samples(model, [q, dq, ddq], 0..16, Sign::Exact, &mut phi);
            Ok(())
        })?;
        let (base, _) = fastest(5, || Ok(BaseParameters::of(model, &[])?))?;
        Ok([inverse, forward, batch / 16.0, base])
    }
}

fn per_call(mut call: impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let (seconds, ()) = fastest(7, || (0..CALLS).try_for_each(|_| call()))?;
    Ok(seconds / CALLS as f64)
}

/// Seconds of the TX40's observation matrix of so many samples, decimated by 100.
fn observation_matrix(samples: usize) -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, .. } = Tx40::new()?;
    let base = BaseParameters::of(&model, &["iam6".to_owned()])?;
    let assembly = thetahat::identification::Assembly::new(&model, &base.columns(), Decimator::new(100, samples)?);
    let [q, dq, ddq] = motion(samples);
    let (seconds, _) = fastest(5, || Ok(assembly.observation_matrix(&q, &dq, &ddq, Sign::Exact)?))?;
    Ok(seconds)
}
