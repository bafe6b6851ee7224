//! How close the filter that is chosen from a recording comes to the best of a grid: the table of `docs/theory/filter_choice.md`.
//!
//! Twins of several robots move, are sampled at 30 Hz to 5 kHz, and are recorded with noise of random size: cases 1 to 100 periodically,
//! those above from rest to rest, one joint after the other, slowly or periodically, some with the steps of encoders. The
//! rms error of the estimates against the truth is compared with that of every filter of a wide grid, over recordings with other
//! noise of the same kind. Each parameter's error counts in units of the least rms error that any filter gives it.
//!
//! `cargo run --release -p thetahat --example studies -- filter_study [--data DIR] [--cases 100] [--first 1] [--robot NAME]`

mod case;
use std::{error::Error, path::PathBuf};

use self::case::{Case, Outcome};
use super::twins;
use super::twins::robots::robots;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (mut data, mut cases, mut first, mut robot, mut verbose) =
        (None::<PathBuf>, 100_u64, 1_u64, String::new(), false);
    let mut arguments = super::arguments();
    while let Some(name) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
        match name.as_str() {
            "--data" => data = Some(value()?.into()),
            "--cases" => cases = value()?.parse()?,
            "--first" => first = value()?.parse()?,
            "--robot" => robot = value()?,
            "--verbose" => verbose = true,
            other => return Err(format!("unknown argument {other}").into()),
        }
    }
    println!(
        "| case | robot | motion | rate Hz | length s | position noise | torque noise % | low-passed Hz | late samples | chosen | best | \
         error over the best's | s |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    let mut ratios = Vec::new();
    for number in first..first + cases {
        let mut subjects = robots(&robot, data.as_deref())?;
        let subject = subjects.swap_remove(number as usize % subjects.len());
        let case = Case::draw(number);
        let Outcome { row, ratio } = case.run(subject, verbose)?;
        println!("{row}");
        ratios.push(ratio);
    }
    ratios.sort_by(f64::total_cmp);
    let within = |limit: f64| ratios.iter().filter(|r| **r <= limit).count();
    println!(
        "\nwithin 25 %: {} of {}; within 100 %: {}; median {:.3}, largest {:.3}",
        within(1.25),
        ratios.len(),
        within(2.0),
        ratios[ratios.len() / 2],
        ratios[ratios.len() - 1]
    );
    Ok(())
}
