//! A recording that is read in pieces, on the joint side.

use std::{ops::Range, path::Path};

use super::error::ReductionError;
use crate::{
    experiment::{Experiment, ExperimentError, RecordingDescription},
    preparation::{PreparationError, Recording},
};
use thetahat_data::recording::{ChannelSource, RecordingError, STEP_TOLERANCE, Side, SignalPieces};
use thetahat_ground::series::Series;

/// Places of the first signals in the list that is opened.
const POSITION: usize = 0;
const TORQUE: usize = 1;

/// Samples up to which a recording is read whole where its steps must be made equal.
const SHORT: usize = 1 << 20;

/// Stamps that are looked at at a time.
const STAMPS: usize = 1 << 16;

/// A recording of which any piece can be had.
pub(super) struct Source<'a> {
    experiment: &'a Experiment,
    pub name: String,
    file: String,
    pub weight: f64,
    pub samples: usize,
    pub sample_rate_hz: f64,
    /// Time for which its torques hold, s; zero where they were measured at their instants.
    pub torque_hold_s: f64,
    /// True standard parameters, for a twin.
    pub truth: Option<Vec<f64>>,
    values: Values<'a>,
    places: Places,
}

/// Places of the signals that not every recording has.
#[derive(Debug, Clone, Copy, Default)]
struct Places {
    time: Option<usize>,
    reference: Option<usize>,
    added: Option<usize>,
}

enum Values<'a> {
    Pieces { signals: Box<SignalPieces>, description: &'a RecordingDescription },
    Whole(Box<Recording>),
}

impl<'a> Source<'a> {
    /// Looks through a recording; one whose files cannot be read in pieces is read whole. `number` counts from one.
    pub(super) fn open(
        experiment: &'a Experiment,
        description: &'a RecordingDescription,
        (number, data): (usize, &Path),
        simulated: bool,
    ) -> Result<Self, ReductionError> {
        if description.payload.is_some() {
            let why = "a reduction has no columns of payloads; an identification takes recordings with one";
            return Err(experiment.missing("[recording] without payload", why).into());
        }
        if !description.left_out_s.is_empty() {
            let why = "a reduction takes every sample; an identification leaves intervals out";
            return Err(experiment.missing("[recording] without left_out_s", why).into());
        }
        let Some(torque) = &description.torque else {
            let why = "a reduction is of torques; an identification takes positions alone, by CLOE";
            return Err(experiment.missing("[recording] torque", why).into());
        };
        let (sources, places) = sources_of(description, torque, simulated);
        if sources.iter().any(|source| source.takes_other_samples()) {
            return Self::whole(experiment, description, (number, data));
        }
        let Some(signals) = SignalPieces::open(&sources, data).map_err(ExperimentError::from)? else {
            return Self::whole(experiment, description, (number, data));
        };
        require_same_length(&signals, &sources, data)?;
        let mut source = Self {
            experiment,
            name: description.name.clone().unwrap_or_else(|| number.to_string()),
            file: file_of(description),
            weight: description.weight,
            samples: signals.samples(POSITION),
            sample_rate_hz: description.sample_rate_hz.unwrap_or_default(),
            torque_hold_s: 0.0,
            truth: None,
            values: Values::Pieces { signals: Box::new(signals), description },
            places,
        };
        source.require_channels(&sources, data)?;
        if description.time.is_some() {
            source.sample_rate_hz = source.rate_from_stamps()?;
            if source.samples <= SHORT && !source.has_equal_steps()? {
                return Self::whole(experiment, description, (number, data));
            }
        }
        if torque.held {
            source.torque_hold_s = 1.0 / source.sample_rate_hz;
        }
        match (simulated, source.places.reference) {
            (true, None) if source.samples <= SHORT => Self::whole(experiment, description, (number, data)),
            (true, None) => Err(ReductionError::NoReference { recording: source.name }),
            _ => Ok(source),
        }
    }

    fn whole(
        experiment: &'a Experiment,
        description: &'a RecordingDescription,
        (number, data): (usize, &Path),
    ) -> Result<Self, ReductionError> {
        let recording = experiment.read_recording(description, number, data)?;
        match recording.gaps.first() {
            None => Ok(Self { file: file_of(description), ..Self::of_recording(experiment, recording) }),
            Some(first) => {
                let (gaps, sample) = (recording.gaps.len(), first.start);
                Err(ReductionError::Gaps { recording: recording.name, gaps, sample })
            }
        }
    }

    /// The recording, where it is in memory.
    pub(super) fn recording(&self) -> Option<&Recording> {
        match &self.values {
            Values::Whole(record) => Some(record),
            Values::Pieces { .. } => None,
        }
    }

    /// The recorded reference of the joints, put right where that is asked for, and the added signal in a range of samples, of a recording that is read in pieces.
    pub(super) fn reference(&self, range: Range<usize>) -> Result<(Series, Option<Series>), ReductionError> {
        let missing = || ReductionError::NoReference { recording: self.name.clone() };
        let (Values::Pieces { description, .. }, Some(place)) = (&self.values, self.places.reference) else {
            return Err(missing());
        };
        let correction = description.reference_correction.as_ref();
        let reach = correction.map_or(0, |c| c.reach(self.experiment.robot.coordinate_count(), self.sample_rate_hz));
        let around = range.start.saturating_sub(reach)..(range.end + reach).min(self.samples);
        let asked: Vec<usize> = [place].into_iter().chain(self.places.added).collect();
        let mut read = self.read(&asked, around.clone())?.into_iter();
        let reference = read.next().ok_or_else(missing)?;
        let is_motor = description.reference.as_ref().is_some_and(|r| r.side == Side::Motor);
        let transmission = &self.experiment.robot.transmission;
        let reference = if is_motor { transmission.joint_positions(&reference) } else { reference };
        let corrected = correction.map(|c| c.apply(&reference, self.sample_rate_hz)).unwrap_or(reference);
        let cut = |series: &Series| series.window(range.start - around.start..range.end - around.start);
        Ok((cut(&corrected), read.next().map(|added| cut(&added))))
    }

    /// A part of the recording, with positions and torques alone.
    pub(super) fn excerpt(&self, range: Range<usize>) -> Result<Recording, ReductionError> {
        let (position, torque) = self.motion(range)?;
        let is_geared = |description: &RecordingDescription| {
            let torque = description.torque.as_ref().map_or(Side::Joint, |torque| torque.side);
            description.position.side == Side::Motor || torque == Side::Motor
        };
        let geared = match &self.values {
            Values::Whole(record) => record.geared,
            Values::Pieces { description, .. } => is_geared(description),
        };
        Ok(Recording {
            name: self.name.clone(),
            weight: self.weight,
            torque_hold_s: self.torque_hold_s,
            geared,
            ..Recording::new(self.sample_rate_hz, position, torque)
        })
    }

    /// All of the recording, as an identification reads it.
    pub(super) fn complete(&self, number: usize, data: &Path) -> Result<Recording, ReductionError> {
        match &self.values {
            Values::Whole(record) => Ok(Recording::clone(record)),
            Values::Pieces { description, .. } => Ok(self.experiment.read_recording(description, number, data)?),
        }
    }

    /// The file of its positions; empty for a twin.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// A recording that is in memory.
    pub(super) fn of_recording(experiment: &'a Experiment, recording: Recording) -> Self {
        Self {
            experiment,
            name: recording.name.clone(),
            file: String::new(),
            weight: recording.weight,
            samples: recording.position.len(),
            sample_rate_hz: recording.sample_rate_hz,
            torque_hold_s: recording.torque_hold_s,
            truth: recording.truth.clone(),
            values: Values::Whole(Box::new(recording)),
            places: Places::default(),
        }
    }

    /// The part of a step for which its torque holds, at most one.
    pub(super) fn held_part_of_step(&self) -> f64 {
        (self.torque_hold_s * self.sample_rate_hz).clamp(0.0, 1.0)
    }

    fn has_equal_steps(&self) -> Result<bool, ReductionError> {
        let mut starts = (0..self.samples).step_by(STAMPS);
        match starts.try_for_each(|start| self.check_stamps(start..(start + STAMPS + 1).min(self.samples))) {
            Ok(()) => Ok(true),
            Err(ReductionError::UnequalSteps { .. }) => Ok(false),
            Err(other) => Err(other),
        }
    }

    /// Whether its time stamps must be looked at.
    pub(super) fn has_stamps(&self) -> bool {
        self.places.time.is_some()
    }

    /// Positions of the joints in a range of samples; the stamps there are checked.
    pub(super) fn position(&self, range: Range<usize>) -> Result<Series, ReductionError> {
        match &self.values {
            Values::Whole(record) => Ok(record.position.window(range)),
            Values::Pieces { .. } => {
                let mut read = self.read(&[POSITION], range)?;
                Ok(self.joint_positions(read.remove(0)))
            }
        }
    }

    /// Positions and torques of the joints, as they were recorded, in a range of samples; the stamps there are checked.
    pub(super) fn motion(&self, range: Range<usize>) -> Result<(Series, Series), ReductionError> {
        match &self.values {
            Values::Whole(record) => {
                let torque = record.torque.as_ref().map(|torque| torque.window(range.clone()));
                let zeros = || Series::zeros(range.len(), record.position.channels());
                Ok((record.position.window(range.clone()), torque.unwrap_or_else(zeros)))
            }
            Values::Pieces { .. } => {
                let mut read = self.read(&[POSITION, TORQUE], range)?;
                let torque = self.joint_torques(read.remove(1));
                Ok((self.joint_positions(read.remove(0)), torque))
            }
        }
    }

    /// Checks the stamps in a range of samples.
    pub(super) fn check_stamps(&self, range: Range<usize>) -> Result<(), ReductionError> {
        self.read(&[], range).map(|_| ())
    }

    /// Signals as they were recorded, in SI units.
    fn read(&self, signals: &[usize], range: Range<usize>) -> Result<Vec<Series>, ReductionError> {
        let Values::Pieces { signals: parts, .. } = &self.values else { return Ok(Vec::new()) };
        let mut asked = signals.to_vec();
        asked.extend(self.places.time);
        let mut read = parts.read(&asked, range.clone()).map_err(ExperimentError::from)?;
        if self.has_stamps()
            && let Some(stamps) = read.pop()
        {
            self.require_equal_steps(stamps.values(), range.start)?;
        }
        Ok(read)
    }

    fn joint_positions(&self, series: Series) -> Series {
        match self.side_of(|description| description.position.side) {
            Side::Motor => self.experiment.robot.transmission.joint_positions(&series),
            Side::Joint => series,
        }
    }

    fn joint_torques(&self, series: Series) -> Series {
        match self.side_of(|description| description.torque.as_ref().map_or(Side::Joint, |torque| torque.side)) {
            Side::Motor => self.experiment.robot.transmission.joint_torques(&series),
            Side::Joint => series,
        }
    }

    /// The side of the gears on which a signal is read; a recording in memory is on the joint side.
    fn side_of(&self, side: fn(&RecordingDescription) -> Side) -> Side {
        match &self.values {
            Values::Pieces { description, .. } => side(description),
            Values::Whole(_) => Side::Joint,
        }
    }

    fn require_equal_steps(&self, stamps: &[f64], first: usize) -> Result<(), ReductionError> {
        let step = 1.0 / self.sample_rate_hz;
        let even = |pair: &[f64]| ((pair[1] - pair[0]) / step - 1.0).abs() <= STEP_TOLERANCE;
        match stamps.windows(2).position(|pair| !even(pair)) {
            None => Ok(()),
            Some(k) => Err(ReductionError::UnequalSteps {
                recording: self.name.clone(),
                sample: first + k + 1,
                expected: step,
                found: stamps[k + 1] - stamps[k],
            }),
        }
    }

    /// The number of steps divided by the time they take.
    fn rate_from_stamps(&self) -> Result<f64, ReductionError> {
        let (Values::Pieces { signals, description }, Some(place)) = (&self.values, self.places.time) else {
            return Ok(self.sample_rate_hz);
        };
        let source = description.time.as_ref();
        let (file, column) = source.map_or((Path::new("").to_owned(), "time".to_owned()), |s| {
            (s.file.clone(), s.columns.first().cloned().unwrap_or_else(|| "time".to_owned()))
        });
        let refuse = |error: RecordingError| ReductionError::from(ExperimentError::from(error));
        let at = |k: usize| -> Result<f64, ReductionError> {
            Ok(signals.read(&[place], k..k + 1).map_err(refuse)?[0].values()[0])
        };
        let last = self.samples - 1;
        if last == 0 {
            return Err(refuse(RecordingError::TooFewTimes { file, column, found: 1 }));
        }
        let (first_s, last_s) = (at(0)?, at(last)?);
        if last_s <= first_s {
            let (previous, found) = (first_s, last_s);
            return Err(refuse(RecordingError::TimeNotIncreasing { file, column, sample: last, previous, found }));
        }
        Ok(last as f64 / (last_s - first_s))
    }

    /// As many channels as joints, and one time.
    fn require_channels(&self, sources: &[&ChannelSource], data: &Path) -> Result<(), ReductionError> {
        let Values::Pieces { signals, .. } = &self.values else { return Ok(()) };
        let (joints, robot) = (self.experiment.robot.coordinate_count(), &self.experiment.robot.name);
        for (signal, source) in sources.iter().enumerate() {
            let found = signals.read(&[signal], 0..1).map_err(ExperimentError::from)?[0].channels();
            let (expected, what) = match Some(signal) == self.places.time {
                true => (1, "1, the time".to_owned()),
                false => (joints, format!("{joints}, one for each joint of {robot}")),
            };
            if found != expected {
                let key = format!("{}: number of channels", source.path(data).display());
                return Err(self.experiment.refuse(PreparationError::value(&key, &what, found)).into());
            }
        }
        Ok(())
    }
}

fn file_of(description: &RecordingDescription) -> String {
    description.position.file.display().to_string()
}

/// The signals that are read, and where in their list those are that not every recording has.
fn sources_of<'d>(
    description: &'d RecordingDescription,
    torque: &'d ChannelSource,
    simulated: bool,
) -> (Vec<&'d ChannelSource>, Places) {
    let mut sources = vec![&description.position, torque];
    let mut places = Places::default();
    for (source, wanted, place) in [
        (&description.time, true, &mut places.time),
        (&description.reference, simulated, &mut places.reference),
        (&description.added_signal, simulated, &mut places.added),
    ] {
        if let Some(source) = source.as_ref().filter(|_| wanted) {
            *place = Some(sources.len());
            sources.push(source);
        }
    }
    (sources, places)
}

fn require_same_length(signals: &SignalPieces, sources: &[&ChannelSource], data: &Path) -> Result<(), ReductionError> {
    let first_samples = signals.samples(POSITION);
    for (signal, source) in sources.iter().enumerate().skip(1) {
        if signals.samples(signal) != first_samples {
            let error = RecordingError::DifferentLengths {
                first: "position".to_owned(),
                first_file: sources[POSITION].path(data),
                first_samples,
                second: if signal == TORQUE { "torque" } else { "time or reference" }.to_owned(),
                second_file: source.path(data),
                second_samples: signals.samples(signal),
            };
            return Err(ExperimentError::from(error).into());
        }
    }
    Ok(())
}
