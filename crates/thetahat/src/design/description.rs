use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::{criterion::CriterionName, error::DesignError};
use crate::{
    control::ControllerDescription,
    files,
    one_or_each::OneOrEach,
    preparation::{EstimationOptions, ParameterSelection, Settings, SignalOptions, SimulationOptions},
    robot::{Locks, Robot, RobotSource},
};

/// What a design file says. Angles are in degrees, lengths in mm.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignFile {
    /// A line that says what it is.
    pub title: String,
    /// The robot description, relative to the design file.
    pub robot: PathBuf,
    /// Joints that do not move, in rad or m.
    #[serde(default)]
    pub locked: BTreeMap<String, f64>,
    /// Duration of the motion, s: it starts and ends at rest in the same posture.
    pub duration_s: f64,
    /// Samples per second of the trajectory and of the record.
    #[serde(default = "default_rate")]
    pub sample_rate_hz: f64,
    /// What is wanted.
    #[serde(default)]
    pub wanted: Wanted,
    /// The kind of motion.
    #[serde(default)]
    pub motion: MotionOptions,
    /// What the joints may do, where the robot's description does not say it or says more.
    #[serde(default)]
    pub limits: LimitOptions,
    /// The noise of the record.
    pub noise: NoiseOptions,
    /// How the record will be filtered.
    pub signal: SignalOptions,
    /// Which parameters will be estimated.
    #[serde(default)]
    pub parameters: ParameterSelection,
    /// How they will be estimated.
    #[serde(default)]
    pub estimation: Option<EstimationOptions>,
    /// The robot's controller: with it the loop is simulated, and tracking errors are in what is promised.
    pub controller: Option<ControllerDescription>,
    /// The simulator's options.
    #[serde(default)]
    pub simulation: SimulationOptions,
    /// Reductions of recordings at hand: what they tell need not be told again.
    #[serde(default)]
    pub prior: Vec<PathBuf>,
}

fn default_rate() -> f64 {
    1000.0
}

/// What a design is to make small.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Wanted {
    /// The criterion.
    pub criterion: CriterionName,
    /// The base parameters of the criterion `chosen`.
    pub parameters: Vec<String>,
    /// Half of an interval that is wanted, percent of the parameter: the table says how long to record for it.
    pub half_width_percent: f64,
}

impl Default for Wanted {
    fn default() -> Self {
        Self { criterion: CriterionName::default(), parameters: Vec::new(), half_width_percent: 10.0 }
    }
}

/// The motions among which one is chosen, and the search.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MotionOptions {
    /// Harmonics of the Fourier series.
    pub harmonics: usize,
    /// Posture in which the motion starts and ends; none leaves it to the design.
    pub start: Option<Vec<f64>>,
    /// Searches from random motions.
    pub starts: usize,
    /// Seed of the random motions.
    pub seed: u64,
}

impl Default for MotionOptions {
    fn default() -> Self {
        Self { harmonics: 5, start: None, starts: 6, seed: 1 }
    }
}

/// Limits of the joints, one for all or one for each: degrees or mm, N m or N, W.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitOptions {
    /// Smallest and largest position of each joint.
    pub position: Option<Vec<[f64; 2]>>,
    /// Largest velocity.
    pub velocity: Option<OneOrEach<f64>>,
    /// Largest acceleration.
    pub acceleration: Option<OneOrEach<f64>>,
    /// Largest jerk.
    pub jerk: Option<OneOrEach<f64>>,
    /// Largest torque, friction included.
    pub torque: Option<OneOrEach<f64>>,
    /// Largest power.
    pub power: Option<OneOrEach<f64>>,
    /// Part of every range that the motion leaves unused.
    pub margin: f64,
}

impl Default for LimitOptions {
    fn default() -> Self {
        Self { position: None, velocity: None, acceleration: None, jerk: None, torque: None, power: None, margin: 0.02 }
    }
}

/// The noise of a record, per sample.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseOptions {
    /// Standard deviation of the white noise on each joint's torque, N m or N.
    pub torque: OneOrEach<f64>,
    /// Standard deviation of the white noise on each joint's position, degrees or mm.
    #[serde(default = "no_noise")]
    pub position: OneOrEach<f64>,
}

fn no_noise() -> OneOrEach<f64> {
    OneOrEach::One(0.0)
}

/// A design file with its robot.
#[derive(Debug, Clone)]
pub struct Design {
    /// Where the file is.
    pub path: PathBuf,
    /// What it says.
    pub file: DesignFile,
    /// Its tables, for the experiment that follows.
    pub(super) tables: toml::Table,
    /// The robot.
    pub robot: Robot,
    /// Where its description is.
    pub robot_path: PathBuf,
    /// How the record will be identified.
    pub settings: Settings,
}

impl Design {
    /// Reads a design and its robot.
    ///
    /// # Errors
    /// [`DesignError`], with the file and the line or key.
    pub fn read(path: &Path) -> Result<Self, DesignError> {
        let text = files::read_to_string(path)
            .map_err(|e| DesignError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
        Self::parse(&text, path)
    }

    /// The same from its text.
    ///
    /// # Errors
    /// As [`Design::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, DesignError> {
        let refuse = |e: toml::de::Error| DesignError::Syntax {
            path: path.to_owned(),
            message: e.to_string().trim_end().to_owned(),
        };
        let file: DesignFile = toml::from_str(text).map_err(refuse)?;
        let tables: toml::Table = toml::from_str(text).map_err(refuse)?;
        let robot_path = path.parent().unwrap_or(Path::new("")).join(&file.robot);
        let locks = Locks { locked: file.locked.clone(), until: Vec::new() };
        let robot = RobotSource::read(&robot_path)?.robot_with_locks(&locks, path)?;
        let settings = settings(&file);
        let design = Self { path: path.to_owned(), tables, robot, robot_path, settings, file };
        design.validate()?;
        Ok(design)
    }

    /// Every file that the design reads.
    #[must_use]
    pub fn input_files(&self) -> Vec<PathBuf> {
        [self.path.clone(), self.robot_path.clone()].into_iter().chain(self.prior_files()).collect()
    }

    pub(super) fn prior_files(&self) -> Vec<PathBuf> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        self.file.prior.iter().map(|prior| folder.join(prior)).collect()
    }

    pub(super) fn value(&self, key: &str, expected: &str, found: impl std::fmt::Display) -> DesignError {
        let (expected, found) = (expected.to_owned(), found.to_string());
        DesignError::Value { path: self.path.clone(), key: key.to_owned(), expected, found }
    }

    pub(super) fn require(
        &self,
        holds: bool,
        key: &str,
        expected: &str,
        found: impl std::fmt::Display,
    ) -> Result<(), DesignError> {
        if holds { Ok(()) } else { Err(self.value(key, expected, found)) }
    }
}

/// How the record will be identified: by least squares weighted by the noise of each joint where nothing else is asked for.
fn settings(file: &DesignFile) -> Settings {
    let default =
        || EstimationOptions { methods: vec![crate::identification::Method::IDIM_WLS], ..EstimationOptions::default() };
    Settings {
        signal: file.signal,
        parameters: file.parameters.clone(),
        estimation: file.estimation.clone().unwrap_or_else(default),
        controller: file.controller.clone(),
        simulation: file.simulation,
        cases: Vec::new(),
        payloads: Vec::new(),
    }
}
