//! Recordings read from their files, on the joint side and at equal time steps.

use std::{ops::Range, path::Path};

use super::{
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
};
use crate::{
    preparation::{PreparationError, Recording},
    recording::{self, ChannelSource, Clock, RecordingError, Side},
    series::Series,
    signal::delayed,
};

/// Largest difference of the channels' times in a sample of a long table, in steps.
const LARGEST_SPREAD: f64 = 0.5;

impl Experiment {
    /// Reads a recording and brings it to the joint side and to equal time steps. `number` counts from one.
    pub(crate) fn read_recording(
        &self,
        description: &RecordingDescription,
        number: usize,
        data: &Path,
    ) -> Result<Recording, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let optional = |source: &Option<ChannelSource>, read: &dyn Fn(&ChannelSource) -> Result<Series, _>| {
            source.as_ref().map(read).transpose()
        };
        let torque = optional(&description.torque, &|s| self.read_torques(s, data))?;
        if let Some((torque, source)) = torque.as_ref().zip(description.torque.as_ref()) {
            recording::not_all_zero(torque, "torque", &source.path(data))?;
        }
        let velocity = optional(&description.velocity, &|s| self.read_joint_velocities(s, data))?;
        let reference = optional(&description.reference, &|s| self.read_joint_positions(s, data))?;
        let added_signal = optional(&description.added_signal, &|s| self.read_channels(s, data))?;
        for (signal, source, series) in [
            ("torque", description.torque.as_ref(), torque.as_ref()),
            ("velocity", description.velocity.as_ref(), velocity.as_ref()),
            ("reference", description.reference.as_ref(), reference.as_ref()),
            ("added signal", description.added_signal.as_ref(), added_signal.as_ref()),
        ] {
            let (Some(source), Some(series)) = (source, series) else { continue };
            let file = description.position.path(data);
            recording::same_length(&position, "position", &file, series, signal, &source.path(data))?;
        }
        let clock = read_clock(description, data, &position)?;
        let recording = described(description, number, data, position, &clock);
        let recording = Recording { torque, velocity, reference, added_signal, ..recording }.into_equal_steps(&clock);
        let recording = without_delays(recording, description);
        Ok(match &description.reference_correction {
            Some(correction) => recording.with_corrected_reference(correction),
            None => recording,
        })
    }

    /// Reads a motion whose torques were not recorded.
    pub(super) fn read_motion(
        &self,
        description: &RecordingDescription,
        data: &Path,
    ) -> Result<Recording, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let clock = read_clock(description, data, &position)?;
        let recording = described(description, 1, data, position, &clock).into_equal_steps(&clock);
        Ok(without_delays(recording, description))
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
        let expected = format!("{joints}, one for each joint of {}", self.robot.name);
        Err(self.refuse(PreparationError::value(&key, &expected, series.channels())))
    }
}

/// A recording of positions with what its description says.
fn described(
    description: &RecordingDescription,
    number: usize,
    data: &Path,
    position: Series,
    clock: &Clock,
) -> Recording {
    let stated = description.sample_rate_hz.filter(|_| description.time.is_none());
    let sources = [Some(&description.position), description.torque.as_ref()];
    let times = |stated| sources.into_iter().flatten().find_map(|s| recording::contradicting_times(s, data, stated));
    let contradicting_times = stated.and_then(times);
    Recording {
        name: description.name.clone().unwrap_or_else(|| number.to_string()),
        weight: description.weight,
        time_stamps_s: clock.stamps().map(<[f64]>::to_vec),
        contradicting_times,
        window_s: [description.window_start_s, description.window_end_s],
        geared: [Some(&description.position), description.torque.as_ref()]
            .into_iter()
            .flatten()
            .any(|s| s.side == Side::Motor),
        ..Recording::without_torque(clock.sample_rate_hz(), position)
    }
}

/// The times of the samples of a long table, in which each channel has its own: their mean, where they are of one instant.
fn of_all_channels(times: Series, source: &ChannelSource, file: &Path) -> Result<Series, RecordingError> {
    let samples = times.len();
    if source.channel_column.is_none() || samples < 2 {
        return Ok(times);
    }
    let step = (times.sample(samples - 1)[0] - times.sample(0)[0]) / (samples - 1) as f64;
    let ends = |k: usize| {
        let sample = times.sample(k).iter().copied();
        (sample.clone().fold(f64::INFINITY, f64::min), sample.fold(f64::NEG_INFINITY, f64::max))
    };
    let spread = (0..samples).map(ends).map(|(least, most)| most - least).fold(0.0, f64::max);
    if spread > LARGEST_SPREAD * step {
        let problem =
            format!("the times of the channels differ by {spread:.6} s within a sample: they are not of one instant");
        return Err(RecordingError::NotLong { file: file.to_owned(), problem });
    }
    let mean = |k: usize| times.sample(k).iter().sum::<f64>() / times.channels() as f64;
    Ok(Series::from_values(1, (0..samples).map(mean).collect()))
}

/// Every signal moved to where it belongs by its delay. What was recorded too late lacks its last samples: the record ends
/// before them. What was recorded too early lacks its first, which are a gap.
fn without_delays(recording: Recording, description: &RecordingDescription) -> Recording {
    let of = |source: Option<&ChannelSource>| source.map_or(0.0, |s| s.delay_s * recording.sample_rate_hz);
    let optional = [&description.torque, &description.velocity, &description.reference, &description.added_signal];
    let [torque, velocity, reference, added_signal] = optional.map(|source| of(source.as_ref()));
    let position = of(Some(&description.position));
    let all = [position, torque, velocity, reference, added_signal];
    let [earliest, latest] = [all.into_iter().fold(0.0, f64::min), all.into_iter().fold(0.0, f64::max)];
    if earliest == 0.0 && latest == 0.0 {
        return recording;
    }
    let lost = |samples: f64| if samples == 0.0 { 0 } else { samples.abs().ceil() as usize + 2 };
    let end = recording.position.len().saturating_sub(lost(latest)).max(1);
    let moved = |series: Series, samples: f64| {
        let delays = vec![-samples; series.channels()];
        if samples == 0.0 { series.window(0..end) } else { delayed(&series, &delays).window(0..end) }
    };
    Recording {
        gaps: moved_gaps(&recording.gaps, (lost(latest), lost(earliest)), end),
        position: moved(recording.position, position),
        torque: recording.torque.map(|s| moved(s, torque)),
        velocity: recording.velocity.map(|s| moved(s, velocity)),
        reference: recording.reference.map(|s| moved(s, reference)),
        added_signal: recording.added_signal.map(|s| moved(s, added_signal)),
        ..recording
    }
}

/// Gaps of all signals, which are earlier and later by up to so many samples, and the samples before the first.
fn moved_gaps(gaps: &[Range<usize>], (earlier, later): (usize, usize), end: usize) -> Vec<Range<usize>> {
    let mut moved: Vec<Range<usize>> = if later > 0 { vec![0..later.min(end)] } else { Vec::new() };
    for gap in gaps {
        let (start, stop) = (gap.start.saturating_sub(earlier), (gap.end + later).min(end));
        match moved.last_mut().filter(|last| last.end >= start) {
            Some(last) => last.end = last.end.max(stop),
            None if start < stop => moved.push(start..stop),
            None => {}
        }
    }
    moved
}

fn read_clock(description: &RecordingDescription, data: &Path, position: &Series) -> Result<Clock, ExperimentError> {
    let Some(source) = &description.time else {
        return Ok(Clock::uniform(description.sample_rate_hz.unwrap_or_default()));
    };
    let time = recording::read_channels(source, data)?;
    let time = of_all_channels(time, source, &source.path(data))?;
    recording::one_channel(&time, "time", &source.path(data))?;
    recording::same_length(position, "position", &description.position.path(data), &time, "time", &source.path(data))?;
    let column = source.columns.first().map_or("time", String::as_str);
    Ok(Clock::from_stamps(time.channel(0), description.largest_jitter, &source.path(data), column)?)
}
