//! What was tried to explain where the paper's tables differ from ours: the tables of `docs/evidence/paper.md`.
//!
//! `cargo run --release -p thetahat --example studies -- paper_study experiments/tx40_paper.toml DATA`

use std::{error::Error, path::Path};

use thetahat::{Experiment, Method, Results, results::RunResult};

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let [experiment, data] = &arguments[..] else {
        return Err("usage: paper_study EXPERIMENT DATA".into());
    };
    let experiment = Experiment::read(Path::new(experiment), Path::new(data))?;
    let data = Path::new(data);
    windows_and_cutoffs(&experiment, data)?;
    deviations_of_iv(&experiment, data)
}

fn find<'a>(results: &'a Results, case: &str, method: Method) -> Result<&'a RunResult, Box<dyn Error>> {
    results.run(case, method).ok_or_else(|| format!("no run {case} {}", method.name()).into())
}

fn windows_and_cutoffs(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    println!("| window s | cut-off Hz | LS % | IV % | fv1 LS | fc1 LS |\n| --- | --- | --- | --- | --- | --- |");
    let settings = [
        (0.06, 7.42, 50.0),
        (0.06, 7.40, 50.0),
        (0.10, 7.42, 50.0),
        (0.06, 7.48, 50.0),
        (0.06, 7.42, 20.0),
        (0.06, 7.42, 30.0),
        (0.06, 7.42, 100.0),
        (0.06, 7.42, 200.0),
    ];
    for (start, end, cutoff_hz) in settings {
        let mut experiment = experiment.clone();
        experiment.settings.cases.clear();
        experiment.settings.estimation.methods = vec![Method::IDIM_LS, Method::IDIM_IV];
        experiment.settings.signal.window_start_s = Some(start);
        experiment.settings.signal.window_end_s = Some(end);
        experiment.settings.signal.cutoff_hz = cutoff_hz;
        let results = experiment.run(data, &mut |_| {})?;
        let (ls, iv) = (find(&results, "nominal", Method::IDIM_LS)?, find(&results, "nominal", Method::IDIM_IV)?);
        let error = |run: &RunResult| run.relative_error_percent.unwrap_or(f64::NAN);
        let estimate = |name: &str| ls.parameter(name).map_or(f64::NAN, |p| p.estimate);
        println!(
            "| {start:.2} to {end:.2} | {cutoff_hz} | {:.3} | {:.3} | {:.3} | {:.3} |",
            error(ls),
            error(iv),
            estimate("fv1"),
            estimate("fc1")
        );
    }
    Ok(())
}

/// Relative standard deviations of IV by its own formula and by `s^2 (Z^T Z)^-1`, from an unweighted DIDIM whose Z has
/// converged to nearly the same.
fn deviations_of_iv(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    let mut experiment = experiment.clone();
    experiment.settings.estimation.weighting.clear();
    let results = experiment.run(data, &mut |_| {})?;
    println!(
        "\n| parameter | IV nominal % | biased % | by Z^T Z, nominal % | biased % |\n| --- | --- | --- | --- | --- |"
    );
    for name in ["zz1r", "fc1", "fv1", "xx2r", "mx2r", "fv2", "my3r", "ia3", "fv5", "ia6", "fcm6", "fvm6"] {
        let mut cells = Vec::new();
        for case in ["nominal", "gear_ratio_0.9"] {
            let (iv, didim) = (find(&results, case, Method::IDIM_IV)?, find(&results, case, Method::DIDIM)?);
            let residuals = iv.relative_error_percent.zip(didim.relative_error_percent).map(|(i, d)| i / d);
            let of_iv = iv.parameter(name).ok_or("no such parameter")?;
            let by_z = didim.parameter(name).and_then(|p| p.standard_deviation).zip(residuals);
            let by_z = by_z.map(|(sd, ratio)| 100.0 * sd * ratio / of_iv.estimate.abs());
            cells.push((of_iv.relative_standard_deviation_percent.unwrap_or(f64::NAN), by_z.unwrap_or(f64::NAN)));
        }
        println!("| {name} | {:.2} | {:.2} | {:.2} | {:.2} |", cells[0].0, cells[1].0, cells[0].1, cells[1].1);
    }
    let unweighted = find(&results, "nominal", Method::DIDIM)?;
    let error = unweighted.relative_error_percent.unwrap_or(f64::NAN);
    let fv6 = unweighted.parameter("fv6").and_then(|p| p.relative_standard_deviation_percent);
    println!("\nunweighted DIDIM: {error:.3} %, fv6 {:.2} %", fv6.unwrap_or(f64::NAN));
    Ok(())
}
