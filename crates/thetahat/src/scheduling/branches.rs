//! Parts of the robot that move independently, simulated apart: with a step size of their own each, in fewer coordinates, with the
//! sensitivities to their own parameters, and side by side on threads.

use thetahat_estimation::{
    control::ControllerDescription,
    simulation::{ClosedLoop, Job, Reference, SensitiveTo, SimulationError},
};
use thetahat_ground::series::Series;
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

/// The parts of a robot that can be simulated apart in these loops; none if there is but one.
pub(super) fn branches_of(robot: &Robot, loops: &[ClosedLoop<'_>]) -> Vec<BranchLoops> {
    let branches = robot.branches();
    let apart = branches.len() > 1 && loops.iter().all(|l| l.controller.own_law().is_none() && l.channels.is_none());
    if !apart {
        return Vec::new();
    }
    let of_branch = |branch: Branch| BranchLoops {
        model: Model::new(&branch.robot),
        references: loops.iter().map(|l| l.reference.of_joints(&branch.coordinates)).collect(),
        added_signals: loops.iter().map(|l| l.added_signal.map(|(signal, _)| signal.select(&branch.motors))).collect(),
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
    pub(super) fn job<'j>(&'j self, recording: usize, whole: &Job<'j>) -> Job<'j> {
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

    /// Its coordinates and motors among those of the whole robot.
    pub(super) fn places(&self) -> (&[usize], &[usize]) {
        (&self.loops.branch.coordinates, &self.loops.branch.motors)
    }

    /// Those of the sensitivity parameters that act on this part, with their columns.
    pub(super) fn sensitive_to(&self, to: &[SensitiveTo]) -> (Vec<usize>, Vec<SensitiveTo>) {
        let Branch { motors, parameters, .. } = &self.loops.branch;
        let own = |(column, to): (usize, &SensitiveTo)| Some((column, to.of_part(motors, parameters)?));
        to.iter().enumerate().filter_map(own).unzip()
    }

    pub(super) fn of_whole(&self, error: SimulationError) -> SimulationError {
        error.of_part(&self.loops.branch.coordinates, &self.loops.branch.joints)
    }
}
