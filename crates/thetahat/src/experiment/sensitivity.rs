//! What errors of the simulator do to the estimates of IV and DIDIM: section V-C of the paper for any error.

use std::{
    convert::Infallible,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
};

use super::{
    Case, Experiment, ExperimentError,
    run::{CaseProblem, Session},
    turns::{self, Attempt, Terms},
};
use crate::{
    identification::{Method, Outcome},
    pool::in_parallel,
    results::{Sensitivity, SensitivityPoint},
    simulation::{BiasKind, SimulatorBias},
};

/// The values of each kind that are swept; the nominal value, 1 or 0, is in none of them.
const SWEEP: [(BiasKind, &[f64]); 7] = [
    (BiasKind::GearRatio, &[0.9, 0.95, 0.98, 0.99, 1.01, 1.02, 1.05, 1.1]),
    (BiasKind::DriveGain, &[0.5, 0.8, 0.9, 1.1, 1.25, 2.0]),
    (BiasKind::ControllerGain, &[0.25, 0.5, 0.8, 1.25, 2.0, 4.0]),
    (BiasKind::Delay, &[0.5e-3, 1e-3, 2e-3, 5e-3]),
    (BiasKind::ReferenceScale, &[0.9, 0.95, 0.98, 0.99, 1.01, 1.02, 1.05, 1.1]),
    (BiasKind::ReferenceOffset, &[-0.02, -0.01, -0.005, 0.005, 0.01, 0.02]),
    (BiasKind::Friction, &[0.0, 0.5, 0.8, 1.2, 1.5, 2.0]),
];
const METHODS: [Method; 2] = [Method::IdimIv, Method::Didim];

impl Experiment {
    /// Estimates by IV and DIDIM with each error of the simulator, on top of none. `progress` is told how many of how many
    /// estimations are done; the result does not depend on the number of `threads`.
    ///
    /// An estimation that does not converge says so in its status.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used, or without a `[controller]`.
    pub fn sensitivity(
        &self,
        data: &Path,
        threads: usize,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Sensitivity, ExperimentError> {
        let why = "idim-iv and didim simulate the closed loop";
        self.file.controller.as_ref().ok_or_else(|| self.missing("[controller]", why))?;
        let session = self.session(data, &mut |_| {})?;
        let problems = session.problems(&mut |_| {})?;
        let sweep = Sweep { experiment: self, session: &session, problem: &problems[0] };
        let nominal = sweep.estimate(&METHODS.map(|method| (method, SimulatorBias::NONE, None)), threads);
        let jobs: Vec<(BiasKind, f64, usize)> = SWEEP
            .iter()
            .flat_map(|(kind, values)| values.iter().map(move |v| (*kind, *v)))
            .flat_map(|(kind, value)| (0..nominal.len()).map(move |m| (kind, value, m)))
            .collect();
        let groups: Vec<&[(BiasKind, f64, usize)]> = jobs.chunks(turns::SIDE_BY_SIDE).collect();
        let done = AtomicUsize::new(0);
        let work = |g: usize| {
            let points = sweep.points(groups[g], &nominal);
            progress(done.fetch_add(points.len(), Ordering::Relaxed) + points.len(), jobs.len());
            points
        };
        let points = in_parallel(groups.len(), threads, work).into_iter().flatten().collect();
        Ok(sweep.finish(&nominal, points))
    }
}

struct Sweep<'a> {
    experiment: &'a Experiment,
    session: &'a Session<'a>,
    problem: &'a CaseProblem,
}

impl Sweep<'_> {
    /// Estimates by some methods with an error of the simulator each, from start values or those of the experiment.
    fn estimate(&self, wanted: &[(Method, SimulatorBias, Option<&[f64]>)], threads: usize) -> Vec<Outcome> {
        let nominal = self.experiment.cases().swap_remove(0);
        let attempt = |&(method, simulator, start): &(Method, SimulatorBias, Option<&[f64]>)| {
            let attempt = self.session.attempt(self.problem, &Case { simulator, ..nominal.clone() }, method);
            Attempt { start: start.map_or(attempt.start, <[f64]>::to_vec), ..attempt }
        };
        let attempts: Vec<Attempt<'_>> = wanted.iter().map(attempt).collect();
        let estimation = &self.experiment.file.estimation;
        let (divisor, convergence) = (estimation.variance, estimation.convergence);
        let terms = Terms { divisor, convergence, motion_step: None, threads };
        let mut outcomes = vec![None; attempts.len()];
        let Ok(()) = turns::make(&attempts, terms, &mut |_| {}, &mut |k, finished| {
            outcomes[k] = Some(finished.outcome);
            Ok::<(), Infallible>(())
        });
        outcomes.into_iter().flatten().collect()
    }

    /// Starts from the nominal estimates, where there are any.
    fn points(&self, jobs: &[(BiasKind, f64, usize)], nominal: &[Outcome]) -> Vec<SensitivityPoint> {
        let start = |m: usize| nominal[m].fit.as_ref().map(|f| f.theta.as_slice());
        let wanted: Vec<_> = jobs
            .iter()
            .map(|&(kind, value, m)| (METHODS[m], SimulatorBias::NONE.with(kind, value), start(m)))
            .collect();
        let outcomes = self.estimate(&wanted, 1);
        let describe = |(&(kind, value, m), outcome): (&(BiasKind, f64, usize), &Outcome)| {
            self.describe((kind, value), METHODS[m], outcome, &nominal[m])
        };
        jobs.iter().zip(&outcomes).map(describe).collect()
    }

    fn describe(
        &self,
        (kind, value): (BiasKind, f64),
        method: Method,
        outcome: &Outcome,
        nominal: &Outcome,
    ) -> SensitivityPoint {
        let changes = self.changes(outcome, nominal);
        let squares: f64 = changes.iter().map(|(_, c)| c * c).sum();
        let rms = (squares / changes.len().max(1) as f64).sqrt();
        SensitivityPoint {
            kind,
            value,
            method,
            status: outcome.status,
            relative_error_percent: outcome.fit.as_ref().map(|f| f.relative_error_percent),
            rms_change: (!changes.is_empty()).then_some(rms),
            largest_change: changes.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())),
            estimates: outcome.fit.as_ref().map(|f| f.theta.clone()).unwrap_or_default(),
        }
    }

    /// The changes of the shown estimates in the nominal standard deviations.
    fn changes(&self, outcome: &Outcome, nominal: &Outcome) -> Vec<(String, f64)> {
        let (Some(fit), Some(from)) = (&outcome.fit, &nominal.fit) else { return Vec::new() };
        let shown = self.shown();
        let change = |i: usize| (fit.theta[i] - from.theta[i]) / from.standard_deviation[i];
        let name = |i: usize| self.problem.problem.estimated.parameters()[i].name.clone();
        (0..fit.theta.len()).filter(|&i| shown[i]).map(|i| (name(i), change(i))).collect()
    }

    fn shown(&self) -> Vec<bool> {
        let show = &self.experiment.file.parameters.show;
        let parameters = self.problem.problem.estimated.parameters().iter();
        parameters.map(|p| show.is_empty() || show.contains(&p.name)).collect()
    }

    fn finish(&self, nominal: &[Outcome], points: Vec<SensitivityPoint>) -> Sensitivity {
        let of_method =
            |(m, outcome): (&Method, &Outcome)| self.describe((BiasKind::GearRatio, 1.0), *m, outcome, outcome);
        Sensitivity {
            title: self.experiment.file.title.clone(),
            robot: self.experiment.robot.name.clone(),
            parameters: self.problem.problem.estimated.parameters().iter().map(|p| p.name.clone()).collect(),
            shown: self.shown(),
            nominal: METHODS.iter().zip(nominal).map(of_method).collect(),
            points,
        }
    }
}
