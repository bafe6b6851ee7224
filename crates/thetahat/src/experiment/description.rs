use std::{
    collections::BTreeMap,
    fmt,
    path::{Path, PathBuf},
};

use serde::{
    Deserialize, Deserializer,
    de::{
        MapAccess, SeqAccess, Visitor,
        value::{MapAccessDeserializer, SeqAccessDeserializer},
    },
};

use super::{ExperimentError, paths};
use crate::{
    control::ControllerDescription,
    identification::{Convergence, Divisor, EliminationRule, Method},
    recording::ChannelSource,
    robot::{Friction, Robot, RobotSource},
    simulation::{Sensors, SimulatorBias, Solver},
};

/// An experiment with its robot, ready to run.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Where the file is; its name in messages.
    pub path: PathBuf,
    /// What it says.
    pub file: ExperimentFile,
    /// Its text, kept for the results.
    pub text: String,
    /// The robot.
    pub robot: Robot,
    /// The text of the robot's description, that of a URDF below it included, kept for the results.
    pub robot_text: String,
}

/// An experiment file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentFile {
    /// A line that says what it is.
    pub title: String,
    /// The robot description, relative to the experiment file, or else to the folder of the data.
    pub robot: PathBuf,
    /// The recordings to identify from: one `[recording]` or several `[[recording]]`.
    #[serde(default, deserialize_with = "one_or_several")]
    pub recording: Vec<RecordingDescription>,
    /// Recordings held back to validate on: one `[validation]` or several `[[validation]]`.
    #[serde(default, deserialize_with = "one_or_several")]
    pub validation: Vec<RecordingDescription>,
    /// A simulated recording instead.
    pub twin: Option<TwinDescription>,
    /// Filters, decimation and window.
    pub signal: SignalDescription,
    /// Which parameters are estimated and shown.
    #[serde(default)]
    pub parameters: ParameterSelection,
    /// Methods and their options.
    #[serde(default)]
    pub estimation: EstimationDescription,
    /// The simulated controller.
    pub controller: Option<ControllerDescription>,
    /// The simulator's options.
    #[serde(default)]
    pub simulation: SimulationDescription,
    /// Cases beside the nominal one.
    #[serde(default)]
    pub case: Vec<Case>,
    /// A table of published figures to show beside ours, relative to the experiment file.
    pub published: Option<PathBuf>,
}

/// Files and channels of a recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingDescription {
    /// Its name in tables and messages; none takes its number.
    pub name: Option<String>,
    /// Weight of its rows beside those of other recordings.
    #[serde(default = "one")]
    pub weight: f64,
    /// Samples per second, where there is no time channel.
    pub sample_rate_hz: Option<f64>,
    /// The time channel.
    pub time: Option<ChannelSource>,
    /// Largest deviation of a time step from the mean one, in steps, up to which the record is resampled to equal steps.
    #[serde(default = "half")]
    pub largest_jitter: f64,
    /// Start of the window, s, where it is another one than the experiment's.
    pub window_start_s: Option<f64>,
    /// End of the window, s, likewise.
    pub window_end_s: Option<f64>,
    /// Positions.
    pub position: ChannelSource,
    /// Velocities, where they were recorded: the checks compare them with the positions; nothing else uses them.
    pub velocity: Option<ChannelSource>,
    /// Torques or drive signals.
    pub torque: ChannelSource,
    /// The reference of the positions, where it was recorded.
    pub reference: Option<ChannelSource>,
    /// A signal that was added to the drive signals behind the controller; the torque channel includes it.
    pub added_signal: Option<ChannelSource>,
}

fn one() -> f64 {
    1.0
}

fn half() -> f64 {
    0.5
}

/// A table, or an array of tables; an untagged enum would lose the parser's message on what is wrong inside.
fn one_or_several<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<RecordingDescription>, D::Error> {
    struct OneOrSeveral;
    impl<'de> Visitor<'de> for OneOrSeveral {
        type Value = Vec<RecordingDescription>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table, or an array of tables")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            RecordingDescription::deserialize(MapAccessDeserializer::new(map)).map(|one| vec![one])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Self::Value, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(sequence))
        }
    }
    deserializer.deserialize_any(OneOrSeveral)
}

/// A simulated robot with known parameters that is recorded and then identified.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TwinDescription {
    /// Samples per second of the record.
    pub sample_rate_hz: f64,
    /// The true base parameters by name.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// The true values of those that are not listed.
    #[serde(default)]
    pub unlisted: Unlisted,
    /// End points of the moves in degrees (or mm for prismatic joints), the first where the robot starts.
    pub points: Vec<Vec<f64>>,
    /// Largest velocity of each joint, degrees/s or mm/s.
    pub max_velocity: Vec<f64>,
    /// Time in which the velocity rises, s.
    pub acceleration_time_s: f64,
    /// Time over which the acceleration is smoothed, s.
    pub smoothing_time_s: f64,
    /// Rest before the first and behind the last move, s.
    pub rest_s: f64,
    /// From the motion to its record.
    pub sensors: Sensors,
}

/// True values of base parameters that a twin does not list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unlisted {
    /// Zero.
    #[default]
    Zero,
    /// Those of the robot's a-priori parameters.
    APriori,
}

/// Filters, decimation and window.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalDescription {
    /// Order of the Butterworth filter of the positions, which runs forward and backward.
    #[serde(default = "fourth_order")]
    pub filter_order: usize,
    /// Its cut-off.
    pub cutoff_hz: f64,
    /// Every how many samples one is kept, behind the parallel filter.
    pub decimation: usize,
    /// Start of the window, s. Without start and end, the window is the moving part less the edges of the filter.
    pub window_start_s: Option<f64>,
    /// End of the window, s; with a start alone, the end of the record.
    pub window_end_s: Option<f64>,
}

fn fourth_order() -> usize {
    4
}

/// Which parameters are estimated and shown.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParameterSelection {
    /// `"base"`, `"essential"`, or a list of base parameters.
    pub estimate: ParameterChoice,
    /// Standard parameters taken as zero.
    pub exclude: Vec<String>,
    /// Parameters that the tables show; none means all.
    pub show: Vec<String>,
    /// The rule of the elimination, for `"essential"`.
    pub elimination: EliminationRule,
}

/// The parameters of a run.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(untagged, expecting = "expected \"base\", \"essential\" or a list of base parameters")]
pub enum ParameterChoice {
    /// All base parameters.
    #[default]
    #[serde(skip)]
    Base,
    /// `"base"` or `"essential"`.
    Named(NamedChoice),
    /// Base parameters by name.
    List(Vec<String>),
}

/// A choice by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamedChoice {
    /// All base parameters.
    Base,
    /// Those that an elimination leaves.
    Essential,
}

/// Methods and their options.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EstimationDescription {
    /// The methods, in the order of the tables.
    pub methods: Vec<Method>,
    /// Weighting by method; none where a method is not listed.
    pub weighting: BTreeMap<Method, Weighting>,
    /// Start values of the iterations.
    pub start: Start,
    /// Gains of a controller that is given by its bandwidth.
    pub gains: Gains,
    /// When the iterations stop.
    pub convergence: Convergence,
    /// What the squared residual is divided by.
    pub variance: Divisor,
}

impl Default for EstimationDescription {
    fn default() -> Self {
        Self {
            methods: vec![Method::IdimLs, Method::IdimIv, Method::Didim],
            weighting: BTreeMap::new(),
            start: Start::default(),
            gains: Gains::default(),
            convergence: Convergence::default(),
            variance: Divisor::default(),
        }
    }
}

/// Weighting of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// Equal weights.
    #[default]
    None,
    /// One over the standard deviation of each joint's residual of LS.
    PerJoint,
}

/// Start values of the iterations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// The robot's a-priori parameters.
    #[default]
    Cad,
    /// The a-priori motor inertias and nothing else.
    MotorInertias,
}

/// Gains of a controller that is given by its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gains {
    /// Follow the estimated inertia, so that the bandwidth stays.
    #[default]
    Updated,
    /// Stay those of the start values.
    Kept,
}

/// The simulator's options.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationDescription {
    /// How to integrate.
    pub solver: Solver,
    /// Velocity scale of the regularised sign of Coulomb friction, rad/s or m/s.
    pub sign_velocity_scale: f64,
    /// Whether simulated positions are filtered and differentiated as the measured ones are.
    pub band_pass: bool,
}

impl Default for SimulationDescription {
    fn default() -> Self {
        Self { solver: Solver::default(), sign_velocity_scale: 0.01, band_pass: false }
    }
}

/// A case beside the nominal one.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Its name, such as `gear_ratio_0.9`.
    pub name: String,
    /// How the simulator differs from the true loop.
    #[serde(default)]
    pub simulator: SimulatorBias,
    /// Another friction model than the robot's.
    pub friction: Option<Friction>,
    /// Other methods than the experiment's.
    pub methods: Option<Vec<Method>>,
}

/// Name of the case without any difference.
pub(crate) const NOMINAL: &str = "nominal";

const DEMO: &str = include_str!("../../../../experiments/demo.toml");
const DEMO_ROBOT: &str = include_str!("../../../../robots/tx40.toml");

impl Experiment {
    /// Reads an experiment and its robot, which is looked for beside the experiment and then in the folder `data`.
    ///
    /// # Errors
    /// [`ExperimentError`], with the file and the line or key.
    pub fn read(path: &Path, data: &Path) -> Result<Self, ExperimentError> {
        let text = read_text(path)?;
        let file: ExperimentFile = parse(&text, path)?;
        let robot = RobotSource::read(&paths::robot(path, &file.robot, data)?)?;
        if let Some(published) = &file.published {
            paths::beside(path, "published", published)?;
        }
        Self::assemble(path, file, text, robot)
    }

    /// The same with another robot description than the one that the experiment names.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn read_with_robot(path: &Path, robot: &Path) -> Result<Self, ExperimentError> {
        let text = read_text(path)?;
        let file: ExperimentFile = parse(&text, path)?;
        Self::assemble(path, file, text, RobotSource::read(robot)?)
    }

    /// An experiment from the texts of its two files; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn from_texts(path: &Path, text: String, robot_text: String) -> Result<Self, ExperimentError> {
        let file: ExperimentFile = parse(&text, path)?;
        let source = RobotSource::from_text(robot_text, &file.robot)?;
        Self::assemble(path, file, text, source)
    }

    /// The built-in demonstration: a TX40 twin.
    ///
    /// # Errors
    /// None in a build that passes its tests.
    pub fn demo() -> Result<Self, ExperimentError> {
        Self::from_texts(Path::new("experiments/demo.toml"), DEMO.to_owned(), DEMO_ROBOT.to_owned())
    }

    /// Where the table of published figures is, if there is one.
    #[must_use]
    pub fn published_path(&self) -> Option<PathBuf> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        self.file.published.as_ref().map(|published| folder.join(published))
    }

    /// The nominal case and the others.
    #[must_use]
    pub fn cases(&self) -> Vec<Case> {
        let nominal = Case { name: NOMINAL.to_owned(), simulator: SimulatorBias::NONE, friction: None, methods: None };
        std::iter::once(nominal).chain(self.file.case.iter().cloned()).collect()
    }

    fn assemble(path: &Path, file: ExperimentFile, text: String, source: RobotSource) -> Result<Self, ExperimentError> {
        let (robot, robot_text) = (source.robot()?, source.to_text());
        let experiment = Self { path: path.to_owned(), file, text, robot, robot_text };
        experiment.validate()?;
        Ok(experiment)
    }

    pub(crate) fn require(
        &self,
        holds: bool,
        key: &str,
        expected: &str,
        found: impl std::fmt::Display,
    ) -> Result<(), ExperimentError> {
        if holds { Ok(()) } else { Err(self.value(key, expected, found)) }
    }

    pub(crate) fn value(&self, key: &str, expected: &str, found: impl std::fmt::Display) -> ExperimentError {
        ExperimentError::Value {
            path: self.path.clone(),
            key: key.to_owned(),
            expected: expected.to_owned(),
            found: found.to_string(),
        }
    }

    pub(crate) fn missing(&self, missing: &'static str, why: &'static str) -> ExperimentError {
        ExperimentError::Missing { path: self.path.clone(), missing, why }
    }
}

fn read_text(path: &Path) -> Result<String, ExperimentError> {
    std::fs::read_to_string(path)
        .map_err(|e| ExperimentError::Unreadable { path: path.to_owned(), reason: e.to_string() })
}

fn parse(text: &str, path: &Path) -> Result<ExperimentFile, ExperimentError> {
    toml::from_str(text)
        .map_err(|e| ExperimentError::Syntax { path: path.to_owned(), message: e.to_string().trim_end().to_owned() })
}
