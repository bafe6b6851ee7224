//! How often the intervals contain the true value: the coverage tables of `docs/statistics.md`.
//!
//! `cargo run --release -p thetahat --example coverage -- [--seeds 500] [--threads 2]`
//!
//! Two twins, two levels of noise, white and coloured. First the methods where their assumptions hold, then the same
//! through the program's filters.

mod noise;
mod tally;
mod trial;
mod twin;

use std::{error::Error, time::Instant};

use noise::{Colour, Level, Noise};
use tally::{INTERVAL, Tally, run_seeds};
use trial::{ASSUMED, CHAIN, Estimate, KINDS, Outcome, Scope, Trials};
use twin::Twin;

/// DIDIM is iterated over the simulator on one seed of so many: TX40, EMPS.
const SIMULATED_EVERY: [u64; 2] = [10, 1];

struct Condition<'a> {
    twin: &'a Twin,
    noise: Noise,
    outcomes: Vec<Outcome>,
    noise_free: [[Vec<f64>; 2]; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (seeds, threads) = (option("--seeds")?.unwrap_or(500), option("--threads")?.unwrap_or(cores as u64));
    let twins = [Twin::tx40()?, Twin::emps()?];
    let mut conditions = Vec::new();
    for (twin, every) in twins.iter().zip(SIMULATED_EVERY) {
        for (level, colour) in Level::ALL.into_iter().flat_map(|l| Colour::ALL.map(|c| (l, c))) {
            let noise = Noise { level, colour };
            let trials = Trials::new(twin, noise, Scope { measured_every: 1, simulated_every: Some(every) })?;
            let outcomes = run_seeds(&trials, seeds, threads as usize)?;
            conditions.push(Condition { twin, noise, outcomes, noise_free: trials.noise_free()? });
            eprintln!("{} {} {}: {:.0} s", twin.name, level.name(), colour.name(), started.elapsed().as_secs_f64());
        }
    }
    pooled("Where the assumptions hold", &conditions, &ASSUMED, |o| &o.0);
    pooled("Through the program's filters", &conditions, &CHAIN, |o| &o.1);
    conditions.iter().filter(|c| c.noise.colour == Colour::White).for_each(each_parameter);
    Ok(())
}

/// The number behind a name on the command line.
fn option(name: &str) -> Result<Option<u64>, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let Some(place) = arguments.iter().position(|a| a == name) else { return Ok(None) };
    let text = arguments.get(place + 1).ok_or_else(|| format!("{name} needs a number"))?;
    Ok(Some(text.parse().map_err(|_| format!("{name}: not a number: {text}"))?))
}

fn percent(part: f64) -> String {
    format!("{:.1}", 100.0 * part)
}

fn pooled(title: &str, conditions: &[Condition<'_>], methods: &[&str], of: fn(&Outcome) -> &[Option<Estimate>]) {
    println!("\n### {title}\n");
    println!("| twin | noise | method | seeds | {} | one parameter | largest bias, sd |", KINDS.join(" | "));
    println!("| --- | --- | --- | --- |{} --- | --- |", " --- |".repeat(KINDS.len()));
    for Condition { twin, noise, outcomes, .. } in conditions {
        for (m, method) in methods.iter().enumerate() {
            let Some(tally) = Tally::new(outcomes.iter().map(|o| of(o)[m].as_ref())) else { continue };
            let kinds: Vec<String> = (0..KINDS.len()).map(|kind| percent(tally.pooled(kind))).collect();
            let (least, most) = tally.extremes(INTERVAL);
            println!(
                "| {} | {}, {} | {method} | {} | {} ± {} | {} to {} | {:.2} |",
                twin.name,
                noise.level.name(),
                noise.colour.name(),
                tally.seeds(),
                kinds.join(" | "),
                percent(tally.pooled_error(INTERVAL)),
                percent(least),
                percent(most),
                tally.largest_bias(),
            );
        }
    }
}

/// Bias and coverage of each shown parameter through the filters.
fn each_parameter(condition: &Condition<'_>) {
    let Condition { twin, noise, outcomes, noise_free } = condition;
    let tallies = [0, 1, 2, 3].map(|m| Tally::new(outcomes.iter().map(|o| o.1[m].as_ref())));
    println!(
        "\n### {}, {} {} noise, through the program's filters\n",
        twin.name,
        noise.level.name(),
        noise.colour.name()
    );
    println!(
        "| parameter | truth | LS: filters | sign | cover % | noise | cover % | IV: filters | sign | noise | cover % | DIDIM: noise | cover % |"
    );
    println!("| --- |{}", " --- |".repeat(12));
    for (i, p) in twin.base.parameters().iter().enumerate().filter(|(_, p)| twin.shown(&p.name)) {
        let cover = |m: usize| tallies[m].as_ref().map_or("-".to_owned(), |t| percent(t.coverage(INTERVAL, i)));
        // Biases in standard deviations of the method's estimates.
        let deviation = |m: usize| tallies[m].as_ref().map_or(f64::NAN, |t| t.bias_and_deviation(i).1);
        let bias = |m: usize| tallies[m].as_ref().map_or(f64::NAN, |t| t.bias_and_deviation(i).0 / deviation(m));
        let free = |stage: usize, m: usize| noise_free[stage][m][i] / deviation(m);
        let ls = format!("{:+.2} | {:+.2} | {} | {:+.2} | {}", free(0, 0), free(1, 0), cover(3), bias(0), cover(0));
        let iv = format!("{:+.2} | {:+.2} | {:+.2} | {}", free(0, 1), free(1, 1), bias(1), cover(1));
        println!("| {} | {} | {ls} | {iv} | {:+.2} | {} |", p.name, twin.theta[i], bias(2), cover(2));
    }
}
