//! One recording and its runs: measurements, filters, every case and method.

use super::{
    Campaign, CampaignError, Key, Row, Subset,
    facts::Facts,
    noise::{measure, recording_stream},
};
use crate::{
    experiment::{Experiment, ExperimentError, TwinMotion},
    preparation::{Basis, Case, FilteredRecording, PreparationError, RecordedReference, Setup},
    run::{CaseProblem, explain},
    scheduling::{EstimationJob, Finished, RunOptions, Simulator, run_all},
};
use thetahat_estimation::{
    identification::{Fit, Method, Outcome, uncertainty},
    simulation::{NoisySignals, SimulatedMotion, random_numbers},
};
use thetahat_ground::{clock::Stopwatch, linear_algebra::norm, series::Series};
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    robot::Friction,
};

/// What all recordings of a campaign share: the true motion, the base parameters, the starts. It runs any recording of the campaign,
/// one by one and in any order, on several threads.
#[derive(Debug)]
pub struct Bench {
    campaign: Campaign,
    twin: TwinMotion,
    sample_rate_hz: f64,
    cases: Vec<Case>,
    bases: Vec<CaseBasis>,
    starts: Vec<Experiment>,
    pub(super) facts: Facts,
}

/// The base parameters of one friction model, and those estimated, with their true values where they have any.
#[derive(Debug)]
struct CaseBasis {
    friction: Friction,
    basis: Basis,
    truth: Option<Vec<f64>>,
    /// Index of each estimated parameter among the campaign's parameters.
    places: Vec<usize>,
}

/// A filtered recording, with the identification problem of each friction model.
struct PreparedRecording {
    filtered: FilteredRecording,
    reference: RecordedReference,
    problems: Vec<CaseProblem>,
    seconds: f64,
}

impl Bench {
    /// Simulates the true motion, finds the base parameters, and draws the starts within the limits.
    ///
    /// # Errors
    /// [`CampaignError`] for input that cannot be used, and where no start is physical.
    pub fn new(campaign: &Campaign, limits: Subset) -> Result<Self, CampaignError> {
        let experiment = &campaign.experiment;
        let why = "it describes the simulated robot that is recorded";
        let twin = experiment.file.twin.as_ref().ok_or_else(|| experiment.missing("[twin]", why))?;
        let sample_rate_hz = twin.sample_rate_hz;
        let twin = experiment.twin_motion(twin)?;
        let chosen = campaign.file.cases.as_ref();
        let cases: Vec<Case> =
            experiment.cases().into_iter().filter(|c| chosen.is_none_or(|names| names.contains(&c.name))).collect();
        let mut facts = Facts::default();
        let mut bases: Vec<CaseBasis> = Vec::new();
        for case in &cases {
            let friction = case.friction.unwrap_or(experiment.robot.friction);
            if bases.iter().all(|b| b.friction != friction) {
                bases.push(CaseBasis::new(experiment, case, friction, &twin, &mut facts)?);
            }
        }
        let starts = limits.starts.unwrap_or(u32::MAX).min(campaign.file.starts.count);
        let starts = (0..starts).map(|s| campaign.start(s)).collect::<Result<_, _>>()?;
        let campaign = campaign.clone();
        Ok(Self { campaign, twin, sample_rate_hz, cases, bases, starts, facts })
    }

    /// Runs every case and method on the recordings at `keys`: their rows, recording by recording. The rows do not depend on which
    /// recordings are run together.
    ///
    /// # Errors
    /// [`CampaignError`] for a key that is not of the campaign, and for recordings that cannot be used.
    pub fn run(&self, keys: &[Key]) -> Result<Vec<Vec<Row>>, CampaignError> {
        keys.iter().try_for_each(|key| self.require_key(*key))?;
        let prepared = keys.iter().map(|key| self.prepare(*key)).collect::<Result<Vec<_>, _>>()?;
        let methods = &self.campaign.file.methods;
        let pairs = || self.cases.iter().flat_map(|case| methods.iter().map(move |method| (case, *method)));
        let all: Vec<(usize, &Case, Method)> =
            (0..keys.len()).flat_map(|r| pairs().map(move |(case, method)| (r, case, method))).collect();
        let jobs: Vec<EstimationJob<'_>> =
            all.iter().map(|&(r, case, method)| self.job(keys[r], &prepared[r], case, method)).collect();
        let mut rows: Vec<Option<Row>> = vec![None; all.len()];
        let Ok(()) = run_all(&jobs, self.options(), &mut |_| {}, &mut |k, finished| {
            let (r, case, _) = all[k];
            rows[k] = Some(self.fill(keys[r], &prepared[r], case, &jobs[k], &finished));
            Ok::<(), std::convert::Infallible>(())
        });
        let mut of_recordings: Vec<Vec<Row>> = vec![Vec::new(); keys.len()];
        all.iter().zip(rows).for_each(|((r, ..), row)| of_recordings[*r].extend(row));
        Ok(of_recordings)
    }

    fn require_key(&self, key: Key) -> Result<(), CampaignError> {
        let file = &self.campaign.file;
        let inside = (key.level as usize) < file.noise.len() && (key.start as usize) < self.starts.len();
        if inside && key.seed < file.seeds {
            return Ok(());
        }
        Err(CampaignError::NoRecording { path: self.campaign.path.clone(), key })
    }

    fn setup(&self) -> Setup<'_> {
        self.campaign.experiment.setup()
    }

    fn options(&self) -> RunOptions {
        let settings = self.setup().settings;
        RunOptions {
            iteration: settings.estimation.iteration(),
            motion_step: Some(settings.signal.decimation),
            threads: 1,
        }
    }

    fn prepare(&self, key: Key) -> Result<PreparedRecording, CampaignError> {
        let mut rng = random_numbers(self.campaign.file.seed, recording_stream(key));
        let level = &self.campaign.file.noise[key.level as usize];
        let NoisySignals { position, torque } = measure(&self.campaign.experiment, &self.twin, level, &mut rng);
        let prepared = self.filter(position, torque);
        prepared.map_err(|e| self.campaign.experiment.refuse(e).into())
    }

    fn filter(&self, position: Series, torque: Series) -> Result<PreparedRecording, PreparationError> {
        let setup = self.setup();
        let stopwatch = Stopwatch::start();
        let filtered = setup.filter(self.twin.recording(self.sample_rate_hz, position, torque))?;
        let reference = setup.reference(&filtered.recording)?;
        let choice = &setup.settings.parameters.estimate;
        let problem = |b: &CaseBasis| {
            let problem = setup.problem_on(b.basis.clone(), &[&filtered], choice)?;
            Ok(CaseProblem::new(b.friction, problem))
        };
        let problems = self.bases.iter().map(problem).collect::<Result<_, PreparationError>>()?;
        Ok(PreparedRecording { filtered, reference, problems, seconds: stopwatch.seconds() })
    }

    fn job<'r>(&'r self, key: Key, prepared: &'r PreparedRecording, case: &Case, method: Method) -> EstimationJob<'r> {
        let problem = &prepared.problems[self.basis_of(case)];
        let setup = self.starts[key.start as usize].setup();
        let recordings = [(&prepared.filtered, &prepared.reference)];
        let controller = setup.settings.controller.as_ref();
        let simulator = controller.map(|c| Simulator::new(setup, &problem.problem, &recordings, c, case));
        let weights = problem.weights(setup.settings, method, &[1.0]);
        EstimationJob::new(&problem.problem, method, weights, simulator)
    }

    /// Index of the base parameters of a case.
    fn basis_of(&self, case: &Case) -> usize {
        let friction = case.friction.unwrap_or(self.campaign.experiment.robot.friction);
        self.bases.iter().position(|b| b.friction == friction).unwrap_or_default()
    }

    fn fill(
        &self,
        key: Key,
        prepared: &PreparedRecording,
        case: &Case,
        job: &EstimationJob<'_>,
        Finished { outcome, motions, seconds, .. }: &Finished,
    ) -> Row {
        let basis = &self.bases[self.basis_of(case)];
        let mut row = self.row(key, case, job, outcome);
        row.seconds = Some(prepared.seconds + seconds);
        if let Some(fit) = &outcome.fit {
            basis.fill(&mut row, fit);
            let found = uncertainty(job.method, &job.regression, outcome.instruments.as_ref(), fit).ok();
            let intervals = found.into_iter().flat_map(|u| u.interval_95);
            basis.places.iter().zip(intervals).for_each(|(&p, i)| row.intervals[p] = Some(i));
        }
        if let Some(motion) = motions.as_ref().and_then(|m| m.first()) {
            self.fill_motion(&mut row, prepared, motion);
        }
        row
    }

    fn row(&self, key: Key, case: &Case, job: &EstimationJob<'_>, outcome: &Outcome) -> Row {
        let absent = vec![None; self.facts.parameters.len()];
        Row {
            case: case.name.clone(),
            noise: self.campaign.file.noise[key.level as usize].name.clone(),
            start: key.start + 1,
            seed: key.seed + 1,
            method: job.method.name().to_owned(),
            status: outcome.status,
            reason: outcome.reason.as_ref().map(|r| explain(&job.problem.estimated, &job.names_of_loop(), r)),
            iterations: outcome.iterations.len(),
            simulations: outcome.simulations,
            seconds: None,
            relative_error_percent: None,
            position_error_percent: None,
            torque_error_percent: None,
            parameter_distance: None,
            estimates: absent.clone(),
            deviations: absent.clone(),
            intervals: vec![None; absent.len()],
        }
    }

    /// The errors of the simulated motion against the true one, in the window, at as many instants as y has.
    fn fill_motion(&self, row: &mut Row, prepared: &PreparedRecording, motion: &SimulatedMotion) {
        let step = self.setup().settings.signal.decimation.max(1);
        let instants = || prepared.filtered.window.clone().step_by(step);
        let error = |truth: &Series, simulated: &Series| {
            let truth: Vec<f64> = instants().flat_map(|k| truth.sample(k).iter().copied()).collect();
            Some(100.0 * distance(&truth, simulated.values()) / norm(&truth))
        };
        row.position_error_percent = error(&self.twin.motion.q, &motion.q);
        row.torque_error_percent = error(&self.twin.motion.tau, &motion.tau);
    }
}

impl CaseBasis {
    fn new(
        experiment: &Experiment,
        case: &Case,
        friction: Friction,
        twin: &TwinMotion,
        facts: &mut Facts,
    ) -> Result<Self, CampaignError> {
        let (basis, estimated) = basis_and_estimated(experiment, case)?;
        let truth = (friction == experiment.robot.friction).then(|| estimated.from_standard(&twin.parameters));
        let value = |i: usize| truth.as_ref().map(|t| t[i]);
        let add = |(i, p): (usize, &BaseParameter)| facts.place(&p.name, &p.unit, value(i));
        let places = estimated.parameters().iter().enumerate().map(add).collect();
        Ok(Self { friction, basis, truth, places })
    }

    fn fill(&self, row: &mut Row, fit: &Fit) {
        row.relative_error_percent = Some(fit.relative_error_percent);
        row.parameter_distance = self.truth.as_ref().map(|truth| distance(truth, &fit.theta));
        for (i, &place) in self.places.iter().enumerate() {
            row.estimates[place] = Some(fit.theta[i]);
            row.deviations[place] = Some(fit.standard_deviation[i]);
        }
    }
}

fn basis_and_estimated(experiment: &Experiment, case: &Case) -> Result<(Basis, BaseParameters), ExperimentError> {
    let setup = experiment.setup();
    let basis = setup.basis(case).map_err(|e| experiment.refuse(e))?;
    let estimated = setup.estimated(&basis).map_err(|e| experiment.refuse(e))?;
    Ok((basis, estimated))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
