//! What an experiment file must hold before anything is read or run.

use std::collections::BTreeSet;

use super::{Experiment, ExperimentError, ParameterChoice, RecordingDescription, description::TwinDescription};
use crate::{
    identification::Method,
    recording::{ChannelSource, Quantity, Side},
    robot::JointKind,
    simulation::Solver,
};

/// Highest order of the position filter: beyond it, its transients are longer than what it is to keep.
const HIGHEST_ORDER: usize = 20;
/// Longest rest of a twin, s.
const LONGEST_REST_S: f64 = 3600.0;

const POSITION: [Quantity; 2] = [Quantity::Angle, Quantity::Length];
const DRIVE: [Quantity; 5] =
    [Quantity::Torque, Quantity::Force, Quantity::Voltage, Quantity::Current, Quantity::Dimensionless];

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
        for recording in self.file.recording.iter().chain(&self.file.validation) {
            self.validate_recording(recording)?;
        }
        self.validate_signal()?;
        self.validate_parameters()?;
        self.validate_methods()?;
        self.validate_convergence()?;
        if let Some(controller) = &self.file.controller {
            let motors = self.robot.coordinate_count();
            let refuse = |source| ExperimentError::Controller { path: self.path.clone(), source };
            controller.validate(motors).map_err(refuse)?;
        }
        self.validate_simulation()
    }

    fn validate_recording(&self, recording: &RecordingDescription) -> Result<(), ExperimentError> {
        self.validate_unit(&recording.position, "position", &POSITION, [Quantity::Angle, Quantity::Length])?;
        self.validate_unit(&recording.torque, "torque", &DRIVE, [Quantity::Torque, Quantity::Force])?;
        self.require_positive("[recording] weight", recording.weight)?;
        let jitter = recording.largest_jitter;
        self.require((0.0..=1.0).contains(&jitter), "[recording] largest_jitter", "from 0 to 1 steps", jitter)?;
        let window = (recording.window_start_s, recording.window_end_s);
        self.validate_window("[recording]", window)?;
        if let Some(reference) = &recording.reference {
            self.validate_unit(reference, "reference", &POSITION, [Quantity::Angle, Quantity::Length])?;
        }
        if let Some(signal) = &recording.added_signal {
            signal.require_quantity("added signal", &DRIVE)?;
        }
        if let Some(time) = &recording.time {
            time.require_quantity("time", &[Quantity::Time])?;
        }
        match (recording.sample_rate_hz, &recording.time) {
            (Some(rate), None) => self.require_positive("[recording] sample_rate_hz", rate),
            (None, Some(_)) => Ok(()),
            (Some(_), Some(_)) => {
                Err(self.value("[recording] the rate", "either sample_rate_hz or time", "given by both"))
            }
            (None, None) => Err(self.missing("[recording] sample_rate_hz or time", "one of the two gives the rate")),
        }
    }

    /// On the joint side, and without gains that convert them, values are those of the `joints`: revolute or prismatic.
    fn validate_unit(
        &self,
        source: &ChannelSource,
        signal: &str,
        any: &[Quantity],
        joints: [Quantity; 2],
    ) -> Result<(), ExperimentError> {
        if source.side == Side::Motor || !source.gain.is_empty() {
            return Ok(source.require_quantity(signal, any)?);
        }
        let has = |kind| self.robot.coordinates().any(|j| j.kind == kind);
        let kinds = joints.into_iter().zip([JointKind::Revolute, JointKind::Prismatic]);
        let expected: Vec<Quantity> = kinds.filter(|(_, kind)| has(*kind)).map(|(quantity, _)| quantity).collect();
        Ok(source.require_quantity(signal, &expected)?)
    }

    fn validate_twin(&self, twin: &TwinDescription) -> Result<(), ExperimentError> {
        let n = self.robot.coordinate_count();
        let sensors = &twin.sensors;
        let lists =
            [("sensors.torque_noise", &sensors.torque_noise), ("sensors.torque_ripple", &sensors.torque_ripple)];
        let points = twin.points.iter().map(|p| ("points", p));
        for (key, list) in [("max_velocity", &twin.max_velocity)].into_iter().chain(lists).chain(points) {
            let key = format!("[twin] {key}");
            self.require(list.len() == n, &key, &format!("a list of {n}, one for each joint"), entries(list.len()))?;
            self.require_finite(&key, list.iter().copied())?;
        }
        for (key, list) in lists {
            if let Some(value) = list.iter().find(|v| **v < 0.0) {
                return Err(self.value(&format!("[twin] {key}"), "zero or above", value));
            }
        }
        self.require(twin.points.len() > 1, "[twin] points", "a start and an end point", entries(twin.points.len()))?;
        self.require_positive("[twin] sample_rate_hz", twin.sample_rate_hz)?;
        self.require_positive("[twin] sensors.encoder_counts_per_turn", sensors.encoder_counts_per_turn)?;
        self.require_finite("[twin] sensors.ripple_per_turn", [sensors.ripple_per_turn])?;
        for (name, &value) in &twin.parameters {
            self.require_finite(&format!("[twin.parameters] {name}"), [value])?;
        }
        self.require((0.0..=LONGEST_REST_S).contains(&twin.rest_s), "[twin] rest_s", "from 0 to 3600", twin.rest_s)?;
        let why = "the twin moves under its control";
        self.file.controller.as_ref().map(|_| ()).ok_or_else(|| self.missing("[controller]", why))
    }

    fn validate_signal(&self) -> Result<(), ExperimentError> {
        let signal = &self.file.signal;
        let orders = 1..=HIGHEST_ORDER;
        let expected = format!("from 1 to {HIGHEST_ORDER}");
        self.require(orders.contains(&signal.filter_order), "[signal] filter_order", &expected, signal.filter_order)?;
        self.require_positive("[signal] cutoff_hz", signal.cutoff_hz)?;
        self.require(signal.decimation > 0, "[signal] decimation", "at least 1", signal.decimation)?;
        self.validate_window("[signal]", (signal.window_start_s, signal.window_end_s))
    }

    fn validate_window(&self, table: &str, (start, end): (Option<f64>, Option<f64>)) -> Result<(), ExperimentError> {
        let start = start.unwrap_or(0.0);
        let key = format!("{table} window_start_s");
        self.require(start >= 0.0 && start.is_finite(), &key, "zero or later", start)?;
        let end = end.unwrap_or(f64::MAX);
        let key = format!("{table} window_end_s");
        self.require(end > start && end.is_finite(), &key, "later than window_start_s", end)
    }

    fn validate_parameters(&self) -> Result<(), ExperimentError> {
        let parameters = &self.file.parameters;
        if matches!(&parameters.estimate, ParameterChoice::List(names) if names.is_empty()) {
            return Err(self.value("[parameters] estimate", "at least one parameter", "an empty list"));
        }
        let rule = parameters.elimination;
        let limit = rule.relative_standard_deviation_percent;
        self.require_positive("[parameters] elimination.relative_standard_deviation_percent", limit)?;
        let level = rule.significance;
        let key = "[parameters] elimination.significance";
        self.require((0.0..1.0).contains(&level) && level > 0.0, key, "between 0 and 1", level)
    }

    fn validate_methods(&self) -> Result<(), ExperimentError> {
        let mut names = BTreeSet::new();
        for case in self.cases() {
            if !names.insert(case.name.clone()) {
                return Err(self.value("[[case]] name", "a name of its own for each case", case.name));
            }
            if !case.simulator.is_valid() {
                let key = format!("[[case]] {}: simulator", case.name);
                return Err(self.value(&key, "factors above zero and a delay not below zero", "out of range"));
            }
            self.validate_method_list(case.methods.as_ref().unwrap_or(&self.file.estimation.methods))?;
        }
        Ok(())
    }

    fn validate_method_list(&self, methods: &[Method]) -> Result<(), ExperimentError> {
        if methods.is_empty() {
            return Err(self.value("methods", "at least one method", "an empty list"));
        }
        if let Some(i) = (1..methods.len()).find(|&i| methods[..i].contains(&methods[i])) {
            return Err(self.value("methods", "each method once", format!("a list with {} twice", methods[i].name())));
        }
        if methods.iter().any(|m| *m != Method::IdimLs) && self.file.controller.is_none() {
            let why =
                "idim-iv and didim simulate the closed loop; describe it, or set [estimation] methods = [\"idim-ls\"]";
            return Err(self.missing("[controller]", why));
        }
        Ok(())
    }

    fn validate_convergence(&self) -> Result<(), ExperimentError> {
        let convergence = self.file.estimation.convergence;
        self.require_positive("[estimation] convergence.parameter_change", convergence.parameter_change)?;
        self.require_positive("[estimation] convergence.error_change", convergence.error_change)?;
        let iterations = convergence.iterations;
        self.require(iterations > 0, "[estimation] convergence.iterations", "at least 1", iterations)
    }

    fn validate_simulation(&self) -> Result<(), ExperimentError> {
        let simulation = &self.file.simulation;
        self.require_positive("[simulation] sign_velocity_scale", simulation.sign_velocity_scale)?;
        match simulation.solver {
            Solver::Automatic { relative_tolerance, absolute_tolerance } => {
                self.require_positive("[simulation] solver.automatic.relative_tolerance", relative_tolerance)?;
                self.require_positive("[simulation] solver.automatic.absolute_tolerance", absolute_tolerance)
            }
            Solver::Adaptive { relative_tolerance, absolute_tolerance } => {
                self.require_positive("[simulation] solver.adaptive.relative_tolerance", relative_tolerance)?;
                self.require_positive("[simulation] solver.adaptive.absolute_tolerance", absolute_tolerance)
            }
            Solver::Implicit { relative_tolerance, absolute_tolerance } => {
                self.require_positive("[simulation] solver.implicit.relative_tolerance", relative_tolerance)?;
                self.require_positive("[simulation] solver.implicit.absolute_tolerance", absolute_tolerance)
            }
            Solver::Fixed { step_s } => self.require_positive("[simulation] solver.fixed.step_s", step_s),
        }
    }

    fn require_positive(&self, key: &str, value: f64) -> Result<(), ExperimentError> {
        self.require(value > 0.0 && value.is_finite(), key, "a finite number above zero", value)
    }

    fn require_finite(&self, key: &str, values: impl IntoIterator<Item = f64>) -> Result<(), ExperimentError> {
        match values.into_iter().find(|v| !v.is_finite()) {
            Some(value) => Err(self.value(key, "finite numbers", value)),
            None => Ok(()),
        }
    }
}

fn entries(count: usize) -> String {
    format!("a list of {count}")
}
