//! The choice of the filter with the least error of the estimates.

use std::{collections::BTreeMap, ops::Range};

use super::{
    bands,
    error::FilterChoiceError,
    grid::{FilterGrid, for_dynamics},
    low_pass::rate_of_noise,
    recorder::Recorder,
    score::{Errors, Tried, relative_errors, sizes},
    separated::separated,
    twin::{Mover, RecordingTwin},
};
use crate::preparation::{
    Basis, Case, FilteredRecording, ParameterChoice, ParameterSelection, PositionFilter, PreparationError, Problem,
    Recording, Settings, Setup, SignalOptions, propose_controller,
};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{Divisor, Method, idim_ls},
    signal::Spectrum,
};
use thetahat_ground::{pool, series::Series};
use thetahat_model::{
    base_parameters::BaseParameters,
    consistency::{InteriorOptions, nearest_to_simulate},
    robot::Robot,
};
use thetahat_report::results::{ComparedFilter, Filter, FilterChoice, FilterError};

/// Limits of the number of recordings of a twin, each with its own noise of the positions, and the samples of all joints that they
/// have together.
const RECORDINGS: [usize; 2] = [3, 10];
const SAMPLES: usize = 600_000;
/// Draws of the noise of the torques, and how many of them each of these recordings takes, in turn.
const TORQUE_DRAWS: usize = 12;
const DRAWS_OF_EACH: usize = 4;
/// Most operations for all filters on a twin: some seconds.
const MOST_WORK: f64 = 1e11;
/// Operations for each entry of the observation matrix of a sample: the regressor and the parallel filter.
const OF_ENTRY: f64 = 20.0;
/// Number of twins: each is made with the filter that the earlier ones chose.
const TWINS: usize = 2;
/// Octaves within which filters are neighbours: half an octave in both of their parts.
const NEIGHBOURS: f64 = 0.8;
/// Rows per parameter that a chosen filter keeps if the recording has them: with fewer, chance decides which motions they contain,
/// and a twin with slightly different parameters does not predict the errors.
const ROWS_PER_PARAMETER: f64 = 10.0;
/// Longest part of a recording from which a twin is made, in samples.
const LONGEST: usize = 40_000;

/// The filter with which IDIM-LS gives the estimates that are nearest to the truth, on twins of the longest recording.
///
/// Of the settings, everything but the filter counts: which parameters are estimated, the order of the filter, the window. The
/// filter `also` is compared with those of the grid. The result does not depend on the number of `threads`.
///
/// # Errors
/// [`FilterChoiceError`] if no recording can be filtered or gives an estimate.
pub fn choose_filter(
    robot: &Robot,
    settings: &Settings,
    recordings: &[Recording],
    also: Option<Filter>,
    threads: usize,
) -> Result<FilterChoice, FilterChoiceError> {
    if !robot.channels().is_empty() {
        return Err(FilterChoiceError::Channels);
    }
    if robot.base_coordinates() > 0 {
        return Err(FilterChoiceError::FloatingBase);
    }
    recordings.iter().try_for_each(|recording| recording.validate(robot.coordinate_count()))?;
    let with_torque = recordings.iter().filter(|r| r.torque.is_some());
    let longest = with_torque.max_by_key(|r| r.position.len()).ok_or(FilterChoiceError::NoTorque)?;
    let longest = &longest.clone().unwrapped(robot);
    let whole = Study::new(robot, settings, longest.clone())?;
    let stretch = whole.moving_stretch(for_dynamics(whole.dynamics_hz(), longest.sample_rate_hz))?;
    let samples: usize = recordings.iter().map(|r| r.position.len()).sum();
    let part = stretch.position.len() as f64 / samples as f64;
    // The whole part is the window.
    let signal = SignalOptions { window_start_s: None, window_end_s: None, ..settings.signal };
    let study = Study { recording: stretch, part, settings: Settings { signal, ..whole.settings }, ..whole };
    study.choose(also, threads)
}

/// The estimates of all base parameters by IDIM-LS with a filter.
///
/// # Errors
/// [`FilterChoiceError`] where the recording cannot be filtered or gives no estimate.
pub fn estimate_with_filter(
    robot: &Robot,
    recording: &Recording,
    filter: Filter,
) -> Result<Vec<f64>, FilterChoiceError> {
    recording.validate(robot.coordinate_count())?;
    let study = Study::new(robot, &Settings::new(filter.cutoff_hz, filter.decimation), recording.clone())?;
    let settings = study.settings_with(filter);
    let (problem, _) = study.problem(&settings, recording, &ParameterChoice::Base)?;
    Ok(idim_ls(&problem.regression, Divisor::default())?.theta)
}

/// A part of a recording from which twins are made.
struct Study<'a> {
    robot: &'a Robot,
    settings: Settings,
    recording: Recording,
    /// Fraction of all samples in this part: the variance of torque noise is that much smaller with the whole recording.
    part: f64,
    basis: Basis,
}

/// A twin and the parameters that are estimated from it.
struct Twin {
    recording: RecordingTwin,
    names: ParameterChoice,
    truth: Vec<f64>,
    sizes: Vec<f64>,
}

/// A physically possible robot near the estimate.
struct Truth {
    estimated: BaseParameters,
    /// Standard parameters of a robot near the estimate.
    standard: Vec<f64>,
    recorder: Recorder,
    controller: ControllerDescription,
}

impl<'a> Study<'a> {
    fn new(robot: &'a Robot, settings: &Settings, recording: Recording) -> Result<Self, PreparationError> {
        // Fixed parameters and payloads are part of the twin.
        let parameters = ParameterSelection { fix: BTreeMap::new(), ..settings.parameters.clone() };
        let settings = Settings { parameters, payloads: Vec::new(), ..settings.clone() };
        let basis = Setup { robot, settings: &settings }.basis(&Case::nominal())?;
        Ok(Self { robot, settings, recording, part: 1.0, basis })
    }

    /// The settings with another filter.
    fn settings_with(&self, filter: Filter) -> Settings {
        let Filter { cutoff_hz, decimation } = filter;
        let position = PositionFilter::Butterworth;
        let signal = SignalOptions { position, cutoff_hz, decimation, ..self.settings.signal };
        Settings { signal, ..self.settings.clone() }
    }

    /// The frequency below which nearly all of each joint's velocity lies, Hz: no noise can be in it.
    fn dynamics_hz(&self) -> f64 {
        let spectrum = Spectrum::of(&self.recording.position, self.recording.sample_rate_hz);
        let rate = rate_of_noise(&self.recording);
        let dynamics = |j| bands::dynamics_hz(&spectrum, j, rate);
        (0..self.recording.position.channels()).map(dynamics).fold(0.0, f64::max)
    }

    /// The window of the recording, or the middle of it if it is too long.
    fn moving_stretch(&self, filter: Filter) -> Result<Recording, PreparationError> {
        let settings = self.settings_with(filter);
        let window = Setup { robot: self.robot, settings: &settings }.filter(self.recording.clone())?.window;
        let kept = window.len().min(LONGEST);
        let start = window.start + (window.len() - kept) / 2;
        let cut = |series: &Series| series.window(start..start + kept);
        let Recording { sample_rate_hz, position, torque, reference, gaps, .. } = &self.recording;
        let gap = |gap: &Range<usize>| {
            let (from, to) = (gap.start.max(start), gap.end.min(start + kept));
            (from < to).then(|| from - start..to - start)
        };
        Ok(Recording {
            gaps: gaps.iter().filter_map(gap).collect(),
            torque: torque.as_ref().map(cut),
            torque_hold_s: self.recording.torque_hold_s,
            reference: reference.as_ref().map(cut),
            ..Recording::without_torque(*sample_rate_hz, cut(position))
        })
    }

    /// The best filter of a grid on several twins, each made with the filter that is the best on those before.
    fn choose(&self, own: Option<Filter>, threads: usize) -> Result<FilterChoice, FilterChoiceError> {
        let sample_rate_hz = self.recording.sample_rate_hz;
        let dynamics_hz = self.dynamics_hz();
        let first = for_dynamics(dynamics_hz, sample_rate_hz);
        // Below the usual filter the motion itself is cut: a twin may favour that by chance, where static friction hides the rest.
        let passing = |f: &Filter| f.cutoff_hz >= first.cutoff_hz && f.decimation <= first.decimation;
        let around = FilterGrid::around(dynamics_hz, sample_rate_hz).filters;
        let passing: Vec<Filter> = around.iter().filter(|f| passing(f)).copied().collect();
        let grid = self.with_rows(if passing.is_empty() { around } else { passing });
        let filters: Vec<Filter> = grid.into_iter().chain(own).collect();
        let of_grid = 0..filters.len() - own.iter().len();
        let copies = self.copies(&filters)?;
        let twin = self.twin(first, first)?;
        let mut estimates = self.estimates(&filters, &twin.names, threads);
        let mut names = twin.names.clone();
        let mut errors = self.relative_errors(&twin, (&filters, &estimates), copies, threads);
        for _ in 1..TWINS {
            let twin = self.twin(best(&filters[of_grid.clone()], &errors).unwrap_or(first), first)?;
            if twin.names != names {
                estimates = self.estimates(&filters, &twin.names, threads);
                names.clone_from(&twin.names);
            }
            let others = self.relative_errors(&twin, (&filters, &estimates), copies, threads);
            errors = errors.iter().zip(&others).map(|(a, b)| Some(FilterError::mean(&[(*a)?, (*b)?]))).collect();
        }
        let errors = smoothed(&filters, &errors);
        let best = best(&filters[of_grid], &errors).unwrap_or(first);
        let with_error = |(&filter, error): (&Filter, _)| ComparedFilter { filter, error };
        let mut compared: Vec<ComparedFilter> = filters.iter().zip(errors).map(with_error).collect();
        let own = own.and_then(|_| compared.pop());
        Ok(FilterChoice { best, own, sample_rate_hz, dynamics_hz, compared })
    }

    /// The filters that keep enough rows, or those that keep the most if none does.
    fn with_rows(&self, filters: Vec<Filter>) -> Vec<Filter> {
        let samples = self.recording.position.values().len() as f64 / self.part;
        let most = samples / (ROWS_PER_PARAMETER * self.basis.base.len() as f64);
        let least = filters.iter().map(|f| f.decimation).min().unwrap_or(1);
        filters.into_iter().filter(|f| f.decimation as f64 <= most.max(least as f64)).collect()
    }

    /// A twin with the parameters that a filter gives: its noise is the residual of the estimate, its motion that of a robot near the
    /// estimate that follows the recorded motion after the position filter of `motion`.
    fn twin(&self, filter: Filter, motion: Filter) -> Result<Twin, FilterChoiceError> {
        let Truth { estimated, standard, controller, recorder } = self.truth(filter)?;
        let model = &self.basis.model;
        let mover = Mover { robot: self.robot, model, theta: &standard, controller: &controller };
        let recording = RecordingTwin::new(&self.recording, motion.cutoff_hz, &recorder, &mover)?;
        let names = ParameterChoice::List(estimated.parameters().iter().map(|p| p.name.clone()).collect());
        let truth = estimated.from_standard(&standard);
        let sizes = sizes(model, &estimated, &truth);
        Ok(Twin { recording, names, truth, sizes })
    }

    /// The number of recordings of a twin, as many as their work allows.
    fn copies(&self, filters: &[Filter]) -> Result<usize, FilterChoiceError> {
        let position = &self.recording.position;
        let (values, joints, parameters) = (position.values().len(), position.channels(), self.basis.base.len());
        let entries = OF_ENTRY * 0.5 * (values * parameters) as f64;
        let rows = |filter: &Filter| values as f64 / filter.decimation as f64;
        let work: f64 = filters.iter().map(|f| entries + 4.0 * rows(f) * (parameters * parameters) as f64).sum();
        let most = (MOST_WORK / work) as usize;
        if most == 0 {
            return Err(FilterChoiceError::TooLarge { parameters, joints });
        }
        Ok((SAMPLES / values).clamp(RECORDINGS[0], RECORDINGS[1]).min(most))
    }

    /// The errors of the estimates from a twin with each filter, whose estimates from the recording itself are known.
    fn relative_errors(
        &self,
        twin: &Twin,
        (filters, estimates): (&[Filter], &[Option<Vec<f64>>]),
        copies: usize,
        threads: usize,
    ) -> Vec<Option<FilterError>> {
        let recordings: Vec<Recording> = (0..copies).map(|seed| twin.recording.record(seed as u64)).collect();
        let noise = twin.recording.torque_noise(TORQUE_DRAWS);
        let errors = in_groups(filters, threads, |group| {
            let of_copies = recordings.iter().zip(noise.chunks(DRAWS_OF_EACH).cycle());
            let by_copy: Vec<Vec<Option<Errors>>> =
                of_copies.map(|(recording, noise)| self.errors(recording, noise, group, twin)).collect();
            let of = |i: usize| by_copy.iter().map(|errors| errors[i].clone()).collect::<Vec<_>>();
            (0..group.len()).map(|i| Errors::mean(&of(i))).collect()
        });
        let tried = |((&filter, errors), estimates): ((&Filter, Option<Errors>), &Option<Vec<f64>>)| {
            Some(Tried { filter, estimates: estimates.clone()?, errors: errors?.within(&twin.sizes) })
        };
        let all: Vec<Option<Tried>> = filters.iter().zip(errors).zip(estimates).map(tried).collect();
        relative_errors(&all, &twin.sizes, self.part)
    }

    /// The estimates from the recording itself with each filter.
    fn estimates(&self, filters: &[Filter], names: &ParameterChoice, threads: usize) -> Vec<Option<Vec<f64>>> {
        in_groups(filters, threads, |group| {
            let filtered = self.filtered(group[0], &self.recording);
            let estimate = |filter: &Filter| {
                let problem = self.problem_of(*filter, filtered.as_ref()?, names).ok()?;
                Some(idim_ls(&problem.regression, Divisor::default()).ok()?.theta)
            };
            group.iter().map(estimate).collect()
        })
    }

    /// The errors of the estimates from a noisy recording of a twin, with each filter of a common cut-off.
    fn errors(&self, recording: &Recording, noise: &[Series], group: &[Filter], twin: &Twin) -> Vec<Option<Errors>> {
        let filtered = self.filtered(group[0], recording);
        group.iter().map(|filter| self.errors_with(*filter, filtered.as_ref()?, noise, twin)).collect()
    }

    fn errors_with(
        &self,
        filter: Filter,
        filtered: &FilteredRecording,
        noise: &[Series],
        twin: &Twin,
    ) -> Option<Errors> {
        let Twin { names, truth, .. } = twin;
        let problem = self.problem_of(filter, filtered, names).ok()?;
        let influence = Method::IDIM_LS.influence(&problem.regression, None).ok()?;
        let found = influence.transpose_times(&problem.regression.y);
        let bias: Vec<f64> = found.iter().zip(truth).map(|(found, truth)| found - truth).collect();
        let mut variance = vec![0.0; truth.len()];
        let mut draws = Vec::new();
        for rows in problem.assembly(0).measurement_vectors(noise, filtered.window.start).ok()? {
            let errors = influence.transpose_times(&rows);
            let share = self.part / noise.len() as f64;
            variance.iter_mut().zip(&errors).for_each(|(v, e)| *v += share * e * e);
            draws.push(bias.iter().zip(errors).map(|(bias, error)| bias + error).collect());
        }
        Some(Errors { bias: bias.iter().map(|b| b * b).collect(), variance, draws })
    }

    /// A recording after the position filter.
    fn filtered(&self, filter: Filter, recording: &Recording) -> Option<FilteredRecording> {
        Setup { robot: self.robot, settings: &self.settings_with(filter) }.filter(recording.clone()).ok()
    }

    /// X and y of a recording that passed the position filter already.
    fn problem_of(
        &self,
        filter: Filter,
        filtered: &FilteredRecording,
        choice: &ParameterChoice,
    ) -> Result<Problem, PreparationError> {
        let settings = self.settings_with(filter);
        Setup { robot: self.robot, settings: &settings }.problem_on(self.basis.clone(), &[filtered], choice)
    }

    /// The robot nearest to the estimate with a filter, with the parameters that the motion separates.
    fn truth(&self, filter: Filter) -> Result<Truth, FilterChoiceError> {
        let settings = self.settings_with(filter);
        let (problem, filtered) = self.problem(&settings, &self.recording, &ParameterChoice::Base)?;
        let (columns, theta) = separated(&problem.regression)?;
        let name = |&c: &usize| problem.estimated.parameters()[c].name.clone();
        let names: Vec<String> = columns.iter().map(name).collect();
        let estimated = problem.base.select(problem.model.parameter_table(), &names).map_err(PreparationError::from)?;
        let mut all = vec![0.0; problem.base.len()];
        columns.iter().zip(theta).for_each(|(&c, value)| all[c] = value);
        let set = problem.consistent_set(Setup { robot: self.robot, settings: &settings });
        let r = problem.regression.x.triangular_factor();
        let options = InteriorOptions::default();
        let near = set.ok().and_then(|set| nearest_to_simulate(set, &problem.base, &r, &all, &options, None).ok());
        let found = problem.base.to_standard(&all);
        let recorder = Recorder::of(&problem, &filtered, &columns, &found)?;
        let standard = near.map_or(found, |fit| fit.standard);
        Ok(Truth { estimated, standard, recorder, controller: propose_controller(&[&filtered]).description })
    }

    /// X and y of a recording with a filter.
    fn problem(
        &self,
        settings: &Settings,
        recording: &Recording,
        choice: &ParameterChoice,
    ) -> Result<(Problem, FilteredRecording), PreparationError> {
        let setup = Setup { robot: self.robot, settings };
        let filtered = setup.filter(recording.clone())?;
        Ok((setup.problem_on(self.basis.clone(), &[&filtered], choice)?, filtered))
    }
}

/// Something of each filter, in their order, from what `of` makes of the filters of one cut-off: they share the filtered motion.
fn in_groups<T: Send>(filters: &[Filter], threads: usize, of: impl Fn(&[Filter]) -> Vec<T> + Sync) -> Vec<T> {
    let mut order: Vec<usize> = (0..filters.len()).collect();
    order.sort_by(|&a, &b| filters[b].cutoff_hz.total_cmp(&filters[a].cutoff_hz));
    let sorted: Vec<Filter> = order.iter().map(|&i| filters[i]).collect();
    let groups: Vec<&[Filter]> = sorted.chunk_by(|a, b| a.cutoff_hz == b.cutoff_hz).collect();
    let found = pool::in_parallel(groups.len(), threads, |g| of(groups[g]));
    let mut placed: Vec<(usize, T)> = order.into_iter().zip(found.into_iter().flatten()).collect();
    placed.sort_by_key(|(i, _)| *i);
    placed.into_iter().map(|(_, found)| found).collect()
}

/// The filter with the least error.
fn best(filters: &[Filter], errors: &[Option<FilterError>]) -> Option<Filter> {
    let totals = filters.iter().zip(errors).filter_map(|(filter, error)| Some((*filter, error.as_ref()?.total)));
    totals.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(filter, _)| filter)
}

/// The geometric means of the errors over each filter and its neighbours: the error of one filter on few recordings is partly chance.
fn smoothed(filters: &[Filter], errors: &[Option<FilterError>]) -> Vec<Option<FilterError>> {
    let around = |(filter, error): (&Filter, &Option<FilterError>)| {
        error.as_ref()?;
        let pairs = filters.iter().zip(errors).filter(|(other, _)| octaves(*filter, **other) <= NEIGHBOURS);
        Some(FilterError::mean(&pairs.filter_map(|(_, error)| *error).collect::<Vec<_>>()))
    };
    filters.iter().zip(errors).map(around).collect()
}

/// How far apart filters are, octaves.
fn octaves(a: Filter, b: Filter) -> f64 {
    let cutoffs = (a.cutoff_hz / b.cutoff_hz).log2();
    cutoffs.hypot((a.decimation as f64 / b.decimation as f64).log2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_a_neighbourhood() {
        let filter = |cutoff_hz, decimation| Filter { cutoff_hz, decimation };
        let error = |total| Some(FilterError { total, bias: total });
        // The lucky one at 40 Hz stands among filters that are worse than those around 10 Hz.
        let filters =
            [filter(7.0, 8), filter(10.0, 8), filter(14.0, 8), filter(28.0, 2), filter(40.0, 2), filter(56.0, 2)];
        let errors = [error(1.1), error(1.1), error(1.1), error(4.0), error(1.0), None];
        let smooth = smoothed(&filters, &errors);
        assert_eq!(best(&filters, &errors), Some(filters[4]));
        assert!((smooth[1].unwrap().total - 1.1).abs() < 1e-12 && (smooth[4].unwrap().bias - 2.0).abs() < 1e-12);
        assert_eq!((smooth[5], best(&filters, &smooth).map(|f| f.decimation)), (None, Some(8)));
    }
}
