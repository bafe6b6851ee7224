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

use super::{base::BaseDescription, error::ExperimentError, paths};
use crate::preparation::{
    Case, EstimationOptions, ModelOptions, ParameterSelection, Payload, PreparationError, ReferenceCorrection,
    Settings, Setup, SignalOptions, SimulationOptions,
};
use thetahat_data::recording::ChannelSource;
use thetahat_estimation::{control::ControllerDescription, simulation::Sensors};
use thetahat_ground::{files, one_or_each, syntax::in_plain_words};
use thetahat_model::robot::{Locks, Robot, RobotError, RobotFile, RobotSource, TermDescription};

/// An experiment with its robot, ready to run.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Where the file is; its name in messages.
    pub path: PathBuf,
    /// What it says of the recordings.
    pub file: ExperimentFile,
    /// How the robot is identified.
    pub settings: Settings,
    /// Its text, kept for the results.
    pub text: String,
    /// The robot.
    pub robot: Robot,
    /// The text of the robot's description, with the text of a URDF below it, kept for the results.
    pub robot_text: String,
    /// The files that the robot was read from.
    robot_files: Vec<PathBuf>,
    /// Their names and hashes, kept for the results.
    pub(crate) robot_hashes: Vec<RobotFile>,
}

/// The contents of an experiment file other than its [`Settings`].
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentFile {
    /// A line that says what it is.
    pub title: String,
    /// The robot description, relative to the experiment file, or else to the folder of the data.
    pub robot: PathBuf,
    /// The joints of the robot that do not move in the recordings, in addition to those that its description locks.
    pub locks: Locks,
    /// Acceleration of gravity in the base frame, m/s^2, in place of the description's.
    pub gravity: Option<[f64; 3]>,
    /// Torque terms in addition to those of the robot's description: `[[term]]`.
    pub terms: Vec<TermDescription>,
    /// The recordings to identify from: one `[recording]` or several `[[recording]]`.
    pub recording: Vec<RecordingDescription>,
    /// Recordings held back to validate on: one `[validation]` or several `[[validation]]`.
    pub validation: Vec<RecordingDescription>,
    /// A simulated recording instead.
    pub twin: Option<TwinDescription>,
    /// A table of published figures to compare with, relative to the experiment file.
    pub published: Option<PathBuf>,
}

/// The tables and keys of an experiment file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    title: String,
    robot: PathBuf,
    #[serde(default)]
    locked: BTreeMap<String, f64>,
    #[serde(default, deserialize_with = "one_or_each::list")]
    until: Vec<String>,
    gravity: Option<[f64; 3]>,
    #[serde(default)]
    term: Vec<TermDescription>,
    #[serde(default, deserialize_with = "one_or_several")]
    recording: Vec<RecordingDescription>,
    #[serde(default, deserialize_with = "one_or_several")]
    validation: Vec<RecordingDescription>,
    twin: Option<TwinDescription>,
    signal: SignalOptions,
    #[serde(default)]
    parameters: ParameterSelection,
    #[serde(default)]
    estimation: EstimationOptions,
    controller: Option<ControllerDescription>,
    #[serde(default)]
    simulation: SimulationOptions,
    #[serde(default)]
    model: ModelOptions,
    #[serde(default)]
    case: Vec<Case>,
    #[serde(default)]
    payload: Vec<Payload>,
    published: Option<PathBuf>,
}

impl Tables {
    fn split(self) -> (ExperimentFile, Settings) {
        let Self { title, robot, recording, validation, twin, signal, parameters, estimation, controller, .. } = self;
        let locks = Locks { locked: self.locked, until: self.until };
        let (gravity, terms, published) = (self.gravity, self.term, self.published);
        let file = ExperimentFile { title, robot, locks, gravity, terms, recording, validation, twin, published };
        let (simulation, model, cases, payloads) = (self.simulation, self.model, self.case, self.payload);
        (file, Settings { signal, parameters, estimation, controller, simulation, model, cases, payloads })
    }
}

/// Files and channels of a recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingDescription {
    /// Its name in tables and messages; none takes its number.
    pub name: Option<String>,
    /// Weight of its rows relative to those of other recordings.
    #[serde(default = "one")]
    pub weight: f64,
    /// Samples per second, where there is no time channel.
    pub sample_rate_hz: Option<f64>,
    /// The time channel.
    pub time: Option<ChannelSource>,
    /// Largest deviation of a time step from the usual one, in steps; a longer step is a gap.
    #[serde(default = "half")]
    pub largest_jitter: f64,
    /// Start of the window, s, where it is another one than the experiment's.
    pub window_start_s: Option<f64>,
    /// End of the window, s, likewise.
    pub window_end_s: Option<f64>,
    /// Intervals that are left out, s from the start of the recording: something else acted on the robot.
    #[serde(default)]
    pub left_out_s: Vec<[f64; 2]>,
    /// Positions.
    pub position: ChannelSource,
    /// Velocities, where they were recorded: the checks compare them with the positions; nothing else uses them.
    pub velocity: Option<ChannelSource>,
    /// Torques or drive signals; without them only `cloe` estimates, or the equations of a base that floats.
    pub torque: Option<ChannelSource>,
    /// The reference of the positions, where it was recorded.
    pub reference: Option<ChannelSource>,
    /// Corrects the reference, on the side of the joints, if it was recorded late, scaled or from another zero.
    pub reference_correction: Option<ReferenceCorrection>,
    /// The `[[payload]]` that the robot carries, by its name.
    pub payload: Option<String>,
    /// A signal that was added to the drive signals after the controller; the torque channel includes it.
    pub added_signal: Option<ChannelSource>,
    /// The pose of a base that floats, and what touches the robot.
    #[doc(hidden)]
    pub base: Option<BaseDescription>,
    /// Other channels by name, as the robot's torque terms take them, such as `temperature`: one column, or one for each
    /// coordinate.
    #[serde(default)]
    pub channels: BTreeMap<String, ChannelSource>,
}

impl RecordingDescription {
    /// The channels that it names.
    fn sources(&self) -> impl Iterator<Item = &ChannelSource> {
        let optional = [&self.time, &self.velocity, &self.torque, &self.reference, &self.added_signal];
        let of_base = self.base.iter().flat_map(BaseDescription::sources);
        let own = [&self.position].into_iter().chain(optional.into_iter().flatten());
        own.chain(self.channels.values()).chain(of_base)
    }
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
    /// Samples per second of the recording.
    pub sample_rate_hz: f64,
    /// The true base parameters by name.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// The true values of those that are not listed.
    #[serde(default)]
    pub unlisted: Unlisted,
    /// End points of the moves in degrees (or mm for prismatic joints); the robot starts at the first.
    #[serde(default)]
    pub points: Vec<Vec<f64>>,
    /// The motion that it follows instead of moves, at `sample_rate_hz`: a file in the folder of the experiment or the one above.
    pub reference: Option<ChannelSource>,
    /// Largest velocity of each joint, degrees/s or mm/s.
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub max_velocity: Vec<f64>,
    /// Time in which the velocity rises, s.
    #[serde(default)]
    pub acceleration_time_s: f64,
    /// Time over which the acceleration is smoothed, s.
    #[serde(default)]
    pub smoothing_time_s: f64,
    /// Rest before the first and after the last move, s.
    #[serde(default)]
    pub rest_s: f64,
    /// The sensors of the recording.
    pub sensors: Sensors,
}

impl TwinDescription {
    /// Lists of one value, which is for all joints, become lists with one for each.
    fn repeat_for(&mut self, joints: usize) {
        let Sensors { torque_noise, position_noise, torque_ripple, .. } = &mut self.sensors;
        for list in [&mut self.max_velocity, torque_noise, position_noise, torque_ripple] {
            if let [value] = list[..] {
                *list = vec![value; joints];
            }
        }
    }
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

/// Copies of `experiments/demo.toml` and `robots/tx40.toml`, which lie outside the package.
const DEMO: &str = include_str!("../../demo/demo.toml");
const DEMO_ROBOT: &str = include_str!("../../demo/tx40.toml");

impl Experiment {
    /// Reads an experiment and its robot, which is looked for in the folder of the experiment and then in the folder `data`.
    ///
    /// # Errors
    /// [`ExperimentError`], with the file and the line or key.
    pub fn read(path: &Path, data: &Path) -> Result<Self, ExperimentError> {
        let text = read_text(path)?;
        let (file, settings) = parse(&text, path)?;
        let robot = RobotSource::read(&paths::robot(path, &file.robot, data)?)?;
        if let Some(published) = &file.published {
            paths::path_in_project(path, "published", published)?;
        }
        Self::assemble(path, file, settings, text, robot)
    }

    /// The same with another robot description than the one that the experiment names.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn read_with_robot(path: &Path, robot: &Path) -> Result<Self, ExperimentError> {
        let text = read_text(path)?;
        let (file, settings) = parse(&text, path)?;
        Self::assemble(path, file, settings, text, RobotSource::read(robot)?)
    }

    /// An experiment from the texts of its two files; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn from_texts(path: &Path, text: String, robot_text: String) -> Result<Self, ExperimentError> {
        let (file, settings) = parse(&text, path)?;
        let source = RobotSource::from_text(robot_text, &file.robot)?;
        Self::assemble(path, file, settings, text, source)
    }

    /// The built-in demonstration: a TX40 twin.
    ///
    /// # Errors
    /// Infallible in practice: the files are part of the program and tested.
    pub fn demo() -> Result<Self, ExperimentError> {
        Self::from_texts(Path::new("experiments/demo.toml"), DEMO.to_owned(), DEMO_ROBOT.to_owned())
    }

    /// Where the table of published figures is, if there is one.
    #[must_use]
    pub fn published_path(&self) -> Option<PathBuf> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        self.file.published.as_ref().map(|published| folder.join(published))
    }

    /// Every file that a run with this folder of data reads.
    #[must_use]
    pub fn input_files(&self, data: &Path) -> Vec<PathBuf> {
        let recordings = self.file.recording.iter().chain(&self.file.validation);
        let channels = recordings.flat_map(RecordingDescription::sources).map(|source| source.path(data));
        let own = self.robot_files.iter().cloned().chain(self.published_path()).chain([self.path.clone()]);
        let followed = self.file.twin.iter().filter_map(|twin| twin.reference.as_ref());
        let own = own.chain(followed.map(|source| source.path(self.folder())));
        own.chain(channels).collect()
    }

    /// The folder of the experiment file.
    pub(super) fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    pub(crate) fn setup(&self) -> Setup<'_> {
        Setup { robot: &self.robot, settings: &self.settings }
    }

    fn assemble(
        path: &Path,
        mut file: ExperimentFile,
        settings: Settings,
        text: String,
        source: RobotSource,
    ) -> Result<Self, ExperimentError> {
        let (mut robot, robot_text) = (source.robot_with_locks(&file.locks, path)?, source.to_text());
        robot.gravity = file.gravity.unwrap_or(robot.gravity);
        robot
            .add_terms(&file.terms)
            .map_err(|source| RobotError::Term { path: path.to_owned(), source: Box::new(source) })?;
        let of_settings = |source| ExperimentError::Preparation { path: path.to_owned(), source };
        let settings = settings.for_robot(&robot).map_err(of_settings)?;
        file.twin.iter_mut().for_each(|twin| twin.repeat_for(robot.coordinate_count()));
        let robot_files = source.paths().to_vec();
        let robot_hashes = source.files();
        let experiment =
            Self { path: path.to_owned(), file, settings, text, robot, robot_text, robot_files, robot_hashes };
        experiment.validate()?;
        Ok(experiment)
    }

    /// An error in the settings, with the file that holds them.
    pub(crate) fn refuse(&self, source: impl Into<PreparationError>) -> ExperimentError {
        ExperimentError::Preparation { path: self.path.clone(), source: source.into() }
    }

    pub(crate) fn missing(&self, missing: &'static str, why: &'static str) -> ExperimentError {
        self.refuse(PreparationError::Missing { missing, why })
    }
}

fn read_text(path: &Path) -> Result<String, ExperimentError> {
    files::read_to_string(path)
        .map_err(|e| ExperimentError::Unreadable { path: path.to_owned(), reason: e.to_string() })
}

pub(super) fn parse(text: &str, path: &Path) -> Result<(ExperimentFile, Settings), ExperimentError> {
    toml::from_str(text)
        .map(Tables::split)
        .map_err(|e| ExperimentError::Syntax { path: path.to_owned(), message: in_plain_words(&e.to_string()) })
}
