use std::{collections::BTreeMap, ops::Range, path::Path};

use super::{
    error::ReductionError,
    factors::{Accumulator, JointColumns},
    fingerprint::Fingerprint,
    instruments::Simulated,
    pieces::{Piece, Pieces, Rows, refuse},
    source::Source,
    value::{Identity, ReducedRecording, Reduction},
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::Model,
    experiment::{Experiment, RecordingDescription},
    pool::in_order,
    preparation::{Basis, Case, PreparationError, STILL, window_of},
    regressor::Regressor,
    signal::{Decimator, Joiner, SignalError},
};

/// How a recording is reduced. The numbers that come out are the same for any number of threads; another length of the
/// pieces changes their last digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReduceOptions {
    /// Pieces that are worked on at a time.
    pub threads: usize,
    /// Samples of one piece, about.
    pub piece_samples: usize,
}

impl Default for ReduceOptions {
    fn default() -> Self {
        Self { threads: 1, piece_samples: 1 << 16 }
    }
}

/// How far a reduction is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReduceProgress {
    /// The recording, from one.
    pub recording: usize,
    /// Recordings in all.
    pub recordings: usize,
    /// Pieces read, including the pass that looks for the moving part.
    pub done: usize,
    /// Pieces to read.
    pub to_do: usize,
}

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
    /// A record that is read in pieces is simulated in pieces along its recorded reference, each from 2 s before it; one
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
        if let Some(channel) = self.robot.channels().pop() {
            let expected = "no torque term of a recorded channel: a reduction does not read it; use thetahat identify";
            return Err(self.refuse(PreparationError::value("[[term]]", expected, channel)).into());
        }
        let Basis { model, base } = self.setup().basis(&Case::nominal()).map_err(|e| self.refuse(e))?;
        let theta = instruments.map(|named| self.base_values(&model, &base, named)).transpose()?;
        let mut reducer = Reducer::new(self, &model, &base, options);
        reducer.theta.clone_from(&theta);
        let mut reduction = Reduction::empty(self, &base, &reducer.regressor);
        reduction.instruments = theta;
        let recordings = self.file.recording.len().max(1);
        for (i, description) in self.file.recording.iter().enumerate() {
            let source = Source::open(self, description, (i + 1, data), reducer.theta.is_some())?;
            let mut tell = |done, to_do| progress(ReduceProgress { recording: i + 1, recordings, done, to_do });
            reduction.add(reducer.recording(&source, Some(description), &mut tell)?)?;
        }
        if let Some(twin) = &self.file.twin {
            let source = Source::of_recording(self, self.simulate_twin(twin)?);
            let mut tell = |done, to_do| progress(ReduceProgress { recording: 1, recordings, done, to_do });
            reduction.add(reducer.recording(&source, None, &mut tell)?)?;
        }
        Ok(reduction)
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
    accumulator: Accumulator,
    fingerprint: Fingerprint,
    /// Largest velocity.
    peak: f64,
    has_torque: bool,
    /// Simulated positions behind the last sample.
    seam: Option<Vec<f64>>,
}

impl<'a> Taken<'a> {
    fn new(decimator: &'a Decimator, accumulator: Accumulator) -> Self {
        let (joiner, fingerprint) = (decimator.joiner(), Fingerprint::EMPTY);
        Self { joiner, accumulator, fingerprint, peak: 0.0, has_torque: false, seam: None }
    }

    /// Takes the next piece, which starts at sample `start` of the recording.
    fn take(&mut self, piece: Piece, simulated: Option<&Simulated<'_>>, start: usize) -> Result<(), ReductionError> {
        self.fingerprint = self.fingerprint.followed_by(piece.fingerprint);
        self.peak = self.peak.max(piece.peak);
        self.has_torque |= piece.has_torque;
        if let Some((simulated, (first, next))) = simulated.zip(piece.seam) {
            self.seam.iter().try_for_each(|before| simulated.require_seam(before, &first, start))?;
            self.seam = next;
        }
        self.joiner.take(piece.decimated).iter().for_each(|rows| self.accumulator.take(rows));
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
    /// Base parameters of the simulation of instruments.
    theta: Option<Vec<f64>>,
}

impl<'a> Reducer<'a> {
    fn new(experiment: &'a Experiment, model: &'a Model, base: &'a BaseParameters, options: ReduceOptions) -> Self {
        Self { experiment, model, base, regressor: Regressor::new(model, &base.columns()), options, theta: None }
    }

    fn recording(
        &mut self,
        source: &Source<'_>,
        description: Option<&RecordingDescription>,
        tell: &mut dyn FnMut(usize, usize),
    ) -> Result<ReducedRecording, ReductionError> {
        let pieces = Pieces::new(self.experiment, source, self.options.piece_samples)?;
        let (window, before) = self.window(&pieces, description, tell)?;
        let decimation = self.experiment.settings.signal.decimation;
        let decimator = Decimator::new(decimation, window.len()).map_err(|e| refuse(self.experiment, e))?;
        let simulated = |theta: &Vec<f64>| {
            Simulated::new(self.experiment, (self.model, self.base), source, theta, (pieces.reach, &window))
        };
        let simulated = self.theta.as_ref().map(simulated).transpose()?;
        let rows = Rows {
            pieces: &pieces,
            window: window.clone(),
            decimator: &decimator,
            model: self.model,
            regressor: &self.regressor,
            simulated: simulated.as_ref(),
        };
        let parts = pieces.parts(&decimator, decimation, rows.channels());
        let joints = joint_columns(self.model, &self.regressor, simulated.is_some());
        let mut taken = Taken::new(&decimator, Accumulator::new(joints, decimator.rows()));
        let work = |number: usize| rows.piece(parts[number].clone());
        in_order(parts.len(), self.options.threads, work, |number, piece| {
            let start = window.start + decimator.samples_of(&parts[number]).start;
            taken.take(piece?, simulated.as_ref(), start)?;
            tell(before + number + 1, before + parts.len());
            Ok::<(), ReductionError>(())
        })?;
        taken.require_motion_and_torque(self.experiment, &source.name)?;
        let rate = source.sample_rate_hz;
        Ok(ReducedRecording {
            name: source.name.clone(),
            weight: source.weight,
            fingerprint: taken.fingerprint.to_hex(),
            samples: window.len(),
            rows: decimator.rows(),
            sample_rate_hz: rate,
            window_s: [window.start as f64 / rate, window.end as f64 / rate],
            truth: source.truth.as_ref().map(|truth| self.base.from_standard(truth)),
            segments: taken.accumulator.finish(),
        })
    }

    /// The window of a recording, and how many pieces were read to find it.
    fn window(
        &self,
        pieces: &Pieces<'_>,
        description: Option<&RecordingDescription>,
        tell: &mut dyn FnMut(usize, usize),
    ) -> Result<(Range<usize>, usize), ReductionError> {
        let source = pieces.source;
        let own = description.map_or([None, None], |d| [d.window_start_s, d.window_end_s]);
        let signal = self.experiment.settings.signal.in_window(own);
        let (all, threads) = (pieces.all(), self.options.threads);
        let of = |moving| {
            let window = window_of(moving, source.samples, source.sample_rate_hz, &signal);
            window.map_err(|e| ReductionError::from(self.experiment.refuse(e)))
        };
        if signal.window_start_s.is_none() {
            let mut peaks = Vec::with_capacity(all.len());
            in_order(
                all.len(),
                threads,
                |piece| pieces.peaks(&all[piece]),
                |piece, of_piece| {
                    peaks.push(of_piece?);
                    tell(piece + 1, 2 * all.len());
                    Ok::<(), ReductionError>(())
                },
            )?;
            return Ok((of(pieces.moving(&peaks)?)?, all.len()));
        }
        let window = of(0..source.samples)?;
        if source.has_stamps() {
            // Outside the window only the stamps are read: they too must be equally spaced.
            let outside = [0..window.start + 1, window.end - 1..source.samples];
            let check = |range: &Range<usize>| {
                let starts = range.clone().step_by(pieces.samples);
                starts.into_iter().try_for_each(|s| source.check_stamps(s..(s + pieces.samples + 1).min(range.end)))
            };
            outside.iter().try_for_each(check)?;
        }
        Ok((window, 0))
    }
}

/// The channels of each joint: its entries of phi in the order of the columns, of the simulated motion and of the measured
/// one, then its torque.
fn joint_columns(model: &Model, regressor: &Regressor, simulated: bool) -> JointColumns {
    let entries = regressor.entries();
    let of_joint = |joint: usize| {
        let mut own: Vec<usize> = (0..entries.len()).filter(|&e| entries[e].joint == joint).collect();
        own.sort_by_key(|&e| entries[e].column);
        let matrices = if simulated { 2 } else { 1 };
        let mut channels: Vec<usize> =
            (0..matrices).flat_map(|m| own.iter().map(move |e| e + m * entries.len())).collect();
        channels.push(matrices * entries.len() + joint);
        channels
    };
    JointColumns { channels: (0..model.coordinate_count()).map(of_joint).collect() }
}

/// The columns that act on each joint, in order.
fn acting(joints: usize, regressor: &Regressor) -> Vec<Vec<usize>> {
    let of_joint = |joint: usize| {
        let mut own: Vec<usize> = regressor.entries().iter().filter(|e| e.joint == joint).map(|e| e.column).collect();
        own.sort_unstable();
        own
    };
    (0..joints).map(of_joint).collect()
}

impl Reduction {
    fn empty(experiment: &Experiment, base: &BaseParameters, regressor: &Regressor) -> Self {
        let signal = experiment.settings.signal;
        let joints: Vec<String> = experiment.robot.coordinates().map(|j| j.name.clone()).collect();
        Self {
            identity: Identity {
                robot: experiment.robot.name.clone(),
                acting: acting(joints.len(), regressor),
                joints,
                locked: experiment.robot.locked.iter().map(|l| format!("{} {}", l.name, l.value)).collect(),
                parameters: base.parameters().iter().map(|p| p.name.clone()).collect(),
                expressions: base.parameters().iter().map(|p| p.expression.clone()).collect(),
                filter_order: signal.filter_order,
                cutoff_hz: signal.cutoff_hz,
                decimation: signal.decimation,
            },
            experiment_name: experiment.path.display().to_string(),
            experiment_description: experiment.text.clone(),
            robot_description: experiment.robot_text.clone(),
            instruments: None,
            recordings: Vec::new(),
        }
    }
}
