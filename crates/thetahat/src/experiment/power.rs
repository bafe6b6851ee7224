//! Size and power of the biased simulator test by Monte Carlo on a twin.

use super::{description::Experiment, error::ExperimentError, twin::TwinMotion};
use crate::{
    diagnosis::{MethodEstimate, diagnose},
    preparation::Case,
    scheduling::{EstimationJob, RunOptions, run_all},
};
use thetahat_estimation::{
    identification::{Convergence, IterationOptions, Method, Outcome, Status},
    simulation::{BiasKind, SimulatorBias},
};
use thetahat_ground::pool::in_parallel;
use thetahat_report::results::Comparison;

/// Iterations of DIDIM for each recording: from the a-priori values the third no longer changes the result of the test.
const ITERATIONS: usize = 3;

/// How often the test detected one error of the simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerPoint {
    /// What was wrong with the simulator.
    pub kind: BiasKind,
    /// Factor, or the value that was added.
    pub value: f64,
    /// Recordings.
    pub recordings: usize,
    /// Recordings on which DIDIM had no estimate; they are in no other count.
    pub failures: usize,
    /// Rejections at 5 %.
    pub rejections: usize,
    /// Verdicts that distrust DIDIM: rejections with a difference that matters, and those that are unclear.
    pub distrusted: usize,
    /// Mean over the recordings of the average difference, in standard deviations of IV.
    pub average_difference: f64,
}

/// The test on one recording.
#[derive(Debug, Clone, Copy)]
struct TestResult {
    verdict: Comparison,
    average_difference: f64,
}

impl Experiment {
    /// How often the biased simulator test rejects, and distrusts DIDIM, for each error of the simulator, over recordings of the twin
    /// with the same true motion and noise of the seeds from 1 to `recordings`.
    ///
    /// The result does not depend on the number of `threads`.
    ///
    /// # Errors
    /// [`ExperimentError`] without a `[twin]`, or if its recording cannot be used.
    pub fn biased_simulator_power(
        &self,
        errors: &[(BiasKind, f64)],
        recordings: usize,
        threads: usize,
    ) -> Result<Vec<PowerPoint>, ExperimentError> {
        let why = "the power is measured on its recordings";
        let twin = self.file.twin.as_ref().ok_or_else(|| self.missing("[twin]", why))?;
        let motion = self.twin_motion(twin)?;
        let of_seed = |k: usize| self.tests_of_seed(&motion, errors, k as u64 + 1);
        let seen = in_parallel(recordings, threads, of_seed).into_iter().collect::<Result<Vec<_>, _>>()?;
        let point = |(i, &(kind, value)): (usize, &(BiasKind, f64))| {
            PowerPoint::of(kind, value, seen.iter().map(|of_seed| of_seed[i]))
        };
        Ok(errors.iter().enumerate().map(point).collect())
    }

    /// The test with each error on the recording of one seed.
    fn tests_of_seed(
        &self,
        motion: &TwinMotion,
        errors: &[(BiasKind, f64)],
        seed: u64,
    ) -> Result<Vec<Option<TestResult>>, ExperimentError> {
        let Some(twin) = &self.file.twin else { return Ok(Vec::new()) };
        let sensors = thetahat_estimation::simulation::Sensors { seed, ..twin.sensors.clone() };
        let recording = self.record_motion(&sensors, twin.sample_rate_hz, motion);
        let identification = self.identification_of(vec![recording])?;
        let problems = identification.problems(&mut |_| {}).map_err(|e| self.refuse(e))?;
        let case =
            |&(kind, value): &(BiasKind, f64)| Case::nominal().with_simulator(SimulatorBias::NONE.with(kind, value));
        let cases: Vec<Case> = errors.iter().map(case).collect();
        let jobs: Vec<EstimationJob<'_>> =
            cases.iter().map(|case| identification.job(&problems[0], case, Method::DIDIM)).collect();
        let estimation = &self.settings.estimation;
        let convergence = Convergence { iterations: ITERATIONS, ..estimation.convergence };
        let iteration = IterationOptions { divisor: estimation.variance, convergence };
        let options = RunOptions { iteration, motion_step: None, threads: 1 };
        let mut seen = vec![None; errors.len()];
        let Ok(()) = run_all(&jobs, options, &mut |_| {}, &mut |k, finished| {
            // The iteration limit is intended.
            let outcome = Outcome { status: Status::Converged, ..finished.outcome };
            let regression = jobs[k].regression.clone();
            let estimated = [MethodEstimate { method: Method::DIDIM, regression, outcome }];
            let test = diagnose(&problems[0].problem, &cases[k], &estimated, &|_, _| Vec::new()).biased_simulator;
            seen[k] = test.map(|t| TestResult { verdict: t.verdict, average_difference: t.average_difference });
            Ok::<(), std::convert::Infallible>(())
        });
        Ok(seen)
    }
}

impl PowerPoint {
    fn of(kind: BiasKind, value: f64, seen: impl Iterator<Item = Option<TestResult>>) -> Self {
        let all: Vec<Option<TestResult>> = seen.collect();
        let good: Vec<TestResult> = all.iter().flatten().copied().collect();
        let count = |wanted: fn(Comparison) -> bool| good.iter().filter(|s| wanted(s.verdict)).count();
        Self {
            kind,
            value,
            recordings: all.len(),
            failures: all.len() - good.len(),
            rejections: count(|v| matches!(v, Comparison::SmallDifference | Comparison::Alarm | Comparison::Undecided)),
            distrusted: count(Comparison::distrusts),
            average_difference: good.iter().map(|s| s.average_difference).sum::<f64>() / good.len().max(1) as f64,
        }
    }
}
