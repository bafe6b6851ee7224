//! Parts of the robot that move independently, simulated apart: with a step size of their own each, in fewer coordinates, with the
//! sensitivities to their own parameters, and side by side on threads.

use super::simulator::{Output, RecordedLoop, Resolved, Simulator};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{Response, SimulatedResponse},
    simulation::{ClosedLoop, Job, Reference, SensitiveTo, SimulatedMotion, SimulationError},
};
use thetahat_ground::{linear_algebra::Matrix, pool::in_parallel, series::Series};
use thetahat_model::{
    dynamics::Model,
    robot::{Branch, Robot, Transmission},
};

/// A part of the robot, and what it follows in each recording.
pub(super) struct BranchLoops {
    branch: Branch,
    model: Model,
    references: Vec<Reference>,
    added_signals: Vec<Option<Series>>,
}

/// What a simulation of a part takes.
pub(super) struct ResolvedBranch<'a> {
    loops: &'a BranchLoops,
    controller: ControllerDescription,
    transmission: Transmission,
    standard: Vec<f64>,
    inertia: Vec<f64>,
}

/// The parts of a robot that can be simulated apart; none if there is but one.
pub(super) fn branches_of(robot: &Robot, loops: &[RecordedLoop<'_>]) -> Vec<BranchLoops> {
    let branches = robot.branches();
    let apart = branches.len() > 1
        && loops.iter().all(|l| l.closed_loop.controller.own_law().is_none() && l.closed_loop.channels.is_none());
    if !apart {
        return Vec::new();
    }
    let of_branch = |branch: Branch| BranchLoops {
        model: Model::new(&branch.robot),
        references: loops.iter().map(|l| l.closed_loop.reference.of_joints(&branch.coordinates)).collect(),
        added_signals: loops
            .iter()
            .map(|l| l.closed_loop.added_signal.map(|(signal, _)| signal.select(&branch.motors)))
            .collect(),
        branch,
    };
    branches.into_iter().map(of_branch).collect()
}

impl<'a> ResolvedBranch<'a> {
    /// Each part with its own of what a simulation of the whole takes; none if the whole is simulated.
    pub(super) fn of_all(
        branches: &'a [BranchLoops],
        (controller, transmission): (&ControllerDescription, &Transmission),
        (standard, inertia): (&[f64], &[f64]),
    ) -> Option<Vec<Self>> {
        let of_branch = |loops: &'a BranchLoops| {
            let Branch { coordinates, motors, parameters, .. } = &loops.branch;
            Some(Self {
                loops,
                controller: controller.of_motors(motors)?,
                transmission: transmission.part(motors, coordinates)?,
                standard: parameters.iter().map(|&i| standard[i]).collect(),
                inertia: motors.iter().map(|&i| inertia[i]).collect(),
            })
        };
        branches.iter().map(of_branch).collect()
    }

    /// The simulation of this part in a recording, given that of the whole.
    fn job<'j>(&'j self, recording: usize, whole: &Job<'j>) -> Job<'j> {
        let added = self.loops.added_signals[recording].as_ref();
        Job {
            closed_loop: ClosedLoop {
                model: &self.loops.model,
                transmission: &self.transmission,
                controller: &self.controller,
                reference: &self.loops.references[recording],
                added_signal: added.zip(whole.closed_loop.added_signal).map(|(signal, (_, rate))| (signal, rate)),
                ..whole.closed_loop
            },
            theta: &self.standard,
            motor_inertia: &self.inertia,
            grid: whole.grid,
        }
    }

    /// Those of the sensitivity parameters that act on this part, with their columns.
    fn sensitive_to(&self, to: &[SensitiveTo]) -> (Vec<usize>, Vec<SensitiveTo>) {
        let Branch { motors, parameters, .. } = &self.loops.branch;
        let own = |(column, to): (usize, &SensitiveTo)| Some((column, to.of_part(motors, parameters)?));
        to.iter().enumerate().filter_map(own).unzip()
    }

    fn of_whole(&self, error: SimulationError) -> SimulationError {
        error.of_part(&self.loops.branch.coordinates, &self.loops.branch.joints)
    }
}

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
                motion.write(&branch.loops.branch.coordinates, &part);
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
            let motors = &branch.loops.branch.motors;
            let of_motors = |column: &usize, all: &[Vec<f64>]| motors.iter().map(|&m| all[*column][m]).collect();
            let slopes: Option<Vec<Vec<f64>>> =
                slopes.as_ref().map(|all| columns.iter().map(|c| of_motors(c, all)).collect());
            let coordinates = &branch.loops.branch.coordinates;
            let job = branch.job(k, &jobs[k]);
            self.loops[k]
                .response_with_sensitivities(&job, (coordinates, &own), slopes.as_deref(), response)
                .map(|found| (columns, found))
                .map_err(|error| branch.of_whole(error))
        };
        let mut found = in_parallel(parts * jobs.len(), threads, of_part).into_iter();
        let mut put_together = |_| {
            let of_parts = found.by_ref().take(parts).collect::<Result<Vec<_>, _>>()?;
            let coordinates = resolved.branches.iter().map(|b| &b.loops.branch.coordinates[..]);
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        preparation::{Case, LoopParameter, Recording, Settings},
        run::Identification,
        scheduling::{EstimationJob, simulator::Parameters},
    };
    use thetahat_estimation::{identification::Method, simulation::Solver};

    const RATE_HZ: f64 = 200.0;

    /// Two legs of two joints each, whose joints are numbered leg by leg.
    fn legs() -> Robot {
        let link = |name: &str, mass: f64| {
            format!(
                "<link name='{name}'><inertial><origin xyz='0.02 0.01 -0.1'/><mass value='{mass}'/>\
                 <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.012' iyz='0' izz='0.004'/></inertial></link>"
            )
        };
        let joint = |name: &str, parent: &str, child: &str, axis: &str, origin: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><axis xyz='{axis}'/>\
                 <origin xyz='{origin}'/><limit lower='-2' upper='2' effort='40' velocity='20'/></joint>"
            )
        };
        let mut text = "<robot name='legs'><link name='base'/>".to_owned();
        for (side, mass) in [("left", 1.5), ("right", 1.1)] {
            let [hip, shank] = ["hip", "shank"].map(|part| format!("{side} {part}"));
            text += &(link(&hip, mass) + &link(&shank, 0.4 * mass));
            text += &joint(&format!("{hip} joint"), "base", &hip, "1 0 0", "0 0.1 0");
            text += &joint(&format!("{side} knee"), &hip, &shank, "0 1 0", "0 0 -0.25");
        }
        Robot::parse(&(text + "</robot>"), Path::new("legs.urdf")).unwrap()
    }

    fn recording() -> Recording {
        let wave = |k: usize, j: usize, late: f64| {
            let t = k as f64 / RATE_HZ - late;
            0.4 * (5.0 * t + 1.3 * j as f64).sin() + 0.1 * ((11.0 + j as f64) * t).cos()
        };
        let series = |late: f64| Series::shaped(4, (0..600 * 4).map(|i| wave(i / 4, i % 4, late)).collect());
        Recording { reference: Some(series(0.0)), ..Recording::without_torque(RATE_HZ, series(0.02)) }
    }

    fn identification(loop_parameters: &[LoopParameter]) -> Identification {
        let mut settings = Settings::new(30.0, 4).with_methods([Method::CLOE]);
        let controller = "law = 'pd'\nposition_gain = [30, 20, 25, 35]\nvelocity_gain = 1.5\nsaturation = 30";
        settings.controller = Some(toml::from_str(controller).unwrap());
        // Equal steps, so that only rounding differs between the whole and its parts.
        settings.simulation.solver = Solver::Fixed { step_s: 1e-3 };
        settings.simulation.sign_velocity_scale = 0.1;
        settings.estimation.loop_parameters = loop_parameters.to_vec();
        Identification::new(&legs(), vec![recording()], settings).unwrap()
    }

    /// The described robot with friction and rotors, and factors near one.
    fn theta(job: &EstimationJob<'_>) -> Vec<f64> {
        let estimated = &job.problem.estimated;
        let table = job.problem.model.parameter_table();
        let of_robot = estimated.parameters().iter().zip(&job.start).map(|(p, start)| {
            start
                + match table.get(p.kept).quantity.name() {
                    "ia" => 0.02,
                    "fv" => 0.3,
                    "fc" => 0.4,
                    "off" => 0.05,
                    _ => 0.0,
                }
        });
        of_robot.chain(job.names_of_loop().iter().map(|_| 0.03)).collect()
    }

    fn assert_close(parts: &[f64], whole: &[f64], what: &str) {
        let size = whole.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
        let worst = parts.iter().zip(whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(parts.len() == whole.len() && worst <= 1e-9 * size, "{what}: {worst:e} of {size:e}");
    }

    #[test]
    fn responses_and_sensitivities_of_parts_are_those_of_the_whole() {
        let loop_parameters = [LoopParameter::VelocityGains, LoopParameter::DriveGain];
        let identification = identification(&loop_parameters);
        let problems = identification.problems(&mut |_| {}).unwrap();
        let job = |apart: bool| {
            let mut job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
            let simulator = job.simulator.as_mut().unwrap();
            assert_eq!(simulator.branches.len(), 2);
            if !apart {
                simulator.branches.clear();
            }
            job
        };
        let [parts, whole] = [job(true), job(false)];
        let parameters = Parameters::Fitted { theta: theta(&parts), tolerance: 1.0 };
        for response in [Response::Position, Response::Torque] {
            let [a, b] = [(&parts, 2), (&whole, 1)].map(|(job, threads)| {
                let simulator = job.simulator.as_ref().unwrap();
                simulator.response_with_sensitivities(&parameters, response, threads).unwrap()
            });
            assert_close(&a.response, &b.response, "response");
            for column in 0..a.sensitivities.columns() {
                let [a, b] = [&a, &b].map(|found| found.sensitivities.column(column));
                assert_close(a, b, &format!("column {column} of {response:?}"));
            }
        }
    }

    /// Equal steps of the explicit method: sensitivities are the derivatives of the response itself.
    #[test]
    fn sensitivities_of_parts_are_differences_of_responses() {
        let identification = identification(&[LoopParameter::PositionGain]);
        let problems = identification.problems(&mut |_| {}).unwrap();
        let job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
        let (simulator, at) = (job.simulator.as_ref().unwrap(), theta(&job));
        let found = |theta: &[f64]| {
            let parameters = Parameters::Fitted { theta: theta.to_vec(), tolerance: 1.0 };
            simulator.response_with_sensitivities(&parameters, Response::Position, 2).unwrap()
        };
        let exact = found(&at).sensitivities;
        for column in 0..at.len() {
            let h = 1e-5 * at[column].abs().max(0.01);
            let [after, before] = [h, -h].map(|by| {
                let mut theta = at.clone();
                theta[column] += by;
                found(&theta).response
            });
            let differences = after.iter().zip(&before).map(|(a, b)| (a - b) / (2.0 * h));
            let size = exact.column(column).iter().fold(1e-3_f64, |size, v| size.max(v.abs()));
            let worst = differences.zip(exact.column(column)).map(|(d, e)| (d - e).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-5 * size, "column {column}: {worst:e} of {size:e}");
        }
    }

    /// In its own simulated motion the controller asks for the torques that were simulated.
    #[test]
    fn commanded_torques_of_a_simulated_motion_are_its_torques() {
        let identification = identification(&[]);
        let problems = identification.problems(&mut |_| {}).unwrap();
        let job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
        assert!(job.commanded.is_some());
        let simulator = job.simulator.as_ref().unwrap();
        let resolved = simulator.resolve(&Parameters::Fitted { theta: theta(&job), tolerance: 1.0 });
        let simulation = simulator.jobs(&resolved, Output::Motion { step: 1 })[0];
        let motion =
            simulation.closed_loop.simulate(simulation.theta, simulation.motor_inertia, &simulation.grid).unwrap();
        let commanded = simulation.commanded_torques(&motion.q, &motion.dq);
        assert_close(commanded.values(), motion.tau.values(), "torques");
    }
}
