//! Estimations under way: what several of them want simulated runs side by side.

use super::{
    fitting::Fitting,
    job::EstimationJob,
    physical::Physical,
    requests::{Request, Simulated, simulate_side_by_side},
    simulator::{Output, Parameters},
};
use thetahat_estimation::{
    identification::{Estimation, IterationOptions, Method, Needs, Outcome},
    simulation::{SimulatedMotion, SimulationError},
};
use thetahat_ground::{clock::Stopwatch, linear_algebra::Matrix};

/// How an estimation ended.
pub(crate) struct Finished {
    pub(crate) outcome: Outcome,
    /// The motion of each recording simulated with the estimate, where it was asked for and succeeds.
    pub(crate) motions: Option<Vec<SimulatedMotion>>,
    /// What is reported of what was simulated.
    pub(crate) note: Option<String>,
    /// Time spent on the estimate; simulations side by side share theirs in equal parts.
    pub(crate) seconds: f64,
}

/// How estimations are run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RunOptions {
    pub(crate) iteration: IterationOptions,
    /// Simulate with the estimate, too, at every so many samples of the window.
    pub(crate) motion_step: Option<usize>,
    pub(crate) threads: usize,
}

/// What is simulated next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnderWay {
    /// Simulations that run side by side.
    pub(crate) simulations: usize,
    /// How far the first fit among them is.
    pub(crate) fit: Option<FitUnderWay>,
}

/// How far a fit is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FitUnderWay {
    pub(crate) method: Method,
    /// Iterations done, and the error after the last.
    pub(crate) iterations: usize,
    pub(crate) error_percent: Option<f64>,
}

/// Simulations for each thread that run at a time: as many as a vector of most machines has lanes. More would wait, with
/// their motions in memory.
pub(crate) const SIDE_BY_SIDE: usize = 4;

/// Runs all estimations. `take` is given each, by its place, as soon as it is finished; `progress` is called with what is
/// simulated next. Results are bit-identical alone or batched, and for any number of threads.
///
/// # Errors
/// What `take` refuses.
pub(crate) fn run_all<E>(
    jobs: &[EstimationJob<'_>],
    options: RunOptions,
    progress: &mut dyn FnMut(UnderWay),
    take: &mut dyn FnMut(usize, Finished) -> Result<(), E>,
) -> Result<(), E> {
    let mut running: Vec<Running<'_>> = jobs.iter().map(|job| Running::new(job, options)).collect();
    loop {
        for (k, estimation) in running.iter_mut().enumerate().filter(|(_, r)| r.request().is_none()) {
            estimation.end().map_or(Ok(()), |finished| take(k, finished))?;
        }
        let (waiting, requests) = next_requests(&running, SIDE_BY_SIDE * options.threads.max(1));
        if requests.is_empty() {
            return Ok(());
        }
        let fit = waiting.iter().find_map(|&k| running[k].fit_under_way());
        progress(UnderWay { simulations: requests.len(), fit });
        let stopwatch = Stopwatch::start();
        let simulated = simulate_side_by_side(&requests, options.threads);
        let seconds = stopwatch.seconds() / waiting.len() as f64;
        for (k, simulated) in waiting.into_iter().zip(simulated) {
            if let Some(finished) = running[k].take(simulated, seconds) {
                take(k, finished)?;
            }
        }
    }
}

/// The first estimations that wait, and what they ask for: no more different simulations than `most`, or those of one
/// request.
fn next_requests<'a>(running: &[Running<'a>], most: usize) -> (Vec<usize>, Vec<Request<'a>>) {
    let (mut waiting, mut requests, mut simulations) = (Vec::new(), Vec::<Request<'_>>::new(), 0);
    for (k, request) in running.iter().enumerate().filter_map(|(k, r)| Some((k, r.request()?))) {
        let is_new = !requests.iter().any(|other| request.is_like(other));
        let with_it = simulations + if is_new { request.simulator.recordings() } else { 0 };
        if requests.is_empty() || with_it <= most {
            simulations = with_it;
            waiting.push(k);
            requests.push(request);
        }
    }
    (waiting, requests)
}

enum Stage<'a> {
    /// By IV or DIDIM.
    Estimating(Box<Estimation>),
    /// By CLIE or CLOE.
    Fitting(Box<Fitting<'a>>),
    /// With the parameters to simulate the estimate with, where there is one.
    Estimated(Box<Outcome>, Option<Parameters>),
    Over,
}

/// An estimation under way.
struct Running<'a> {
    job: &'a EstimationJob<'a>,
    options: RunOptions,
    stage: Stage<'a>,
    /// What stands for the estimates of IV and DIDIM in their simulations.
    physical: Option<Physical<'a>>,
    /// What is reported of a fit that has ended.
    note: Option<String>,
    seconds: f64,
}

impl<'a> Running<'a> {
    fn new(job: &'a EstimationJob<'a>, options: RunOptions) -> Self {
        let stopwatch = Stopwatch::start();
        let EstimationJob { method, regression, start, .. } = job;
        let simulator = job.simulator.as_ref();
        let mut physical = simulator
            .filter(|_| method.needs() == Needs::Instruments)
            .map(|simulator| Physical::new(*method, simulator, regression));
        let direct = || estimated(Outcome::direct(method.estimate(regression, None, options.iteration.divisor)), None);
        let stage = match (method.needs(), simulator) {
            (Needs::Measurement, _) | (Needs::Instruments | Needs::Sensitivities, None) => direct(),
            (Needs::Instruments, Some(_)) => {
                let start = physical.as_mut().map_or_else(|| start.clone(), |physical| physical.start(start));
                Stage::Estimating(Box::new(Estimation::new(*method, options.iteration, start)))
            }
            (Needs::Sensitivities, Some(simulator)) => {
                Stage::Fitting(Box::new(Fitting::new(job, simulator, options.iteration)))
            }
        };
        Self { job, options, stage, physical, note: None, seconds: stopwatch.seconds() }
    }

    /// The simulation that it waits for.
    fn request(&self) -> Option<Request<'a>> {
        let simulator = self.job.simulator.as_ref()?;
        let (theta, output) = match &self.stage {
            Stage::Estimating(estimation) => {
                estimation.wanted()?;
                (self.physical.as_ref()?.current().clone(), Output::Instruments)
            }
            Stage::Fitting(fitting) => return fitting.request(),
            Stage::Estimated(_, theta) => (theta.as_ref()?.clone(), Output::Motion { step: self.options.motion_step? }),
            Stage::Over => return None,
        };
        Some(Request { simulator, theta, output })
    }

    /// How far it is, if it fits the response.
    fn fit_under_way(&self) -> Option<FitUnderWay> {
        let Stage::Fitting(fitting) = &self.stage else { return None };
        let done = fitting.iterations();
        let error_percent = done.last().map(|last| last.relative_error_percent);
        Some(FitUnderWay { method: self.job.method, iterations: done.len(), error_percent })
    }

    /// Takes what was simulated in `seconds`; how the estimation ended, where it has.
    fn take(&mut self, simulated: Result<Simulated, SimulationError>, seconds: f64) -> Option<Finished> {
        if let Stage::Fitting(fitting) = &mut self.stage {
            let stopwatch = Stopwatch::start();
            fitting.take(simulated);
            if fitting.request().is_none()
                && let Stage::Fitting(fitting) = std::mem::replace(&mut self.stage, Stage::Over)
            {
                self.note = fitting.note();
                let outcome = fitting.into_outcome();
                let theta =
                    outcome.fit.as_ref().map(|fit| Parameters::Fitted { theta: fit.theta.clone(), tolerance: 1.0 });
                self.stage = Stage::Estimated(Box::new(outcome), theta);
            }
            self.seconds += seconds + stopwatch.seconds();
            return None;
        }
        let z = match (&self.stage, simulated) {
            (Stage::Estimating(_), Ok(Simulated::Instruments(z))) => Ok(z),
            (Stage::Estimating(_), Err(error)) => Err(error),
            (Stage::Estimated(..) | Stage::Over, Ok(Simulated::Motions(motions))) => {
                return self.end().map(|finished| Finished { motions: Some(motions), ..finished });
            }
            (Stage::Estimating(_) | Stage::Fitting(_), Ok(_))
            | (Stage::Fitting(_), Err(_))
            | (Stage::Estimated(..) | Stage::Over, Ok(Simulated::Instruments(_) | Simulated::Response(_)) | Err(_)) => {
                return self.end();
            }
        };
        let stopwatch = Stopwatch::start();
        if let Stage::Estimating(mut estimation) = std::mem::replace(&mut self.stage, Stage::Over) {
            self.estimate(&mut estimation, z);
            let goes_on = estimation.wanted().is_some();
            self.stage = if goes_on {
                Stage::Estimating(estimation)
            } else {
                estimated(estimation.into_outcome(), self.physical.as_mut())
            };
        }
        self.seconds += seconds + stopwatch.seconds();
        None
    }

    /// Goes on with what was simulated. Where an estimate could not be, a physical robot's parameters are.
    fn estimate(&mut self, estimation: &mut Estimation, z: Result<Matrix, SimulationError>) {
        let Some(physical) = &mut self.physical else { return };
        if z.is_err()
            && !estimation.has_estimate()
            && let Some(start) = physical.start_near_ls()
        {
            return estimation.start_anew(start);
        }
        let anew = z.is_err() && physical.require() && estimation.simulate_anew(&mut |fit, z| physical.revise(fit, z));
        if !anew {
            estimation.take(z, &self.job.regression, &mut |fit, z| physical.revise(fit, z));
        }
        if let Some(theta) = estimation.wanted() {
            let tolerance = physical.simulate(theta, estimation.tolerance());
            estimation.simulated_with(tolerance);
        }
    }

    /// How the estimation ended, once.
    fn end(&mut self) -> Option<Finished> {
        match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Estimating(estimation) => Some(estimation.into_outcome()),
            Stage::Fitting(fitting) => Some(fitting.into_outcome()),
            Stage::Estimated(outcome, _) => Some(*outcome),
            Stage::Over => None,
        }
        .map(|outcome| Finished {
            outcome,
            motions: None,
            note: self.note.take().or_else(|| self.physical.as_ref().and_then(Physical::note)),
            seconds: self.seconds,
        })
    }
}

/// An outcome with the parameters that stand for its estimate in a simulation.
fn estimated<'a>(outcome: Outcome, physical: Option<&mut Physical<'_>>) -> Stage<'a> {
    let theta = outcome.fit.as_ref().map(|fit| match physical {
        Some(physical) => {
            physical.simulate(&fit.theta, 1.0);
            physical.current().clone()
        }
        None => Parameters::Estimated(fit.theta.clone()),
    });
    Stage::Estimated(Box::new(outcome), theta)
}
