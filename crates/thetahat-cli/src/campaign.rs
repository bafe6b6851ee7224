//! The command `campaign`.

use std::{
    error::Error,
    io::IsTerminal,
    num::NonZero,
    thread::available_parallelism,
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};
use thetahat::{
    campaign::{Campaign, CampaignRuns, Limits, Progress, Row, Store},
    report,
};

use crate::{
    arguments,
    commands::{Verdict, print},
};

/// How often a line is printed where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

pub fn run(request: &arguments::Campaign) -> Result<Verdict, Box<dyn Error>> {
    if let Some(directory) = &request.out {
        report::check_folder(directory)?;
    }
    let campaign = Campaign::read(&request.campaign)?;
    let store = request.out.as_ref().map(|directory| Store::open(directory, &campaign)).transpose()?;
    let limits = Limits { starts: request.starts, seeds: request.seeds };
    let threads = request.threads.or_else(|| available_parallelism().ok().map(NonZero::get)).unwrap_or(1);
    let mut bar = Bar::new();
    let runs = campaign.run(limits, threads, store.as_ref(), &mut |progress| bar.tell(progress))?;
    bar.finish();
    print(&report::campaign_text(&campaign, &runs))?;
    print(&files(request, &campaign, &runs)?)?;
    Ok(if runs.rows.iter().any(Row::has_converged) { Verdict::Good } else { Verdict::NotTrusted })
}

/// Writes the page, and says which files there are.
fn files(request: &arguments::Campaign, campaign: &Campaign, runs: &CampaignRuns) -> Result<String, Box<dyn Error>> {
    let Some(directory) = &request.out else {
        return Ok("\nno files written; with --out DIR: runs.parquet, timing.parquet, campaign.html\n".to_owned());
    };
    let page = report::write_campaign(campaign, runs, directory)?;
    let names: String = runs.files.iter().chain([&page]).map(|f| format!("  {}\n", f.display())).collect();
    Ok(format!("\nwritten:\n{names}"))
}

/// Records done, and the time left: a bar on a terminal, lines elsewhere.
struct Bar {
    started: Instant,
    told: Instant,
    bar: Option<ProgressBar>,
}

impl Bar {
    fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| ProgressBar::new(0));
        if let Some((bar, style)) = bar.as_ref().zip(ProgressStyle::with_template(TEMPLATE).ok()) {
            bar.set_style(style);
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self { started: Instant::now(), told: Instant::now(), bar }
    }

    fn tell(&mut self, progress: Progress) {
        let Progress { before, done, to_do } = progress;
        if let Some(bar) = &self.bar {
            bar.set_length(to_do as u64);
            bar.set_position(done as u64);
            bar.set_message(if before > 0 { format!(", {before} there before") } else { String::new() });
        } else if self.told.elapsed() >= LINE_EVERY || (done == 0 && before > 0) {
            self.told = Instant::now();
            let elapsed = self.started.elapsed().as_secs_f64();
            let left = elapsed / done.max(1) as f64 * (to_do - done) as f64;
            let left = if done > 0 { format!(", {left:.0} s left") } else { String::new() };
            eprintln!("{elapsed:5.0} s  {done} of {to_do} records, {before} there before{left}");
        }
    }

    fn finish(self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

const TEMPLATE: &str = "{wide_bar} {pos} of {len} records{msg}, {elapsed} gone, {eta} left";
