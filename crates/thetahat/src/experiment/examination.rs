//! The checks of an experiment's recordings, before anything is estimated.

use std::path::Path;

use super::{
    Experiment, ExperimentError,
    chain::{FilteredRecord, Problem},
    simulator::RecordReference,
};
use crate::{
    checks::{self, SignalSettings, Subject},
    results::RecordingFindings,
    simulation::Reference,
};

impl Experiment {
    /// Checks every recording; nothing is estimated.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used. What is used but looks wrong is a finding.
    pub fn check(&self, data: &Path) -> Result<Vec<RecordingFindings>, ExperimentError> {
        let mut all = Vec::new();
        for (descriptions, held_back) in [(&self.file.recording, false), (&self.file.validation, true)] {
            for (i, description) in descriptions.iter().enumerate() {
                let record = self.read_record(description, i + 1, data)?;
                all.push(self.check_alone(&self.filter(record, Some(description))?, held_back)?);
            }
        }
        if let Some(twin) = &self.file.twin {
            all.push(self.check_alone(&self.filter(self.simulate_twin(twin)?, None)?, false)?);
        }
        Ok(all)
    }

    fn check_alone(&self, filtered: &FilteredRecord, held_back: bool) -> Result<RecordingFindings, ExperimentError> {
        let problem = self.problem(&self.robot, &[filtered])?;
        // A motion that no reference describes is a finding, and not the end of the checks.
        let reference = self.file.controller.as_ref().and_then(|_| self.reference(filtered).ok());
        Ok(self.examine(filtered, reference.as_ref(), &problem, held_back))
    }

    /// Examines one recording.
    pub(super) fn examine(
        &self,
        filtered: &FilteredRecord,
        reference: Option<&RecordReference>,
        problem: &Problem,
        held_back: bool,
    ) -> RecordingFindings {
        let record = &filtered.record;
        let reconstructed = reference.filter(|r| matches!(r.reference, Reference::Moves(_)));
        let deviation = reconstructed.map(|r| filtered.rms_deviation_from(r));
        let subject = Subject {
            robot: &self.robot,
            model: &problem.model,
            base: &problem.estimated,
            sample_rate_hz: record.sample_rate_hz,
            time_s: record.stamps.as_deref(),
            position: &record.position,
            geared: record.geared,
            velocity: record.velocity.as_ref(),
            torque: &record.torque,
            reference: record.reference.as_ref(),
            reconstructed_deviation: deviation.as_deref(),
            added_signal: record.added_signal.is_some(),
            signal: SignalSettings {
                filter_order: self.file.signal.filter_order,
                cutoff_hz: self.file.signal.cutoff_hz,
                decimation: self.file.signal.decimation,
                window: filtered.window.clone(),
            },
            controller: self.file.controller.as_ref(),
        };
        RecordingFindings { recording: record.name.clone(), held_back, findings: checks::examine(&subject) }
    }
}

impl FilteredRecord {
    /// Rms deviation, per joint, of the recorded positions from a reference in the window, rad or m.
    pub(super) fn rms_deviation_from(&self, reference: &RecordReference) -> Vec<f64> {
        let joints = self.q.channels();
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; joints]);
        let mut squares = vec![0.0; joints];
        for k in self.window.clone() {
            reference.reference.evaluate(k as f64 / self.record.sample_rate_hz, &mut q, &mut dq, &mut ddq);
            let measured = self.record.position.sample(k);
            squares.iter_mut().zip(measured.iter().zip(&q)).for_each(|(s, (m, r))| *s += (m - r).powi(2));
        }
        squares.iter().map(|s| (s / self.window.len() as f64).sqrt()).collect()
    }
}
