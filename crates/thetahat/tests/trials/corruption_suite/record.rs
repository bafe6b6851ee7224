//! The clean records of the suite: the TX40 twin and the recorded TX40, on the joint side.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    ControllerDescription, Experiment, Robot, Series,
    base_parameters::BaseParameters,
    checks::Finding,
    dynamics::Model,
    experiment::TwinDescription,
    recording::read_channels,
    robot::JointKind,
    signal::{Derivative, band_pass},
    simulation::{ClosedLoop, OutputGrid, Reference, SimulatorBias},
    trajectory::{MotionLimits, Moves},
};
use thetahat_estimation::{
    checks::{SignalSettings, Subject, examine},
    signal::moving_samples,
    trajectory,
};

/// A record with everything that the checks look at, to be changed at will.
#[derive(Clone)]
pub struct Record {
    pub robot: Robot,
    pub excluded: Vec<String>,
    pub rate_hz: f64,
    pub time_s: Option<Vec<f64>>,
    pub position: Series,
    pub velocity: Option<Series>,
    pub torque: Series,
    pub reference: Option<Series>,
    pub reconstructed_deviation: Option<Vec<f64>>,
    pub added_signal: bool,
    /// Whether positions or torques came through the transmission.
    pub geared: bool,
    pub signal: SignalSettings,
    pub controller: Option<ControllerDescription>,
    /// The noise-free moves, for corruptions of a reference.
    pub moves: Option<Moves>,
}

impl Record {
    /// Calls `f` with the record as a subject.
    pub fn with_subject<T>(&self, f: impl FnOnce(&Subject<'_>) -> T) -> T {
        let model = Model::new(&self.robot);
        let base = BaseParameters::of(&model, &self.excluded).unwrap();
        f(&self.subject(&model, &base))
    }

    /// The record as a subject with a model and parameters that several records share.
    pub fn subject<'a>(&'a self, model: &'a Model, base: &'a BaseParameters) -> Subject<'a> {
        Subject {
            robot: &self.robot,
            model,
            base,
            all: base,
            sample_rate_hz: self.rate_hz,
            time_s: self.time_s.as_deref(),
            position: &self.position,
            geared: self.geared,
            velocity: self.velocity.as_ref(),
            torque: Some(&self.torque),
            reference: self.reference.as_ref(),
            reconstructed_deviation: self.reconstructed_deviation.as_deref(),
            held_part_of_step: 0.0,
            left_out: &[],
            rests_left_out: false,
            contradicting_times: None,
            added_signal: self.added_signal,
            signal: self.signal.clone(),
            controller: self.controller.as_ref(),
        }
    }

    /// The band-passed velocity of the record's own positions: what a robot that records velocities would give.
    pub fn own_velocity(&self) -> Series {
        let SignalSettings { filter_order, cutoff_hz, .. } = self.signal;
        band_pass(&self.position, self.rate_hz, filter_order, cutoff_hz, Derivative::Central).unwrap().dq
    }
}

/// The moving part less the edges of the filter, as an experiment without a stated window has it.
pub fn moving_window(record: &Record) -> std::ops::Range<usize> {
    let moving = moving_samples(&record.own_velocity(), 0.01, 1e-3).unwrap();
    let edge = (5.0 * record.rate_hz / record.signal.cutoff_hz).ceil() as usize;
    moving.start.max(edge)..moving.end.min(record.position.len() - edge)
}

/// The twin of the demonstration, recorded once more through its public parts.
pub fn twin(change: impl FnOnce(&mut TwinDescription)) -> Record {
    let mut experiment = Experiment::demo().unwrap();
    change(experiment.file.twin.as_mut().unwrap());
    let robot = experiment.robot.clone();
    let twin = experiment.file.twin.clone().unwrap();
    let model = Model::new(&robot);
    let si = |values: &Vec<f64>| -> Vec<f64> {
        let convert = |(v, j): (&f64, &thetahat::robot::Joint)| match j.kind {
            JointKind::Prismatic => 1e-3 * v,
            JointKind::Revolute => v.to_radians(),
        };
        values.iter().zip(robot.coordinates()).map(convert).collect()
    };
    let points: Vec<Vec<f64>> = twin.points.iter().map(si).collect();
    let limits = MotionLimits {
        max_velocity: si(&twin.max_velocity),
        acceleration_time_s: twin.acceleration_time_s,
        smoothing_time_s: twin.smoothing_time_s,
        dwell_s: 0.0,
    };
    let moves = trajectory::plan(points[0].clone(), &points[1..], &limits, twin.rest_s).unwrap();
    let excluded = experiment.settings.parameters.exclude.clone();
    let base = BaseParameters::of(&model, &excluded).unwrap();
    let value = |name: &str| twin.parameters.get(name).copied().unwrap_or(0.0);
    let theta = base.to_standard(&base.parameters().iter().map(|p| value(&p.name)).collect::<Vec<_>>());
    let reference = Reference::Moves(moves.clone());
    let controller = experiment.settings.controller.clone().unwrap();
    let closed_loop = ClosedLoop {
        model: &model,
        transmission: &robot.transmission,
        controller: &controller,
        reference: &reference,
        added_signal: None,
        channels: None,
        bias: SimulatorBias::NONE,
        solver: experiment.settings.simulation.solver,
        sign_velocity_scale: experiment.settings.simulation.sign_velocity_scale,
    };
    let samples = ((moves.end_s() + twin.rest_s) * twin.sample_rate_hz).ceil() as usize;
    let grid = OutputGrid { start_s: 0.0, sample_rate_hz: twin.sample_rate_hz, samples };
    let inertia = closed_loop.motor_inertia(&theta, moves.end_s());
    let motion = closed_loop.simulate(&theta, &inertia, &grid).unwrap();
    let (positions, drive) = twin.sensors.record(&motion, &robot);
    let signal = experiment.settings.signal;
    let mut record = Record {
        excluded,
        rate_hz: twin.sample_rate_hz,
        time_s: None,
        position: robot.transmission.joint_positions(&positions),
        velocity: None,
        torque: robot.transmission.joint_torques(&drive),
        reference: None,
        reconstructed_deviation: None,
        added_signal: false,
        geared: true,
        signal: SignalSettings {
            filter_order: signal.filter_order,
            cutoff_hz: signal.cutoff_hz,
            decimation: signal.decimation,
            window: 0..samples,
        },
        controller: Some(controller),
        moves: Some(moves),
        robot,
    };
    record.signal.window = moving_window(&record);
    record
}

/// The recorded TX40 of the paper's experiment.
pub fn tx40(root: &Path, data: &Path) -> Record {
    from_experiment(&root.join("experiments/tx40_paper.toml"), data, Which::Main(0))
}

/// A recording of an experiment file, from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    Main(usize),
    Validation(usize),
}

/// The record of an experiment file.
pub fn from_experiment(path: &Path, data: &Path, which: Which) -> Record {
    let experiment = Experiment::read(path, data).unwrap();
    let (file, settings) = (&experiment.file, &experiment.settings);
    let description = match which {
        Which::Main(i) => file.recording[i].clone(),
        Which::Validation(i) => file.validation[i].clone(),
    };
    let transmission = &experiment.robot.transmission;
    let motor = thetahat::recording::Side::Motor;
    let positions = |source: &thetahat::recording::ChannelSource| {
        let series = read_channels(source, data).unwrap();
        if source.side == motor { transmission.joint_positions(&series) } else { series }
    };
    let position = positions(&description.position);
    let source = description.torque.as_ref().unwrap();
    let torque = read_channels(source, data).unwrap();
    let torque = if source.side == motor { transmission.joint_torques(&torque) } else { torque };
    let time_s = description.time.as_ref().map(|t| read_channels(t, data).unwrap().channel(0));
    let rate = description.sample_rate_hz.or(time_s.as_ref().map(|t| (t.len() - 1) as f64 / (t[t.len() - 1] - t[0])));
    let rate_hz = rate.unwrap();
    let samples = position.len();
    let mut record = Record {
        excluded: settings.parameters.exclude.clone(),
        rate_hz,
        time_s,
        velocity: None,
        torque,
        reference: description.reference.as_ref().map(positions),
        reconstructed_deviation: None,
        added_signal: description.added_signal.is_some(),
        geared: source.side == motor || description.position.side == motor,
        signal: SignalSettings {
            filter_order: settings.signal.filter_order,
            cutoff_hz: settings.signal.cutoff_hz,
            decimation: settings.signal.decimation,
            window: 0..samples,
        },
        controller: settings.controller.clone(),
        moves: None,
        position,
        robot: experiment.robot.clone(),
    };
    let sample = |t: f64| (t * rate_hz).round() as usize;
    record.signal.window = match (settings.signal.window_start_s, settings.signal.window_end_s) {
        (Some(start), end) => sample(start)..end.map_or(samples, sample),
        _ => moving_window(&record),
    };
    record
}

impl Record {
    /// What the checks find.
    pub fn findings(&self) -> Vec<Finding> {
        self.with_subject(examine)
    }
}

/// The real record with the reference that is found in its motion.
pub fn tx40_with_reference(root: &Path, data: &Path) -> Record {
    let mut record = tx40(root, data);
    let found = trajectory::reconstruct(&record.position, &record.own_velocity(), record.rate_hz).unwrap();
    record.moves = Some(found.moves);
    // The real one is not known.
    record.controller = None;
    record.reconstructed_deviation = Some(found.rms_deviation);
    record
}

/// A twin with another seed, noise and trajectory: `number` picks them.
pub fn other_twin(number: u64) -> Record {
    let mut rng = ChaCha8Rng::seed_from_u64(1000 + number);
    twin(|t| {
        let noise = [0.3, 1.0, 1.5][number as usize % 3];
        t.sensors.seed = 100 + number;
        t.sensors.torque_noise.iter_mut().for_each(|n| *n *= noise);
        t.sensors.torque_ripple.iter_mut().for_each(|n| *n *= noise);
        t.acceleration_time_s = rng.random_range(0.15..0.3);
        let last = t.points.len() - 1;
        for point in &mut t.points[1..last] {
            let ranges = [150.0, 60.0, 100.0, 180.0, 110.0, 180.0];
            for (j, value) in point.iter_mut().enumerate() {
                let center = [0.0, -30.0, 30.0, -60.0, 10.0, -60.0][j];
                *value = (center + 0.8 * ranges[j] * rng.random_range(-1.0_f64..1.0)).round();
            }
        }
    })
}

/// A twin with little noise and without Coulomb friction, whose torque has no edges.
pub fn quiet_twin() -> Record {
    twin(|t| {
        t.sensors.torque_noise.iter_mut().for_each(|n| *n *= 0.02);
        t.sensors.torque_ripple.iter_mut().for_each(|n| *n = 0.0);
        t.parameters.iter_mut().filter(|(name, _)| name.starts_with("fc")).for_each(|(_, value)| *value = 0.0);
    })
}
