/// The results of a campaign, as `campaign.html` shows them.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignResults {
    /// Title of the campaign.
    pub title: String,
    /// Name of the robot.
    pub robot: String,
    /// Title of the experiment whose motion is simulated repeatedly.
    pub experiment_title: String,
    /// Number of parameters of all cases.
    pub parameters: usize,
    /// Starts of the iterations.
    pub starts: Extent,
    /// Relative standard deviation of the starts from the a-priori parameters.
    pub start_deviation: f64,
    /// Seeds of the noise.
    pub seeds: Extent,
    /// Number of runs.
    pub runs: usize,
    /// One summary for each case, noise level and method.
    pub summaries: Vec<MethodSummary>,
    /// Statements of publications to compare the figures with.
    pub statements: Vec<PublishedStatement>,
    /// The text of the campaign file.
    pub campaign_description: String,
    /// The text of the experiment file.
    pub experiment_description: String,
    /// The text of the robot description.
    pub robot_description: String,
}

/// How much of a campaign was run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Number that was run.
    pub run: u32,
    /// Number in the description.
    pub described: u32,
}

/// A statement of a publication.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublishedStatement {
    /// The publication.
    pub source: String,
    /// The statement.
    pub says: String,
}

/// The runs of one case, noise level and method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSummary {
    /// The case.
    pub case: String,
    /// The noise level.
    pub noise: String,
    /// The method.
    pub method: String,
    /// Runs.
    pub runs: usize,
    /// Runs that converged: all numbers below are from these.
    pub converged: usize,
    /// Root mean square over the parameters of the mean error in mean classical standard deviations.
    pub bias: Option<f64>,
    /// Root mean square over the parameters of the ratio of the estimates' standard deviation to the mean classical one:
    /// one where the classical one is right.
    pub spread: Option<f64>,
    /// Share of the 95 % intervals that contain the true value, over all parameters, percent.
    pub coverage_percent: Option<f64>,
    /// The same for intervals of 1.96 classical standard deviations on both sides.
    pub classical_coverage_percent: Option<f64>,
    /// Mean of the iterations.
    pub iterations: Option<f64>,
    /// Mean of the simulations.
    pub simulations: Option<f64>,
    /// Mean of the time, s.
    pub seconds: Option<f64>,
    /// `100 |theta - theta_true| / |theta_true|`.
    pub distance_percent: Option<Quantiles>,
    /// Error of the simulated positions.
    pub position_error_percent: Option<Quantiles>,
    /// Error of the simulated torques.
    pub torque_error_percent: Option<Quantiles>,
    /// Every parameter that has a true value.
    pub parameters: Vec<ParameterSummary>,
    /// Reasons of failed runs, with their counts.
    pub failures: Vec<(String, usize)>,
}

/// One parameter in the runs of one case, noise level and method.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSummary {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its true value.
    pub truth: f64,
    /// Mean of the estimates.
    pub mean: f64,
    /// Standard deviation of the estimates.
    pub spread: Option<f64>,
    /// Mean of the classical standard deviations.
    pub deviation: f64,
    /// Share of the 95 % intervals that contain the true value, percent.
    pub coverage_percent: f64,
    /// The same for intervals of 1.96 classical standard deviations on both sides.
    pub classical_coverage_percent: f64,
    /// Share of the 95 % intervals that exclude zero, percent.
    pub power_percent: f64,
    /// Number of estimates.
    pub count: usize,
}

/// Five numbers of a distribution, by linear interpolation between the order statistics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantiles {
    /// The smallest.
    pub smallest: f64,
    /// The lower quartile.
    pub lower: f64,
    /// The median.
    pub median: f64,
    /// The upper quartile.
    pub upper: f64,
    /// The largest.
    pub largest: f64,
}
