//! What is to be estimated.

use super::simulator::{Parameters, Simulator};
use crate::preparation::Problem;
use thetahat_estimation::{
    identification::{Method, Response, SimulatedResponse},
    regression::Regression,
};

/// A method on a problem.
pub(crate) struct EstimationJob<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) method: Method,
    /// The rows of the problem with the weights of the method.
    pub(crate) regression: Regression,
    pub(crate) simulator: Option<Simulator<'a>>,
    /// Where an iteration starts.
    pub(crate) start: Vec<f64>,
    /// The rows of the problem with the torques that the controller asks for, where none were recorded: their estimate of LS is
    /// near enough to start from.
    pub(crate) commanded: Option<Regression>,
}

impl<'a> EstimationJob<'a> {
    /// A method with weights of the rows, from the start values of its simulator.
    pub(crate) fn new(
        problem: &'a Problem,
        method: Method,
        weights: Option<Vec<f64>>,
        simulator: Option<Simulator<'a>>,
    ) -> Self {
        let simulator = simulator.map(|simulator| simulator.of_method(method));
        let commanded = match method.response() {
            Response::Position => simulator.as_ref().and_then(Simulator::commanded_torques),
            Response::Torque => None,
        };
        let commanded = commanded.map(|torques| problem.regression.with_measured(torques));
        let start = simulator.as_ref().map(Simulator::start).unwrap_or_default();
        let regression = problem.regression.with_weights(weights);
        let regression = match (method.response(), &simulator) {
            (Response::Position, Some(simulator)) => simulator
                .measured(Response::Position)
                .map_or_else(|_| regression.clone(), |y| regression.with_measured(y).without_mask()),
            (Response::Position, None) | (Response::Torque, _) => regression,
        };
        Self { problem, method, regression, simulator, start, commanded }
    }

    /// The response with these parameters of the robot and the loop as it is described, and its sensitivities to all that is estimated; none if
    /// it cannot be simulated.
    pub(crate) fn linearised(&self, of_robot: &[f64], threads: usize) -> Option<SimulatedResponse> {
        let simulator = self.simulator.as_ref()?;
        let mut theta = of_robot.to_vec();
        theta.resize(theta.len() + simulator.loop_parameters().len(), 0.0);
        let parameters = Parameters::Fitted { theta, tolerance: 1.0 };
        simulator.response_with_sensitivities(&parameters, self.method.response(), threads).ok()
    }

    /// The names of what of the loop is estimated after the robot's parameters.
    pub(crate) fn names_of_loop(&self) -> Vec<String> {
        self.simulator.as_ref().map(|s| s.loop_parameters().names()).unwrap_or_default()
    }
}
