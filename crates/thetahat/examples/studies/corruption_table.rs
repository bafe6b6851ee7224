//! Prints the tables of `docs/evidence/checks.md`: what the checks find in corrupted recordings, how far the clean recordings are from
//! the limits, and the smallest corruptions that are found. DATA is the folder of the recordings.
//!
//! ```sh
//! cargo run --release -p thetahat --example studies -- corruption_table DATA
//! ```

use std::path::{Path, PathBuf};

use super::corruption_suite::{
    corruptions::{Beside, all, of_controllers, unseen},
    power::powers,
    record::{Record, Which, from_experiment, other_twin, twin, tx40_with_reference},
    table::{Clean, markdown, row, short},
};
use thetahat::checks::Code;
use thetahat_estimation::checks::measure;

/// Runs the study.
pub fn main() {
    let data = PathBuf::from(super::arguments().next().unwrap_or_else(|| "../shared/datasets".to_owned()));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let emps = root.join("experiments/emps.toml");
    let (twin, tx40) = (twin(|_| {}), tx40_with_reference(&root, &data));
    println!("## Limits and margins\n");
    let records = [
        ("twin", twin.with(Beside::Reference)),
        ("TX40", tx40.clone()),
        ("EMPS", from_experiment(&emps, &data, Which::Main(0))),
        ("EMPS, pulses", from_experiment(&emps, &data, Which::Validation(0))),
    ];
    margins(&records);
    println!("\n## The corruption suite\n");
    suite(&Clean::new(twin.clone()), &Clean::new(tx40.clone()), &Clean::new(records[2].1.clone()));
    println!("\n## What is not detected\n");
    let rows: Vec<Vec<String>> = unseen().iter().map(|u| vec![u.name.to_owned(), u.why.to_owned()]).collect();
    print!("{}", markdown(&["corruption", "why"], &rows));
    println!("\n## The smallest that is found\n");
    smallest(&twin, &tx40);
}

/// The largest evidence of each code and limit, record by record, and of twenty other twins.
fn margins(records: &[(&str, Record)]) {
    let others: Vec<Vec<_>> = (0..20).map(|n| other_twin(n).with_subject(measure)).collect();
    let measured: Vec<Vec<_>> = records.iter().map(|r| r.1.with_subject(measure)).collect();
    let mut rows = Vec::new();
    for code in Code::ALL {
        let mut limits: Vec<f64> =
            measured.iter().chain(&others).flatten().filter(|m| m.code == code).map(|m| m.limit).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        for limit in limits {
            let worst = |measures: &Vec<thetahat_estimation::checks::Measure>| {
                let own = measures.iter().filter(|m| m.code == code && m.limit == limit).map(|m| m.value);
                own.fold(f64::NEG_INFINITY, f64::max)
            };
            let cell = |value: f64| if value.is_finite() { short(value) } else { String::new() };
            let mut row = vec![format!("`{code}`"), format!("{limit}")];
            row.extend(measured.iter().map(|m| cell(worst(m))));
            row.push(cell(others.iter().map(worst).fold(f64::NEG_INFINITY, f64::max)));
            rows.push(row);
        }
    }
    let mut head = vec!["code", "limit"];
    head.extend(records.iter().map(|r| r.0));
    head.push("20 other twins");
    print!("{}", markdown(&head, &rows));
}

fn suite(twin: &Clean, tx40: &Clean, emps: &Clean) {
    let head = ["corruption", "finding", "twin", "recorded TX40", "also raised"];
    let rows: Vec<Vec<String>> = all().iter().map(|c| row(c, &[twin, tx40])).collect();
    print!("{}", markdown(&head, &rows));
    let head = ["corruption", "finding", "twin", "recorded EMPS", "also raised"];
    let rows: Vec<Vec<String>> = of_controllers().iter().map(|c| row(c, &[twin, emps])).collect();
    println!("\n{}", markdown(&head, &rows));
}

fn smallest(twin: &Record, tx40: &Record) {
    let rows: Vec<Vec<String>> = powers()
        .iter()
        .map(|p| {
            let cell = |record: &Record| {
                p.smallest(record)
                    .map_or_else(|| "none".to_owned(), |v| format!("{v} {}", p.unit).trim_end().to_owned())
            };
            vec![p.name.to_owned(), format!("`{}`", p.code), cell(twin), cell(tx40)]
        })
        .collect();
    print!("{}", markdown(&["corruption", "finding", "twin", "recorded TX40"], &rows));
}
