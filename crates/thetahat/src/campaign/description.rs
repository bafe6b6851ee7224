use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::CampaignError;
use crate::experiment::Experiment;
use thetahat_estimation::identification::Method;
use thetahat_ground::{files, one_or_each::OneOrEach, syntax::in_plain_words};

/// A campaign with its experiment, ready to run.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// Where the file is; its name in messages.
    pub path: PathBuf,
    /// What it says.
    pub file: CampaignFile,
    /// Its text, which identifies a folder of results as this campaign's.
    pub text: String,
    /// The experiment whose twin is recorded; its robot has the a-priori values of the campaign.
    pub experiment: Experiment,
}

/// A campaign file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// A line that says what it is.
    pub title: String,
    /// The experiment file with the twin, relative to the campaign file.
    pub experiment: PathBuf,
    /// Recordings at each noise level and for each start, each with its own noise.
    pub seeds: u32,
    /// Seed of all random numbers.
    #[serde(default)]
    pub seed: u64,
    /// The methods.
    pub methods: Vec<Method>,
    /// Cases of the experiment by name; none means all.
    pub cases: Option<Vec<String>>,
    /// Noise levels.
    #[serde(default)]
    pub noise: Vec<NoiseLevel>,
    /// Start values of the iterations.
    #[serde(default)]
    pub starts: Starts,
    /// A-priori values that replace the values of the robot description.
    #[serde(default)]
    pub a_priori: BTreeMap<String, f64>,
    /// Published statements, listed next to the figures.
    #[serde(default)]
    pub claim: Vec<Claim>,
}

/// Standard deviations of the white noise on the measured joints.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseLevel {
    /// Its name in the rows.
    pub name: String,
    /// On the positions, degrees or mm: one for all joints, or one for each.
    pub position_noise: OneOrEach<f64>,
    /// On the torques, N m or N: one for all joints, or one for each.
    pub torque_noise: OneOrEach<f64>,
    /// Whether the twin's encoder and torque ripple act as well.
    #[serde(default)]
    pub sensors: bool,
}

/// Start values: the a-priori standard parameters, each multiplied by its own N(1, deviation^2), drawn again until the
/// whole set is physical. Without deviation, the a-priori values themselves.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Starts {
    /// Number of starts.
    pub count: u32,
    /// Standard deviation of the factors.
    pub relative_deviation: f64,
}

impl Default for Starts {
    fn default() -> Self {
        Self { count: 1, relative_deviation: 0.0 }
    }
}

/// A statement of a publication that the figures can be held against.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Who says so, and where.
    pub source: String,
    /// What they say.
    pub says: String,
}

/// How much of a campaign is run now. The runs are the same as in the whole campaign, and go into the same folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Subset {
    /// Only the first starts.
    pub starts: Option<u32>,
    /// Only the first seeds.
    pub seeds: Option<u32>,
}

impl Campaign {
    /// Every file that it was read from.
    #[must_use]
    pub fn input_files(&self) -> Vec<PathBuf> {
        [self.path.clone()].into_iter().chain(self.experiment.input_files(Path::new(""))).collect()
    }

    /// Reads a campaign with its experiment and robot.
    ///
    /// # Errors
    /// [`CampaignError`], with the file and the line or key.
    pub fn read(path: &Path) -> Result<Self, CampaignError> {
        let text = files::read_to_string(path)
            .map_err(|e| CampaignError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
        let file = Self::parse(path, &text)?;
        let experiment = crate::experiment::path_in_project(path, "experiment", &file.experiment)?;
        if !files::is_file(&experiment) {
            let expected = format!("the path of an experiment file, from {}", path.parent().unwrap_or(path).display());
            let found = format!("{:?}, which is no file", file.experiment.display().to_string());
            return Err(CampaignError::Value { path: path.to_owned(), key: "experiment".to_owned(), expected, found });
        }
        let data = experiment.parent().map_or_else(PathBuf::new, Path::to_owned);
        Self::assemble(path, text, file, Experiment::read(&experiment, &data)?)
    }

    /// A campaign from its text and an experiment; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Campaign::read`].
    pub fn from_text(path: &Path, text: String, experiment: Experiment) -> Result<Self, CampaignError> {
        let file = Self::parse(path, &text)?;
        Self::assemble(path, text, file, experiment)
    }

    fn parse(path: &Path, text: &str) -> Result<CampaignFile, CampaignError> {
        toml::from_str(text)
            .map_err(|e| CampaignError::Syntax { path: path.to_owned(), message: in_plain_words(&e.to_string()) })
    }

    fn assemble(
        path: &Path,
        text: String,
        file: CampaignFile,
        mut experiment: Experiment,
    ) -> Result<Self, CampaignError> {
        experiment.robot.a_priori.extend(file.a_priori.clone());
        let campaign = Self { path: path.to_owned(), file, text, experiment };
        campaign.validate()?;
        Ok(campaign)
    }
}
