//! The linearly implicit method on closed loops: against closed forms, against the explicit method at tight tolerance, and
//! where friction is stiff against the inertia.

use std::path::Path;

use thetahat::{
    ControllerDescription, Robot, Series,
    dynamics::Model,
    simulation::{
        ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulationError, SimulatorBias, Solver,
    },
    trajectory::{MotionLimits, plan},
};

const RATE: f64 = 1000.0;
const EXPLICIT: Solver = Solver::Adaptive { relative_tolerance: 1e-9, absolute_tolerance: 1e-12 };

/// A slide of 2 kg without gravity along its axis.
const SLIDE: &str = "name = \"slide\"\n[[joint]]\nname = \"s\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[10.0]]\ndrive_gain = [4.0]\n[parameters]\nm1 = 2.0\n";
const COUPLED: &str = "name = \"wrist\"\ngravity = [0, 0, -9.81]\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
                       [[joint]]\nname = \"b\"\nkind = \"revolute\"\nalpha_deg = 90\n[transmission]\n\
                       matrix = [[45, 0], [32, 32]]\noffset_deg = [20, -10]\n[parameters]\n\
                       zz1 = 0.5\nzz2 = 0.2\nxx2 = 0.1\nyy2 = 0.1\nmx2 = 0.2\nfv1 = 0.4\nfc1 = 0.3\nfcm2 = 0.1\n";
/// A motor alone.
const WRIST: &str = "name = \"wrist\"\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n[transmission]\nmatrix = [[100.0]]\n\
                     [parameters]\nzz1 = 1e-3\nfc1 = 1.0\nfv1 = 0.1\n";

struct Bench {
    robot: Robot,
    model: Model,
    controller: ControllerDescription,
    reference: Reference,
    theta: Vec<f64>,
    scale: f64,
}

impl Bench {
    fn new(robot: &str, controller: &str, reference: Reference) -> Self {
        let robot = Robot::parse(robot, Path::new("robot.toml")).unwrap();
        let controller: ControllerDescription = toml::from_str(controller).unwrap();
        controller.validate(robot.coordinate_count()).unwrap();
        let theta = robot.a_priori_parameters();
        Self { model: Model::new(&robot), robot, controller, reference, theta, scale: 0.01 }
    }

    fn closed_loop(&self, solver: Solver) -> ClosedLoop<'_> {
        ClosedLoop {
            model: &self.model,
            transmission: &self.robot.transmission,
            controller: &self.controller,
            reference: &self.reference,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver,
            sign_velocity_scale: self.scale,
        }
    }

    fn run(&self, solver: Solver, samples: usize) -> Result<SimulatedMotion, SimulationError> {
        let closed_loop = self.closed_loop(solver);
        let inertia = closed_loop.motor_inertia(&self.theta, 1.0);
        closed_loop.simulate(&self.theta, &inertia, &OutputGrid { start_s: 0.0, sample_rate_hz: RATE, samples })
    }
}

fn implicit(tolerance: f64) -> Solver {
    Solver::Implicit { relative_tolerance: tolerance, absolute_tolerance: tolerance / 1e3 }
}

fn one_move(start: Vec<f64>, end: Vec<f64>) -> Reference {
    let limits = MotionLimits {
        max_velocity: vec![2.0; start.len()],
        acceleration_time_s: 0.1,
        smoothing_time_s: 0.03,
        dwell_s: 0.0,
    };
    Reference::Moves(plan(start, &[end], &limits, 0.05).unwrap())
}

fn largest(a: &Series, b: &Series) -> f64 {
    a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Mean time, in samples, of the rise of a step between two samples: the cubic with the central differences as slopes
/// rises within one sample and passes by 7 % in the next, `11/24 - 1/24`.
const RISE: f64 = 5.0 / 12.0;

/// `m ddq + f dq = g (kp (r - q) - kv dq)` from rest at a step; the friction is a hundred times stiffer than the loop.
#[test]
fn the_step_response_of_an_overdamped_slide_has_its_closed_form() {
    let robot = format!("{SLIDE}fv1 = 6000.0\n");
    let values = (0..2000).map(|k| if k == 0 { 0.0 } else { 0.01 }).collect();
    let reference = Reference::Sampled(SampledReference::new(Series::shaped(1, values), RATE));
    let bench = Bench::new(&robot, "law = \"pd\"\nposition_gain = [9000.0]\nvelocity_gain = [0.1]", reference);
    let motion = bench.run(implicit(1e-8), 1500).unwrap();
    let (stiffness, damping) = (40.0 * 9000.0 / 2.0, (6000.0 + 4.0) / 2.0);
    let root = f64::sqrt(0.25 * damping * damping - stiffness);
    let (slow, fast) = (0.5 * damping - root, 0.5 * damping + root);
    for k in [100, 500, 1400] {
        let t = k as f64 / RATE - RISE / RATE;
        let expected = 0.01 * (1.0 - (fast * f64::exp(-slow * t) - slow * f64::exp(-fast * t)) / (fast - slow));
        let found = motion.q.sample(k)[0];
        assert!((found - expected).abs() < 2e-8, "{t}: {found} against {expected}");
    }
}

/// Continuous, sampled with delay, and limited controllers, on moves and on a recorded reference: the error is a few times the tolerance.
#[test]
fn it_agrees_with_the_explicit_method() {
    let pd = "law = \"pd\"\nbandwidth_hz = [10]\nvelocity_feed_forward = 1.0";
    let moves = one_move(vec![0.3, -0.1], vec![0.9, 0.5]);
    let wave = (0..1000).flat_map(|k| [0.3 * (0.008 * f64::from(k)).sin(), 0.2 * (0.011 * f64::from(k)).sin()]);
    let recorded = Reference::Sampled(SampledReference::new(Series::shaped(2, wave.collect()), RATE));
    for (controller, reference) in [
        (pd.to_owned(), &moves),
        (pd.to_owned(), &recorded),
        (format!("{pd}\nsaturation = [0.1, 0.02]"), &moves),
        (format!("{pd}\nsample_time_s = 0.002\ndelay_s = 0.0015"), &moves),
        (format!("{pd}\nsample_time_s = 0.004\nvelocity = \"averaged-difference\"\nsaturation = [0.2]"), &recorded),
    ] {
        let bench = Bench::new(COUPLED, &controller, reference.clone());
        let exact = bench.run(EXPLICIT, 700).unwrap();
        for tolerance in [1e-4, 1e-6] {
            let found = bench.run(implicit(tolerance), 700).unwrap();
            let (q, dq) = (largest(&found.q, &exact.q), largest(&found.dq, &exact.dq));
            assert!(q < 3.0 * tolerance && dq < 30.0 * tolerance, "{controller}\n{tolerance:e}: {q:e} {dq:e}");
        }
    }
}

/// A wrist of 1e-3 kg m^2 with 1 N m of friction over 0.01 rad/s: time constants of 1e-5 s.
#[test]
fn stiff_friction_costs_few_steps() {
    let bench = Bench::new(WRIST, "law = \"pd\"\nbandwidth_hz = [10]", one_move(vec![0.0], vec![0.8]));
    let exact = bench.run(EXPLICIT, 1500).unwrap();
    let default = bench.run(Solver::ODE45, 1500).unwrap();
    let found = bench.run(implicit(1e-4), 1500).unwrap();
    assert!(largest(&found.q, &exact.q) < 1e-5);
    assert!(largest(&found.ddq, &exact.ddq) < 0.05 * largest(&exact.ddq, &Series::zeros(1500, 1)));
    assert!(10 * found.counts.evaluations < default.counts.evaluations, "{:?} {:?}", found.counts, default.counts);
}

/// `D_jj (M^-1)_jj`, and the choice by what it costs: the solver left to choose has the bits of the one that it chooses.
#[test]
fn the_method_follows_from_stiffness_and_duration() {
    let pd = "law = \"pd\"\nbandwidth_hz = [10]";
    let mut bench = Bench::new(WRIST, pd, one_move(vec![0.0], vec![0.8]));
    let stiffness =
        |bench: &Bench| bench.closed_loop(Solver::default()).stiffness(&bench.robot.a_priori_parameters(), 1.0);
    let expected = (1.0 / 0.01 + 0.1) / 1e-3;
    assert!((stiffness(&bench) / expected - 1.0).abs() < 1e-12);
    assert!(bench.run(Solver::default(), 500) == bench.run(Solver::ODE45, 500));
    bench.scale = 1e-5;
    let tighter = Solver::Implicit { relative_tolerance: 1e-3 / 10.0, absolute_tolerance: 1e-6 / 10.0 };
    assert!(bench.run(Solver::default(), 500) == bench.run(tighter, 500));
}

#[test]
fn a_mass_matrix_that_is_not_positive_definite_is_named() {
    let mut bench =
        Bench::new(WRIST, "law = \"pd\"\nposition_gain = [1.0]\nvelocity_gain = [0.1]", one_move(vec![0.0], vec![0.8]));
    let inertia = bench.model.parameter_table().iter().position(|p| p.quantity.is_motor_inertia()).unwrap();
    bench.theta[inertia] = -1e-3;
    for solver in [implicit(1e-4), Solver::default()] {
        assert!(matches!(bench.run(solver, 500), Err(SimulationError::Dynamics { .. })));
    }
}
