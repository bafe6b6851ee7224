use std::{collections::BTreeMap, ops::Range, path::Path};

use super::{
    error::ReductionError,
    examined::{Examiner, Repetition},
    factors::{JointColumns, RowCollector},
    fingerprint::Fingerprint,
    identity::Identity,
    instruments::Simulated,
    model_rows::{ModelRows, ModelTaker},
    near_rest::NearRestMask,
    options::{ReduceOptions, ReduceProgress},
    overlap::Marks,
    pieces::{Pieces, refuse},
    rows::{Channels, Piece, Rows},
    source::Source,
    survey::{Survey, Surveyed},
    value::{ReducedRecording, Reduction},
};
use crate::{
    experiment::{Experiment, RecordingDescription},
    preparation::{Basis, Case, PreparationError, STILL},
    run::{RowParts, memory, near_rest_limits, places},
};
use thetahat_estimation::signal::{Decimator, Joiner, SignalError};
use thetahat_ground::pool::in_order;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Jump, Model},
    regressor::Regressor,
};

impl Experiment {
    /// Reduces the recordings of the experiment to the factors from which LS estimates; no more than a few pieces of them
    /// are in memory at a time.
    ///
    /// The rows are the same as in [`Experiment::run`] with the nominal friction. Recordings held back are not read.
    ///
    /// # Errors
    /// [`ReductionError`] for input that cannot be used.
    pub fn reduce(
        &self,
        data: &Path,
        options: ReduceOptions,
        progress: &mut dyn FnMut(ReduceProgress),
    ) -> Result<Reduction, ReductionError> {
        self.reduce_with_instruments(data, None, options, progress)
    }

    /// The same with instruments, for IDIM-IV: the observation matrix of the closed loop simulated with base parameters of
    /// these names; those that are not named are zero.
    ///
    /// A recording that is read in pieces is simulated in pieces along its recorded reference, each from 2 s before it; one
    /// that is read whole is simulated as [`Experiment::run`] does.
    ///
    /// # Errors
    /// [`ReductionError`] for input that cannot be used, and a simulation that fails.
    pub fn reduce_with_instruments(
        &self,
        data: &Path,
        instruments: Option<&BTreeMap<String, f64>>,
        options: ReduceOptions,
        progress: &mut dyn FnMut(ReduceProgress),
    ) -> Result<Reduction, ReductionError> {
        self.require_reducible()?;
        let Basis { model, base } = self.setup().basis(&Case::nominal()).map_err(|e| self.refuse(e))?;
        let theta = instruments.map(|named| self.base_values(&model, &base, named)).transpose()?;
        let mut reducer = Reducer::new(self, &model, &base, options);
        reducer.theta = theta;
        let mut reduction = reducer.nothing_yet();
        let mut examiner = Examiner::new(self, &model, &base, options)?;
        let recordings = self.file.recording.len().max(1);
        for (i, description) in self.file.recording.iter().enumerate() {
            let source = Source::open(self, description, (i + 1, data), reducer.theta.is_some())?;
            let mut report = |done, to_do| progress(ReduceProgress { recording: i + 1, recordings, done, to_do });
            let whole = examiner.whole(&source, (i + 1, data));
            let has_reference = description.reference.is_some();
            let described = (Some(description), examiner.repetition(&source, whole.as_ref(), has_reference));
            let reduced = reducer.recording(&source, described, &mut report)?;
            let examined = examiner.examine(&source, whole, &reduced)?;
            reduction.add(reduced.examined(examined))?;
        }
        if let Some(twin) = &self.file.twin {
            let source = Source::of_recording(self, self.simulate_twin(twin)?);
            let mut report = |done, to_do| progress(ReduceProgress { recording: 1, recordings, done, to_do });
            let whole = examiner.whole(&source, (1, data));
            let repetition = examiner.repetition(&source, whole.as_ref(), true);
            let reduced = reducer.recording(&source, (None, repetition), &mut report)?;
            let examined = examiner.examine(&source, whole, &reduced)?;
            reduction.add(reduced.examined(examined))?;
        }
        reduction.compared = examiner.compared(&reduction).into_iter().collect();
        Ok(reduction)
    }

    /// Refuses what only an identification of whole samples takes.
    fn require_reducible(&self) -> Result<(), ReductionError> {
        if let Some(channel) = self.robot.channels().pop() {
            let expected = "no torque term of a recorded channel: a reduction does not read it; use thetahat identify";
            return Err(self.refuse(PreparationError::value("[[term]]", expected, channel)).into());
        }
        if self.robot.base_coordinates() > 0 {
            let expected =
                "a robot whose base is fixed: a reduction does not read [recording.base]; use thetahat identify";
            return Err(self.refuse(PreparationError::value("robot", expected, "a base that floats")).into());
        }
        if let Some(size) = self.settings.model.estimated.first() {
            let expected = "none: a reduction has no column for them; use thetahat identify";
            return Err(self.refuse(PreparationError::value("[model] estimated", expected, size)).into());
        }
        self.settings.require_stated_cutoff("a reduction reads in pieces").map_err(|e| self.refuse(e))?;
        self.require_stated_terms()
    }

    /// Refuses torque terms whose constants are searched for.
    fn require_stated_terms(&self) -> Result<(), ReductionError> {
        match self.robot.term_descriptions.iter().any(|term| term.is_profiled()) {
            false => Ok(()),
            true => {
                let expected =
                    "constants that are stated: a reduction does not search for them; an identification does";
                Err(self.refuse(PreparationError::value("[[term]] profile", expected, true)).into())
            }
        }
    }

    /// Values of all base parameters from those named.
    fn base_values(
        &self,
        model: &Model,
        base: &BaseParameters,
        named: &BTreeMap<String, f64>,
    ) -> Result<Vec<f64>, ReductionError> {
        let names: Vec<String> = named.keys().cloned().collect();
        base.select(model.parameter_table(), &names).map_err(|e| self.refuse(e))?;
        Ok(base.parameters().iter().map(|p| named.get(&p.name).copied().unwrap_or(0.0)).collect())
    }
}

/// What the pieces taken so far have given.
struct Taken<'a> {
    joiner: Joiner<'a>,
    collector: RowCollector<'a>,
    fingerprint: Fingerprint,
    marks: Marks,
    /// Largest velocity.
    peak: f64,
    has_torque: bool,
    /// Samples of each coordinate that make no rows.
    left_out: Vec<usize>,
    /// Simulated positions after the last sample.
    seam: Option<Vec<f64>>,
    model: ModelTaker<'a>,
}

impl<'a> Taken<'a> {
    fn new(decimator: &'a Decimator, columns: JointColumns, model: ModelTaker<'a>) -> Self {
        let (joiner, left_out) = (decimator.joiner(), vec![0; columns.channels.len()]);
        let (collector, fingerprint) = (RowCollector::new(columns, decimator), Fingerprint::EMPTY);
        let marks = Marks::default();
        Self { joiner, collector, fingerprint, marks, peak: 0.0, has_torque: false, left_out, seam: None, model }
    }

    /// Takes the next piece, which starts at sample `start` of the recording.
    fn take(&mut self, piece: Piece, simulated: Option<&Simulated<'_>>, start: usize) -> Result<(), ReductionError> {
        self.fingerprint = self.fingerprint.followed_by(piece.fingerprint);
        self.marks.join(piece.marks);
        self.peak = self.peak.max(piece.peak);
        self.has_torque |= piece.has_torque;
        self.left_out.iter_mut().zip(&piece.left_out).for_each(|(sum, samples)| *sum += samples);
        if let Some((simulated, (first, next))) = simulated.zip(piece.seam) {
            self.seam.iter().try_for_each(|before| simulated.require_seam(before, &first, start))?;
            self.seam = next;
        }
        self.model.take(piece.model);
        self.joiner.take(piece.decimated).iter().for_each(|rows| self.collector.take(rows));
        Ok(())
    }

    fn require_motion_and_torque(&self, experiment: &Experiment, recording: &str) -> Result<(), ReductionError> {
        if self.peak <= STILL {
            let still = SignalError::NoMotion { peak_velocity: self.peak, still_velocity: STILL };
            return Err(refuse(experiment, still));
        }
        if !self.has_torque {
            return Err(ReductionError::NoTorque { recording: recording.to_owned() });
        }
        Ok(())
    }
}

/// What all recordings share.
struct Reducer<'a> {
    experiment: &'a Experiment,
    model: &'a Model,
    base: &'a BaseParameters,
    regressor: Regressor,
    options: ReduceOptions,
    identity: Identity,
    /// Base parameters of the simulation of instruments.
    theta: Option<Vec<f64>>,
}

impl<'a> Reducer<'a> {
    fn new(experiment: &'a Experiment, model: &'a Model, base: &'a BaseParameters, options: ReduceOptions) -> Self {
        let regressor = Regressor::new(model, &base.columns());
        let has_jumps = !Jump::among(model, &base.columns()).is_empty();
        let identity = Identity::of(experiment, (model, base), &regressor, has_jumps);
        Self { experiment, model, base, regressor, options, identity, theta: None }
    }

    fn recording(
        &mut self,
        source: &Source<'_>,
        (description, repetition): (Option<&RecordingDescription>, Repetition),
        report: &mut dyn FnMut(usize, usize),
    ) -> Result<ReducedRecording, ReductionError> {
        let pieces = Pieces::new(self.experiment, source, self.options.piece_samples)?;
        let own = description.map_or([None, None], |d| [d.window_start_s, d.window_end_s]);
        let signal = self.experiment.settings.signal.in_window(own);
        let jumps = self.jumps();
        let surveyed = Survey::new(&pieces, self.options.threads, report).run(&signal, !jumps.is_empty())?;
        let Surveyed { window, near_rest, pieces: mut before } = surveyed;
        let decimator = signal.decimator(window.len()).map_err(|e| refuse(self.experiment, e))?;
        let model_rows = ModelRows::new((self.model, self.base), &self.identity, &signal, window.len());
        let model_rows = model_rows.map_err(|e| refuse(self.experiment, e))?;
        let near_rest_limits = near_rest_limits(near_rest.as_ref(), self.identity.joints.len());
        let rows_of_period = |hz: f64| source.sample_rate_hz / (hz * signal.decimation as f64);
        let period = repetition.of_motion_hz.map(rows_of_period);
        let parts = self.row_parts(source, (&window, &decimator), repetition.of_reference_hz);
        let simulated = |theta: &Vec<f64>| {
            Simulated::new(self.experiment, (self.model, self.base), source, theta, (pieces.reach, &window))
        };
        let simulated = self.theta.as_ref().map(simulated).transpose()?;
        let mut mask = near_rest.map(|rule| NearRestMask::new(jumps, rule, window.clone()));
        let taken = loop {
            let rows = Rows {
                pieces: &pieces,
                window: window.clone(),
                decimator: &decimator,
                model: self.model,
                regressor: &self.regressor,
                simulated: simulated.as_ref(),
                mask: mask.as_ref(),
                model_rows: &model_rows,
            };
            let model = model_rows.taker(parts.clone(), near_rest_limits.clone(), period);
            let taken = self.take_all(&rows, model, &mut before, report)?;
            match mask.as_ref().and_then(|mask| mask.after(&taken.left_out)) {
                None => break taken,
                Some(next) => mask = Some(next),
            }
        };
        taken.require_motion_and_torque(self.experiment, &source.name)?;
        let rate = source.sample_rate_hz;
        let near_rest = mask.as_ref().and_then(|mask| mask.describe(&taken.left_out, rate));
        let kept = taken.collector.finish();
        let truth = source.truth.as_ref().filter(|truth| self.base.agrees_with_fixed(truth));
        Ok(ReducedRecording {
            name: source.name.clone(),
            file: source.file().to_owned(),
            weight: source.weight,
            fingerprint: taken.fingerprint.to_hex(),
            marks: taken.marks,
            samples: window.len(),
            rows: decimator.rows(),
            sample_rate_hz: rate,
            window_s: [window.start as f64 / rate, window.end as f64 / rate],
            torque_hold_s: source.torque_hold_s,
            model: taken.model.finish(window.len()),
            kept: if near_rest.is_some() { kept } else { kept.without_mask() },
            near_rest,
            truth: truth.map(|truth| self.base.from_standard(truth)),
            findings: Vec::new(),
            examined_parts: 0,
            folds: None,
            samples_kept: None,
        })
    }

    /// Takes the rows of all pieces, after so many pieces that were read before.
    fn take_all<'r>(
        &self,
        rows: &Rows<'r>,
        model: ModelTaker<'r>,
        before: &mut usize,
        report: &mut dyn FnMut(usize, usize),
    ) -> Result<Taken<'r>, ReductionError> {
        let Rows { pieces, decimator, simulated, .. } = *rows;
        let channels = rows.channels().count() + rows.model_rows.channels();
        let parts = pieces.parts(decimator, self.experiment.settings.signal.decimation, channels);
        let mut taken = Taken::new(decimator, joint_columns(&self.regressor, rows.channels()), model);
        let work = |number: usize| rows.piece(parts[number].clone());
        in_order(parts.len(), self.options.threads, work, |number, piece| {
            let start = rows.window.start + decimator.samples_of(&parts[number]).start;
            taken.take(piece?, simulated, start)?;
            report(*before + number + 1, *before + parts.len());
            Ok::<(), ReductionError>(())
        })?;
        *before += parts.len();
        Ok(taken)
    }

    /// The parts of a window that are left out in turn, of a motion that repeats with a frequency by its periods.
    fn row_parts(
        &self,
        source: &Source<'_>,
        (window, decimator): (&Range<usize>, &Decimator),
        frequency_hz: Option<f64>,
    ) -> RowParts {
        let (signal, rate) = (&self.experiment.settings.signal, source.sample_rate_hz);
        let samples: Vec<usize> = decimator.kept().collect();
        let times_s = samples.iter().map(|k| window.start as f64 / rate + *k as f64 / rate);
        RowParts::new(places(times_s, frequency_hz), memory(rate, signal.cutoff_hz, signal.decimation))
    }

    /// Where torques of the parameters jump.
    fn jumps(&self) -> Vec<Jump> {
        Jump::among(self.model, &self.base.columns())
    }

    /// The reduction of no recording.
    fn nothing_yet(&self) -> Reduction {
        let experiment = self.experiment;
        Reduction {
            identity: self.identity.clone(),
            experiment_name: experiment.path.display().to_string(),
            experiment_description: experiment.text.clone(),
            robot_description: experiment.robot_text.clone(),
            instruments: self.theta.clone(),
            recordings: Vec::new(),
            compared: Vec::new(),
        }
    }
}

/// The channels of each joint: its entries of phi in the order of the columns, of the simulated motion and of the measured
/// one, then its torque.
fn joint_columns(regressor: &Regressor, channels: Channels) -> JointColumns {
    let entries = regressor.entries();
    let of_joint = |joint: usize| {
        let mut own: Vec<usize> = (0..entries.len()).filter(|&e| entries[e].joint == joint).collect();
        own.sort_by_key(|&e| entries[e].column);
        let of_matrix = |first: &usize| own.iter().map(move |e| e + first).collect::<Vec<_>>();
        let mut of_joint: Vec<usize> = channels.matrices().iter().flat_map(of_matrix).collect();
        of_joint.push(channels.torque() + joint);
        of_joint
    };
    let joints = 0..channels.joints();
    JointColumns { channels: joints.map(of_joint).collect(), mask: channels.mask() }
}
