//! IV and DIDIM on recorded robots with simulated PD loops of several bandwidths, and with none stated: the table of figures
//! of `docs/evidence/closed_loop.md`.
//!
//! `cargo run --release -p thetahat --example studies -- closed_loop_study DATA [--methods idim-ls,idim-iv,didim]`
//!
//! DATA holds `kuka_lwr4/` and `ur10/`.

use std::{error::Error, path::Path};

use thetahat::{
    ControllerDescription, Experiment, Method,
    identification::{Needs, Status},
    results::RunResult,
};

/// Experiments of the checkout with recorded motion.
const EXPERIMENTS: [(&str, &str); 2] = [("LWR4+", "kuka_lwr4.toml"), ("UR10", "ur10.toml")];
const BANDWIDTHS_HZ: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 80.0];

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let (data, methods) = match &arguments[..] {
        [data] => (data, "idim-ls,idim-iv,didim"),
        [data, key, methods] if key == "--methods" => (data, methods.as_str()),
        _ => return Err("usage: closed_loop_study DATA [--methods idim-ls,idim-iv,didim]".into()),
    };
    let methods: Vec<Method> = methods.split(',').map(str::parse).collect::<Result<_, _>>()?;
    println!("| robot | loop | method | ended | iterations | error % | last change, sd | physical | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut notes = String::new();
    for (robot, file) in EXPERIMENTS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments").join(file);
        let experiment = Experiment::read(&path, Path::new(data))?;
        for bandwidth_hz in [None].into_iter().chain(BANDWIDTHS_HZ.map(Some)) {
            let name = bandwidth_hz.map_or_else(|| "no key".to_owned(), |hz| format!("{hz} Hz"));
            for run in run(&experiment, bandwidth_hz, &methods, Path::new(data))? {
                println!("| {robot} | {name} | {}", row(&run));
                let reason = run.reason.iter().filter(|_| run.status != Status::Converged);
                for text in run.notes.iter().chain(reason) {
                    notes += &format!("- {robot}, {name}, {}: {text}\n", run.method);
                }
            }
        }
    }
    println!("\n{notes}");
    Ok(())
}

/// The runs of an experiment with a PD loop. Without one, methods that fit the simulated loop are left out; with one, those
/// that simulate nothing.
fn run(
    experiment: &Experiment,
    bandwidth_hz: Option<f64>,
    methods: &[Method],
    data: &Path,
) -> Result<Vec<RunResult>, Box<dyn Error>> {
    let mut experiment = experiment.clone();
    let has_place = |m: &&Method| match (bandwidth_hz, m.needs()) {
        (None, _) => **m == Method::IDIM_LS || **m == Method::IDIM_IV,
        (Some(_), needs) => needs != Needs::Measurement,
    };
    experiment.settings.estimation.methods = methods.iter().filter(has_place).copied().collect();
    experiment.settings.controller = bandwidth_hz.map(ControllerDescription::pd);
    if experiment.settings.estimation.methods.is_empty() {
        return Ok(Vec::new());
    }
    Ok(experiment.run(data, &mut |_| {})?.runs)
}

fn row(run: &RunResult) -> String {
    let or_dash = |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
    let change = run.convergence.last().and_then(|i| i.parameter_change);
    let physical = run.physical.as_ref().map_or("-", |p| if p.consistent { "yes" } else { "no" });
    format!(
        "{} | {} | {} | {} | {} | {physical} | {:.1} |",
        run.method,
        format!("{:?}", run.status).to_lowercase(),
        run.iterations,
        or_dash(run.relative_error_percent, 3),
        or_dash(change, 3),
        run.seconds
    )
}
