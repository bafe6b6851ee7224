//! What the simulator's settings do to the estimates on the TX40 record: the tables of `docs/evidence/simulation.md`.
//!
//! `cargo run --release --example studies -p thetahat -- simulator_study experiments/tx40_paper.toml DATA`

use std::{error::Error, path::Path};

use thetahat::{Experiment, Method, Results, results::RunResult, simulation::Solver};

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let [experiment, data] = &arguments[..] else {
        return Err("usage: simulator_study EXPERIMENT DATA".into());
    };
    let experiment = Experiment::read(Path::new(experiment), Path::new(data))?;
    let data = Path::new(data);
    bandwidths(&experiment, data)?;
    sign_scales(&experiment, data)?;
    solvers(&experiment, data)
}

fn run(experiment: &Experiment, data: &Path) -> Result<Results, Box<dyn Error>> {
    Ok(experiment.run(data, &mut |_| {})?)
}

fn find<'a>(results: &'a Results, case: &str, method: Method) -> Result<&'a RunResult, Box<dyn Error>> {
    results.run(case, method).ok_or_else(|| format!("no run {case} {}", method.name()).into())
}

/// Largest and root mean square difference of the shown estimates, in standard deviations of `reference`.
fn difference(run: &RunResult, reference: &RunResult) -> (f64, f64) {
    let z: Vec<f64> = run
        .parameters
        .iter()
        .zip(&reference.parameters)
        .filter(|(p, _)| p.shown)
        .map(|(p, r)| (p.estimate - r.estimate).abs() / r.standard_deviation.unwrap_or(f64::INFINITY))
        .collect();
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
    (z.iter().copied().fold(0.0, f64::max), rms)
}

fn percent(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.2}"))
}

fn bandwidths(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    println!("| bandwidth Hz | IV % | DIDIM % | DIDIM - LS, sd: max | rms | biased DIDIM % | zz1r % | fv1 % |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for hz in [20.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0] {
        let mut experiment = experiment.clone();
        if let Some(controller) = &mut experiment.settings.controller {
            controller.bandwidth_hz = vec![hz];
        }
        let results = run(&experiment, data)?;
        let didim = find(&results, "nominal", Method::DIDIM)?;
        let biased = find(&results, "gear_ratio_0.9", Method::DIDIM)?;
        let (max, rms) = difference(didim, find(&results, "nominal", Method::IDIM_LS)?);
        let change = |name: &str| {
            let of = |r: &RunResult| r.parameter(name).map(|p| p.estimate);
            of(biased).zip(of(didim)).map(|(b, n)| 100.0 * (b / n - 1.0))
        };
        println!(
            "| {hz} | {} | {} | {max:.1} | {rms:.2} | {} | {} | {} |",
            percent(find(&results, "nominal", Method::IDIM_IV)?.relative_error_percent),
            percent(didim.relative_error_percent),
            percent(biased.relative_error_percent),
            percent(change("zz1r")),
            percent(change("fv1")),
        );
    }
    Ok(())
}

/// Runs the nominal case with other settings, and compares with the tightest.
fn compare(rows: Vec<(String, Results)>) -> Result<(), Box<dyn Error>> {
    let Some((_, reference)) = rows.last() else { return Ok(()) };
    for (name, results) in &rows {
        let of = |method| -> Result<_, Box<dyn Error>> {
            let run = find(results, "nominal", method)?;
            let (max, rms) = difference(run, find(reference, "nominal", method)?);
            Ok((percent(run.relative_error_percent), max, rms, run.seconds / run.simulations.max(1) as f64))
        };
        let (iv, didim) = (of(Method::IDIM_IV)?, of(Method::DIDIM)?);
        println!(
            "| {name} | {} | {:.3} | {:.3} | {} | {:.3} | {:.3} | {:.2} |",
            iv.0, iv.1, iv.2, didim.0, didim.1, didim.2, didim.3
        );
    }
    Ok(())
}

const COLUMNS: &str = "IV % | IV max sd | rms sd | DIDIM % | DIDIM max sd | rms sd | s per simulation |\n\
                       | --- | --- | --- | --- | --- | --- | --- | --- |";

fn sign_scales(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    println!("\n| sign_velocity_scale rad/s | {COLUMNS}");
    let mut rows = Vec::new();
    for scale in [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001] {
        let mut experiment = experiment.clone();
        experiment.settings.cases.clear();
        experiment.settings.simulation.sign_velocity_scale = scale;
        experiment.settings.simulation.solver = Solver::Adaptive { relative_tolerance: 1e-6, absolute_tolerance: 1e-9 };
        rows.push((scale.to_string(), run(&experiment, data)?));
    }
    compare(rows)
}

fn solvers(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    println!("\n| solver | {COLUMNS}");
    let adaptive = |r, a| Solver::Adaptive { relative_tolerance: r, absolute_tolerance: a };
    let solvers = [
        ("fixed 0.2 ms", Solver::Fixed { step_s: 2e-4 }),
        ("fixed 0.1 ms", Solver::Fixed { step_s: 1e-4 }),
        ("ode45: 1e-3, 1e-6", adaptive(1e-3, 1e-6)),
        ("1e-4, 1e-7", adaptive(1e-4, 1e-7)),
        ("1e-6, 1e-9", adaptive(1e-6, 1e-9)),
        ("1e-9, 1e-12", adaptive(1e-9, 1e-12)),
    ];
    let mut rows = Vec::new();
    for (name, solver) in solvers {
        let mut experiment = experiment.clone();
        experiment.settings.cases.clear();
        experiment.settings.simulation.solver = solver;
        rows.push((name.to_owned(), run(&experiment, data)?));
    }
    compare(rows)
}
