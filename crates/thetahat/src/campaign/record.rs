//! One record and its runs: measurements, filters, every case and method.

use std::time::Instant;

use super::{
    Campaign, CampaignError, CampaignMethod, Key, Row,
    methods::{attempt, uncertainty_of},
    noise::{measure, random, record_stream},
    run::Facts,
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::Model,
    experiment::{
        Attempt, Case, Experiment, FilteredRecord, Finished, Problem, RecordReference, Simulator, Terms, TwinMotion,
        explain, make,
    },
    identification::{Fit, Outcome},
    linear_algebra::norm,
    robot::Friction,
    series::Series,
    simulation::SimulatedMotion,
};

/// What all records of a campaign share.
pub(super) struct Bench<'a> {
    campaign: &'a Campaign,
    twin: TwinMotion,
    sample_rate_hz: f64,
    cases: Vec<Case>,
    bases: Vec<Basis>,
    starts: Vec<Experiment>,
    pub(super) facts: Facts,
}

/// The base parameters of one friction model, and those estimated, with their true values where they have any.
struct Basis {
    friction: Friction,
    model: Model,
    base: BaseParameters,
    truth: Option<Vec<f64>>,
    /// Place of each estimated parameter among those of the campaign.
    places: Vec<usize>,
}

/// A record that is filtered, with the problem of each friction model.
struct Prepared {
    filtered: FilteredRecord,
    reference: RecordReference,
    problems: Vec<Problem>,
    seconds: f64,
}

impl<'a> Bench<'a> {
    /// Simulates the true motion, finds the base parameters, and draws so many starts.
    pub(super) fn new(campaign: &'a Campaign, starts: u32) -> Result<Self, CampaignError> {
        let experiment = &campaign.experiment;
        let why = "it describes the simulated robot that is recorded";
        let twin = experiment.file.twin.as_ref().ok_or_else(|| experiment.missing("[twin]", why))?;
        let sample_rate_hz = twin.sample_rate_hz;
        let twin = experiment.twin_motion(twin)?;
        let chosen = campaign.file.cases.as_ref();
        let cases: Vec<Case> =
            experiment.cases().into_iter().filter(|c| chosen.is_none_or(|names| names.contains(&c.name))).collect();
        let mut facts = Facts::default();
        let mut bases: Vec<Basis> = Vec::new();
        for case in &cases {
            let friction = case.friction.unwrap_or(experiment.robot.friction);
            if bases.iter().all(|b| b.friction != friction) {
                bases.push(Basis::new(experiment, case, friction, &twin, &mut facts)?);
            }
        }
        let starts = (0..starts).map(|s| campaign.start(s)).collect::<Result<_, _>>()?;
        Ok(Self { campaign, twin, sample_rate_hz, cases, bases, starts, facts })
    }

    /// Runs every case and method on the records at `keys`: their rows, record by record.
    pub(super) fn run(&self, keys: &[Key]) -> Result<Vec<Vec<Row>>, CampaignError> {
        let prepared = keys.iter().map(|key| self.prepare(*key)).collect::<Result<Vec<_>, _>>()?;
        let methods = &self.campaign.file.methods;
        let pairs = || self.cases.iter().flat_map(|case| methods.iter().map(move |method| (case, *method)));
        let all: Vec<(usize, &Case, CampaignMethod)> =
            (0..keys.len()).flat_map(|r| pairs().map(move |(case, method)| (r, case, method))).collect();
        let attempts: Vec<Attempt<'_>> =
            all.iter().map(|&(r, case, method)| self.attempt(keys[r], &prepared[r], case, method)).collect();
        let mut rows: Vec<Option<Row>> = vec![None; all.len()];
        let Ok(()) = make(&attempts, self.terms(), &mut |_| {}, &mut |k, finished| {
            let (r, case, method) = all[k];
            rows[k] = Some(self.fill(keys[r], &prepared[r], (case, method), &attempts[k], &finished));
            Ok::<(), std::convert::Infallible>(())
        });
        let mut of_records: Vec<Vec<Row>> = vec![Vec::new(); keys.len()];
        all.iter().zip(rows).for_each(|((r, ..), row)| of_records[*r].extend(row));
        Ok(of_records)
    }

    fn terms(&self) -> Terms {
        let file = &self.campaign.experiment.file;
        Terms {
            divisor: file.estimation.variance,
            convergence: file.estimation.convergence,
            motion_step: Some(file.signal.decimation),
            threads: 1,
        }
    }

    fn prepare(&self, key: Key) -> Result<Prepared, CampaignError> {
        let experiment = &self.campaign.experiment;
        let mut rng = random(self.campaign.file.seed, record_stream(key));
        let level = &self.campaign.file.noise[key.level as usize];
        let (position, torque) = measure(experiment, &self.twin, level, &mut rng);
        let started = Instant::now();
        let filtered = experiment.filter(self.twin.record(self.sample_rate_hz, position, torque), None)?;
        let reference = experiment.reference(&filtered)?;
        let choice = &experiment.file.parameters.estimate;
        let problem = |b: &Basis| experiment.problem_on((b.model.clone(), b.base.clone()), &[&filtered], choice);
        let problems = self.bases.iter().map(problem).collect::<Result<_, _>>()?;
        Ok(Prepared { filtered, reference, problems, seconds: started.elapsed().as_secs_f64() })
    }

    fn attempt<'r>(&'r self, key: Key, prepared: &'r Prepared, case: &Case, method: CampaignMethod) -> Attempt<'r> {
        let problem = &prepared.problems[self.basis_of(case)];
        let experiment = &self.starts[key.start as usize];
        let recordings = [(&prepared.filtered, &prepared.reference)];
        let controller = experiment.file.controller.as_ref();
        let simulator = controller.map(|c| Simulator::new(experiment, problem, &recordings, c, case.simulator));
        attempt(experiment, problem, simulator, method)
    }

    /// Place of the base parameters of a case.
    fn basis_of(&self, case: &Case) -> usize {
        let friction = case.friction.unwrap_or(self.campaign.experiment.robot.friction);
        self.bases.iter().position(|b| b.friction == friction).unwrap_or_default()
    }

    fn fill(
        &self,
        key: Key,
        prepared: &Prepared,
        (case, method): (&Case, CampaignMethod),
        attempt: &Attempt<'_>,
        Finished { outcome, motions, seconds }: &Finished,
    ) -> Row {
        let basis = &self.bases[self.basis_of(case)];
        let mut row = self.row(key, (case, method), attempt.problem, outcome);
        row.seconds = Some(prepared.seconds + seconds);
        if let Some(fit) = &outcome.fit {
            basis.fill(&mut row, fit);
            let intervals = uncertainty_of(attempt, fit, outcome).map(|u| u.interval_95);
            basis.places.iter().zip(intervals.into_iter().flatten()).for_each(|(&p, i)| row.intervals[p] = Some(i));
        }
        if let Some(motion) = motions.as_ref().and_then(|m| m.first()) {
            self.fill_motion(&mut row, prepared, motion);
        }
        row
    }

    fn row(&self, key: Key, (case, method): (&Case, CampaignMethod), problem: &Problem, outcome: &Outcome) -> Row {
        let absent = vec![None; self.facts.parameters.len()];
        Row {
            case: case.name.clone(),
            noise: self.campaign.file.noise[key.level as usize].name.clone(),
            start: key.start + 1,
            seed: key.seed + 1,
            method: method.name().to_owned(),
            status: outcome.status,
            reason: outcome.reason.as_ref().map(|r| explain(problem, r)),
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
    fn fill_motion(&self, row: &mut Row, prepared: &Prepared, motion: &SimulatedMotion) {
        let step = self.campaign.experiment.file.signal.decimation.max(1);
        let instants = || prepared.filtered.window.clone().step_by(step);
        let error = |truth: &Series, simulated: &Series| {
            let truth: Vec<f64> = instants().flat_map(|k| truth.sample(k).iter().copied()).collect();
            Some(100.0 * distance(&truth, simulated.values()) / norm(&truth))
        };
        row.position_error_percent = error(&self.twin.motion.q, &motion.q);
        row.torque_error_percent = error(&self.twin.motion.tau, &motion.tau);
    }
}

impl Basis {
    fn new(
        experiment: &Experiment,
        case: &Case,
        friction: Friction,
        twin: &TwinMotion,
        facts: &mut Facts,
    ) -> Result<Self, CampaignError> {
        let (model, base) = experiment.basis(&experiment.robot_for(case))?;
        let estimated = experiment.estimated(&model, &base)?;
        let truth = (friction == experiment.robot.friction).then(|| estimated.from_standard(&twin.parameters));
        let value = |i: usize| truth.as_ref().map(|t| t[i]);
        let add = |(i, p): (usize, &crate::base_parameters::BaseParameter)| facts.place(&p.name, p.unit, value(i));
        let places = estimated.parameters().iter().enumerate().map(add).collect();
        Ok(Self { friction, model, base, truth, places })
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

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
