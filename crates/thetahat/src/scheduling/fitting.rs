//! CLIE and CLOE under way: what they want simulated, and what they make of it.

use super::{
    requests::{Request, Simulated},
    scheduler::EstimationJob,
    simulator::{Output, Parameters, Simulator},
};
use crate::{
    identification::{IterationOptions, Outcome, PredictionErrorEstimation, SimulatedResponse, Wanted, idim_ls},
    simulation::SimulationError,
};

/// A fit of the simulated response to that of the record.
pub(super) struct Fitting<'a> {
    job: &'a EstimationJob<'a>,
    simulator: &'a Simulator<'a>,
    estimation: PredictionErrorEstimation,
}

impl<'a> Fitting<'a> {
    pub(super) fn new(job: &'a EstimationJob<'a>, simulator: &'a Simulator<'a>, options: IterationOptions) -> Self {
        // Zeros leave the loop as it is described.
        let with_loop = |mut theta: Vec<f64>| {
            theta.resize(theta.len() + simulator.loop_parameters().len(), 0.0);
            theta
        };
        let starts = std::iter::once(job.start.clone()).chain(least_squares(job)).map(with_loop).collect();
        Self { job, simulator, estimation: PredictionErrorEstimation::new(options, starts) }
    }

    /// The simulation that it waits for.
    pub(super) fn request(&self) -> Option<Request<'a>> {
        let (theta, output) = match self.estimation.wanted()? {
            Wanted::Response(theta) => (theta, Output::Motion { step: 1 }),
            Wanted::Sensitivities(theta) => (theta, Output::Sensitivities(self.job.method.response())),
        };
        Some(Request { simulator: self.simulator, theta: Parameters::Fitted(theta.to_vec()), output })
    }

    /// Takes what was simulated.
    pub(super) fn take(&mut self, simulated: Result<Simulated, SimulationError>) {
        let regression = &self.job.regression;
        match self.estimation.wanted() {
            Some(Wanted::Response(_)) => self.estimation.take_response(self.response(simulated), regression),
            Some(Wanted::Sensitivities(_)) => self.estimation.take_sensitivities(sensitivities(simulated), regression),
            None => {}
        }
    }

    pub(super) fn into_outcome(self) -> Outcome {
        self.estimation.into_outcome()
    }

    fn response(&self, simulated: Result<Simulated, SimulationError>) -> Result<Vec<f64>, SimulationError> {
        match simulated? {
            Simulated::Motions(motions) => self.simulator.response_of(&motions, self.job.method.response()),
            Simulated::Response(SimulatedResponse { response, .. }) => Ok(response),
            Simulated::Instruments(_) => Err(SimulationError::TooShortToFilter),
        }
    }
}

/// The estimate of LS, where torques were recorded and give one: another place to start from.
fn least_squares(job: &EstimationJob<'_>) -> Option<Vec<f64>> {
    let ls = idim_ls(&job.problem.regression, Default::default()).ok()?;
    Some(ls.theta)
}

fn sensitivities(simulated: Result<Simulated, SimulationError>) -> Result<SimulatedResponse, SimulationError> {
    match simulated? {
        Simulated::Response(response) => Ok(response),
        Simulated::Motions(_) | Simulated::Instruments(_) => Err(SimulationError::TooShortToFilter),
    }
}
