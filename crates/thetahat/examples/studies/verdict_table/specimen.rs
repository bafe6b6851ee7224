use std::{error::Error, path::Path};

use thetahat::{
    Experiment, Recording, Robot, Series,
    dynamics::Model,
    experiment::{TwinDescription, TwinMotion},
    simulation::{ClosedLoop, OutputGrid, Reference, Sensors, SimulatedMotion, SimulatorBias},
};
use thetahat_model::robot::TermDescription;

/// Lengths of the wrong robot, relative to the true ones.
const LONGER: f64 = 1.5;

/// A robot with known parameters that moves under its control, and the experiment that identifies it.
pub struct Specimen {
    pub name: &'static str,
    pub experiment: Experiment,
    pub description: TwinDescription,
    pub motion: TwinMotion,
}

impl Specimen {
    pub fn all() -> Result<Vec<Self>, Box<dyn Error>> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments");
        let read = |file: &str| Experiment::read(&root.join(file), &root);
        [
            ("TX40 (demo)", Experiment::demo()?),
            ("EMPS twin", read("emps_twin.toml")?),
            ("two_joint", read("two_joint.toml")?),
        ]
        .into_iter()
        .map(|(name, experiment)| Self::new(name, experiment))
        .collect()
    }

    fn new(name: &'static str, mut experiment: Experiment) -> Result<Self, Box<dyn Error>> {
        experiment.settings.cases.clear();
        let description = experiment.file.twin.clone().ok_or("no twin")?;
        let motion = experiment.twin_motion(&description)?;
        Ok(Self { name, experiment, description, motion })
    }

    pub fn rate_hz(&self) -> f64 {
        self.description.sample_rate_hz
    }

    /// What the robot's sensors see of a motion.
    fn recording(&self, motion: &SimulatedMotion) -> Recording {
        self.seen_by(&self.description.sensors, motion)
    }

    fn seen_by(&self, sensors: &Sensors, motion: &SimulatedMotion) -> Recording {
        let transmission = &self.experiment.robot.transmission;
        let (positions, drives) = sensors.record(motion, &self.experiment.robot);
        let (position, torque) = (transmission.joint_positions(&positions), transmission.joint_torques(&drives));
        Recording {
            geared: true,
            planned: self.motion.reference.moves().cloned(),
            truth: Some(self.motion.parameters.clone()),
            ..Recording::new(self.rate_hz(), position, torque)
        }
    }

    pub fn clean(&self) -> Recording {
        self.recording(&self.motion.motion)
    }

    /// The recording with a tenth of the noise.
    pub fn quiet(&self) -> Recording {
        let mut sensors = self.description.sensors.clone();
        sensors.torque_noise.iter_mut().chain(&mut sensors.torque_ripple).for_each(|size| *size *= 0.1);
        self.seen_by(&sensors, &self.motion.motion)
    }

    /// The recording with other torques: `change` gives them by joint, sample and torque.
    pub fn with_torques(&self, change: impl Fn(usize, usize, f64) -> f64) -> Recording {
        let mut recording = self.clean();
        let torque = self.torque();
        let joints = torque.channels();
        let changed = torque.values().iter().enumerate().map(|(i, t)| change(i % joints, i / joints, *t)).collect();
        recording.torque = Some(Series::shaped(joints, changed));
        recording
    }

    /// The recorded torques.
    pub fn torque(&self) -> Series {
        self.clean().torque.unwrap_or_else(|| Series::zeros(0, 1))
    }

    /// The recording of a loop that differs from the simulated one.
    pub fn of_another_loop(&self, bias: SimulatorBias) -> Result<Recording, Box<dyn Error>> {
        let experiment = &self.experiment;
        let model = Model::new(&experiment.robot);
        let moves = self.motion.reference.moves().ok_or("the twin follows no moves")?;
        let reference = Reference::Moves(moves.clone());
        let simulation = &experiment.settings.simulation;
        let closed_loop = ClosedLoop {
            model: &model,
            transmission: &experiment.robot.transmission,
            controller: experiment.settings.controller.as_ref().ok_or("no controller")?,
            reference: &reference,
            added_signal: None,
            channels: None,
            bias,
            solver: simulation.solver,
            sign_velocity_scale: simulation.sign_velocity_scale,
        };
        let samples = self.motion.motion.q.len();
        let inertia = closed_loop.motor_inertia(&self.motion.parameters, moves.end_s());
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: self.rate_hz(), samples };
        Ok(self.recording(&closed_loop.simulate(&self.motion.parameters, &inertia, &grid)?))
    }

    /// The recording of a robot with a Stribeck torque of a part of its Coulomb friction.
    pub fn with_stribeck(&self, velocity: f64, part: f64) -> Result<Recording, Box<dyn Error>> {
        let mut experiment = self.experiment.clone();
        let before = Model::new(&experiment.robot).parameter_table().len();
        let term = TermDescription::ExponentialStribeck { joints: None, velocity, exponent: 2.0, profile: false };
        experiment.robot.add_terms(&[term])?;
        let model = Model::new(&experiment.robot);
        let coulomb = |name: &str| {
            let joint = name.trim_start_matches(|c: char| !c.is_ascii_digit());
            let name = format!("fc{joint}");
            self.description.parameters.get(&name).copied().unwrap_or_else(|| self.a_priori(&name))
        };
        let terms: Vec<(String, f64)> =
            model.parameter_table().iter().skip(before).map(|p| (p.name(), part * coulomb(&p.name()))).collect();
        let mut description = self.description.clone();
        description.parameters.extend(terms);
        let motion = experiment.twin_motion(&description)?;
        Ok(self.recording(&motion.motion))
    }

    fn a_priori(&self, name: &str) -> f64 {
        self.experiment.robot.a_priori.iter().find(|(n, _)| n.as_str() == name).map_or(0.0, |(_, value)| *value)
    }

    /// The torques of another motion of the same robot, with the positions of this one.
    pub fn with_torques_of_another_motion(&self) -> Result<Recording, Box<dyn Error>> {
        let mut description = self.description.clone();
        let last = description.points.len() - 1;
        description.points[1..last].reverse();
        let other = self.recording(&self.experiment.twin_motion(&description)?.motion);
        let torque = other.torque.ok_or("no torque")?;
        let at = |j: usize, k: usize| torque.sample(k.min(torque.len() - 1))[j];
        Ok(self.with_torques(|j, k, _| at(j, k)))
    }

    /// The robot with other lengths; `None` if an axis has no length.
    pub fn wrong_robot(&self) -> Option<Robot> {
        let mut robot = self.experiment.robot.clone();
        if robot.joints.len() < 2 {
            return None;
        }
        robot.joints.iter_mut().skip(1).for_each(|joint| {
            joint.placement.origin = joint.placement.origin.map(|length| LONGER * length);
        });
        Some(robot)
    }
}
