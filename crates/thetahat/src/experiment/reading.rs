//! Recordings read from their files, on the joint side and at equal time steps.

use std::{collections::BTreeMap, path::Path};

use super::{
    arrival_times::equal_times,
    base::BaseDescription,
    copies::{selected, without_copies},
    delays::without_delays,
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
    floating::after_base,
    low_pass::before_low_pass,
    missing_values::complete_samples,
    repeated_rows::{bridged, repeated_rows},
    straight_lines::{Straightened, without_straight_lines},
};
use crate::preparation::{PreparationError, Recording, unwrap};
use thetahat_data::recording::{self, ChannelSource, Clock, Dimension, RecordingError, Side};
use thetahat_estimation::identification::Response;
use thetahat_ground::series::Series;

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
        let position = self.with_pose_of_base(description, data, position)?;
        let optional = |source: &Option<ChannelSource>, read: &dyn Fn(&ChannelSource) -> Result<Series, _>| {
            source.as_ref().map(read).transpose()
        };
        let torque = optional(&description.torque, &|s| self.read_torques(s, data))?;
        if let Some((torque, source)) = torque.as_ref().zip(description.torque.as_ref()) {
            recording::not_all_zero(torque, "torque", &source.path(data))?;
        }
        let velocity = optional(&description.velocity, &|s| self.read_joint_velocities(s, data))?;
        let reference = optional(&description.reference, &|s| self.read_joint_positions(s, data))?;
        let (reference, notes) = self.reference_of_recording(description, data, reference, &position);
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
        let channels = read_other_channels(description, data, &position)?;
        let times = read_times(description, data, &position)?;
        let read = Recording {
            torque,
            velocity,
            reference,
            added_signal,
            channels,
            notes,
            ..Recording::without_torque(1.0, position)
        };
        let (read, times) = with_complete_samples(description, data, (read, times))?;
        let (read, times) = with_samples_once(read, times);
        let (read, clock) = clock_of_read(description, data, without_lines(with_repeats_bridged(read)), times)?;
        let recording = described(description, number, data, read, &clock);
        let is_held = description.torque.as_ref().is_some_and(|torque| torque.held);
        let mut recording = if is_held { recording.with_held_torque() } else { recording };
        recording.position_unit_guessed = description.position.unit_guessed;
        recording.torque_unit_guessed = description.torque.as_ref().is_some_and(|torque| torque.unit_guessed);
        recording.torque_delay_s = description.torque.as_ref().map_or(0.0, ChannelSource::least_delay_s);
        let recording = recording.unwrapped(&self.robot);
        let recording = without_filter(recording.into_equal_steps(&clock), description);
        let recording = without_delays(recording, description);
        let recording = without_intervals(recording, &description.left_out_s).map_err(|e| self.refuse(e))?;
        let recording = self.with_contacts(description, recording)?;
        Ok(match &description.reference_correction {
            Some(correction) => recording.with_corrected_reference(correction),
            None => recording,
        })
    }

    /// The reference, unless it is a planned motion in a file of its own that the recording does not follow sample by sample: a
    /// logger starts before the robot, and has a clock of its own. Torques are fitted without it, which a note says.
    fn reference_of_recording(
        &self,
        description: &RecordingDescription,
        data: &Path,
        reference: Option<Series>,
        position: &Series,
    ) -> (Option<Series>, Vec<String>) {
        let Some((source, series)) = description.reference.as_ref().zip(reference.as_ref()) else {
            return (reference, Vec::new());
        };
        let fits_positions = self.settings.all_methods().into_iter().any(|m| m.response() != Response::Torque);
        let has_own_file = source.path(data) != description.position.path(data);
        if fits_positions || !has_own_file || series.len() == position.len() {
            return (reference, Vec::new());
        }
        let note = format!(
            "the reference has {} samples, the positions have {}: it was left out, as the two have not one clock; record both in \
             one file",
            series.len(),
            position.len()
        );
        (None, vec![note])
    }

    /// Reads a motion whose torques were not recorded.
    pub(super) fn read_motion(
        &self,
        description: &RecordingDescription,
        data: &Path,
    ) -> Result<Recording, ExperimentError> {
        let position = self.read_joint_positions(&description.position, data)?;
        let position = self.with_pose_of_base(description, data, position)?;
        let channels = read_other_channels(description, data, &position)?;
        let times = read_times(description, data, &position)?;
        let read = Recording { channels, ..Recording::without_torque(1.0, position) };
        let (read, times) = with_complete_samples(description, data, (read, times))?;
        let (read, times) = with_samples_once(read, times);
        let (read, clock) = clock_of_read(description, data, without_lines(with_repeats_bridged(read)), times)?;
        let recording = described(description, 1, data, read, &clock);
        let recording = recording.unwrapped(&self.robot);
        self.with_contacts(description, without_delays(recording.into_equal_steps(&clock), description))
    }

    fn read_joint_velocities(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = self.read_channels(source, data)?;
        Ok(match source.side {
            Side::Motor => self.robot.transmission.joint_velocities(&series),
            Side::Joint => series,
        })
    }

    /// Positions of the joints. Angles of motors that wrap are unwrapped before the gears, after which they show no turns.
    pub(super) fn read_joint_positions(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let mut series = self.read_channels(source, data)?;
        Ok(match source.side {
            Side::Motor => {
                unwrap(&mut series, |channel| source.unit.of(channel).dimension() == Dimension::Angle);
                self.robot.transmission.joint_positions(&series)
            }
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

    /// Channels of the joints, with NaN where a value is missing.
    fn read_channels(&self, source: &ChannelSource, data: &Path) -> Result<Series, ExperimentError> {
        let series = recording::read_channels_with_missing_values(source, data)?;
        let base = self.robot.base_coordinates();
        let (expected, found) = (self.robot.coordinate_count() - base, series.channels());
        if found == expected {
            return Ok(if base == 0 { series } else { after_base(&series, base) });
        }
        let place = source.path(data).display().to_string();
        Err(self.refuse(PreparationError::JointCount { place, expected, found }))
    }
}

/// The recording with the torques before their filter.
fn without_filter(recording: Recording, description: &RecordingDescription) -> Recording {
    let filter_s = description.torque.as_ref().and_then(|torque| torque.low_pass_s);
    let Some((torque, filter_s)) = recording.torque.as_ref().zip(filter_s) else { return recording };
    let torque = before_low_pass(torque, filter_s * recording.sample_rate_hz);
    Recording { torque: Some(torque), ..recording }
}

/// The recording without samples that were written twice, which its notes name.
fn with_samples_once(mut read: Recording, times: Option<Vec<f64>>) -> (Recording, Option<Vec<f64>>) {
    let Some(all) = &times else { return (read, times) };
    let optional = [&read.torque, &read.velocity, &read.reference, &read.added_signal];
    let series: Vec<&Series> =
        [&read.position].into_iter().chain(optional.into_iter().flatten()).chain(read.channels.values()).collect();
    let Some(kept) = without_copies(all, &series) else { return (read, times) };
    let copies = all.len() - kept.len();
    let (are, the) = if copies == 1 { ("sample is a copy", "was") } else { ("samples are copies", "were") };
    read.notes.push(format!("{copies} {are} of the one before, with its time, and {the} left out"));
    let times = kept.iter().map(|&k| all[k]).collect();
    (of_samples(read, &kept), Some(times))
}

/// Some samples of a recording that was read.
fn of_samples(mut read: Recording, kept: &[usize]) -> Recording {
    read.position = selected(&read.position, kept);
    for series in [&mut read.torque, &mut read.velocity, &mut read.reference, &mut read.added_signal] {
        *series = series.as_ref().map(|s| selected(s, kept));
    }
    read.channels.values_mut().for_each(|s| *s = selected(s, kept));
    read
}

/// The recording without samples that lack a value, which its notes name: they are gaps.
fn with_complete_samples(
    description: &RecordingDescription,
    data: &Path,
    (mut read, times): (Recording, Option<Vec<f64>>),
) -> Result<(Recording, Option<Vec<f64>>), ExperimentError> {
    let channel = |(name, source): (String, _)| Some((source, read.channels.get(&name)?));
    let time = times.as_ref().map(|times| Series::shaped(1, times.clone()));
    let signals = [
        description.time.as_ref().zip(time.as_ref()),
        Some((&description.position, &read.position)),
        description.torque.as_ref().zip(read.torque.as_ref()),
        description.velocity.as_ref().zip(read.velocity.as_ref()),
        description.reference.as_ref().zip(read.reference.as_ref()),
        description.added_signal.as_ref().zip(read.added_signal.as_ref()),
    ];
    let of_base = description.base.iter().flat_map(BaseDescription::channels);
    let named = description.channels.iter().map(|(name, source)| (name.clone(), source)).chain(of_base);
    let signals: Vec<_> = signals.into_iter().flatten().chain(named.filter_map(channel)).collect();
    let Some(complete) = complete_samples(&signals, data)? else { return Ok((read, times)) };
    let samples = read.position.len();
    read.notes.push(format!(
        "{} of {samples} samples lack a value (an empty cell or NaN), and were left out as gaps",
        samples - complete.len()
    ));
    let rate = description.sample_rate_hz.unwrap_or(1.0);
    let time = |k: &usize| times.as_ref().map_or(*k as f64 / rate, |times| times[*k]);
    let times = complete.iter().map(time).collect();
    Ok((of_samples(read, &complete), Some(times)))
}

/// The recording with the rows interpolated that a logger repeated, which its notes name.
fn with_repeats_bridged(mut read: Recording) -> Recording {
    let Some(repeated) = repeated_rows(&read.position, read.torque.as_ref()) else { return read };
    read.notes.push(format!(
        "{} of {} samples repeat the positions of the one before while the robot moves, as where a logger asks more often than there are \
         new values: repeated values were replaced by ones interpolated between the new ones",
        repeated.len(),
        read.position.len()
    ));
    read.position = bridged(&read.position, &repeated);
    for series in [&mut read.torque, &mut read.velocity, &mut read.reference, &mut read.added_signal] {
        *series = series.as_ref().map(|s| bridged(s, &repeated));
    }
    read
}

/// The recording with cubics through the values that a logger joined by straight lines, which its notes name.
fn without_lines(mut read: Recording) -> Recording {
    let mut replace = |what: &str, series: &mut Series| {
        let Some(Straightened { series: cubic, on_lines }) = without_straight_lines(series) else { return };
        read.notes.push(format!(
            "{on_lines} of {} samples of the {what} lie on straight lines between the others, as where a logger interpolates values of a \
             lower rate: cubics through the others were taken instead",
            series.len()
        ));
        *series = cubic;
    };
    replace("positions", &mut read.position);
    if let Some(torque) = &mut read.torque {
        replace("torques", torque);
    }
    read
}

/// The clock of a recording, with equal steps where its stamps are times of arrival, which its notes name.
fn clock_of_read(
    description: &RecordingDescription,
    data: &Path,
    mut read: Recording,
    times: Option<Vec<f64>>,
) -> Result<(Recording, Clock), ExperimentError> {
    let clock = clock_of(description, data, times.clone())?;
    let Some(equal) = times.and_then(|times| equal_times(&times, &clock, &read.position)) else {
        return Ok((read, clock));
    };
    read.notes.push(
        "its time stamps are times of arrival: in their order its positions are smooth, and by their stamps rough; it is taken as sampled \
         at equal steps"
            .to_owned(),
    );
    Ok((read, clock_of(description, data, Some(equal))?))
}

/// The recording with gaps at intervals, s, that its description leaves out.
fn without_intervals(mut recording: Recording, intervals: &[[f64; 2]]) -> Result<Recording, PreparationError> {
    let (samples, rate) = (recording.position.len(), recording.sample_rate_hz);
    let sample = |seconds: f64| ((seconds * rate).round() as usize).min(samples);
    for [from, to] in intervals {
        let expected = format!("intervals that start before the recording ends, at {:.3} s", samples as f64 / rate);
        let found = format!("[{from}, {to}]");
        PreparationError::require(sample(*from) < samples, "[recording] left_out_s", &expected, found)?;
        recording.gaps.push(sample(*from)..sample(*to));
    }
    recording.gaps.retain(|gap| !gap.is_empty());
    recording.gaps.sort_unstable_by_key(|gap| gap.start);
    Ok(recording)
}

/// A recording with what its description says.
fn described(
    description: &RecordingDescription,
    number: usize,
    data: &Path,
    read: Recording,
    clock: &Clock,
) -> Recording {
    let stated = description.sample_rate_hz.filter(|_| description.time.is_none());
    let sources = [Some(&description.position), description.torque.as_ref()];
    let times = |stated| sources.into_iter().flatten().find_map(|s| recording::contradicting_times(s, data, stated));
    let contradicting_times = stated.and_then(times);
    Recording {
        name: description.name.clone().unwrap_or_else(|| number.to_string()),
        weight: description.weight,
        payload: description.payload.clone(),
        notes: read.notes.into_iter().chain(clock.coarse_tick_s().map(note_of_coarse_clock)).collect(),
        sample_rate_hz: clock.sample_rate_hz(),
        time_stamps_s: clock.stamps().map(<[f64]>::to_vec),
        contradicting_times,
        window_s: [description.window_start_s, description.window_end_s],
        geared: [Some(&description.position), description.torque.as_ref()]
            .into_iter()
            .flatten()
            .any(|s| s.side == Side::Motor),
        ..read
    }
}

fn note_of_coarse_clock(tick_s: f64) -> String {
    format!(
        "its clock has ticks of {:.3} ms, longer than the steps: the rate is the number of samples over their time",
        1e3 * tick_s
    )
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
    Ok(Series::shaped(1, (0..samples).map(mean).collect()))
}

/// The channels that the robot's torque terms take.
fn read_other_channels(
    description: &RecordingDescription,
    data: &Path,
    position: &Series,
) -> Result<BTreeMap<String, Series>, ExperimentError> {
    let read = |(name, source): (&String, &ChannelSource)| {
        let series = recording::read_channels_with_missing_values(source, data)?;
        let file = description.position.path(data);
        recording::same_length(position, "position", &file, &series, name, &source.path(data))?;
        Ok((name.clone(), series))
    };
    let of_base = description.base.iter().flat_map(BaseDescription::channels);
    let of_base = of_base.map(|(name, source)| read((&name, source)));
    description.channels.iter().map(read).chain(of_base).collect()
}

/// The recorded times in s; none if a rate is stated.
fn read_times(
    description: &RecordingDescription,
    data: &Path,
    position: &Series,
) -> Result<Option<Vec<f64>>, ExperimentError> {
    let Some(source) = &description.time else { return Ok(None) };
    let time = recording::read_channels_with_missing_values(source, data)?;
    let time = of_all_channels(time, source, &source.path(data))?;
    recording::one_channel(&time, "time", &source.path(data))?;
    recording::same_length(position, "position", &description.position.path(data), &time, "time", &source.path(data))?;
    Ok(Some(time.channel(0)))
}

fn clock_of(
    description: &RecordingDescription,
    data: &Path,
    times: Option<Vec<f64>>,
) -> Result<Clock, ExperimentError> {
    let Some(times) = times else {
        return Ok(Clock::uniform(description.sample_rate_hz.unwrap_or_default()));
    };
    // Times of a stated rate are those of the positions.
    let source = description.time.as_ref().unwrap_or(&description.position);
    let column = source.columns.first().map_or("time", String::as_str);
    Ok(Clock::from_stamps(times, description.largest_jitter, &source.path(data), column)?)
}
