//! What errors of the simulator do to the estimates of IV and DIDIM: section V-C of the paper for any error.

use std::{
    convert::Infallible,
    sync::atomic::{AtomicUsize, Ordering},
};

use super::identification::{CaseProblem, Identification};
use crate::{
    preparation::{Case, PreparationError},
    scheduling::{EstimationJob, RunOptions, SIDE_BY_SIDE, run_all},
};
use thetahat_estimation::{
    identification::{DesignMatrix, Method, Outcome},
    simulation::{BiasKind, SimulatorBias},
};
use thetahat_ground::pool::in_parallel;
use thetahat_report::results::{Sensitivity, SensitivityPoint};

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
const METHODS: [Method; 2] = [Method::IDIM_IV, Method::DIDIM];

impl Identification {
    /// Estimates by IV and DIDIM with each error of the simulator, on top of none. `progress` is called with how many of how many
    /// estimations are done; the result does not depend on the number of `threads`.
    ///
    /// An estimation that does not converge says so in its status.
    ///
    /// # Errors
    /// [`PreparationError`] for input that cannot be used, or without a controller.
    pub fn sensitivity(
        &self,
        threads: usize,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Sensitivity, PreparationError> {
        if self.controller().is_none() {
            let why = "idim-iv and didim simulate the closed loop; for idim-iv among the methods one is guessed";
            return Err(PreparationError::Missing { missing: "[controller]", why });
        }
        let problems = self.problems(&mut |_| {})?;
        let sweep = Sweep { identification: self, problem: &problems[0] };
        // A guessed controller serves instruments alone.
        let is_stated = self.setup().settings.controller.is_some();
        let methods = METHODS.into_iter().filter(|m| is_stated || m.design() == DesignMatrix::Measured);
        let nominal: Vec<SensitivityCase<'_>> = methods.map(|method| (method, SimulatorBias::NONE, None)).collect();
        let nominal = sweep.estimate(&nominal, threads);
        let jobs: Vec<(BiasKind, f64, usize)> = SWEEP
            .iter()
            .flat_map(|(kind, values)| values.iter().map(move |v| (*kind, *v)))
            .flat_map(|(kind, value)| (0..nominal.len()).map(move |m| (kind, value, m)))
            .collect();
        let groups: Vec<&[(BiasKind, f64, usize)]> = jobs.chunks(SIDE_BY_SIDE).collect();
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

/// A method with an error of the simulator, from start values or those of the settings.
type SensitivityCase<'a> = (Method, SimulatorBias, Option<&'a [f64]>);

struct Sweep<'a> {
    identification: &'a Identification,
    problem: &'a CaseProblem,
}

impl Sweep<'_> {
    fn estimate(&self, wanted: &[SensitivityCase<'_>], threads: usize) -> Vec<Outcome> {
        let job = |&(method, simulator, start): &SensitivityCase<'_>| {
            let job = self.identification.job(self.problem, &Case::nominal().with_simulator(simulator), method);
            EstimationJob { start: start.map_or(job.start, <[f64]>::to_vec), ..job }
        };
        let jobs: Vec<EstimationJob<'_>> = wanted.iter().map(job).collect();
        let iteration = self.identification.setup().settings.estimation.iteration();
        let options = RunOptions { iteration, motion_step: None, threads };
        let mut outcomes = vec![None; jobs.len()];
        let Ok(()) = run_all(&jobs, options, &mut |_| {}, &mut |k, finished| {
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
        let settings = self.identification.setup().settings;
        self.problem.problem.estimated.parameters().iter().map(|p| settings.shows(&p.name)).collect()
    }

    fn finish(&self, nominal: &[Outcome], points: Vec<SensitivityPoint>) -> Sensitivity {
        let of_method =
            |(m, outcome): (&Method, &Outcome)| self.describe((BiasKind::GearRatio, 1.0), *m, outcome, outcome);
        Sensitivity {
            title: String::new(),
            robot: self.identification.setup().robot.name.clone(),
            parameters: self.problem.problem.estimated.parameters().iter().map(|p| p.name.clone()).collect(),
            shown: self.shown(),
            nominal: METHODS.iter().zip(nominal).map(of_method).collect(),
            points,
        }
    }
}
