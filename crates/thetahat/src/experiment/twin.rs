//! The twin: a simulated robot with known parameters, recorded through its sensors.

use super::{
    description::{Experiment, TwinDescription, Unlisted},
    error::ExperimentError,
    missing_values::refuse_missing,
    paths,
};
use crate::{
    preparation::{PreparationError, Recording},
    scheduling::closed_loop,
};
use thetahat_data::recording::ChannelSource;
use thetahat_estimation::{
    simulation::{OutputGrid, Reference, SampledReference, Sensors, SimulatedMotion, SimulatorBias},
    trajectory::{self, MotionLimits, Moves},
};
use thetahat_ground::{digest::sha256, files, series::Series};
use thetahat_model::{base_parameters::BaseParameters, dynamics::Model};
use thetahat_report::results::TwinRecording;

/// Fewer samples of a twin cannot be filtered; more are not needed for any use of it: an hour at 25 kHz.
const TWIN_SAMPLES: std::ops::RangeInclusive<f64> = 100.0..=1e8;

/// What a twin follows.
#[derive(Debug, Clone, PartialEq)]
pub enum TwinReference {
    /// Moves.
    Moves(Moves),
    /// Positions of the joints at the samples of its recording.
    Sampled(Series),
}

impl TwinReference {
    /// The moves, where it follows moves.
    #[must_use]
    pub fn moves(&self) -> Option<&Moves> {
        match self {
            Self::Moves(moves) => Some(moves),
            Self::Sampled(_) => None,
        }
    }

    /// Its end, s.
    fn end_s(&self, sample_rate_hz: f64) -> f64 {
        match self {
            Self::Moves(moves) => moves.end_s(),
            Self::Sampled(positions) => positions.len() as f64 / sample_rate_hz,
        }
    }

    /// Samples of a recording that ends `rest_s` after the motion.
    fn samples(&self, sample_rate_hz: f64, rest_s: f64) -> f64 {
        match self {
            Self::Moves(moves) => (moves.end_s() + rest_s) * sample_rate_hz,
            Self::Sampled(positions) => positions.len() as f64 + rest_s * sample_rate_hz,
        }
    }

    /// The reference of a simulation.
    fn simulated(&self, sample_rate_hz: f64) -> Reference {
        match self {
            Self::Moves(moves) => Reference::Moves(moves.clone()),
            Self::Sampled(positions) => Reference::Sampled(SampledReference::new(positions.clone(), sample_rate_hz)),
        }
    }
}

/// The true motion of a twin.
#[derive(Debug, Clone, PartialEq)]
pub struct TwinMotion {
    /// The motion and the torques that made it.
    pub motion: SimulatedMotion,
    /// The reference it followed.
    pub reference: TwinReference,
    /// Its standard parameters.
    pub parameters: Vec<f64>,
}

impl TwinMotion {
    /// The positions that it follows, at the samples of its recording.
    fn followed(&self, samples: usize) -> Option<Series> {
        match &self.reference {
            TwinReference::Moves(_) => None,
            TwinReference::Sampled(positions) => {
                let last = positions.len() - 1;
                let values = (0..samples).flat_map(|k| positions.sample(k.min(last)).iter().copied());
                Some(Series::shaped(positions.channels(), values.collect()))
            }
        }
    }

    /// The recording of what sensors saw of the joints: a motion can be recorded again and again with other noise.
    pub(crate) fn recording(&self, sample_rate_hz: f64, position: Series, torque: Series) -> Recording {
        Recording {
            geared: true,
            planned: self.reference.moves().cloned(),
            reference: self.followed(position.len()),
            truth: Some(self.parameters.clone()),
            ..Recording::new(sample_rate_hz, position, torque).named("twin")
        }
    }
}

impl Experiment {
    /// Simulates the twin's motion and records it through its sensors.
    pub(crate) fn simulate_twin(&self, twin: &TwinDescription) -> Result<Recording, ExperimentError> {
        Ok(self.record_motion(&twin.sensors, twin.sample_rate_hz, &self.twin_motion(twin)?))
    }

    /// The simulated recording of `[twin]`: time in s, positions and torques of the joints.
    ///
    /// # Errors
    /// [`ExperimentError`] where there is no twin, or its motion cannot be simulated.
    pub fn record_twin(&self) -> Result<TwinRecording, ExperimentError> {
        let why = "it describes the simulated robot that is recorded";
        let twin = self.file.twin.as_ref().ok_or_else(|| self.missing("[twin]", why))?;
        let Recording { sample_rate_hz, position, torque, .. } = self.simulate_twin(twin)?;
        let joints = self.robot.coordinates().map(|j| j.name.clone()).collect();
        let torque = torque.unwrap_or_else(|| Series::zeros(position.len(), position.channels()));
        Ok(TwinRecording { joints, sample_rate_hz, position, torque })
    }

    /// The motion of a twin before its sensors, with this experiment's robot, controller and solver.
    ///
    /// # Errors
    /// [`ExperimentError`] for a description that cannot be used or a loop that diverges.
    pub fn twin_motion(&self, twin: &TwinDescription) -> Result<TwinMotion, ExperimentError> {
        if let Some(term) = self.robot.term_of_acceleration().map(str::to_owned).or_else(|| self.robot.channels().pop())
        {
            let expected = "terms of positions and velocities alone, where a twin is simulated";
            return Err(self.refuse(PreparationError::value("[[term]]", expected, term)));
        }
        let model = Model::new(&self.robot);
        let followed = self.reference_of(twin)?;
        let end_s = followed.end_s(twin.sample_rate_hz);
        let samples = followed.samples(twin.sample_rate_hz, twin.rest_s);
        let key = "[twin] duration of the moves times sample_rate_hz";
        PreparationError::require(TWIN_SAMPLES.contains(&samples), key, "from 100 to 1e8 samples", samples)
            .map_err(|e| self.refuse(e))?;
        let parameters = self.true_parameters(twin, &model)?;
        let why = "the twin moves under its control";
        let controller = self.settings.controller.as_ref().ok_or_else(|| self.missing("[controller]", why))?;
        let reference = followed.simulated(twin.sample_rate_hz);
        let closed_loop = closed_loop(self.setup(), &model, controller, &reference, None, SimulatorBias::NONE);
        let inertia = closed_loop.motor_inertia(&parameters, end_s);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: twin.sample_rate_hz, samples: samples.ceil() as usize };
        let motion = closed_loop
            .simulate(&parameters, &inertia, &grid)
            .map_err(|source| ExperimentError::Twin { path: self.path.clone(), source })?;
        Ok(TwinMotion { motion, reference: followed, parameters })
    }

    /// The recording of a twin's motion by its sensors.
    pub(super) fn record_motion(&self, sensors: &Sensors, sample_rate_hz: f64, twin: &TwinMotion) -> Recording {
        let (positions, drive_signals) = sensors.record(&twin.motion, &self.robot);
        let position = self.robot.transmission.joint_positions(&positions);
        let torque = self.robot.transmission.joint_torques(&drive_signals);
        let sample_time_s = self.settings.controller.as_ref().map_or(0.0, |c| c.sample_time_s);
        let recording = twin.recording(sample_rate_hz, position, torque);
        Recording { torque_hold_s: sample_time_s.min(1.0 / sample_rate_hz), ..recording }
    }

    /// What the twin follows: its moves, or the positions of a file of the experiment.
    fn reference_of(&self, twin: &TwinDescription) -> Result<TwinReference, ExperimentError> {
        let Some(source) = &twin.reference else { return self.plan(twin).map(TwinReference::Moves) };
        paths::path_in_project(&self.path, "[twin] reference", &source.file)?;
        let positions = self.read_joint_positions(source, self.folder())?;
        refuse_missing(source, &positions, self.folder())?;
        let (found, expected) = (positions.len(), "positions of a motion of two samples at least");
        PreparationError::require(found > 1, "[twin] reference", expected, found).map_err(|e| self.refuse(e))?;
        Ok(TwinReference::Sampled(positions))
    }

    /// SHA-256 of the file that the twin follows, in hexadecimal digits; `None` if it follows moves. The experiment's text names the
    /// file and does not hold it, so that recordings of two motions can have one text.
    ///
    /// # Errors
    /// [`ExperimentError`] for a file that cannot be read.
    pub fn reference_sha256(&self) -> Result<Option<String>, ExperimentError> {
        let followed = self.file.twin.as_ref().and_then(|twin| twin.reference.as_ref());
        let digest = |source: &ChannelSource| {
            let path = paths::path_in_project(&self.path, "[twin] reference", &source.file)?;
            let content = files::read(&path);
            content.map(|c| sha256(&c)).map_err(|e| ExperimentError::Unreadable { path, reason: e.to_string() })
        };
        followed.map(digest).transpose()
    }

    fn plan(&self, twin: &TwinDescription) -> Result<Moves, ExperimentError> {
        // Angles in degrees, lengths in mm.
        let si = |values: &Vec<f64>| -> Vec<f64> {
            values.iter().zip(self.robot.coordinates()).map(|(value, joint)| joint.kind.to_si(*value)).collect()
        };
        let points: Vec<Vec<f64>> = twin.points.iter().map(si).collect();
        let limits = MotionLimits {
            max_velocity: si(&twin.max_velocity),
            acceleration_time_s: twin.acceleration_time_s,
            smoothing_time_s: twin.smoothing_time_s,
            dwell_s: 0.0,
        };
        trajectory::plan(points[0].clone(), &points[1..], &limits, twin.rest_s)
            .map_err(|source| ExperimentError::Plan { path: self.path.clone(), source })
    }

    fn true_parameters(&self, twin: &TwinDescription, model: &Model) -> Result<Vec<f64>, ExperimentError> {
        let base = BaseParameters::of(model, &self.settings.parameters.exclude).map_err(|e| self.refuse(e))?;
        let names: Vec<String> = twin.parameters.keys().cloned().collect();
        base.select(model.parameter_table(), &names).map_err(|e| self.refuse(e))?;
        let unlisted = match twin.unlisted {
            Unlisted::Zero => vec![0.0; base.len()],
            Unlisted::APriori => base.from_standard(&self.robot.a_priori_parameters()),
        };
        let value = |(name, unlisted): (&str, f64)| twin.parameters.get(name).copied().unwrap_or(unlisted);
        let names = base.parameters().iter().map(|p| p.name.as_str());
        let theta: Vec<f64> = names.zip(unlisted).map(value).collect();
        Ok(base.to_standard(&theta))
    }
}
