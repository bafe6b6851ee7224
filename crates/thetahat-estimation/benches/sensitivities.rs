//! Simulations of the TX40 with and without their sensitivities to its 60 base parameters: `cargo bench -p
//! thetahat-estimation --bench sensitivities`. No data needed.

mod tx40;

use divan::Bencher;
use thetahat_estimation::{
    control::ControllerDescription,
    simulation::{
        ClosedLoop, Job, OutputGrid, Reference, SensitiveTo, Sensitivities, SimulatorBias, Solver, simulate_all,
    },
    trajectory::{MotionLimits, plan},
};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::Model,
    robot::{Robot, Role},
};

const EXPLICIT: Solver = Solver::ODE45;
const IMPLICIT: Solver = Solver::Implicit { relative_tolerance: 1e-4, absolute_tolerance: 1e-7 };
/// Five seconds.
const GRID: OutputGrid = OutputGrid { start_s: 0.0, sample_rate_hz: 1000.0, samples: 5000 };

fn main() {
    divan::main();
}

struct Bench {
    robot: Robot,
    model: Model,
    controller: ControllerDescription,
    reference: Reference,
    theta: Vec<f64>,
}

impl Bench {
    /// A PD loop of 40 Hz on every motor, and a move there and back, twice.
    fn new() -> Self {
        let robot = tx40::robot().expect("robots/tx40.toml");
        let model = Model::new(&robot);
        let mut theta = robot.a_priori_parameters();
        for (value, parameter) in theta.iter_mut().zip(model.parameter_table().iter()) {
            let added = if parameter.quantity.role() == Role::MotorInertia { 0.3 } else { 0.0 };
            *value += if parameter.quantity.is_friction() { 1.0 } else { added };
        }
        let [rest, there] = [[0.0, -1.4, 1.5, 0.1, 0.2, 0.0], [0.8, -0.6, 0.9, 1.3, 0.9, 1.3]].map(Vec::from);
        let limits = MotionLimits {
            max_velocity: vec![1.0; 6],
            acceleration_time_s: 0.1,
            smoothing_time_s: 0.03,
            dwell_s: 0.02,
        };
        let points = [there.clone(), rest.clone(), there, rest.clone()];
        let reference = Reference::Moves(plan(rest, &points, &limits, 0.05).expect("a trajectory"));
        Self { model, robot, controller: ControllerDescription::pd(40.0), reference, theta }
    }

    fn run<T>(&self, solver: Solver, use_job: impl FnOnce(&Job<'_>) -> T) -> T {
        let closed_loop = ClosedLoop {
            model: &self.model,
            transmission: &self.robot.transmission,
            controller: &self.controller,
            reference: &self.reference,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver,
            sign_velocity_scale: 0.002,
        };
        let motor_inertia = closed_loop.motor_inertia(&self.theta, 5.0);
        use_job(&Job { closed_loop, theta: &self.theta, motor_inertia: &motor_inertia, grid: GRID })
    }

    fn base_parameters(&self) -> Vec<SensitiveTo> {
        let base = BaseParameters::of(&self.model, &["iam6".to_owned()]).expect("base parameters");
        base.columns().into_iter().map(SensitiveTo::Parameter).collect()
    }
}

#[divan::bench(args = [EXPLICIT, IMPLICIT])]
fn plain(bencher: Bencher, solver: Solver) {
    let bench = Bench::new();
    bencher.bench_local(|| bench.run(solver, |job| simulate_all(&[*job])));
}

#[divan::bench(args = [EXPLICIT, IMPLICIT])]
fn four_side_by_side(bencher: Bencher, solver: Solver) {
    let bench = Bench::new();
    bencher.bench_local(|| bench.run(solver, |job| simulate_all(&[*job; 4])));
}

#[divan::bench(args = [EXPLICIT, IMPLICIT])]
fn with_60_sensitivities(bencher: Bencher, solver: Solver) {
    let bench = Bench::new();
    let to = bench.base_parameters();
    bencher.bench_local(|| {
        bench.run(solver, |job| {
            let mut simulation = Sensitivities::new(job, &to, None).expect("a simulation");
            let mut samples = 0;
            while simulation.next_sample().expect("a sample").is_some() {
                samples += 1;
            }
            samples
        })
    });
}
