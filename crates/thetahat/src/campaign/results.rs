use super::{
    description::{Campaign, Claim},
    row::Row,
    run::CampaignRuns,
    summary::summarise,
};
use thetahat_report::results::{CampaignResults, Extent, PublishedStatement};

impl Campaign {
    /// What the report shows of the runs of this campaign.
    #[must_use]
    pub fn results(&self, runs: &CampaignRuns) -> CampaignResults {
        let largest = |number: fn(&Row) -> u32| runs.rows.iter().map(number).max().unwrap_or_default();
        let (file, experiment) = (&self.file, &self.experiment);
        let statement = |c: &Claim| PublishedStatement { source: c.source.clone(), says: c.says.clone() };
        CampaignResults {
            title: file.title.clone(),
            robot: experiment.robot.name.clone(),
            experiment_title: experiment.file.title.clone(),
            parameters: runs.facts.parameters.len(),
            starts: Extent { run: largest(|r| r.start), described: file.starts.count },
            start_deviation: file.starts.relative_deviation,
            seeds: Extent { run: largest(|r| r.seed), described: file.seeds },
            runs: runs.rows.len(),
            summaries: summarise(runs),
            statements: file.claim.iter().map(statement).collect(),
            campaign_description: self.text.clone(),
            experiment_description: experiment.text.clone(),
            robot_description: experiment.robot_text.clone(),
        }
    }
}
