use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use crate::design::{
    error::DesignError,
    prediction::{noise::TorqueNoise, prior_model::with_model},
    text::{
        collision_options::CollisionOptions,
        options::{DesignObjective, LimitOptions, MotionOptions, NoiseOptions, RatedOptions, UncertaintyOptions},
    },
};
use crate::preparation::{
    EstimationOptions, ParameterSelection, Payload, PreparationError, Settings, SignalOptions, SimulationOptions,
};
use thetahat_estimation::control::ControllerDescription;
use thetahat_ground::{files, syntax::in_plain_words};
use thetahat_model::robot::{Locks, Robot, RobotSource};

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
    /// Samples per second of the trajectory and of the recording.
    #[serde(default = "default_rate")]
    pub sample_rate_hz: f64,
    /// Points per second of what a robot's controller follows (`points.csv`, `points.script`, `trajectory.yaml`, `trajectory.json`): by
    /// default 125 in the first two, and `sample_rate_hz` in the others.
    pub points_hz: Option<f64>,
    /// The criterion and the parameters that it is for.
    #[serde(default)]
    pub wanted: DesignObjective,
    /// The kind of motion.
    #[serde(default)]
    pub motion: MotionOptions,
    /// Limits of the joints: for what the robot's description does not state, or to replace it.
    #[serde(default)]
    pub limits: LimitOptions,
    /// What the percentages of programs are of.
    #[serde(default)]
    pub rated: RatedOptions,
    /// The noise of the recording.
    pub noise: NoiseOptions,
    /// How far the robot may be from its a-priori parameters.
    #[serde(default)]
    pub uncertainty: UncertaintyOptions,
    /// The payload that the robot carries, as in an experiment file: one that is known, or none.
    #[serde(default)]
    pub payload: Vec<Payload>,
    /// The robot's shape and what stands around it.
    pub collision: Option<CollisionOptions>,
    /// How the recording will be filtered.
    pub signal: SignalOptions,
    /// Which parameters will be estimated.
    #[serde(default)]
    pub parameters: ParameterSelection,
    /// How they will be estimated.
    #[serde(default)]
    pub estimation: Option<EstimationOptions>,
    /// The robot's controller: with it the loop is simulated, and the predicted intervals include tracking errors.
    pub controller: Option<ControllerDescription>,
    /// The simulator's options.
    #[serde(default)]
    pub simulation: SimulationOptions,
    /// Reductions of earlier recordings, used as prior information; or a `results.json`, whose model is the a-priori robot as well.
    #[serde(default)]
    pub prior: Vec<PathBuf>,
    /// Results of an identification, or an experiment file with recordings, whose intervals are listed next to the predicted ones.
    pub compare: Option<PathBuf>,
}

fn default_rate() -> f64 {
    1000.0
}

/// A design file with its robot.
#[derive(Debug, Clone)]
pub struct Design {
    /// Where the file is.
    pub path: PathBuf,
    /// What it says.
    pub file: DesignFile,
    /// Its tables, for the experiment that follows.
    pub(in crate::design) tables: toml::Table,
    /// The robot.
    pub robot: Robot,
    /// Where its description is.
    pub robot_path: PathBuf,
    /// The files that it was read from.
    pub(in crate::design) robot_files: Vec<PathBuf>,
    /// How the recording will be identified.
    pub settings: Settings,
    /// The noise of its torques.
    pub(in crate::design) noise: TorqueNoise,
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
        let refuse =
            |e: toml::de::Error| DesignError::Syntax { path: path.to_owned(), message: in_plain_words(&e.to_string()) };
        let file: DesignFile = toml::from_str(text).map_err(refuse)?;
        let tables: toml::Table = toml::from_str(text).map_err(refuse)?;
        let robot_path = path.parent().unwrap_or(Path::new("")).join(&file.robot);
        let locks = Locks { locked: file.locked.clone(), until: Vec::new() };
        let source = RobotSource::read(&robot_path)?;
        let robot = with_model(source.robot_with_locks(&locks, path)?, &files_of(path, &file.prior))?;
        let refuse = |source| DesignError::Preparation { path: path.to_owned(), source };
        let settings = settings(&file).for_robot(&robot).map_err(refuse)?;
        let noise = TorqueNoise::default();
        let robot_files = source.paths().to_vec();
        let design = Self { path: path.to_owned(), tables, robot, robot_path, robot_files, settings, noise, file };
        design.validate()?;
        Ok(Self { noise: design.torque_noise()?, ..design })
    }

    /// Every file that the design reads.
    #[must_use]
    pub fn input_files(&self) -> Vec<PathBuf> {
        [self.path.clone()]
            .into_iter()
            .chain(self.robot_files.iter().cloned())
            .chain(self.prior_files())
            .chain(self.compared_files())
            .chain(self.noise_file())
            .collect()
    }

    pub(in crate::design) fn prior_files(&self) -> Vec<PathBuf> {
        files_of(&self.path, &self.file.prior)
    }

    pub(in crate::design) fn compared_file(&self) -> Option<PathBuf> {
        self.in_own_folder(self.file.compare.as_deref())
    }

    pub(in crate::design) fn noise_file(&self) -> Option<PathBuf> {
        self.in_own_folder(self.file.noise.results.as_deref())
    }

    /// The path of a file that is named relative to the design's folder.
    fn in_own_folder(&self, file: Option<&Path>) -> Option<PathBuf> {
        file.map(|file| self.path.parent().unwrap_or(Path::new("")).join(file))
    }

    pub(in crate::design) fn refuse(&self, source: PreparationError) -> DesignError {
        DesignError::Preparation { path: self.path.clone(), source }
    }

    pub(in crate::design) fn value(&self, key: &str, expected: &str, found: impl std::fmt::Display) -> DesignError {
        self.refuse(PreparationError::value(key, expected, found))
    }

    pub(in crate::design) fn require(
        &self,
        holds: bool,
        key: &str,
        expected: &str,
        found: impl std::fmt::Display,
    ) -> Result<(), DesignError> {
        PreparationError::require(holds, key, expected, found).map_err(|source| self.refuse(source))
    }
}

/// The paths of files that are named relative to the design's folder.
fn files_of(design: &Path, named: &[PathBuf]) -> Vec<PathBuf> {
    let folder = design.parent().unwrap_or(Path::new(""));
    named.iter().map(|file| folder.join(file)).collect()
}

/// How the recording will be identified: by least squares weighted by the noise of each joint unless the file asks for other methods.
fn settings(file: &DesignFile) -> Settings {
    let default = || EstimationOptions {
        methods: vec![thetahat_estimation::identification::Method::IDIM_WLS],
        ..EstimationOptions::default()
    };
    Settings {
        signal: file.signal,
        parameters: file.parameters.clone(),
        estimation: file.estimation.clone().unwrap_or_else(default),
        controller: file.controller.clone(),
        simulation: file.simulation,
        model: Default::default(),
        cases: Vec::new(),
        payloads: file.payload.clone(),
    }
}
