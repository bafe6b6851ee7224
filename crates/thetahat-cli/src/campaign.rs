//! The command `campaign`.

use std::error::Error;

use thetahat::{
    campaign::{Campaign, CampaignRuns, Progress, Row, Store, Subset},
    results::CampaignResults,
};
use thetahat_ground::output::OutputGuard;
use thetahat_report::report;

use crate::{
    arguments,
    inputs::threads,
    progress::Counter,
    terminal::{Ending, print, width},
};

pub fn run(request: &arguments::Campaign) -> Result<Ending, Box<dyn Error>> {
    let campaign = Campaign::read(&request.campaign)?;
    if let Some(directory) = &request.out {
        let guard = OutputGuard::new(campaign.input_files(), request.force.force);
        guard.folder(directory, [report::CAMPAIGN_PAGE])?;
    }
    let store = request.out.as_ref().map(|directory| Store::open(directory, &campaign)).transpose()?;
    let limits = Subset { starts: request.starts, seeds: request.seeds };
    let mut counter = Counter::new("recordings");
    let mut report_progress = |Progress { before, done, to_do }| {
        counter.show(done, to_do, if before > 0 { format!("{before} already there, ") } else { String::new() });
    };
    let runs = campaign.run(limits, threads(request.threads), store.as_ref(), &mut report_progress)?;
    drop(counter);
    let results = campaign.results(&runs);
    print(&report::campaign_text(&results, width()))?;
    print(&files(request, &results, &runs)?)?;
    Ok(if runs.rows.iter().any(Row::has_converged) { Ending::Good } else { Ending::NotTrusted })
}

/// Writes the page, and lists the files.
fn files(
    request: &arguments::Campaign,
    results: &CampaignResults,
    runs: &CampaignRuns,
) -> Result<String, Box<dyn Error>> {
    let Some(directory) = &request.out else {
        return Ok("\nno files written; with --out DIR: runs.parquet, timing.parquet, campaign.html\n".to_owned());
    };
    let page = report::write_campaign(results, directory)?;
    let names: String = runs.files.iter().chain([&page]).map(|f| format!("  {}\n", f.display())).collect();
    Ok(format!("\nwritten:\n{names}"))
}
