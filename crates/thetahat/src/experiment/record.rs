//! The record of a motion on the joint side, read from files or made by the twin.

use std::path::Path;

use super::{Experiment, ExperimentError, RecordingDescription, description::TwinDescription};
use crate::{
    base_parameters::BaseParameters,
    dynamics::Model,
    recording::{self, ChannelSource, Side},
    series::Series,
    simulation::{ClosedLoop, OutputGrid, Reference, SimulatorBias},
    trajectory::{self, Limits, Moves},
};

/// Fewer samples of a twin cannot be filtered; more are not needed for any use of it: an hour at 25 kHz.
const TWIN_SAMPLES: std::ops::RangeInclusive<f64> = 100.0..=1e8;

/// Positions and torques of the joints, and what else was recorded with them.
pub(super) struct Record {
    pub(super) sample_rate_hz: f64,
    pub(super) position: Series,
    pub(super) torque: Series,
    /// The recorded reference of the joints.
    pub(super) reference: Option<Series>,
    /// The signal added to the drives behind the controller.
    pub(super) added_signal: Option<Series>,
    /// The planned moves of a twin.
    pub(super) planned: Option<Moves>,
    /// The true standard parameters of a twin.
    pub(super) truth: Option<Vec<f64>>,
}

impl Experiment {
    /// Reads a recording and brings it to the joint side.
    pub(super) fn read_record(
        &self,
        description: &RecordingDescription,
        data: &Path,
    ) -> Result<Record, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let torque = self.read_torques(&description.torque, data)?;
        let files = (description.position.path(data), description.torque.path(data));
        recording::same_length(&position, "position", &files.0, &torque, "torque", &files.1)?;
        let reference = description.reference.as_ref().map(|s| self.read_joint_positions(s, data)).transpose()?;
        let added_signal = description.added_signal.as_ref().map(|s| self.read_channels(s, data)).transpose()?;
        for (name, source, series) in [
            ("reference", &description.reference, &reference),
            ("added signal", &description.added_signal, &added_signal),
        ] {
            if let (Some(source), Some(series)) = (source, series) {
                recording::same_length(&position, "position", &files.0, series, name, &source.path(data))?;
            }
        }
        recording::not_all_zero(&torque, "torque", &files.1)?;
        let sample_rate_hz = sample_rate(description, data, &position)?;
        Ok(Record { sample_rate_hz, position, torque, reference, added_signal, planned: None, truth: None })
    }

    /// Reads a motion whose torques were not recorded.
    pub(super) fn read_motion(
        &self,
        description: &RecordingDescription,
        data: &Path,
    ) -> Result<Record, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        Ok(Record {
            sample_rate_hz: sample_rate(description, data, &position)?,
            torque: Series::zeros(position.len(), position.channels()),
            position,
            reference: None,
            added_signal: None,
            planned: None,
            truth: None,
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
        let joints = self.robot.joint_count();
        if series.channels() == joints {
            return Ok(series);
        }
        let key = format!("{}: number of channels", source.path(data).display());
        Err(self.value(&key, &format!("{joints}, one for each joint of {}", self.robot.name), series.channels()))
    }

    /// Simulates the twin's motion and records it through its sensors.
    pub(super) fn simulate_twin(&self, twin: &TwinDescription) -> Result<Record, ExperimentError> {
        let model = Model::new(&self.robot);
        let moves = self.plan(twin)?;
        let samples = (moves.end_s() + twin.rest_s) * twin.sample_rate_hz;
        let key = "[twin] duration of the moves times sample_rate_hz";
        self.require(TWIN_SAMPLES.contains(&samples), key, "from 100 to 1e8 samples", samples)?;
        let samples = samples.ceil() as usize;
        let truth = self.true_parameters(twin, &model)?;
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
        let inertia = closed_loop.motor_inertia(&truth, moves.end_s());
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: twin.sample_rate_hz, samples };
        let motion = closed_loop
            .simulate(&truth, &inertia, &grid)
            .map_err(|source| ExperimentError::Twin { path: self.path.clone(), source })?;
        let (positions, drive_signals) = twin.sensors.record(&motion, &self.robot.transmission);
        Ok(Record {
            sample_rate_hz: twin.sample_rate_hz,
            position: self.robot.transmission.joint_positions(&positions),
            torque: self.robot.transmission.joint_torques(&drive_signals),
            reference: None,
            added_signal: None,
            planned: Some(moves),
            truth: Some(truth),
        })
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
        let limits = Limits {
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
        let value = |name: &str| twin.parameters.get(name).copied().unwrap_or(0.0);
        let theta: Vec<f64> = base.parameters().iter().map(|p| value(&p.name)).collect();
        Ok(base.to_standard(&theta))
    }
}

fn sample_rate(description: &RecordingDescription, data: &Path, position: &Series) -> Result<f64, ExperimentError> {
    let Some(source) = &description.time else {
        return Ok(description.sample_rate_hz.unwrap_or_default());
    };
    let time = recording::read_channels(source, data)?;
    recording::one_channel(&time, "time", &source.path(data))?;
    recording::same_length(position, "position", &description.position.path(data), &time, "time", &source.path(data))?;
    let column = source.columns.first().map_or("time", String::as_str);
    Ok(recording::sample_rate_from_time(&time.channel(0), &source.path(data), column)?)
}
