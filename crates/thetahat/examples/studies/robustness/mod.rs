//! Whether the methods that simulate the closed loop converge whatever the robot, the simulated controller, the start values
//! and the noise: the table of `docs/evidence/closed_loop.md`, with every failure and its reason.
//!
//! A twin of each robot follows a recorded reference under a PD loop of 10 Hz. The simulated loop has 0.25 to 4 times that
//! bandwidth; iterations start from CAD, from CAD with 30 % errors, and from motor inertias alone.
//!
//! `cargo run --release -p thetahat --example studies -- robustness [--data DIR] [--quick] [--methods idim-iv,didim] [--robot NAME] [--seed 1] [--factors 1]`
//!
//! Methods that fit the simulated loop take its gains as they are; to the others they are given by the bandwidth.
//!
//! DIR holds `kuka_lwr4/kuka_lwr4.urdf`; that robot is left out without it.

mod arguments;
mod cells;
mod table;
use std::{error::Error, time::Instant};

use self::arguments::{Arguments, FACTORS};
use self::cells::{Cell, run_cells};
use self::table::{failures, robot_row, totals};
use super::twins;
use super::twins::{
    reference::Kind,
    robots::robots,
    twin::{RATE_HZ, Sampling, Twin},
};
use thetahat::{Method, identification::Needs};

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments = read_arguments()?;
    let started = Instant::now();
    println!(
        "| robot | parameters | method | converged at {} | within 4 | largest error, median | iterations, mean | s, mean |",
        arguments.factors.iter().map(|f| format!("{f}")).collect::<Vec<_>>().join(", ")
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut all: Vec<Cell> = Vec::new();
    for robot in robots(&arguments.robot, arguments.data.as_deref())? {
        let twin = Twin::new(
            robot,
            Sampling { kind: Kind::Periodic, duration_s: arguments.duration_s(), rate_hz: RATE_HZ },
            arguments.seed,
        )?;
        let cells = run_cells(&twin, &arguments)?;
        for method in &arguments.methods {
            println!("{}", robot_row(&twin, *method, &cells, &arguments.factors));
        }
        eprintln!("{}: {:.0} s", twin.name, started.elapsed().as_secs_f64());
        all.extend(cells);
    }
    println!("\n{}", totals(&arguments.methods, &all));
    println!("{}", failures(&all));
    eprintln!("{:.0} s", started.elapsed().as_secs_f64());
    Ok(())
}

/// What the command line asks for; every method that iterates unless some are named.
fn read_arguments() -> Result<Arguments, Box<dyn Error>> {
    let iterates = |m: &Method| m.needs() != Needs::Measurement;
    let methods = Method::all().filter(iterates).collect();
    let mut found =
        Arguments { data: None, quick: false, methods, robot: String::new(), seed: 1, factors: FACTORS.to_vec() };
    let mut arguments = super::arguments();
    while let Some(name) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
        match name.as_str() {
            "--data" => found.data = Some(value()?.into()),
            "--quick" => (found.quick, found.factors) = (true, FACTORS[1..4].to_vec()),
            "--factors" => found.factors = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--methods" => found.methods = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--robot" => found.robot = value()?,
            "--seed" => found.seed = value()?.parse()?,
            other => return Err(format!("unknown argument {other}").into()),
        }
    }
    Ok(found)
}
