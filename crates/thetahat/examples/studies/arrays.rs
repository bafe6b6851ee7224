//! What Python's calls are measured against (`crates/thetahat-python/benchmarks/speed.py`): the same work on arrays, without
//! Python. `cargo run --release -p thetahat --example studies -- arrays DATA`, where DATA holds `tx40/`; prints seconds by name.

use std::{error::Error, hint::black_box, path::Path, time::Instant};

use thetahat::{
    Experiment, Identification, Method, Series, Settings,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
};

/// Samples of the motion.
const SAMPLES: usize = 45_000;
/// Each piece of work is done so often; the best time counts.
const TIMES: usize = 20;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let data = super::arguments().next().ok_or("the folder that holds tx40/ is missing")?;
    let experiment = Experiment::read(Path::new("experiments/tx40_paper.toml"), Path::new(&data))?;
    let model = Model::new(&experiment.robot);
    let sample = |k: usize| (0..6).map(move |j| (0.37 * k as f64 + j as f64).sin());
    let q = Series::shaped(6, (0..SAMPLES).flat_map(sample).collect());

    let all: Vec<usize> = (0..model.parameter_table().len()).collect();
    let regressor = Regressor::new(&model, &all);
    let entries = || black_box(regressor.evaluate_series(&model, &q, &q, &q, Sign::Exact).values()[0]);
    println!("regressor_entries {}", best(entries));
    let mut phi = vec![0.0; SAMPLES * 6 * all.len()];
    let rows = |phi: &mut [f64]| {
        regressor.evaluate_rows(&model, [&q, &q, &q], 0..SAMPLES, Sign::Exact, phi);
        black_box(phi[0])
    };
    println!("regressor {}", best(|| rows(&mut phi)));
    println!("regressor_new {}", best(|| rows(&mut vec![0.0; SAMPLES * 6 * all.len()])));

    let parameters = DynamicParameters::sorted(&model, &experiment.robot.a_priori_parameters());
    let mut workspace = Workspace::new(&model);
    let torques = || {
        let mut tau = vec![0.0; SAMPLES * 6];
        for (k, tau) in tau.chunks_exact_mut(6).enumerate() {
            let state = State::new(q.sample(k), q.sample(k));
            model.inverse_dynamics(&parameters, state, q.sample(k), Sign::Exact, &mut workspace, tau);
        }
        black_box(tau[0])
    };
    println!("inverse_dynamics {}", best(torques));

    let recordings = experiment.recordings(Path::new(&data))?;
    let settings = Settings { cases: Vec::new(), ..experiment.settings.clone() }.with_methods([Method::IDIM_LS]);
    let identify = || {
        let identification = Identification::new(&experiment.robot, recordings.clone(), settings.clone());
        identification.and_then(|identification| identification.run()).map_or(0, |results| results.runs.len())
    };
    println!("identify_ls {}", best(identify));
    Ok(())
}

/// The best time of a piece of work, s.
fn best<T>(mut work: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..TIMES).map(time).fold(f64::INFINITY, f64::min)
}
