//! The record of a motion on the joint side, read from files or made by the twin.

use std::path::Path;

use super::{Experiment, ExperimentError, RecordingDescription, TwinDescription, Unlisted};
use crate::{
    base_parameters::BaseParameters,
    dynamics::Model,
    recording::{self, ChannelSource, Clock, Resampling, Side},
    series::Series,
    simulation::{ClosedLoop, OutputGrid, Reference, Sensors, SimulatedMotion, SimulatorBias},
    trajectory::{self, MotionLimits, Moves},
};

/// Fewer samples of a twin cannot be filtered; more are not needed for any use of it: an hour at 25 kHz.
const TWIN_SAMPLES: std::ops::RangeInclusive<f64> = 100.0..=1e8;

/// Positions and torques of the joints, and what else was recorded with them.
pub(crate) struct Record {
    pub(crate) name: String,
    /// Weight of its rows.
    pub(crate) weight: f64,
    pub(crate) sample_rate_hz: f64,
    /// The times as they were recorded, s.
    pub(crate) stamps: Option<Vec<f64>>,
    /// How the record was brought to equal steps, where it had none.
    pub(crate) resampling: Option<Resampling>,
    pub(crate) position: Series,
    /// Whether positions or torques came through the transmission.
    pub(crate) geared: bool,
    pub(crate) velocity: Option<Series>,
    pub(crate) torque: Series,
    /// The recorded reference of the joints.
    pub(crate) reference: Option<Series>,
    /// The signal added to the drives behind the controller.
    pub(crate) added_signal: Option<Series>,
    /// The planned moves of a twin.
    pub(crate) planned: Option<Moves>,
    /// The true standard parameters of a twin.
    pub(crate) truth: Option<Vec<f64>>,
}

/// What the sensors of a twin saw.
#[derive(Debug, Clone, PartialEq)]
pub struct TwinRecord {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Joint positions, rad or m.
    pub position: Series,
    /// Joint torques, N m or N.
    pub torque: Series,
}

/// The true motion of a twin.
#[derive(Debug, Clone, PartialEq)]
pub struct TwinMotion {
    /// The motion and the torques that made it.
    pub motion: SimulatedMotion,
    /// The reference it followed.
    pub moves: Moves,
    /// Its standard parameters.
    pub parameters: Vec<f64>,
}

impl TwinMotion {
    /// The record of what sensors saw of the joints: a motion can be recorded again and again with other noise.
    pub(crate) fn record(&self, sample_rate_hz: f64, position: Series, torque: Series) -> Record {
        Record {
            name: "twin".to_owned(),
            weight: 1.0,
            sample_rate_hz,
            stamps: None,
            resampling: None,
            velocity: None,
            geared: true,
            position,
            torque,
            reference: None,
            added_signal: None,
            planned: Some(self.moves.clone()),
            truth: Some(self.parameters.clone()),
        }
    }
}

impl Experiment {
    /// Reads a recording and brings it to the joint side and to equal time steps. `number` counts from one.
    pub(crate) fn read_record(
        &self,
        description: &RecordingDescription,
        number: usize,
        data: &Path,
    ) -> Result<Record, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let torque = self.read_torques(&description.torque, data)?;
        recording::not_all_zero(&torque, "torque", &description.torque.path(data))?;
        let optional = |source: &Option<ChannelSource>, read: &dyn Fn(&ChannelSource) -> Result<Series, _>| {
            source.as_ref().map(read).transpose()
        };
        let velocity = optional(&description.velocity, &|s| self.read_joint_velocities(s, data))?;
        let reference = optional(&description.reference, &|s| self.read_joint_positions(s, data))?;
        let added_signal = optional(&description.added_signal, &|s| self.read_channels(s, data))?;
        for (signal, source, series) in [
            ("torque", Some(&description.torque), Some(&torque)),
            ("velocity", description.velocity.as_ref(), velocity.as_ref()),
            ("reference", description.reference.as_ref(), reference.as_ref()),
            ("added signal", description.added_signal.as_ref(), added_signal.as_ref()),
        ] {
            let (Some(source), Some(series)) = (source, series) else { continue };
            let file = description.position.path(data);
            recording::same_length(&position, "position", &file, series, signal, &source.path(data))?;
        }
        let clock = read_clock(description, data, &position)?;
        let even = |series: Series| clock.to_equal_steps(series);
        Ok(Record {
            torque: even(torque),
            velocity: velocity.map(even),
            reference: reference.map(even),
            added_signal: added_signal.map(even),
            ..Record::of_motion(description, number, position, &clock)
        })
    }

    /// Reads a motion whose torques were not recorded.
    pub(super) fn read_motion(
        &self,
        description: &RecordingDescription,
        data: &Path,
    ) -> Result<Record, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let clock = read_clock(description, data, &position)?;
        Ok(Record::of_motion(description, 1, position, &clock))
    }

    fn read_joint_velocities(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = self.read_channels(source, data)?;
        Ok(match source.side {
            Side::Motor => self.robot.transmission.joint_velocities(&series),
            Side::Joint => series,
        })
    }

    fn read_joint_positions(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = self.read_channels(source, data)?;
        Ok(match source.side {
            Side::Motor => self.robot.transmission.joint_positions(&series),
            Side::Joint => series,
        })
    }

    fn read_torques(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = self.read_channels(source, data)?;
        Ok(match source.side {
            Side::Motor => self.robot.transmission.joint_torques(&series),
            Side::Joint => series,
        })
    }

    fn read_channels(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = recording::read_channels(source, data)?;
        let joints = self.robot.coordinate_count();
        if series.channels() == joints {
            return Ok(series);
        }
        let key = format!("{}: number of channels", source.path(data).display());
        Err(self.value(&key, &format!("{joints}, one for each joint of {}", self.robot.name), series.channels()))
    }

    /// Simulates the twin's motion and records it through its sensors.
    pub(crate) fn simulate_twin(&self, twin: &TwinDescription) -> Result<Record, ExperimentError> {
        Ok(self.record_motion(&twin.sensors, twin.sample_rate_hz, &self.twin_motion(twin)?))
    }

    /// The record of the twin of `[twin]`: time in s, positions and torques of the joints.
    ///
    /// # Errors
    /// [`ExperimentError`] where there is no twin, or its motion cannot be simulated.
    pub fn record_twin(&self) -> Result<TwinRecord, ExperimentError> {
        let why = "it describes the simulated robot that is recorded";
        let twin = self.file.twin.as_ref().ok_or_else(|| self.missing("[twin]", why))?;
        let Record { sample_rate_hz, position, torque, .. } = self.simulate_twin(twin)?;
        let joints = self.robot.coordinates().map(|j| j.name.clone()).collect();
        Ok(TwinRecord { joints, sample_rate_hz, position, torque })
    }

    /// The motion of a twin before its sensors, with this experiment's robot, controller and solver.
    ///
    /// # Errors
    /// [`ExperimentError`] for a description that cannot be used or a loop that diverges.
    pub fn twin_motion(&self, twin: &TwinDescription) -> Result<TwinMotion, ExperimentError> {
        let model = Model::new(&self.robot);
        let moves = self.plan(twin)?;
        let samples = (moves.end_s() + twin.rest_s) * twin.sample_rate_hz;
        let key = "[twin] duration of the moves times sample_rate_hz";
        self.require(TWIN_SAMPLES.contains(&samples), key, "from 100 to 1e8 samples", samples)?;
        let samples = samples.ceil() as usize;
        let parameters = self.true_parameters(twin, &model)?;
        let controller = self.file.controller.as_ref();
        let why = "the twin moves under its control";
        let reference = Reference::Moves(moves.clone());
        let closed_loop = ClosedLoop {
            model: &model,
            transmission: &self.robot.transmission,
            controller: controller.ok_or_else(|| self.missing("[controller]", why))?,
            reference: &reference,
            added_signal: None,
            bias: SimulatorBias::NONE,
            solver: self.file.simulation.solver,
            sign_velocity_scale: self.file.simulation.sign_velocity_scale,
        };
        let inertia = closed_loop.motor_inertia(&parameters, moves.end_s());
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: twin.sample_rate_hz, samples };
        let motion = closed_loop
            .simulate(&parameters, &inertia, &grid)
            .map_err(|source| ExperimentError::Twin { path: self.path.clone(), source })?;
        Ok(TwinMotion { motion, moves, parameters })
    }

    /// The record of a twin's motion by its sensors.
    pub(super) fn record_motion(&self, sensors: &Sensors, sample_rate_hz: f64, twin: &TwinMotion) -> Record {
        let (positions, drive_signals) = sensors.record(&twin.motion, &self.robot.transmission);
        let position = self.robot.transmission.joint_positions(&positions);
        let torque = self.robot.transmission.joint_torques(&drive_signals);
        twin.record(sample_rate_hz, position, torque)
    }

    fn plan(&self, twin: &TwinDescription) -> Result<Moves, ExperimentError> {
        // Angles in degrees, lengths in mm.
        let si = |values: &Vec<f64>| -> Vec<f64> {
            let model = self.robot.coordinates().map(|j| j.kind);
            let convert = |(v, kind): (&f64, _)| match kind {
                crate::robot::JointKind::Revolute => v.to_radians(),
                crate::robot::JointKind::Prismatic => 1e-3 * v,
            };
            values.iter().zip(model).map(convert).collect()
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
        let refuse = |source| ExperimentError::Parameters { path: self.path.clone(), source };
        let base = BaseParameters::of(model, &self.file.parameters.exclude).map_err(refuse)?;
        let names: Vec<String> = twin.parameters.keys().cloned().collect();
        base.select(model.parameter_table(), &names).map_err(refuse)?;
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

impl Record {
    /// A record of positions alone; its torques are zero.
    fn of_motion(description: &RecordingDescription, number: usize, position: Series, clock: &Clock) -> Self {
        Self {
            name: description.name.clone().unwrap_or_else(|| number.to_string()),
            weight: description.weight,
            sample_rate_hz: clock.sample_rate_hz(),
            stamps: clock.stamps().map(<[f64]>::to_vec),
            resampling: clock.resampling(),
            torque: Series::zeros(position.len(), position.channels()),
            position: clock.to_equal_steps(position),
            geared: [&description.position, &description.torque].iter().any(|s| s.side == Side::Motor),
            velocity: None,
            reference: None,
            added_signal: None,
            planned: None,
            truth: None,
        }
    }
}

fn read_clock(description: &RecordingDescription, data: &Path, position: &Series) -> Result<Clock, ExperimentError> {
    let Some(source) = &description.time else {
        return Ok(Clock::uniform(description.sample_rate_hz.unwrap_or_default()));
    };
    let time = recording::read_channels(source, data)?;
    recording::one_channel(&time, "time", &source.path(data))?;
    recording::same_length(position, "position", &description.position.path(data), &time, "time", &source.path(data))?;
    let column = source.columns.first().map_or("time", String::as_str);
    Ok(Clock::from_stamps(time.channel(0), description.largest_jitter, &source.path(data), column)?)
}
