//! Simulations of the whole robot, or of its independent parts put together.

use super::{
    branches::ResolvedBranch,
    simulator::{Output, Resolved, Simulator},
};
use thetahat_estimation::{
    identification::{Response, SimulatedResponse},
    simulation::{Job, SensitiveTo, SimulatedMotion, SimulationError},
};
use thetahat_ground::{linear_algebra::Matrix, pool::in_parallel};

impl Simulator<'_> {
    /// The simulations that give the motion of all recordings: one for each, or for each part of the robot one after the other.
    pub(super) fn motion_jobs<'j>(&'j self, resolved: &'j Resolved<'_>, output: Output) -> Vec<Job<'j>> {
        let whole = self.jobs(resolved, output);
        if resolved.branches.is_empty() {
            return whole;
        }
        let of_branch = |branch: &'j ResolvedBranch<'_>| {
            whole.iter().enumerate().map(|(recording, job)| branch.job(recording, job)).collect::<Vec<_>>()
        };
        resolved.branches.iter().flat_map(of_branch).collect()
    }

    /// The motion of all recordings of what [`Self::motion_jobs`] gave.
    pub(super) fn whole_motions(
        &self,
        resolved: &Resolved<'_>,
        found: Vec<Result<SimulatedMotion, SimulationError>>,
    ) -> Result<Vec<SimulatedMotion>, SimulationError> {
        if resolved.branches.is_empty() {
            return found.into_iter().collect();
        }
        let joints = self.problem.model.coordinate_count();
        let mut motions: Vec<Option<SimulatedMotion>> = self.loops.iter().map(|_| None).collect();
        let mut found = found.into_iter();
        for branch in &resolved.branches {
            for (motion, part) in motions.iter_mut().zip(found.by_ref()) {
                let part = part.map_err(|error| branch.of_whole(error))?;
                let motion = motion.get_or_insert_with(|| SimulatedMotion::zeros(part.q.len(), joints));
                motion.write(branch.places().0, &part);
            }
        }
        Ok(motions.into_iter().flatten().collect())
    }

    /// The responses of all recordings with their sensitivities, of the whole robot or put together from its parts.
    pub(super) fn sensitive_responses(
        &self,
        resolved: &Resolved<'_>,
        to: &[SensitiveTo],
        response: Response,
        threads: usize,
    ) -> Result<Vec<SimulatedResponse>, SimulationError> {
        let jobs = self.jobs(resolved, Output::Sensitivities(response));
        let slopes = self.kept_inertia.is_none().then(|| self.inertia_slopes(to));
        let all: Vec<usize> = (0..self.problem.model.coordinate_count()).collect();
        if resolved.branches.is_empty() {
            let of_loop =
                |k: usize| self.loops[k].response_with_sensitivities(&jobs[k], (&all, to), slopes.as_deref(), response);
            return in_parallel(jobs.len(), threads, of_loop).into_iter().collect();
        }
        let parts = resolved.branches.len();
        let of_part = |number: usize| {
            let (k, branch) = (number / parts, &resolved.branches[number % parts]);
            let (columns, own) = branch.sensitive_to(to);
            let (coordinates, motors) = branch.places();
            let of_motors = |column: &usize, all: &[Vec<f64>]| motors.iter().map(|&m| all[*column][m]).collect();
            let slopes: Option<Vec<Vec<f64>>> =
                slopes.as_ref().map(|all| columns.iter().map(|c| of_motors(c, all)).collect());
            let job = branch.job(k, &jobs[k]);
            self.loops[k]
                .response_with_sensitivities(&job, (coordinates, &own), slopes.as_deref(), response)
                .map(|found| (columns, found))
                .map_err(|error| branch.of_whole(error))
        };
        let mut found = in_parallel(parts * jobs.len(), threads, of_part).into_iter();
        let mut put_together = |_| {
            let of_parts = found.by_ref().take(parts).collect::<Result<Vec<_>, _>>()?;
            let coordinates = resolved.branches.iter().map(|branch| branch.places().0);
            Ok(together(coordinates.zip(of_parts), all.len(), to.len()))
        };
        (0..jobs.len()).map(&mut put_together).collect()
    }
}

/// The response of the whole robot, joint by joint, from those of its parts, each with its coordinates and columns.
fn together<'c>(
    parts: impl Iterator<Item = (&'c [usize], (Vec<usize>, SimulatedResponse))>,
    joints: usize,
    columns: usize,
) -> SimulatedResponse {
    let mut whole: Option<(Vec<f64>, Matrix)> = None;
    for (coordinates, (own, part)) in parts {
        let rows = part.response.len() / coordinates.len();
        let (response, sensitivities) =
            whole.get_or_insert_with(|| (vec![0.0; joints * rows], Matrix::zeros(joints * rows, columns)));
        for (i, &coordinate) in coordinates.iter().enumerate() {
            let (from, to) = (i * rows..(i + 1) * rows, coordinate * rows..(coordinate + 1) * rows);
            response[to.clone()].copy_from_slice(&part.response[from.clone()]);
            for (c, &column) in own.iter().enumerate() {
                sensitivities.column_mut(column)[to.clone()]
                    .copy_from_slice(&part.sensitivities.column(c)[from.clone()]);
            }
        }
    }
    let (response, sensitivities) = whole.unwrap_or_else(|| (Vec::new(), Matrix::zeros(0, columns)));
    SimulatedResponse { response, sensitivities }
}
