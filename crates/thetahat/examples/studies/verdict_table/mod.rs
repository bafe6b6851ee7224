//! Tries to mislead the verdict, and prints the table of `docs/reference/verdict.md`: right, undecided, too strict or misled, with the
//! verdict, the largest error of the numbers that are taken in deviations, and the first reasons. With the folder of the
//! recordings, those of others come first as they are.
//!
//! ```sh
//! cargo run --release -p thetahat --example studies -- verdict_table DATA [WORDS]
//! ```
//!
//! With words, only the trials whose names contain them.

mod outcome;
mod specimen;
mod trial;

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use self::outcome::{Outcome, largest_error};
use self::specimen::Specimen;
use self::trial::Trial;
use thetahat::{Experiment, Identification, Results};

/// Experiments on recordings of others.
const RECORDED: [&str; 4] = ["tx40_paper", "emps", "kuka_lwr4", "ur10"];
/// Reasons that the table names.
const NAMED: usize = 3;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    if let Some(data) = super::arguments().next().map(PathBuf::from) {
        recorded(&data)?;
    }
    let specimens = Specimen::all()?;
    println!("| what is wrong | twin | outcome | verdict | largest error, sd | reasons |");
    println!("| --- | --- | --- | --- | --- | --- |");
    let words = super::arguments().nth(1).unwrap_or_default();
    for trial in Trial::ALL.into_iter().filter(|t| t.name().contains(&words)) {
        for specimen in &specimens {
            if let Some(row) = row(trial, specimen)? {
                println!("{row}");
            }
        }
    }
    Ok(())
}

/// The verdicts on recordings of others.
fn recorded(data: &Path) -> Result<(), Box<dyn Error>> {
    println!("| experiment | verdict | reasons |\n| --- | --- | --- |");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments");
    for name in RECORDED {
        let results = Experiment::read(&folder.join(format!("{name}.toml")), data)?.run(data, &mut |_| {})?;
        println!("| {name} | {} | {} |", verdict(&results), reasons(&results));
    }
    println!();
    Ok(())
}

/// The row of a trial: of its worst outcome if there are several seeds; `None` if the twin has no such trial.
fn row(trial: Trial, specimen: &Specimen) -> Result<Option<String>, Box<dyn Error>> {
    let mut all: Vec<(Outcome, Results)> = Vec::new();
    for seed in 0..trial.seeds() {
        let Some((robot, recording)) = trial.make(specimen, seed)? else { return Ok(None) };
        let results = Identification::new(&robot, vec![recording], specimen.experiment.settings.clone())?.run()?;
        all.push((Outcome::of(trial, &results), results));
    }
    let count = |outcome: Outcome| all.iter().filter(|(o, _)| *o == outcome).count();
    let counted = Outcome::ALL.into_iter().filter(|o| count(*o) > 0).map(|o| match all.len() {
        1 => o.name().to_owned(),
        n => format!("{} {} of {n}", o.name(), count(o)),
    });
    let counted: Vec<String> = counted.collect();
    let place = |outcome: Outcome| Outcome::ALL.iter().position(|o| *o == outcome);
    let worst = all.iter().max_by_key(|(o, _)| place(*o));
    Ok(worst.map(|(_, results)| {
        let error = largest_error(results);
        let error = if error.is_finite() { format!("{error:.1}") } else { "-".to_owned() };
        format!(
            "| {} | {} | {} | {} | {error} | {} |",
            trial.name(),
            specimen.name,
            counted.join(", "),
            verdict(results),
            reasons(results)
        )
    }))
}

fn verdict(results: &Results) -> &'static str {
    results.verdict.map_or("none", |v| v.name())
}

fn reasons(results: &Results) -> String {
    let words = results.verdict_reasons.iter().take(NAMED).map(|r| {
        let finding = r.subject.finding.map(|code| code.name()).filter(|name| *name != r.code.name());
        let finding = finding.map(|name| format!(" ({name})")).unwrap_or_default();
        format!("`{}`{finding}", r.code)
    });
    words.collect::<Vec<_>>().join(", ")
}
