//! CLIE and CLOE under way: what they want simulated, and what they make of it.

use super::{
    job::EstimationJob,
    physical::Physical,
    requests::{Request, Simulated},
    simulator::{Output, Parameters, Simulator},
};
use crate::preparation::LoopParameters;
use thetahat_estimation::{
    identification::{
        GaussNewtonStep, Iteration, IterationOptions, Method, Outcome, PredictionErrorEstimation, SimulatedResponse,
        SimulationRequest,
    },
    simulation::SimulationError,
};

/// A fit of the simulated response to that of the recording.
pub(super) struct Fitting<'a> {
    job: &'a EstimationJob<'a>,
    simulator: &'a Simulator<'a>,
    estimation: PredictionErrorEstimation,
    physical: Physical<'a>,
}

impl<'a> Fitting<'a> {
    pub(super) fn new(job: &'a EstimationJob<'a>, simulator: &'a Simulator<'a>, options: IterationOptions) -> Self {
        let mut physical =
            Physical::new(job.method, simulator, job.commanded.as_ref().unwrap_or(&job.problem.regression));
        // Zeros leave the loop as it is described.
        let with_loop = |mut theta: Vec<f64>| {
            theta.resize(theta.len() + simulator.loop_parameters().len(), 0.0);
            theta
        };
        let starts = physical.starts(&job.start).into_iter().map(with_loop).collect();
        let estimation = PredictionErrorEstimation::new(options, starts);
        // What the controller asks for gives a start that is near, to which coarse simulations lead as well.
        let estimation = if job.commanded.is_some() { estimation.with_near_starts() } else { estimation };
        Self { job, simulator, estimation, physical }
    }

    /// The simulation that it waits for.
    pub(super) fn request(&self) -> Option<Request<'a>> {
        let (theta, output) = match self.estimation.wanted()? {
            SimulationRequest::Response(theta) => (theta, Output::Motion { step: 1 }),
            SimulationRequest::Sensitivities(theta) => (theta, Output::Sensitivities(self.job.method.response())),
        };
        Some(Request {
            simulator: self.simulator,
            theta: Parameters::Fitted { theta: theta.to_vec(), tolerance: self.estimation.tolerance() },
            output,
        })
    }

    /// Takes what was simulated. Where simulations near the minimum keep it from being found, it is sought among physical
    /// parameters.
    pub(super) fn take(&mut self, simulated: Result<Simulated, SimulationError>) {
        let (regression, of_robot) = (&self.job.regression, self.job.start.len());
        let of_loop = self.simulator.loop_parameters();
        let mut admit = |step| admit(&mut self.physical, of_loop, of_robot, step);
        match self.estimation.wanted() {
            Some(SimulationRequest::Response(_)) => {
                let response = response(self.simulator, self.job.method, simulated);
                self.estimation.take_response(response, regression, &mut admit);
            }
            Some(SimulationRequest::Sensitivities(_)) => {
                self.estimation.take_sensitivities(sensitivities(simulated), regression, &mut admit);
            }
            None => {}
        }
        if self.estimation.is_held_up() && self.physical.keep_in_set() {
            self.estimation.start_anew(&mut |step| self::admit(&mut self.physical, of_loop, of_robot, step));
        }
    }

    /// The iterations done.
    pub(super) fn iterations(&self) -> &[Iteration] {
        self.estimation.iterations()
    }

    /// What is reported of what was simulated.
    pub(super) fn note(&self) -> Option<String> {
        let kept = self
            .simulator
            .keeps_gains_for(self.job.method)
            .then(|| "gains that a bandwidth gives are those for the start values".to_owned());
        let physical = if self.physical.is_needed() { self.physical.note() } else { None };
        let notes: Vec<String> = kept.into_iter().chain(physical).collect();
        (!notes.is_empty()).then(|| notes.join("; "))
    }

    pub(super) fn into_outcome(self) -> Outcome {
        self.estimation.into_outcome()
    }
}

fn response(
    simulator: &Simulator<'_>,
    method: Method,
    simulated: Result<Simulated, SimulationError>,
) -> Result<Vec<f64>, SimulationError> {
    match simulated? {
        Simulated::Motions(motions) => simulator.response_of(&motions, method.response()),
        Simulated::Response(SimulatedResponse { response, .. }) => Ok(response),
        Simulated::Instruments(_) => Err(SimulationError::TooShortToFilter),
    }
}

/// What a step leads to, the parameters of the robot in what can be simulated. Their metric is that with the parameters of the
/// loop, which follow them, at their best.
fn admit(
    physical: &mut Physical<'_>,
    loop_parameters: &LoopParameters,
    of_robot: usize,
    GaussNewtonStep { mut theta, r }: GaussNewtonStep,
) -> Vec<f64> {
    let of_loop = loop_parameters.within_bounds(theta.split_off(of_robot));
    let loop_first: Vec<usize> = (of_robot..r.columns()).chain(0..of_robot).collect();
    let r = r.select_columns(&loop_first).triangular_factor();
    let robot_rows = of_loop.len()..r.rows();
    let last: Vec<usize> = (of_loop.len()..r.columns()).collect();
    let mut admitted = physical.admit(theta, &r.row_range(robot_rows).select_columns(&last));
    admitted.extend(of_loop);
    admitted
}

fn sensitivities(simulated: Result<Simulated, SimulationError>) -> Result<SimulatedResponse, SimulationError> {
    match simulated? {
        Simulated::Response(response) => Ok(response),
        Simulated::Motions(_) | Simulated::Instruments(_) => Err(SimulationError::TooShortToFilter),
    }
}
