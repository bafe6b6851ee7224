//! From a record to y and X: band-pass, window, observation matrix, parallel decimation.

use std::ops::Range;

use super::{
    Experiment, ExperimentError, ParameterChoice, RecordingDescription,
    description::{NamedChoice, SignalDescription},
    record::Record,
    rows::Rows,
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    identification::{Assembly, Elimination, eliminate, relative_error_percent},
    linear_algebra::Matrix,
    results::{Bandwidth, RunPlots},
    robot::Robot,
    series::Series,
    signal::{
        Decimator, Padding, SecondOrderSections, SignalError, central_difference, minus_3_db_bandwidth_hz,
        moving_samples, zero_phase,
    },
    simulation::SimulatedMotion,
};

/// Part of its peak velocity above which a joint counts as moving.
pub(crate) const MOVING: f64 = 0.01;
/// Periods of the position filter's cut-off that are cut at both ends of a record: the reach of its transient, where a
/// record starts or ends in motion.
const EDGE_PERIODS: f64 = 5.0;
/// Peak velocity in rad/s or m/s below which a joint counts as still.
pub(crate) const STILL: f64 = 1e-3;
/// Fewest periods of the position filter's cut-off in a record: with fewer, the ends are all that is left of it.
const FEWEST_PERIODS: f64 = 10.0;
/// Length, in periods of the cut-off, of the record through which bandwidths are measured.
const PROBE_PERIODS: f64 = 200.0;

/// The band-passed motion of a record, cut to the window.
pub(crate) struct FilteredRecord {
    pub(super) record: Record,
    pub(super) q: Series,
    pub(super) dq: Series,
    pub(super) ddq: Series,
    pub(crate) window: Range<usize>,
}

impl Experiment {
    /// Filters and differentiates the whole record, then cuts it to its window: that of its description, or else the
    /// experiment's.
    pub(crate) fn filter(
        &self,
        record: Record,
        description: Option<&RecordingDescription>,
    ) -> Result<FilteredRecord, ExperimentError> {
        self.filter_and_cut(record, &self.signal_of(description))
    }

    /// The settings for a recording, which may state a window of its own.
    pub(crate) fn signal_of(&self, description: Option<&RecordingDescription>) -> SignalDescription {
        let own = description.map(|d| (d.window_start_s, d.window_end_s)).filter(|w| *w != (None, None));
        match own {
            Some((window_start_s, window_end_s)) => {
                SignalDescription { window_start_s, window_end_s, ..self.file.signal }
            }
            None => self.file.signal,
        }
    }

    /// Filters and differentiates the whole record, then cuts it to its moving part.
    pub(super) fn filter_moving_part(&self, record: Record) -> Result<FilteredRecord, ExperimentError> {
        let signal = SignalDescription { window_start_s: None, window_end_s: None, ..self.file.signal };
        self.filter_and_cut(record, &signal)
    }

    fn filter_and_cut(&self, record: Record, signal: &SignalDescription) -> Result<FilteredRecord, ExperimentError> {
        let refuse = |source| ExperimentError::Signal { path: self.path.clone(), source };
        self.require_periods(record.position.len(), record.sample_rate_hz)?;
        let (q, dq, ddq) = self.band_pass(&record.position, record.sample_rate_hz).map_err(refuse)?;
        let window = self.window(&dq, record.sample_rate_hz, signal)?;
        let cut = |series: &Series| series.window(window.clone());
        Ok(FilteredRecord { q: cut(&q), dq: cut(&dq), ddq: cut(&ddq), record, window })
    }

    /// A record must be long beside the period of the position filter.
    pub(crate) fn require_periods(&self, samples: usize, sample_rate_hz: f64) -> Result<(), ExperimentError> {
        let cutoff_hz = self.file.signal.cutoff_hz;
        let slowest = FEWEST_PERIODS * sample_rate_hz / samples as f64;
        let expected = format!("at least {slowest:.3}, {FEWEST_PERIODS} periods in the record");
        self.require(cutoff_hz >= slowest, "[signal] cutoff_hz", &expected, cutoff_hz)
    }

    /// Position, velocity and acceleration by the zero-phase Butterworth filter and central differences (III-A).
    pub(crate) fn band_pass(
        &self,
        position: &Series,
        sample_rate_hz: f64,
    ) -> Result<(Series, Series, Series), SignalError> {
        let filter = self.position_filter(sample_rate_hz)?;
        let q = zero_phase(&filter, position, Padding::Matlab)?;
        let dq = central_difference(&q, sample_rate_hz);
        let ddq = central_difference(&dq, sample_rate_hz);
        Ok((q, dq, ddq))
    }

    /// The filter of the positions, one pass.
    pub(crate) fn position_filter(&self, sample_rate_hz: f64) -> Result<SecondOrderSections, SignalError> {
        let signal = &self.file.signal;
        SecondOrderSections::butterworth_lowpass(signal.filter_order, signal.cutoff_hz, sample_rate_hz)
    }

    /// The stated window, or the moving part without the edges of the filter. A record without motion is refused in both
    /// cases.
    fn window(
        &self,
        dq: &Series,
        sample_rate_hz: f64,
        signal: &SignalDescription,
    ) -> Result<Range<usize>, ExperimentError> {
        let refuse = |source| ExperimentError::Signal { path: self.path.clone(), source };
        let moving = moving_samples(dq, MOVING, STILL).map_err(refuse)?;
        self.window_of(moving, dq.len(), sample_rate_hz, signal)
    }

    /// The window of a record of so many samples that moves in a range of them.
    pub(crate) fn window_of(
        &self,
        moving: Range<usize>,
        samples: usize,
        sample_rate_hz: f64,
        signal: &SignalDescription,
    ) -> Result<Range<usize>, ExperimentError> {
        let sample = |t: f64| (t * sample_rate_hz).round() as usize;
        let edge = (EDGE_PERIODS * sample_rate_hz / signal.cutoff_hz).ceil() as usize;
        let start = signal.window_start_s.map_or(moving.start.max(edge), sample);
        let end = match (signal.window_start_s, signal.window_end_s) {
            (_, Some(end)) => sample(end),
            (Some(_), None) => samples,
            (None, None) => moving.end.min(samples.saturating_sub(edge)),
        };
        if end > samples {
            let found = format!("{} s", signal.window_end_s.unwrap_or_default());
            let record = format!("at most the record's {:.4} s", samples as f64 / sample_rate_hz);
            return Err(self.value("[signal] window_end_s", &record, found));
        }
        if start >= end {
            let found = format!("{start} to {end}");
            return Err(self.value("[signal] the window, in samples,", "a start before its end", found));
        }
        Ok(start..end)
    }

    /// Sends an impulse through the filters as they are used on the record, and measures where they are 3 dB down.
    pub(crate) fn measure_bandwidth(&self, sample_rate_hz: f64) -> Result<Bandwidth, ExperimentError> {
        let refuse = |source| ExperimentError::Signal { path: self.path.clone(), source };
        let signal = &self.file.signal;
        let decimation_cutoff_hz = 0.8 * 0.5 * sample_rate_hz / signal.decimation as f64;
        let length = |cutoff: f64| (PROBE_PERIODS * sample_rate_hz / cutoff).ceil() as usize;
        let filtered = length(signal.cutoff_hz);
        let position = minus_3_db_bandwidth_hz(sample_rate_hz, filtered, 0, |x| {
            self.band_pass(x, sample_rate_hz).map(|(q, _, _)| q)
        });
        let acceleration = minus_3_db_bandwidth_hz(sample_rate_hz, filtered, 2, |x| {
            self.band_pass(x, sample_rate_hz).map(|(_, _, ddq)| ddq)
        });
        let decimated = length(decimation_cutoff_hz);
        let decimation = Decimator::new(signal.decimation, decimated)
            .and_then(|d| minus_3_db_bandwidth_hz(sample_rate_hz, decimated, 0, |x| d.filter(x)));
        Ok(Bandwidth {
            position_cutoff_hz: signal.cutoff_hz,
            position_measured_hz: position.map_err(refuse)?,
            acceleration_measured_hz: acceleration.map_err(refuse)?,
            decimation_cutoff_hz,
            decimation_measured_hz: decimation.map_err(refuse)?,
        })
    }
}

/// The regression problem of one friction model, over all recordings.
pub(crate) struct Problem {
    pub(super) model: Model,
    /// All base parameters.
    pub(super) base: BaseParameters,
    /// Those that are estimated.
    pub(crate) estimated: BaseParameters,
    pub(super) elimination: Option<Elimination>,
    /// The parallel filter of each recording.
    pub(super) decimators: Vec<Decimator>,
    pub(crate) rows: Rows,
    pub(crate) x: Matrix,
    pub(crate) y: Vec<f64>,
    /// X of all base parameters, where fewer are estimated.
    pub(super) full_x: Option<Matrix>,
}

impl Experiment {
    /// Builds y and X for a friction model, and chooses the parameters.
    pub(super) fn problem(&self, robot: &Robot, recordings: &[&FilteredRecord]) -> Result<Problem, ExperimentError> {
        self.problem_on(self.basis(robot)?, recordings, &self.file.parameters.estimate)
    }

    /// The model of a robot with its base parameters: what the problems of all its records share.
    pub(crate) fn basis(&self, robot: &Robot) -> Result<(Model, BaseParameters), ExperimentError> {
        let model = Model::new(robot);
        let refuse = |source| ExperimentError::Parameters { path: self.path.clone(), source };
        let base = BaseParameters::of(&model, &self.file.parameters.exclude).map_err(refuse)?;
        Ok((model, base))
    }

    /// Builds y and X of other recordings for parameters that are estimated already.
    pub(super) fn validation_problem(
        &self,
        robot: &Robot,
        recordings: &[&FilteredRecord],
        estimated: &BaseParameters,
    ) -> Result<Problem, ExperimentError> {
        let names = estimated.parameters().iter().map(|p| p.name.clone()).collect();
        self.problem_on(self.basis(robot)?, recordings, &ParameterChoice::List(names))
    }

    /// The parameters of the base that are estimated, where no record has to choose them.
    pub(crate) fn estimated(&self, model: &Model, base: &BaseParameters) -> Result<BaseParameters, ExperimentError> {
        let ParameterChoice::List(names) = &self.file.parameters.estimate else { return Ok(base.clone()) };
        let refuse = |source| ExperimentError::Parameters { path: self.path.clone(), source };
        base.select(model.parameter_table(), names).map_err(refuse)
    }

    /// Builds y and X of records for the parameters chosen from the base.
    pub(crate) fn problem_on(
        &self,
        (model, base): (Model, BaseParameters),
        recordings: &[&FilteredRecord],
        choice: &ParameterChoice,
    ) -> Result<Problem, ExperimentError> {
        let refuse_signal = |source| ExperimentError::Signal { path: self.path.clone(), source };
        let refuse = |source| ExperimentError::Parameters { path: self.path.clone(), source };
        self.require_rows(recordings, choice, base.len())?;
        let decimator = |r: &&FilteredRecord| Decimator::new(self.file.signal.decimation, r.window.len());
        let decimators = recordings.iter().map(decimator).collect::<Result<Vec<_>, _>>().map_err(refuse_signal)?;
        let rows = Rows::new(model.coordinate_count(), decimators.iter().map(Decimator::rows).collect());
        let (mut matrices, mut vectors) = (Vec::new(), Vec::new());
        for (recording, decimator) in recordings.iter().zip(&decimators) {
            let assembly = Assembly::new(&model, &base.columns(), decimator.clone());
            let torque = recording.record.torque.window(recording.window.clone());
            matrices.push(recording.observation_matrix(&assembly).map_err(refuse_signal)?);
            vectors.push(assembly.measurement_vector(&torque).map_err(refuse_signal)?);
        }
        let (full_x, y) = (rows.stack_matrices(matrices), rows.stack_vectors(vectors));
        let (chosen, elimination) = self.choose(choice, (&model, &base), &full_x, &y)?;
        let estimated = base.select(model.parameter_table(), &chosen).map_err(refuse)?;
        let column = |p: &crate::base_parameters::BaseParameter| base.columns().iter().position(|&c| c == p.kept);
        let columns: Vec<usize> = estimated.parameters().iter().filter_map(column).collect();
        let (x, full_x) =
            if columns.len() == base.len() { (full_x, None) } else { (full_x.select_columns(&columns), Some(full_x)) };
        Ok(Problem { model, base, estimated, elimination, decimators, rows, x, y, full_x })
    }

    /// A decimation must leave more rows than there are parameters, with which the estimation begins.
    fn require_rows(
        &self,
        recordings: &[&FilteredRecord],
        choice: &ParameterChoice,
        base: usize,
    ) -> Result<(), ExperimentError> {
        let parameters = if let ParameterChoice::List(names) = choice { names.len() } else { base };
        let decimation = self.file.signal.decimation;
        let rows: usize = recordings.iter().map(|r| r.q.channels() * r.window.len().div_ceil(decimation)).sum();
        let expected = format!("a smaller factor or a longer window: {rows} rows are left for {parameters} parameters");
        self.require(rows > parameters, "[signal] decimation", &expected, decimation)
    }

    fn choose(
        &self,
        choice: &ParameterChoice,
        (model, base): (&Model, &BaseParameters),
        x: &Matrix,
        y: &[f64],
    ) -> Result<(Vec<String>, Option<Elimination>), ExperimentError> {
        let name = |i: usize| base.parameters()[i].name.clone();
        let all = || (0..base.len()).map(name).collect::<Vec<_>>();
        let unknown = |source| ExperimentError::Parameters { path: self.path.clone(), source };
        base.select(model.parameter_table(), &self.file.parameters.show).map_err(unknown)?;
        match choice {
            ParameterChoice::Base | ParameterChoice::Named(NamedChoice::Base) => Ok((all(), None)),
            ParameterChoice::List(names) => Ok((names.clone(), None)),
            ParameterChoice::Named(NamedChoice::Essential) => {
                // A set that cannot be estimated as a whole has nothing to start an elimination from; its runs say why.
                match eliminate(x, y, self.file.parameters.elimination) {
                    Ok(result) => Ok((result.kept.iter().map(|&i| name(i)).collect(), Some(result))),
                    Err(_) => Ok((all(), None)),
                }
            }
        }
    }
}

impl FilteredRecord {
    /// X of the measured motion.
    pub(super) fn observation_matrix(&self, assembly: &Assembly<'_>) -> Result<Matrix, SignalError> {
        assembly.observation_matrix(&self.q, &self.dq, &self.ddq, Sign::Exact)
    }

    /// Time of the first sample of the window, s.
    pub(super) fn start_s(&self) -> f64 {
        self.window.start as f64 / self.record.sample_rate_hz
    }
}

impl Problem {
    /// The assembly of one recording.
    pub(super) fn assembly(&self, recording: usize) -> Assembly<'_> {
        Assembly::new(&self.model, &self.estimated.columns(), self.decimators[recording].clone())
    }

    pub(crate) fn joints(&self) -> usize {
        self.model.coordinate_count()
    }

    /// A vector with the rows of y, joint by joint.
    pub(super) fn by_joint(&self, rows: &[f64]) -> Vec<Vec<f64>> {
        rows.chunks(self.rows.per_joint()).map(<[f64]>::to_vec).collect()
    }

    /// The relative error of each joint, percent; none where its torque is zero.
    pub(super) fn joint_errors(&self, prediction: &[f64]) -> Vec<Option<f64>> {
        let rows = self.rows.per_joint();
        let error = |(y, p)| Some(relative_error_percent(y, p)).filter(|e| e.is_finite());
        self.y.chunks(rows).zip(prediction.chunks(rows)).map(error).collect()
    }

    /// One series for each recording at the decimated instants, one vector per joint.
    pub(super) fn at_rows(&self, series: &[&Series]) -> Vec<Vec<f64>> {
        let of_recording =
            |j| self.decimators.iter().zip(series).flat_map(move |(d, s)| d.kept().map(move |k| s.sample(k)[j]));
        (0..self.joints()).map(|j| of_recording(j).collect()).collect()
    }

    /// Curves of a prediction.
    pub(super) fn plots(&self, prediction: &[f64], simulated: &[SimulatedMotion]) -> RunPlots {
        let positions: Vec<&Series> = simulated.iter().map(|m| &m.q).collect();
        RunPlots {
            predicted: self.by_joint(prediction),
            simulated_position: if positions.is_empty() { Vec::new() } else { self.at_rows(&positions) },
        }
    }
}
