//! What an experiment file must hold before anything is read or run.

use super::{
    base::BaseDescription,
    description::{Experiment, RecordingDescription, TwinDescription},
    error::ExperimentError,
};
use crate::preparation::{PreparationError, validate_window};
use thetahat_data::recording::{ChannelSource, Dimension, Side};
use thetahat_model::robot::{EXPECTED_GRAVITY, JointKind, is_gravity};

/// Longest rest of a twin, s.
const LONGEST_REST_S: f64 = 3600.0;

/// Longest time constant of a filter of the torques, s.
const LONGEST_FILTER_S: f64 = 1.0;
/// Longest delay of a signal, s.
const LONGEST_DELAY_S: f64 = 60.0;

/// What is measured of a joint that turns, and of one that slides.
const POSITION: [Dimension; 2] = [Dimension::Angle, Dimension::Length];
const VELOCITY: [Dimension; 2] = [Dimension::AngularVelocity, Dimension::LinearVelocity];
const EFFORT: [Dimension; 2] = [Dimension::Torque, Dimension::Force];
const DRIVE: [Dimension; 5] =
    [Dimension::Torque, Dimension::Force, Dimension::Voltage, Dimension::Current, Dimension::Dimensionless];

impl Experiment {
    pub(super) fn validate(&self) -> Result<(), ExperimentError> {
        match (&self.file.recording[..], &self.file.twin) {
            ([], Some(twin)) => self.validate_twin(twin)?,
            ([_, ..], None) => {}
            _ => {
                let why = "exactly one of the two gives the motion and torques";
                return Err(self.missing("[recording] or [twin]", why));
            }
        }
        if let Some(gravity) = self.file.gravity {
            self.require(is_gravity(gravity), "gravity", EXPECTED_GRAVITY, format!("{gravity:?}"))?;
        }
        for recording in self.file.recording.iter().chain(&self.file.validation) {
            self.validate_recording(recording)?;
        }
        self.settings.validate(&self.robot).map_err(|e| self.refuse(e))
    }

    fn validate_recording(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        self.validate_units(recording)?;
        self.require_positive("[recording] weight", recording.weight)?;
        self.validate_times(recording)?;
        if let Some(correction) = &recording.reference_correction {
            correction.validate(self.robot.coordinate_count()).map_err(|e| self.refuse(e))?;
            let why = "reference_correction puts a recorded reference right";
            recording.reference.as_ref().map(|_| ()).ok_or_else(|| self.missing("[recording] reference", why))?;
        }
        self.validate_delays(recording)?;
        self.validate_keys_of_torque(recording)
    }

    fn validate_units(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        self.validate_unit(&recording.position, "position", &POSITION, POSITION)?;
        if let Some(torque) = &recording.torque {
            self.validate_unit(torque, "torque", &DRIVE, EFFORT)?;
        }
        if let Some(velocity) = &recording.velocity {
            self.validate_unit(velocity, "velocity", &VELOCITY, VELOCITY)?;
        }
        if let Some(reference) = &recording.reference {
            self.validate_unit(reference, "reference", &POSITION, POSITION)?;
        }
        if let Some(signal) = &recording.added_signal {
            signal.require_dimension("added signal", &DRIVE)?;
        }
        Ok(recording.base.iter().try_for_each(BaseDescription::require_units)?)
    }

    /// The clock, the window and the times that are left out.
    fn validate_times(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        let jitter = recording.largest_jitter;
        self.require((0.0..=1.0).contains(&jitter), "[recording] largest_jitter", "from 0 to 1 steps", jitter)?;
        let window = [recording.window_start_s, recording.window_end_s];
        validate_window("[recording]", window).map_err(|e| self.refuse(e))?;
        for [from, to] in &recording.left_out_s {
            let is_interval = *from >= 0.0 && to > from && to.is_finite();
            let found = format!("[{from}, {to}]");
            self.require(is_interval, "[recording] left_out_s", "pairs of a start and a later end", found)?;
        }
        if let Some(time) = &recording.time {
            let expected = "0: signals are late, not times";
            self.require(!time.is_delayed(), "[recording] time: delay_s", expected, "another number")?;
            time.require_dimension("time", &[Dimension::Time])?;
        }
        match (recording.sample_rate_hz, &recording.time) {
            (Some(rate), None) => self.require_positive("[recording] sample_rate_hz", rate),
            (None, Some(_)) => Ok(()),
            (Some(_), Some(_)) => {
                Err(self.refuse_value("[recording] the rate", "either sample_rate_hz or time", "given by both"))
            }
            (None, None) => Err(self.missing("[recording] sample_rate_hz or time", "one of the two gives the rate")),
        }
    }

    fn validate_delays(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        let n = self.robot.coordinate_count();
        let optional = [&recording.torque, &recording.velocity, &recording.reference, &recording.added_signal];
        for source in optional.into_iter().flatten().chain([&recording.position]) {
            self.validate_delay(source)?;
            let expected = format!("one number, or a list of {n}");
            let found = format!("a list of {}", source.delay_s.given().len());
            self.require(source.delay_s.fits(n), "[recording] delay_s", &expected, found)?;
        }
        for source in recording.channels.values() {
            self.validate_delay(source)?;
            self.require(source.delay_s.given().len() == 1, "[recording.channels] delay_s", "one number", "a list")?;
        }
        Ok(())
    }

    fn validate_delay(&self, source: &ChannelSource) -> Result<(), ExperimentError> {
        let is_short = |delay: &&f64| delay.abs() <= LONGEST_DELAY_S;
        match source.delay_s.given().iter().find(|delay| !is_short(delay)) {
            Some(delay) => Err(self.refuse_value("[recording] delay_s", "from -60 to 60 s", delay)),
            None => Ok(()),
        }
    }

    /// Other signals have no keys that only a torque, or a torque and a position, have.
    fn validate_keys_of_torque(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        let optional = [&recording.velocity, &recording.reference, &recording.added_signal].into_iter().flatten();
        let others: Vec<&ChannelSource> = optional.chain(recording.channels.values()).collect();
        let held = recording.position.held || others.iter().any(|source| source.held);
        self.require(!held, "[recording] held", "for the torque alone", held)?;
        let filters: Vec<f64> =
            others.iter().chain([&&recording.position]).filter_map(|source| source.low_pass_s).collect();
        self.require(filters.is_empty(), "[recording] low_pass_s", "for the torque alone", "that of another signal")?;
        if let Some(time_s) = recording.torque.as_ref().and_then(|torque| torque.low_pass_s) {
            let is_filter = time_s > 0.0 && time_s <= LONGEST_FILTER_S;
            self.require(is_filter, "[recording] torque: low_pass_s", "above 0, and at most 1 s", time_s)?;
        }
        let guessed = others.iter().any(|source| source.unit_guessed);
        self.require(!guessed, "[recording] unit_guessed", "for position and torque alone", guessed)
    }

    /// On the joint side, and without gains that convert them, values have a dimension of `joints`: revolute or
    /// prismatic.
    fn validate_unit(
        &self,
        source: &ChannelSource,
        signal: &str,
        any: &[Dimension],
        joints: [Dimension; 2],
    ) -> Result<(), ExperimentError> {
        if source.side == Side::Motor || source.gain.is_some() {
            return Ok(source.require_dimension(signal, any)?);
        }
        let [angular, linear] = joints;
        let dimension = |kind| match kind {
            JointKind::Revolute => angular,
            JointKind::Prismatic => linear,
        };
        let joints: Vec<(&str, Dimension)> =
            self.robot.coordinates().filter(|j| !j.of_base).map(|j| (j.name.as_str(), dimension(j.kind))).collect();
        Ok(source.require_dimensions(signal, &joints)?)
    }

    fn validate_twin(&self, twin: &TwinDescription) -> Result<(), ExperimentError> {
        let n = self.robot.coordinate_count();
        let (key, expected) =
            ("[twin]", "a robot whose base is fixed: a twin's loop moves its joints, and nothing would move the base");
        self.require(self.robot.base_coordinates() == 0, key, expected, "a base that floats")?;
        let sensors = &twin.sensors;
        let lists = [
            ("sensors.torque_noise", &sensors.torque_noise),
            ("sensors.position_noise", &sensors.position_noise),
            ("sensors.torque_ripple", &sensors.torque_ripple),
        ];
        let points = twin.points.iter().map(|p| ("points", p));
        let of_moves = twin.reference.is_none().then_some(("max_velocity", &twin.max_velocity));
        for (key, list) in of_moves.into_iter().chain(lists).chain(points) {
            let key = format!("[twin] {key}");
            self.require(list.len() == n, &key, &format!("a list of {n}, one for each joint"), entries(list.len()))?;
            self.require_finite(&key, list.iter().copied())?;
        }
        for (key, list) in lists {
            if let Some(value) = list.iter().find(|v| **v < 0.0) {
                return Err(self.refuse_value(&format!("[twin] {key}"), "zero or above", value));
            }
        }
        match &twin.reference {
            Some(source) => {
                self.require(
                    twin.points.is_empty(),
                    "[twin] points",
                    "none with a reference",
                    entries(twin.points.len()),
                )?;
                self.validate_unit(source, "[twin] reference", &POSITION, POSITION)?;
            }
            None => {
                let expected = "a start and an end point";
                self.require(twin.points.len() > 1, "[twin] points", expected, entries(twin.points.len()))?;
            }
        }
        self.require_positive("[twin] sample_rate_hz", twin.sample_rate_hz)?;
        self.require_positive("[twin] sensors.encoder_counts_per_turn", sensors.encoder_counts_per_turn)?;
        self.require_finite("[twin] sensors.ripple_per_turn", [sensors.ripple_per_turn])?;
        for (name, &value) in &twin.parameters {
            self.require_finite(&format!("[twin.parameters] {name}"), [value])?;
        }
        self.require((0.0..=LONGEST_REST_S).contains(&twin.rest_s), "[twin] rest_s", "from 0 to 3600", twin.rest_s)?;
        let why = "the twin moves under its control";
        let controller = self.settings.controller.as_ref().ok_or_else(|| self.missing("[controller]", why))?;
        let expected = "\"pd\" or \"cascaded\" with [twin]: nothing is recorded that moves it in an open loop";
        self.require(!controller.is_open_loop(), "[controller] law", expected, "\"open-loop\"")
    }

    fn refuse_value(&self, key: &str, expected: &str, found: impl std::fmt::Display) -> ExperimentError {
        self.refuse(PreparationError::value(key, expected, found))
    }

    fn require(
        &self,
        holds: bool,
        key: &str,
        expected: &str,
        found: impl std::fmt::Display,
    ) -> Result<(), ExperimentError> {
        PreparationError::require(holds, key, expected, found).map_err(|e| self.refuse(e))
    }

    fn require_positive(&self, key: &str, value: f64) -> Result<(), ExperimentError> {
        PreparationError::require_positive(key, value).map_err(|e| self.refuse(e))
    }

    fn require_finite(&self, key: &str, values: impl IntoIterator<Item = f64>) -> Result<(), ExperimentError> {
        match values.into_iter().find(|v| !v.is_finite()) {
            Some(value) => Err(self.refuse(PreparationError::value(key, "finite numbers", value))),
            None => Ok(()),
        }
    }
}

fn entries(count: usize) -> String {
    format!("a list of {count}")
}
