use std::{collections::BTreeMap, ops::Range, path::Path};

use super::{
    error::PreparationError,
    reference_correction::ReferenceCorrection,
    wrapped::{align, unwrap},
};
use thetahat_data::recording::{Clock, RecordingError, Resampling, same_length};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;
use thetahat_model::robot::{JointKind, Robot};

/// Positions and torques of the joints at equal time steps, and what else was recorded with them.
///
/// All series have one channel for each coordinate of the robot and the same number of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Its name in tables and messages; empty takes its number.
    pub name: String,
    /// Weight of its rows relative to those of other recordings.
    pub weight: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// The times as they were recorded, s.
    pub time_stamps_s: Option<Vec<f64>>,
    /// How the recording was brought to equal steps, where it had none.
    pub resampling: Option<Resampling>,
    /// Samples that were not recorded, in ranges that rise: the series go on smoothly there. Their rows are left out of the
    /// regression, with those that a filter made of them.
    pub gaps: Vec<Range<usize>>,
    /// Coordinates and samples that make no rows, because what acts on them is not known: those of a base that is held, or of legs
    /// with a contact that was not measured.
    #[doc(hidden)]
    pub unused_rows: Vec<(Range<usize>, Range<usize>)>,
    /// Why these are not known, in sentences.
    #[doc(hidden)]
    pub notes_of_base: Vec<String>,
    /// Whether the unit of some of its positions is a guess.
    #[doc(hidden)]
    pub position_unit_guessed: bool,
    /// Whether the unit of its torques is a guess from the masses of the description.
    #[doc(hidden)]
    pub torque_unit_guessed: bool,
    /// The least delay that was stated of its torques, and taken off, s.
    #[doc(hidden)]
    pub torque_delay_s: f64,
    /// A column of times in its file and their rate, Hz, where another rate is stated.
    pub contradicting_times: Option<(String, f64)>,
    /// What was changed when it was read, in sentences: angles unwrapped, copies left out, a coarse clock.
    pub notes: Vec<String>,
    /// Start and end of its window, s, where it is another one than that of the settings.
    pub window_s: [Option<f64>; 2],
    /// Positions of the joints, rad or m.
    pub position: Series,
    /// Torques of the joints, N m or N, where they were recorded.
    pub torque: Option<Series>,
    /// Time for which a recorded torque holds, s, as that of a sampled controller does: the time between its samples. Zero for a
    /// torque that was measured at its instant.
    pub torque_hold_s: f64,
    /// Velocities of the joints, rad/s or m/s, which the checks compare with the positions; nothing else uses them.
    pub velocity: Option<Series>,
    /// The reference of the positions.
    pub reference: Option<Series>,
    /// A signal that was added to the drive signals of the motors after the controller; the torques include it.
    pub added_signal: Option<Series>,
    /// Other channels by name, as the robot's torque terms take them, such as temperatures: one channel, or one for each
    /// coordinate.
    pub channels: BTreeMap<String, Series>,
    /// Whether positions or torques came through the transmission.
    pub geared: bool,
    /// The payload of the settings that the robot carries, by its name.
    pub payload: Option<String>,
    /// The moves of a simulated recording.
    pub planned: Option<Moves>,
    /// The true standard parameters of a simulated recording.
    pub truth: Option<Vec<f64>>,
}

/// The note on wrapped angles.
pub(crate) fn note_of_wraps(joint: &str, count: usize) -> String {
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    format!("the angle of {joint} wraps {times} by one turn: it was unwrapped")
}

impl Recording {
    /// Positions and torques of the joints, sampled at equal steps.
    #[must_use]
    pub fn new(sample_rate_hz: f64, position: Series, torque: Series) -> Self {
        Self { torque: Some(torque), ..Self::without_torque(sample_rate_hz, position) }
    }

    /// Positions of the joints, sampled at equal steps, of a motion whose torques were not recorded: CLOE alone estimates
    /// from them.
    #[must_use]
    pub fn without_torque(sample_rate_hz: f64, position: Series) -> Self {
        Self {
            name: String::new(),
            weight: 1.0,
            sample_rate_hz,
            time_stamps_s: None,
            resampling: None,
            gaps: Vec::new(),
            unused_rows: Vec::new(),
            notes_of_base: Vec::new(),
            position_unit_guessed: false,
            torque_unit_guessed: false,
            torque_delay_s: 0.0,
            contradicting_times: None,
            notes: Vec::new(),
            window_s: [None, None],
            position,
            torque: None,
            torque_hold_s: 0.0,
            velocity: None,
            reference: None,
            added_signal: None,
            channels: BTreeMap::new(),
            geared: false,
            payload: None,
            planned: None,
            truth: None,
        }
    }

    /// Positions and torques of the joints at time stamps in s, whose steps may deviate from the usual one by up to half of
    /// it; longer ones are gaps.
    ///
    /// # Errors
    /// [`RecordingError`] for stamps that do not rise, or without a usual step, and for series of other lengths.
    pub fn at_times(time_s: Vec<f64>, position: Series, torque: Series) -> Result<Self, RecordingError> {
        Self::new(1.0, position, torque).with_time_stamps(time_s)
    }

    /// The same with every series at these time stamps in s, as of [`Recording::at_times`], in the place of equal steps.
    ///
    /// # Errors
    /// As [`Recording::at_times`].
    pub fn with_time_stamps(self, time_s: Vec<f64>) -> Result<Self, RecordingError> {
        let (source, times) = (Path::new("arrays"), Series::shaped(1, time_s));
        let optional = [("torque", &self.torque), ("velocity", &self.velocity), ("reference", &self.reference)];
        let named = optional.into_iter().chain([("added signal", &self.added_signal)]);
        let channels = self.channels.iter().map(|(name, series)| (name.as_str(), series));
        let all = named.filter_map(|(name, series)| Some((name, series.as_ref()?))).chain(channels);
        for (name, series) in [("position", &self.position)].into_iter().chain(all) {
            same_length(&times, "time", source, series, name, source)?;
        }
        let clock = Clock::from_stamps(times.channel(0), LARGEST_JITTER, source, "time_s")?;
        let recording = Self { sample_rate_hz: clock.sample_rate_hz(), ..self };
        Ok(Self { time_stamps_s: clock.stamps().map(<[f64]>::to_vec), ..recording.into_equal_steps(&clock) })
    }

    /// The same with torques that hold until the next sample, as a sampled controller's drive signals do: what acts around a
    /// sample is the mean of its own torque and the one before.
    #[must_use]
    pub fn with_held_torque(self) -> Self {
        Self { torque_hold_s: 1.0 / self.sample_rate_hz, ..self }
    }

    /// The part of a step for which its torque holds, at most one.
    pub(crate) fn held_part_of_step(&self) -> f64 {
        (self.torque_hold_s * self.sample_rate_hz).clamp(0.0, 1.0)
    }

    /// The same with the reference of the positions.
    #[must_use]
    pub fn with_reference(self, reference: Series) -> Self {
        Self { reference: Some(reference), ..self }
    }

    /// The same with its reference put right, where it has one.
    #[must_use]
    pub fn with_corrected_reference(self, correction: &ReferenceCorrection) -> Self {
        let rate = self.sample_rate_hz;
        Self { reference: self.reference.map(|reference| correction.apply(&reference, rate)), ..self }
    }

    /// The same with a recorded channel that the robot's torque terms take, such as a temperature: one for all coordinates,
    /// or one for each.
    #[must_use]
    pub fn with_channel(mut self, name: &str, channel: Series) -> Self {
        self.channels.insert(name.to_owned(), channel);
        self
    }

    /// The same with a name for tables and messages.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// The same with the turns that wrapped angles of the joints lost, which its notes name.
    pub(crate) fn unwrapped(mut self, robot: &Robot) -> Self {
        let joints: Vec<_> = robot.coordinates().collect();
        let is_angle = |c: usize| joints.get(c).is_some_and(|joint| joint.kind == JointKind::Revolute);
        let found = unwrap(&mut self.position, is_angle);
        if let Some(reference) = &mut self.reference {
            unwrap(reference, is_angle);
            let changed = |c: usize| found.iter().any(|w| w.channel == c);
            align(reference, &self.position, changed);
        }
        self.notes.extend(found.iter().map(|w| note_of_wraps(&joints[w.channel].name, w.count)));
        self
    }

    /// The same with something taken off its torques, where it has any.
    pub(crate) fn less_torque(mut self, part: &Series) -> Self {
        if let Some(torque) = &mut self.torque {
            for k in 0..torque.len() {
                torque.sample_mut(k).iter_mut().zip(part.sample(k)).for_each(|(tau, part)| *tau -= part);
            }
        }
        self
    }

    /// Every series at the equal steps of a clock.
    pub(crate) fn into_equal_steps(self, clock: &Clock) -> Self {
        let even = |series: Option<Series>| series.map(|s| clock.to_equal_steps(s));
        Self {
            resampling: clock.resampling(),
            gaps: clock.gaps().to_vec(),
            position: clock.to_equal_steps(self.position),
            torque: even(self.torque),
            velocity: even(self.velocity),
            reference: even(self.reference),
            added_signal: even(self.added_signal),
            channels: self.channels.into_iter().map(|(name, s)| (name, clock.to_equal_steps(s))).collect(),
            ..self
        }
    }

    /// Refuses series that do not fit the robot or one another, and values that are no numbers.
    ///
    /// # Errors
    /// [`PreparationError`], which names the recording, the signal, what was expected and what was found.
    pub(crate) fn validate(&self, coordinates: usize) -> Result<(), PreparationError> {
        PreparationError::require_positive("sample_rate_hz", self.sample_rate_hz)?;
        PreparationError::require_positive("weight", self.weight)?;
        let (hold, expected) = (self.torque_hold_s, "zero or a finite number above it");
        PreparationError::require(hold >= 0.0 && hold.is_finite(), "torque_hold_s", expected, hold)?;
        for (signal, series) in self.signals() {
            if series.channels() != coordinates {
                return Err(self.joint_count(signal, coordinates, series));
            }
            self.validate_samples(signal, series)?;
        }
        for (name, series) in &self.channels {
            if series.channels() != 1 && series.channels() != coordinates {
                return Err(self.column_count(name, coordinates, series));
            }
            self.validate_samples(&format!("channel {name}"), series)?;
        }
        Ok(())
    }

    /// Its series by name, those alone that have one channel for each coordinate.
    fn signals(&self) -> impl Iterator<Item = (&'static str, &Series)> {
        let optional = [
            ("torque", &self.torque),
            ("velocity", &self.velocity),
            ("reference", &self.reference),
            ("added_signal", &self.added_signal),
        ];
        let present = optional.into_iter().filter_map(|(signal, series)| Some((signal, series.as_ref()?)));
        [("position", &self.position)].into_iter().chain(present)
    }

    fn validate_samples(&self, signal: &str, series: &Series) -> Result<(), PreparationError> {
        let (expected, found) = (self.position.len(), series.len());
        if found != expected {
            let (recording, signal) = (self.name.clone(), signal.to_owned());
            return Err(PreparationError::SampleCount { recording, signal, expected, found });
        }
        match series.values().iter().position(|v| !v.is_finite()) {
            Some(place) => Err(self.not_finite(signal, place, series)),
            None => Ok(()),
        }
    }

    fn joint_count(&self, signal: &str, expected: usize, series: &Series) -> PreparationError {
        let place = format!("recording {}, {signal}", self.name);
        PreparationError::JointCount { place, expected, found: series.channels() }
    }

    fn column_count(&self, channel: &str, expected: usize, series: &Series) -> PreparationError {
        let (recording, channel, found) = (self.name.clone(), channel.to_owned(), series.channels());
        PreparationError::ColumnCount { recording, channel, expected, found }
    }

    fn not_finite(&self, signal: &str, place: usize, series: &Series) -> PreparationError {
        PreparationError::NotFinite {
            recording: self.name.clone(),
            signal: signal.to_owned(),
            column: place % series.channels() + 1,
            sample: place / series.channels(),
            found: series.values()[place],
        }
    }

    /// The channels of these names side by side, as the dynamics take them: one for each coordinate of each.
    pub(crate) fn channels_named(
        &self,
        names: &[String],
        coordinates: usize,
    ) -> Result<Option<Series>, PreparationError> {
        let mut columns = Vec::new();
        for name in names {
            let Some(series) = self.channels.get(name) else {
                let key = format!("recording {}: channels.{name}", self.name);
                let expected = "the recorded channel that a [[term]] of the robot takes";
                return Err(PreparationError::value(&key, expected, "missing"));
            };
            columns.extend((0..coordinates).map(|c| series.channel(if series.channels() == 1 { 0 } else { c })));
        }
        Ok((!columns.is_empty()).then(|| Series::side_by_side(&columns)))
    }
}

/// Largest deviation of a time step from the usual one, in steps; a longer step is a gap.
const LARGEST_JITTER: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;

    fn series(values: &[f64]) -> Series {
        Series::shaped(1, values.to_vec())
    }

    fn good() -> Recording {
        Recording::new(100.0, series(&[0.0, 1.0]), series(&[0.0, 1.0])).named("a")
    }

    #[test]
    fn series_that_fit_are_taken() {
        assert!(good().validate(1).is_ok());
    }

    #[test]
    fn a_wrong_number_of_joints_is_a_joint_count() {
        let error = good().validate(2).unwrap_err();
        let PreparationError::JointCount { place, expected, found } = &error else { panic!("{error}") };
        assert_eq!((place.as_str(), *expected, *found), ("recording a, position", 2, 1));
    }

    #[test]
    fn a_channel_of_other_columns_is_a_column_count() {
        let two = Recording { position: Series::zeros(2, 3), torque: None, ..good() };
        let error = two.with_channel("oil", Series::zeros(2, 2)).validate(3).unwrap_err();
        assert!(matches!(error, PreparationError::ColumnCount { expected: 3, found: 2, .. }), "{error}");
    }

    #[test]
    fn a_wrong_length_is_a_sample_count() {
        let error = Recording { torque: Some(series(&[0.0])), ..good() }.validate(1).unwrap_err();
        let PreparationError::SampleCount { signal, expected, found, .. } = &error else { panic!("{error}") };
        assert_eq!((signal.as_str(), *expected, *found), ("torque", 2, 1));
    }

    #[test]
    fn a_value_that_is_not_finite_has_its_place() {
        let error = Recording { torque: Some(series(&[0.0, f64::NAN])), ..good() }.validate(1).unwrap_err();
        let PreparationError::NotFinite { signal, column, sample, found, .. } = &error else { panic!("{error}") };
        assert_eq!((signal.as_str(), *column, *sample), ("torque", 1, 1));
        assert!(found.is_nan());
    }

    #[test]
    fn a_rate_of_zero_is_not_positive() {
        let error = Recording { sample_rate_hz: 0.0, ..good() }.validate(1).unwrap_err();
        assert!(
            matches!(&error, PreparationError::NotPositive { key, found: 0.0 } if key == "sample_rate_hz"),
            "{error}"
        );
    }

    #[test]
    fn uneven_steps_are_brought_to_equal_ones() {
        let time: Vec<f64> = (0..200).map(|k| 0.01 * (f64::from(k) + 0.2 * f64::from(k).sin())).collect();
        let position = series(&time.iter().map(|t| 3.0 * t).collect::<Vec<_>>());
        let recording = Recording::at_times(time, position.clone(), position).unwrap();
        assert!((recording.sample_rate_hz - 100.0).abs() < 0.5 && recording.resampling.is_some());
        let steps: Vec<f64> = recording.position.values().windows(2).map(|w| w[1] - w[0]).collect();
        assert!(steps[1..198].iter().all(|s| (s - steps[100]).abs() < 1e-9));
    }

    #[test]
    fn every_series_goes_along_with_the_time_stamps() {
        let time: Vec<f64> = (0..200).map(|k| 0.01 * (f64::from(k) + 0.2 * f64::from(k).sin())).collect();
        let ramp = series(&time);
        let recording = Recording::new(1.0, ramp.clone(), ramp.clone()).with_reference(ramp.clone());
        let recording = recording.with_channel("temperature", ramp.clone()).with_time_stamps(time.clone()).unwrap();
        assert_eq!(recording.reference.as_ref(), Some(&recording.position));
        assert_eq!(recording.channels["temperature"], recording.position);
        assert_ne!(recording.position, ramp);
        let short = Recording::new(1.0, ramp.clone(), ramp.clone()).with_reference(ramp.window(0..199));
        assert!(matches!(short.with_time_stamps(time), Err(RecordingError::DifferentLengths { .. })));
    }
}
