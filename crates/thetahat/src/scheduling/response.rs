//! What the loops of all recordings answer, for methods that compare it with the recording.

use super::simulator::{Output, Parameters, RecordedLoop, Simulator};
use thetahat_estimation::{
    identification::{Assembly, Response, SimulatedResponse},
    signal::centred_hold,
    simulation::{Job, SensitiveTo, Sensitivities, SimulatedMotion, SimulationError},
};
use thetahat_ground::series::Series;

impl Simulator<'_> {
    /// The response of the recording in the rows of y: raw torques, or raw positions through the same parallel filter.
    pub(super) fn measured(&self, response: Response) -> Result<Vec<f64>, SimulationError> {
        let of_loop = |l: &RecordedLoop<'_>| match response {
            Response::Torque => l.in_rows(&l.filtered.centred_torque(), response),
            Response::Position => l.in_rows(&l.filtered.position(), response),
        };
        Ok(self.problem.regression.layout.stack_vectors(self.loops.iter().map(of_loop).collect::<Result<_, _>>()?))
    }

    /// The torques that the controller asks for in the recorded motion, in the rows of y, less those of fixed parameters; none if
    /// torques were recorded.
    pub(super) fn commanded_torques(&self) -> Option<Vec<f64>> {
        if self.loops.iter().any(|l| l.filtered.recording.torque.is_some()) {
            return None;
        }
        let resolved = self.resolve(&Parameters::Estimated(self.start()));
        let jobs = self.jobs(&resolved, Output::Motion { step: 1 });
        let of_loop = |(l, job): (&RecordedLoop<'_>, &Job<'_>)| {
            let mut torques = job.commanded_torques(&l.filtered.motion.q, &l.filtered.motion.dq);
            if let Some(fixed) = &l.filtered.fixed_torque {
                let fixed = fixed.window(l.filtered.window.clone());
                torques.values_mut().iter_mut().zip(fixed.values()).for_each(|(all, fixed)| *all -= fixed);
            }
            l.assembly.measurement_vector(&torques).ok()
        };
        let vectors = self.loops.iter().zip(&jobs).map(of_loop).collect::<Option<_>>()?;
        Some(self.problem.regression.layout.stack_vectors(vectors))
    }

    /// The response of motions simulated at every sample of the windows, in the rows of y.
    pub(super) fn response_of(
        &self,
        motions: &[SimulatedMotion],
        response: Response,
    ) -> Result<Vec<f64>, SimulationError> {
        let of_loop = |(l, motion): (&RecordedLoop<'_>, &SimulatedMotion)| match response {
            Response::Torque => l.in_rows(&centred_hold(&motion.tau, l.held_part_of_step()), response),
            Response::Position => l.in_rows(&motion.q, response),
        };
        let vectors = self.loops.iter().zip(motions).map(of_loop).collect::<Result<_, _>>()?;
        Ok(self.problem.regression.layout.stack_vectors(vectors))
    }

    /// The response with its sensitivities, in the rows of y.
    pub(super) fn response_with_sensitivities(
        &self,
        parameters: &Parameters,
        response: Response,
        threads: usize,
    ) -> Result<SimulatedResponse, SimulationError> {
        let resolved = self.resolve(parameters);
        let of_robot = self.problem.estimated.columns().into_iter().map(SensitiveTo::Parameter);
        let to: Vec<SensitiveTo> = of_robot.chain(self.loop_parameters.sensitive_to().iter().copied()).collect();
        let found = self.sensitive_responses(&resolved, &to, response, threads)?;
        let (responses, matrices) = found.into_iter().map(|found| (found.response, found.sensitivities)).unzip();
        let layout = &self.problem.regression.layout;
        Ok(SimulatedResponse {
            response: layout.stack_vectors(responses),
            sensitivities: layout.stack_matrices(matrices),
        })
    }

    /// The derivatives of the inertia that each motor sees.
    pub(super) fn inertia_slopes(&self, to: &[SensitiveTo]) -> Vec<Vec<f64>> {
        let of_loops: Vec<Vec<Vec<f64>>> =
            self.loops.iter().map(|l| l.closed_loop.motor_inertia_slopes(to, l.duration_s())).collect();
        let count = of_loops.len() as f64;
        let mean = |p: usize, motor: usize| of_loops.iter().map(|slopes| slopes[p][motor]).sum::<f64>() / count;
        let motors = self.problem.model.coordinate_count();
        (0..to.len()).map(|p| (0..motors).map(|motor| mean(p, motor)).collect()).collect()
    }
}

impl RecordedLoop<'_> {
    /// The response of a job and its sensitivities, in the rows of y; `joints` are those of the job among all.
    pub(super) fn response_with_sensitivities(
        &self,
        job: &Job<'_>,
        (joints, to): (&[usize], &[SensitiveTo]),
        inertia_slopes: Option<&[Vec<f64>]>,
        response: Response,
    ) -> Result<SimulatedResponse, SimulationError> {
        let mut simulation = Sensitivities::new(job, to, inertia_slopes)?;
        self.assembly_for(response).response_with_sensitivities(joints, to.len(), |values, slopes| {
            let end = SimulationError::TooShortToFilter;
            let sample = simulation.next_sample()?.ok_or(end)?;
            let (of_joints, of_parameters) = match response {
                Response::Torque => (sample.tau, sample.tau_slopes),
                Response::Position => (sample.q, sample.q_slopes),
            };
            values.copy_from_slice(of_joints);
            slopes.copy_from_slice(of_parameters);
            Ok(())
        })
    }

    /// The part of a step for which recorded torques hold: simulated ones are compared with them.
    pub(super) fn held_part_of_step(&self) -> f64 {
        self.filtered.recording.held_part_of_step()
    }

    /// The rows of a response: of positions every sample, since no sign of a velocity is in them.
    fn assembly_for(&self, response: Response) -> Assembly<'_> {
        match response {
            Response::Torque => self.assembly.clone().of_held_torques(self.held_part_of_step()),
            Response::Position => self.assembly.clone().masked(None),
        }
    }

    /// A series of the window in the rows of y.
    fn in_rows(&self, series: &Series, response: Response) -> Result<Vec<f64>, SimulationError> {
        self.assembly_for(response).measurement_vector(series).map_err(|_| SimulationError::TooShortToFilter)
    }
}
