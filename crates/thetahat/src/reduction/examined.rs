//! The checks of samples while they are there: what they find is kept with the rows.

use std::{ops::Range, path::Path};

use super::{
    error::ReductionError,
    options::ReduceOptions,
    parts::{PartFindings, findings_of_parts},
    source::Source,
    value::{ComparedRecordings, RecordingFolds, ReducedRecording, Reduction},
};
use crate::{
    experiment::Experiment,
    preparation::{Basis, Recording},
    run::{ExaminationModel, PreparedRecording, compare, examine, frequency_hz},
};
use thetahat_estimation::checks::Finding;
use thetahat_ground::pool::in_parallel;
use thetahat_model::{base_parameters::BaseParameters, dynamics::Model};

/// Samples of a recording up to which it is examined as a whole, and of each part of a longer one at the most.
const MOST_SAMPLES: usize = 1 << 17;
/// Parts of a longer recording, spread over it evenly.
const MOST_PARTS: usize = 16;
/// Samples of all recordings up to which they are compared with one another.
const MOST_COMPARED: usize = 1 << 19;

/// What was found in a recording.
pub(super) struct Examined {
    pub findings: Vec<Finding>,
    /// Parts that were looked at one by one.
    pub parts: usize,
    pub folds: Option<RecordingFolds>,
    /// The recording itself, where it is kept.
    pub samples: Option<Box<Recording>>,
}

/// How a motion repeats.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Repetition {
    /// The frequency of the reference that simulations would follow: parts of its period are left out in turn.
    pub of_reference_hz: Option<f64>,
    /// The frequency of the motion, whatever reference is recorded: errors may come back with it.
    pub of_motion_hz: Option<f64>,
}

/// A recording that is short enough to be examined as a whole.
pub(super) struct Whole {
    recording: Recording,
    prepared: PreparedRecording,
}

/// Examines the recordings of an experiment one after the other, and then with one another.
pub(super) struct Examiner<'a> {
    experiment: &'a Experiment,
    model: &'a Model,
    base: &'a BaseParameters,
    estimated: BaseParameters,
    /// Whether short recordings are kept themselves.
    keeps_samples: bool,
    threads: usize,
    /// Recordings that are compared; none once they are too long together, or one was not examined as a whole.
    prepared: Option<Vec<PreparedRecording>>,
}

impl<'a> Examiner<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        model: &'a Model,
        base: &'a BaseParameters,
        options: ReduceOptions,
    ) -> Result<Self, ReductionError> {
        let basis = Basis { model: model.clone(), base: base.clone() };
        let estimated = experiment.setup().estimated(&basis).map_err(|e| experiment.refuse(e))?;
        let (keeps_samples, threads) = (!options.rows_only, options.threads);
        Ok(Self { experiment, model, base, estimated, keeps_samples, threads, prepared: Some(Vec::new()) })
    }

    /// A recording with the place `number`, from one, in the experiment; none if it is too long to be examined as a whole.
    pub(super) fn whole(
        &self,
        source: &Source<'_>,
        (number, data): (usize, &Path),
    ) -> Option<Result<Whole, ReductionError>> {
        let read = || {
            let recording = source.complete(number, data)?;
            let prepared = self.prepare(recording.clone())?;
            Ok(Whole { recording, prepared })
        };
        (source.samples <= MOST_SAMPLES).then(read)
    }

    /// How the motion repeats; of a long recording, its first part.
    pub(super) fn repetition(
        &self,
        source: &Source<'_>,
        whole: Option<&Result<Whole, ReductionError>>,
        has_reference: bool,
    ) -> Repetition {
        let of_motion = |recording: &Recording| {
            frequency_hz(&self.experiment.setup().reference_of_motion(recording).ok()?.reference)
        };
        match whole {
            Some(Ok(Whole { recording, prepared })) => Repetition {
                of_reference_hz: prepared.frequency_hz(),
                of_motion_hz: prepared.frequency_hz().or_else(|| of_motion(recording)),
            },
            Some(Err(_)) => Repetition::default(),
            None => {
                let of_motion_hz = source.excerpt(0..MOST_SAMPLES).ok().and_then(|first| of_motion(&first));
                let is_followed = !has_reference && self.simulates();
                Repetition { of_reference_hz: of_motion_hz.filter(|_| is_followed), of_motion_hz }
            }
        }
    }

    /// What the checks find in a recording that was reduced.
    pub(super) fn examine(
        &mut self,
        source: &Source<'_>,
        whole: Option<Result<Whole, ReductionError>>,
        reduced: &ReducedRecording,
    ) -> Result<Examined, ReductionError> {
        let Some(whole) = whole else {
            self.prepared = None;
            return self.examine_parts(source, reduced);
        };
        let Whole { recording, prepared } = whole?;
        let samples = self.keeps_samples.then(|| Box::new(recording));
        let findings = self.findings_of(&prepared);
        let folds = self.folds_of(&prepared, reduced);
        self.keep(prepared);
        Ok(Examined { findings, parts: 1, folds, samples })
    }

    /// What the checks find in recordings together, where all are there.
    pub(super) fn compared(&self, reduction: &Reduction) -> Option<ComparedRecordings> {
        let prepared = self.prepared.as_ref().filter(|prepared| prepared.len() > 1)?;
        let found = compare(self.experiment.setup(), [prepared, &[]], (self.model, self.base));
        Some(ComparedRecordings {
            fingerprints: reduction.recordings.iter().map(|r| r.fingerprint.clone()).collect(),
            findings: found.map(|found| found.findings).unwrap_or_default(),
        })
    }

    /// Filters a recording, and finds the reference of its motion where simulations would follow it.
    fn prepare(&self, mut recording: Recording) -> Result<PreparedRecording, ReductionError> {
        let setup = self.experiment.setup();
        if recording.name.is_empty() {
            recording.name = "1".to_owned();
        }
        let filtered = setup.filter(recording).map_err(|e| self.experiment.refuse(e))?;
        let reference = self.simulates().then(|| setup.reference(&filtered.recording).ok()).flatten();
        Ok(PreparedRecording { filtered, reference })
    }

    /// Whether simulations would follow a reference.
    fn simulates(&self) -> bool {
        let settings = &self.experiment.settings;
        settings.controller.is_some() || settings.lacks_controller()
    }

    fn findings_of(&self, prepared: &PreparedRecording) -> Vec<Finding> {
        let by = ExaminationModel { model: self.model, estimated: &self.estimated, base: self.base };
        examine(self.experiment.setup(), prepared, by, false).findings
    }

    /// The folds of cross-validation, where the rows are those of the recording that was examined.
    fn folds_of(&self, prepared: &PreparedRecording, reduced: &ReducedRecording) -> Option<RecordingFolds> {
        let decimator = prepared.filtered.decimator(&self.experiment.settings.signal).ok()?;
        let folds = prepared.folds(&decimator);
        (folds.of_row.len() == reduced.rows).then_some(RecordingFolds { of_row: folds.of_row, names: folds.names })
    }

    fn keep(&mut self, recording: PreparedRecording) {
        let Some(prepared) = &mut self.prepared else { return };
        prepared.push(recording);
        let samples: usize = prepared.iter().map(|p| p.filtered.recording.position.len()).sum();
        if samples > MOST_COMPARED {
            self.prepared = None;
        }
    }

    fn examine_parts(&self, source: &Source<'_>, reduced: &ReducedRecording) -> Result<Examined, ReductionError> {
        let rate = source.sample_rate_hz;
        let [start, end] = reduced.window_s.map(|t| (t * rate).round() as usize);
        let own = parts_of(start..end);
        let examined = in_parallel(own.len(), self.threads, |k| self.examine_part(source, own[k].clone()));
        let parts: Vec<PartFindings> = examined.into_iter().filter_map(Result::transpose).collect::<Result<_, _>>()?;
        Ok(Examined { findings: findings_of_parts(&parts), parts: parts.len(), folds: None, samples: None })
    }

    /// What the checks find in a part of a recording, with samples around it for the filters; none of a part without motion.
    fn examine_part(&self, source: &Source<'_>, own: Range<usize>) -> Result<Option<PartFindings>, ReductionError> {
        let rate = source.sample_rate_hz;
        let around = own.len() / 8;
        let read = own.start.saturating_sub(around)..(own.end + around).min(source.samples);
        let [from_s, to_s] = [own.start, own.end].map(|k| (k - read.start) as f64 / rate);
        let excerpt = source.excerpt(read)?;
        let recording = Recording { window_s: [Some(from_s), Some(to_s)], ..excerpt };
        let Ok(filtered) = self.experiment.setup().filter(recording) else { return Ok(None) };
        let findings = self.findings_of(&PreparedRecording { filtered, reference: None });
        Ok(Some(PartFindings { span_s: [own.start as f64 / rate, own.end as f64 / rate], findings }))
    }
}

impl ReducedRecording {
    /// The same with what was found in it.
    pub(super) fn examined(self, Examined { findings, parts, folds, samples }: Examined) -> Self {
        Self { findings, examined_parts: parts, folds, ..self }.with_samples(samples)
    }

    /// The same with the recording itself, in the window of its rows.
    fn with_samples(self, samples: Option<Box<Recording>>) -> Self {
        let in_window = |recording: Box<Recording>| {
            let (name, window_s) = (self.name.clone(), self.window_s.map(Some));
            Box::new(Recording { name, window_s, ..*recording })
        };
        Self { samples_kept: samples.map(in_window), ..self }
    }
}

/// Equal parts of a window, or parts at equal distances where they would be too many.
fn parts_of(window: Range<usize>) -> Vec<Range<usize>> {
    let count = window.len().div_ceil(MOST_SAMPLES).clamp(1, MOST_PARTS);
    let length = (window.len() / count).min(MOST_SAMPLES);
    let start = |k: usize| window.start + k * (window.len() - length) / (count - 1).max(1);
    (0..count).map(|k| start(k)..start(k) + length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_a_window_or_are_spread_over_it() {
        let whole = parts_of(10..5010);
        assert_eq!((whole.len(), whole[0].start, whole[0].end), (1, 10, 5010));
        assert_eq!(parts_of(0..200_000), [0..100_000, 100_000..200_000]);
        let parts = parts_of(100..50_000_100);
        assert_eq!((parts.len(), parts[0].start, parts[15].end), (MOST_PARTS, 100, 50_000_100));
        assert!(parts.iter().all(|part| part.len() == MOST_SAMPLES));
    }
}
