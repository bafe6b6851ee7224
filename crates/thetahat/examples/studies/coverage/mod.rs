//! How often the intervals contain the true value: the coverage tables of `docs/evidence/coverage.md`.
//!
//! `cargo run --release -p thetahat --example studies -- coverage [--seeds 500] [--threads 2]`
//!
//! Two twins, two levels of noise, white and coloured. First the methods where their assumptions hold, then the same through
//! what the program does with a recording, step by step.

mod noise;
mod stage;
mod tally;
mod trial;
mod twin;

use std::{error::Error, time::Instant};

use self::noise::{Colour, Level, Noise};
use self::stage::Stage;
use self::tally::{INTERVAL, Tally, run_seeds};
use self::trial::{ASSUMED, DIDIM, Estimate, KINDS, Outcome, Scope, Trials, place};
use self::twin::Twin;
use thetahat::Method;

/// DIDIM is iterated over the simulator on one seed of so many: TX40, EMPS.
const SIMULATED_EVERY: [u64; 2] = [10, 1];

struct Condition<'a> {
    twin: &'a Twin,
    noise: Noise,
    outcomes: Vec<Outcome>,
    noise_free: [[Vec<f64>; 2]; 4],
    bound: Vec<f64>,
}

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (seeds, threads) = (option("--seeds")?.unwrap_or(500), option("--threads")?.unwrap_or(cores as u64));
    let twins = [Twin::tx40()?, Twin::emps()?];
    let mut conditions = Vec::new();
    for (twin, every) in twins.iter().zip(SIMULATED_EVERY) {
        for (level, colour) in Level::ALL.into_iter().flat_map(|l| Colour::ALL.map(|c| (l, c))) {
            let noise = Noise { level, colour };
            let scope = Scope { measured_every: 1, stages: &Stage::ALL, simulated_every: Some(every) };
            let trials = Trials::new(twin, noise, scope)?;
            let outcomes = run_seeds(&trials, seeds, threads as usize)?;
            let (noise_free, bound) = (trials.noise_free()?, trials.bound());
            conditions.push(Condition { twin, noise, outcomes, noise_free, bound });
            eprintln!("{} {} {}: {:.0} s", twin.name, level.name(), colour.name(), started.elapsed().as_secs_f64());
        }
    }
    println!("\n### Where the assumptions hold\n");
    heading();
    for condition in &conditions {
        (0..ASSUMED.len()).for_each(|m| condition.row(ASSUMED[m], |o| o.assumed[m].as_ref()));
    }
    println!("\n### Through the program's filters\n");
    heading();
    for condition in &conditions {
        condition.rows_of_chain();
    }
    conditions.iter().filter(|c| c.noise.colour == Colour::White).for_each(Condition::each_parameter);
    Ok(())
}

/// The number after a name on the command line.
fn option(name: &str) -> Result<Option<u64>, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let Some(place) = arguments.iter().position(|a| a == name) else { return Ok(None) };
    let text = arguments.get(place + 1).ok_or_else(|| format!("{name} needs a number"))?;
    Ok(Some(text.parse().map_err(|_| format!("{name}: not a number: {text}"))?))
}

fn percent(part: f64) -> String {
    format!("{:.1}", 100.0 * part)
}

fn heading() {
    let kinds = KINDS.join(" | ");
    println!("| twin | noise | method | seeds | {kinds} | one parameter | largest bias, sd | error over bound |");
    println!("| --- | --- | --- | --- |{} --- | --- | --- |", " --- |".repeat(KINDS.len()));
}

impl Condition<'_> {
    /// One line: how often the intervals of each kind contain the true values.
    fn row(&self, method: &str, of: impl Fn(&Outcome) -> Option<&Estimate>) {
        let Some(tally) = Tally::new(self.outcomes.iter().map(of)) else { return };
        let kinds: Vec<String> = (0..KINDS.len()).map(|kind| percent(tally.pooled(kind))).collect();
        let (least, most) = tally.extremes(INTERVAL);
        println!(
            "| {} | {}, {} | {method} | {} | {} ± {} | {} to {} | {:.2} | {:.2} |",
            self.twin.name,
            self.noise.level.name(),
            self.noise.colour.name(),
            tally.seeds(),
            kinds.join(" | "),
            percent(tally.pooled_error(INTERVAL)),
            percent(least),
            percent(most),
            tally.largest_bias(),
            tally.over_bound(&self.bound),
        );
    }

    fn rows_of_chain(&self) {
        for (method, name) in [(Method::IDIM_LS, "IDIM-LS"), (Method::IDIM_IV, "IDIM-IV")] {
            for stage in Stage::ALL {
                self.row(&format!("{name} {}", stage.name()), |o| o.chain[place(method, stage)].as_ref());
            }
        }
        self.row("DIDIM", |o| o.chain[DIDIM].as_ref());
    }

    /// Bias of each shown parameter at every stage, and its coverage after the last.
    fn each_parameter(&self) {
        let of = |place: usize| Tally::new(self.outcomes.iter().map(|o| o.chain[place].as_ref()));
        let methods = [Method::IDIM_LS, Method::IDIM_IV].map(|m| of(place(m, Stage::Derivative)));
        println!("\n### {}, {} {} noise\n", self.twin.name, self.noise.level.name(), self.noise.colour.name());
        println!(
            "| parameter | truth | LS: as recorded | + hold | + mask | + derivative | + noise | cover % | \
             IV: as recorded | + hold | + mask | + derivative | + noise | cover % |"
        );
        println!("| --- |{}", " --- |".repeat(13));
        for (i, p) in self.twin.base.parameters().iter().enumerate().filter(|(_, p)| self.twin.shown(&p.name)) {
            let of_method = |(m, tally): (usize, &Option<Tally<'_>>)| {
                let Some(tally) = tally else { return "-".to_owned() };
                let (bias, deviation) = tally.bias_and_deviation(i);
                let free =
                    self.noise_free.each_ref().map(|stage| format!("{:+.2}", stage[m][i] / deviation)).join(" | ");
                format!("{free} | {:+.2} | {}", bias / deviation, percent(tally.coverage(INTERVAL, i)))
            };
            let cells: Vec<String> = methods.iter().enumerate().map(of_method).collect();
            println!("| {} | {} | {} |", p.name, self.twin.theta[i], cells.join(" | "));
        }
    }
}
