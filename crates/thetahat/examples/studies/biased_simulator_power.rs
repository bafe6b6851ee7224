//! Size and power of the biased simulator test by Monte Carlo on the TX40 twin: the table of `docs/reference/verdict.md`.
//!
//! `cargo run --release -p thetahat --example studies -- biased_simulator_power [-- RECORDS [RECORDS_NOMINAL [THREADS]]]`

use std::error::Error;

use thetahat::{Experiment, experiment::PowerPoint, simulation::BiasKind};

/// Records for each error, and for none.
const RECORDS: usize = 50;
const NOMINAL_RECORDS: usize = 200;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<usize> = super::arguments().map(|a| a.parse()).collect::<Result<_, _>>()?;
    let argument = |k: usize, default: usize| arguments.get(k).copied().unwrap_or(default);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let (records, nominal, threads) = (argument(0, RECORDS), argument(1, NOMINAL_RECORDS), argument(2, cores));
    let experiment = Experiment::demo()?;
    println!(
        "| simulator's error | records | rejected % | DIDIM distrusted % | mean difference, sd |\n| --- | --- | --- | --- | --- |"
    );
    print(&experiment.biased_simulator_power(&[(BiasKind::GearRatio, 1.0)], nominal, threads)?);
    print(&experiment.biased_simulator_power(&errors(), records, threads)?);
    Ok(())
}

fn errors() -> Vec<(BiasKind, f64)> {
    let factors = |kind, values: &'static [f64]| values.iter().map(move |v| (kind, *v));
    factors(BiasKind::GearRatio, &[0.995, 0.99, 0.98, 0.95, 0.9])
        .chain(factors(BiasKind::DriveGain, &[0.9, 0.5, 0.25]))
        .chain(factors(BiasKind::ControllerGain, &[0.5, 0.25]))
        .chain(factors(BiasKind::Delay, &[0.5e-3, 1e-3, 2e-3, 5e-3]))
        .chain(factors(BiasKind::Friction, &[0.5]))
        .collect()
}

fn print(points: &[PowerPoint]) {
    for point in points {
        let judged = point.recordings - point.failures;
        let percent = |count: usize| 100.0 * count as f64 / judged.max(1) as f64;
        let failures =
            if point.failures > 0 { format!(", {} without estimate", point.failures) } else { String::new() };
        println!(
            "| {} | {judged}{failures} | {:.1} | {:.1} | {:.2} |",
            error(point),
            percent(point.rejections),
            percent(point.distrusted),
            point.average_difference
        );
    }
}

fn error(point: &PowerPoint) -> String {
    if point.kind == BiasKind::Delay {
        format!("delay {} ms", 1e3 * point.value)
    } else if point.kind == BiasKind::ReferenceOffset {
        format!("reference offset {} mrad", 1e3 * point.value)
    } else if point.value == 1.0 {
        "none".to_owned()
    } else {
        format!("{} at {} %", point.kind.name(), 100.0 * point.value)
    }
}
