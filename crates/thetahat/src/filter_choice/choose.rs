//! The choice of the filter with the least error of the estimates.

use super::{
    bands,
    grid::{Filter, FilterGrid},
    score::{Errors, RelativeError, relative_errors},
    twin::{Noise, RecordTwin},
};
use crate::{
    base_parameters::BaseParameters,
    consistency::{SimulationOptions, nearest_to_simulate},
    control::ControllerDescription,
    identification::{Divisor, EstimationError, Method, idim_ls},
    pool,
    preparation::{
        Basis, Case, FilteredRecording, ParameterChoice, PreparationError, Problem, Recording, Settings, Setup,
        propose_controller,
    },
    regression::Regression,
    robot::Robot,
    series::Series,
    signal::{SignalError, Spectrum},
};

/// Records whose positions have other noise.
const RECORDS: usize = 3;
/// Rounds: the second twin is made with the filter that the first one chose.
const ROUNDS: usize = 2;
/// Longest stretch of a record of which a twin is made, in samples.
const LONGEST: usize = 40_000;

/// A filter, and what the others give.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterChoice {
    /// The filter.
    pub filter: Filter,
    /// The highest frequency of the motion of each joint, Hz.
    pub bands_hz: Vec<f64>,
    /// Every filter that was compared, with the error of the estimates; none where the filter gives no estimate.
    pub compared: Vec<(Filter, Option<RelativeError>)>,
}

/// Why no filter can be chosen.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum FilterChoiceError {
    /// The recording cannot be used.
    #[error("{source}")]
    Preparation {
        /// Why.
        #[from]
        source: PreparationError,
    },
    /// The recording cannot be filtered.
    #[error("{source}")]
    Signal {
        /// Why.
        #[from]
        source: SignalError,
    },
    /// No estimate.
    #[error("{source}")]
    Estimation {
        /// Why.
        #[from]
        source: EstimationError,
    },
    /// There is no recording with torques.
    #[error("no recording has torques: a filter is chosen from what it does to the estimates")]
    NoTorque,
}

/// The filter with which IDIM-LS gives the estimates that are nearest to the truth, on twins of the longest recording.
///
/// The result does not depend on the number of `threads`.
///
/// # Errors
/// [`FilterChoiceError`] where no recording can be filtered or gives an estimate.
pub fn choose_filter(
    robot: &Robot,
    recordings: &[Recording],
    threads: usize,
) -> Result<FilterChoice, FilterChoiceError> {
    let with_torque = recordings.iter().filter(|r| r.torque.is_some());
    let longest = with_torque.max_by_key(|r| r.position.len()).ok_or(FilterChoiceError::NoTorque)?;
    let samples: usize = recordings.iter().map(|r| r.position.len()).sum();
    let study = Study::new(robot, middle(longest), samples)?;
    let mut choice = study.choose(study.preliminary(), threads)?;
    for _ in 1..ROUNDS {
        choice = study.choose(choice.filter, threads)?;
    }
    Ok(choice)
}

/// The estimates of all base parameters by IDIM-LS behind a filter.
///
/// # Errors
/// [`FilterChoiceError`] where the recording cannot be filtered or gives no estimate.
pub fn estimate_behind(robot: &Robot, recording: &Recording, filter: Filter) -> Result<Vec<f64>, FilterChoiceError> {
    let study = Study::new(robot, recording.clone(), recording.position.len())?;
    let settings = filter.settings();
    let (problem, _) = study.problem(&settings, recording, &ParameterChoice::Base)?;
    Ok(idim_ls(&problem.regression, Divisor::default())?.theta)
}

/// The middle of a record that is too long.
fn middle(recording: &Recording) -> Recording {
    let kept = recording.position.len().min(LONGEST);
    let start = (recording.position.len() - kept) / 2;
    let cut = |series: &Series| series.window(start..start + kept);
    Recording {
        torque: recording.torque.as_ref().map(cut),
        reference: recording.reference.as_ref().map(cut),
        ..Recording::without_torque(recording.sample_rate_hz, cut(&recording.position))
    }
}

/// A stretch of a record of which twins are made.
struct Study<'a> {
    robot: &'a Robot,
    recording: Recording,
    /// Part of all samples that the stretch has: the noise of torques counts that much less in the whole record.
    part: f64,
    basis: Basis,
}

/// An estimate that a robot can have.
struct Truth {
    estimated: BaseParameters,
    standard: Vec<f64>,
    controller: ControllerDescription,
}

impl<'a> Study<'a> {
    fn new(robot: &'a Robot, recording: Recording, samples: usize) -> Result<Self, PreparationError> {
        let settings = Settings::new(1.0, 1);
        let basis = Setup { robot, settings: &settings }.basis(&Case::nominal())?;
        let part = recording.position.len() as f64 / samples as f64;
        Ok(Self { robot, recording, part, basis })
    }

    /// A filter to begin with: at the end of the band of the fastest joint.
    fn preliminary(&self) -> Filter {
        let Recording { sample_rate_hz: rate, position, .. } = &self.recording;
        let spectrum = Spectrum::of(position, *rate);
        let band = |j| bands::above_noise_hz(&spectrum, j, *rate);
        Filter::at_band((0..position.channels()).map(band).fold(0.0, f64::max), *rate)
    }

    /// The best filter of the grid on a twin that is made with the filter before.
    fn choose(&self, before: Filter, threads: usize) -> Result<FilterChoice, FilterChoiceError> {
        let Truth { estimated, standard, controller } = self.truth(before)?;
        let twin = RecordTwin::of(&self.recording, &self.basis.model, &standard)?;
        let twin = twin.simulated(self.robot, &self.basis.model, &standard, &controller);
        let noise = twin.torque_noise();
        let grid = FilterGrid::around(median(&twin.bands_hz), self.recording.sample_rate_hz);
        let names = ParameterChoice::List(estimated.parameters().iter().map(|p| p.name.clone()).collect());
        let truth = estimated.from_standard(&standard);
        let records: Vec<Recording> = (0..RECORDS).map(|seed| twin.record(seed as u64)).collect();
        let filters = &grid.filters;
        let of_filter = |i: usize| {
            let errors = |record: &Recording| self.errors(record, &noise, filters[i], (&names, &truth));
            Errors::mean(&records.iter().map(errors).collect::<Vec<_>>())
        };
        let relative = relative_errors(&pool::in_parallel(filters.len(), threads, of_filter));
        let compared: Vec<(Filter, Option<RelativeError>)> = filters.iter().copied().zip(relative).collect();
        let totals = compared.iter().filter_map(|(filter, error)| Some((*filter, error.as_ref()?.total)));
        let best = totals.min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(FilterChoice { filter: best.map_or(before, |(filter, _)| filter), bands_hz: twin.bands_hz, compared })
    }

    /// The errors of the estimates from a record of a twin whose parameters are known.
    fn errors(
        &self,
        record: &Recording,
        noise: &Noise,
        filter: Filter,
        (names, truth): (&ParameterChoice, &[f64]),
    ) -> Option<Errors> {
        let settings = filter.settings();
        let (problem, filtered) = self.problem(&settings, record, names).ok()?;
        let influence = Method::IDIM_LS.influence(&problem.regression, None).ok()?;
        let found = influence.transpose_times(&problem.regression.y);
        let bias = found.iter().zip(truth).map(|(found, truth)| (found - truth).powi(2)).collect();
        let mut variance = vec![0.0; truth.len()];
        for draw in noise {
            let rows = problem.assembly(0).measurement_vector(&draw.window(filtered.window.clone())).ok()?;
            let errors = influence.transpose_times(&rows);
            let share = self.part / noise.len() as f64;
            variance.iter_mut().zip(errors).for_each(|(v, e)| *v += share * e * e);
        }
        Some(Errors { bias, variance })
    }

    /// The robot nearest to the estimate with a filter, with the parameters that the motion separates.
    fn truth(&self, filter: Filter) -> Result<Truth, FilterChoiceError> {
        let settings = filter.settings();
        let (problem, filtered) = self.problem(&settings, &self.recording, &ParameterChoice::Base)?;
        let (columns, theta) = separated(&problem.regression)?;
        let name = |&c: &usize| problem.estimated.parameters()[c].name.clone();
        let names: Vec<String> = columns.iter().map(name).collect();
        let estimated = problem.base.select(problem.model.parameter_table(), &names).map_err(PreparationError::from)?;
        let mut all = vec![0.0; problem.base.len()];
        columns.iter().zip(theta).for_each(|(&c, value)| all[c] = value);
        let set = problem.consistent_set(Setup { robot: self.robot, settings: &settings });
        let r = problem.regression.x.triangular_factor();
        let options = SimulationOptions::default();
        let near = set.ok().and_then(|set| nearest_to_simulate(set, &problem.base, &r, &all, &options, None).ok());
        let standard = near.map_or_else(|| problem.base.to_standard(&all), |fit| fit.standard);
        Ok(Truth { estimated, standard, controller: propose_controller(&[&filtered]).description })
    }

    /// X and y of a recording behind a filter.
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

/// The columns that the motion separates, and the estimate with them.
fn separated(regression: &Regression) -> Result<(Vec<usize>, Vec<f64>), EstimationError> {
    let all = 0..regression.x.columns();
    match idim_ls(regression, Divisor::default()) {
        Ok(fit) => Ok((all.collect(), fit.theta)),
        Err(EstimationError::NotIdentifiable { dependent, .. }) => {
            let columns: Vec<usize> = all.filter(|c| !dependent.contains(c)).collect();
            let fit = idim_ls(&regression.with_columns(&columns), Divisor::default())?;
            Ok((columns, fit.theta))
        }
        Err(error) => Err(error),
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
