//! The samples of a recording, and of text that grows.

use std::path::{Path, PathBuf};

use super::{error::WatchError, subject::WatchedRobot};
use crate::{
    experiment::{Experiment, ExperimentError, PredictionRequest, RecordingDescription, recording_to_predict},
    preparation::Recording,
};
use thetahat_data::recording::{ChannelSource, Side, SignalStream};
use thetahat_ground::series::Series;

/// Samples whose steps show the rate.
const STEPS: usize = 1000;

/// Positions and torques of the joints at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// Positions, rad or m.
    pub position: Vec<f64>,
    /// Torques, N m or N.
    pub torque: Vec<f64>,
}

/// The rate of a recording's file, and its samples without those in gaps. Its channels are described as in the experiment of the results.
///
/// # Errors
/// [`WatchError`] for files that cannot be used, or without torques.
pub fn recorded_samples(
    robot: &WatchedRobot,
    request: &PredictionRequest,
) -> Result<(f64, impl Iterator<Item = Sample> + use<>), WatchError> {
    let (experiment, description) = described(robot, request)?;
    let recording = experiment.read_recording(&description, 1, Path::new(""))?;
    let rate_hz = recording.sample_rate_hz;
    let part = recording.held_part_of_step();
    let start_s = recording.time_stamps_s.as_ref().and_then(|stamps| stamps.first()).copied().unwrap_or(0.0);
    let Recording { position, torque, gaps, .. } = recording;
    let Some(torque) = torque else { return Err(WatchError::NoTorque { path: request.recording.clone() }) };
    let is_recorded = move |k: &usize| !gaps.iter().any(|gap| gap.contains(k));
    let samples = (0..position.len()).filter(is_recorded).map(move |k| Sample {
        time_s: start_s + k as f64 / rate_hz,
        position: position.sample(k).to_vec(),
        torque: centred(&torque, k, part),
    });
    Ok((rate_hz, samples))
}

/// The torque around a sample, of torques that hold for a part of a step.
fn centred(torque: &Series, k: usize, part: f64) -> Vec<f64> {
    let before = torque.sample(k.saturating_sub(1));
    torque.sample(k).iter().zip(before).map(|(now, before)| now - 0.5 * part * (now - before)).collect()
}

/// The experiment of a robot, and how it describes the recording.
fn described<'a>(
    robot: &'a WatchedRobot,
    request: &PredictionRequest,
) -> Result<(&'a Experiment, RecordingDescription), WatchError> {
    let of_arrays = || ExperimentError::OfArrays { path: request.results.clone() };
    let experiment = robot.experiment().ok_or_else(of_arrays)?;
    let description = recording_to_predict(experiment, request)?;
    match &description.torque {
        Some(torque) if torque.file == description.position.file => Ok((experiment, description)),
        Some(_) | None => Err(WatchError::NoTorque { path: request.recording.clone() }),
    }
}

/// A text that grows, such as a pipe or the file of a logger that is at work.
pub struct GrowingText {
    experiment: Experiment,
    description: RecordingDescription,
    stream: SignalStream,
    /// Samples that wait until the rate is known.
    waiting: Vec<Sample>,
    rate_hz: Option<f64>,
    count: usize,
    last_torque: Vec<f64>,
    path: PathBuf,
}

impl GrowingText {
    /// The text of a request's recording.
    ///
    /// # Errors
    /// [`WatchError`] for a description that does not fit a text that grows.
    pub fn new(robot: &WatchedRobot, request: &PredictionRequest) -> Result<Self, WatchError> {
        let (experiment, description) = described(robot, request)?;
        let torque = description.torque.iter().map(|source| ("the torque", source));
        let time = description.time.iter().map(|source| ("the time", source));
        let named: Vec<_> = [("the position", &description.position)].into_iter().chain(torque).chain(time).collect();
        for (signal, source) in &named {
            let refuse = |why| Err(WatchError::NotInText { path: request.recording.clone(), signal, why });
            if source.takes_other_samples() {
                return refuse("has a delay_s or a low_pass_s");
            }
            if !SignalStream::can_read(source) {
                return refuse("is not one column for each channel");
            }
        }
        let sources = named.into_iter().map(|(_, source)| source.clone()).collect();
        Ok(Self {
            experiment: experiment.clone(),
            stream: SignalStream::new(sources, &request.recording),
            waiting: Vec::new(),
            rate_hz: description.sample_rate_hz.filter(|_| description.time.is_none()),
            description,
            count: 0,
            last_torque: Vec::new(),
            path: request.recording.clone(),
        })
    }

    /// Samples per second: stated, or by the mean of the first steps; `None` until these are known.
    #[must_use]
    pub fn rate_hz(&self) -> Option<f64> {
        self.rate_hz
    }

    /// Takes bytes; the samples that they complete, none until the rate is known. At the end, a line without its end is complete.
    ///
    /// # Errors
    /// [`WatchError`] for a line that cannot be read, by its number.
    pub fn read(&mut self, bytes: &[u8], is_end: bool) -> Result<Vec<Sample>, WatchError> {
        let signals = self.stream.read(bytes, is_end)?;
        if let [position, torque, time @ ..] = signals.as_slice() {
            self.add(position.clone(), torque.clone(), time.first())?;
        }
        if self.rate_hz.is_none() && (self.waiting.len() > STEPS || is_end) {
            self.rate_hz = rate_of(&self.waiting);
        }
        Ok(if self.rate_hz.is_some() { std::mem::take(&mut self.waiting) } else { Vec::new() })
    }

    fn add(&mut self, position: Series, torque: Series, time: Option<&Series>) -> Result<(), WatchError> {
        let transmission = &self.experiment.robot.transmission;
        let expected = self.experiment.robot.coordinate_count();
        let (of_torque, of_position) = (self.description.torque.as_ref(), &self.description.position);
        for (series, signal) in [(&position, "positions"), (&torque, "torques")] {
            if series.channels() != expected {
                let (path, found) = (self.path.clone(), series.channels());
                return Err(WatchError::JointCount { path, signal, expected, found });
            }
        }
        let is_of_motor = |source: &ChannelSource| source.side == Side::Motor;
        let position = if is_of_motor(of_position) { transmission.joint_positions(&position) } else { position };
        let torque = match of_torque {
            Some(source) if is_of_motor(source) => transmission.joint_torques(&torque),
            Some(_) | None => torque,
        };
        let is_held = of_torque.is_some_and(|source| source.held);
        for k in 0..position.len() {
            let now = torque.sample(k);
            let before = if is_held && !self.last_torque.is_empty() { &self.last_torque } else { now };
            let centred = now.iter().zip(before).map(|(now, before)| 0.5 * (now + before)).collect();
            let counted = self.count as f64 / self.rate_hz.unwrap_or(1.0);
            self.waiting.push(Sample {
                time_s: time.map_or(counted, |time| time.sample(k)[0]),
                position: position.sample(k).to_vec(),
                torque: centred,
            });
            self.last_torque = now.to_vec();
            self.count += 1;
        }
        Ok(())
    }
}

/// The rate by the mean of the usual steps: stamps are often rounded, gaps are no steps.
fn rate_of(samples: &[Sample]) -> Option<f64> {
    let mut steps: Vec<f64> = samples.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    steps.retain(|step| *step > 0.0 && step.is_finite());
    steps.sort_by(f64::total_cmp);
    let median = *steps.get(steps.len() / 2)?;
    steps.retain(|step| (0.5 * median..1.5 * median).contains(step));
    Some(steps.len() as f64 / steps.iter().sum::<f64>())
}
