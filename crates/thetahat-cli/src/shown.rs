//! Output of results: the screen and the files, and last the verdict card.

use std::{error::Error, path::Path};

use thetahat::{Results, report::Published, results::Verdict};
use thetahat_report::report;

use crate::{
    arguments::Output,
    terminal::{Ending, print, print_verdict, width},
};

/// What is shown with results.
#[derive(Default)]
pub struct Remark<'a> {
    /// A text below the tables.
    pub note: &'a str,
    /// The command that applies remedies, without their codes, where there is an experiment file.
    pub apply: Option<&'a str>,
}

/// Shows results as requested and writes their files.
pub fn show(
    results: &Results,
    published: Option<&Published>,
    output: &Output,
    remark: &Remark<'_>,
) -> Result<Ending, Box<dyn Error>> {
    let files = output.out.as_ref().map(|directory| report::write_all(results, published, directory)).transpose()?;
    if output.shown.json {
        print(&results.to_json()?)?;
        return Ok(Ending::of(results.verdict));
    }
    if !output.shown.quiet {
        print_verdict(results)?;
        print(&format!("\n{}{note}\n", tables(results, published, output.shown.full), note = remark.note))?;
        print(&written(files.as_deref(), results.verdict))?;
        print(&format!("{}\n", "-".repeat(width().columns())))?;
    }
    print(&report::card_text(results, width()))?;
    remark.apply.iter().try_for_each(|command| print(&report::remedies_text(results, command, width())))?;
    print_verdict(results)?;
    Ok(Ending::of(results.verdict))
}

fn tables(results: &Results, published: Option<&Published>, full: bool) -> String {
    if full { report::text::all(results, published, width()) } else { report::brief(results, width()) }
}

/// The files that were written.
fn written(files: Option<&[impl AsRef<Path>]>, verdict: Option<Verdict>) -> String {
    let Some(files) = files else {
        return "no files written (--out DIR writes them)\n".to_owned();
    };
    let names: String = files.iter().map(|f| format!("  {}\n", f.as_ref().display())).collect();
    let not = if verdict == Some(Verdict::DoNotUse) { ", with numbers that must not be used" } else { "" };
    format!("written{not}:\n{names}")
}
