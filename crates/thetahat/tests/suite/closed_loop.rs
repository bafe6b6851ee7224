//! The closed loop against closed forms and against itself at tight tolerance: no data needed.

use std::path::Path;

use thetahat::{
    ControllerDescription, Robot, Series,
    dynamics::Model,
    simulation::{
        BiasKind, ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulationError, SimulatorBias,
        Solver,
    },
    trajectory::{MotionLimits, Moves, plan},
};
use thetahat_estimation::simulation::{Job, simulate_all};

const TIGHT: Solver = Solver::Adaptive { relative_tolerance: 1e-10, absolute_tolerance: 1e-12 };
const RATE: f64 = 1000.0;

/// A slide of 2 kg with viscous friction of 3 N s/m, without gravity along its axis.
const SLIDE: &str = "name = \"slide\"\n[[joint]]\nname = \"s\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[10.0]]\ndrive_gain = [4.0]\n[parameters]\nm1 = 2.0\nfv1 = 3.0\n";

const COUPLED: &str = "name = \"wrist\"\ngravity = [0, 0, 0]\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
                       [[joint]]\nname = \"b\"\nkind = \"revolute\"\nalpha_deg = 90\n[transmission]\n\
                       matrix = [[45, 0], [32, 32]]\noffset_deg = [20, -10]\n[parameters]\n\
                       zz1 = 0.5\nzz2 = 0.2\nxx2 = 0.1\nyy2 = 0.1\nfv1 = 0.4\nfc2 = 0.3\n";

struct Bench {
    robot: Robot,
    model: Model,
    controller: ControllerDescription,
    reference: Reference,
    bias: SimulatorBias,
    solver: Solver,
}

impl Bench {
    fn new(robot: &str, controller: &str, reference: Reference) -> Self {
        let robot = Robot::parse(robot, Path::new("robot.toml")).unwrap();
        let controller: ControllerDescription = toml::from_str(controller).unwrap();
        controller.validate(robot.coordinate_count()).unwrap();
        let model = Model::new(&robot);
        Self { robot, model, controller, reference, bias: SimulatorBias::NONE, solver: TIGHT }
    }

    fn closed_loop(&self) -> ClosedLoop<'_> {
        ClosedLoop {
            model: &self.model,
            transmission: &self.robot.transmission,
            controller: &self.controller,
            reference: &self.reference,
            added_signal: None,
            channels: None,
            bias: self.bias,
            solver: self.solver,
            sign_velocity_scale: 0.01,
        }
    }

    fn try_run(&self, samples: usize) -> Result<SimulatedMotion, SimulationError> {
        let closed_loop = self.closed_loop();
        let theta = self.robot.a_priori_parameters();
        let inertia = closed_loop.motor_inertia(&theta, 1.0);
        closed_loop.simulate(&theta, &inertia, &OutputGrid { start_s: 0.0, sample_rate_hz: RATE, samples })
    }

    fn run(&self, samples: usize) -> SimulatedMotion {
        self.try_run(samples).unwrap()
    }
}

fn one_move(start: Vec<f64>, end: Vec<f64>) -> Moves {
    let limits = MotionLimits {
        max_velocity: vec![2.0; start.len()],
        acceleration_time_s: 0.1,
        smoothing_time_s: 0.03,
        dwell_s: 0.0,
    };
    plan(start, &[end], &limits, 0.05).unwrap()
}

/// A step of the reference before the first output: held by a recorded reference that jumps at its second sample.
fn step(height: f64, samples: usize) -> Reference {
    let values = (0..samples).map(|k| if k == 0 { 0.0 } else { height }).collect();
    Reference::Sampled(SampledReference::new(Series::shaped(1, values), RATE))
}

/// Mean time, in samples, of the rise of a step between two samples: the cubic with the central differences as slopes
/// rises within one sample and passes by 7 % in the next, `11/24 - 1/24`.
const RISE: f64 = 5.0 / 12.0;

/// `m ddq + f dq = g (kp (r - q) - kv dq)`, underdamped, from rest at a step: the textbook's oscillation.
#[test]
fn the_step_response_of_a_slide_has_its_closed_form() {
    let bench = Bench::new(SLIDE, "law = \"pd\"\nposition_gain = [5.0]\nvelocity_gain = [0.1]", step(0.01, 2000));
    let motion = bench.run(1500);
    let (m, gain) = (2.0f64, 40.0f64);
    let (stiffness, damping) = (gain * 5.0 / m, (3.0 + gain * 0.1) / m);
    let (decay, frequency) = (0.5 * damping, (stiffness - 0.25 * damping * damping).sqrt());
    for k in [100, 500, 1400] {
        let t = k as f64 / RATE - RISE / RATE;
        let wave = (frequency * t).cos() + decay / frequency * (frequency * t).sin();
        let expected = 0.01 * (1.0 - (-decay * t).exp() * wave);
        let found = motion.q.sample(k)[0];
        assert!((found - expected).abs() < 2e-8, "{t}: {found} against {expected}");
    }
}

/// Recorded torque is what moves the slide: M ddq + Fv dq, at every output.
#[test]
fn torques_and_accelerations_are_consistent() {
    let bench = Bench::new(
        SLIDE,
        "law = \"cascaded\"\nposition_gain = [30.0]\nvelocity_gain = [2.0]\nsaturation = [0.05]\nsample_time_s = 0.004\n\
         velocity = \"averaged-difference\"",
        Reference::Moves(one_move(vec![0.0], vec![0.3])),
    );
    let motion = bench.run(800);
    let mut saturated = 0;
    for k in 0..800 {
        let torque = motion.tau.sample(k)[0];
        let expected = 2.0 * motion.ddq.sample(k)[0] + 3.0 * motion.dq.sample(k)[0];
        assert!((torque - expected).abs() < 1e-9);
        saturated += usize::from(torque.abs() > 40.0 * 0.05 - 1e-12);
        // Held over the four outputs of a sample.
        assert!(k % 4 == 0 || torque == motion.tau.sample(k - 1)[0], "held at {k}");
    }
    assert!(saturated > 10, "the limit was meant to act: {saturated}");
}

#[test]
fn a_delay_shifts_the_first_action() {
    let text = "law = \"pd\"\nposition_gain = [5.0]\nvelocity_gain = [0.1]\nsample_time_s = 0.002\ndelay_s = 0.003";
    let bench = Bench::new(SLIDE, text, step(0.01, 1000));
    let motion = bench.run(20);
    // The step is seen at the sample of 2 ms and acts 3 ms later.
    let first = (0..20).find(|&k| motion.tau.sample(k)[0] != 0.0);
    assert_eq!(first, Some(5));
}

/// q_s = n_s^-1 n (q_ref - offset) + offset where the motors track well: 1/0.9 as far about the motor's zero.
#[test]
fn smaller_gear_ratios_move_the_joints_further() {
    let start = vec![20f64.to_radians(), -10f64.to_radians()];
    let end = vec![start[0] + 0.3, start[1] - 0.2];
    let controller =
        "law = \"pd\"\nbandwidth_hz = [60.0]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0";
    let mut bench = Bench::new(COUPLED, controller, Reference::Moves(one_move(start.clone(), end)));
    let nominal = bench.run(700);
    bench.bias = SimulatorBias { gear_ratio: 0.9, ..SimulatorBias::NONE };
    let biased = bench.run(700);
    for (j, start) in start.iter().enumerate() {
        let moved = |motion: &SimulatedMotion| motion.q.sample(699)[j] - start;
        assert!((moved(&biased) * 0.9 / moved(&nominal) - 1.0).abs() < 2e-3, "joint {j}");
    }
}

/// The motors start where the true gears put them for the reference: wrong gears put the joints elsewhere, about the motors'
/// zero.
#[test]
fn smaller_gear_ratios_start_the_joints_further_from_the_motors_zero() {
    let start = vec![45f64.to_radians(), -30f64.to_radians()];
    let end = vec![start[0] + 0.3, start[1] - 0.2];
    let mut bench = Bench::new(COUPLED, "law = \"pd\"\nbandwidth_hz = [60.0]", Reference::Moves(one_move(start, end)));
    let nominal = bench.run(1);
    bench.bias = SimulatorBias { gear_ratio: 0.9, ..SimulatorBias::NONE };
    let biased = bench.run(1);
    let offset = bench.robot.transmission.offset().to_vec();
    for (j, offset) in offset.iter().enumerate() {
        let from_zero = |motion: &SimulatedMotion| motion.q.sample(0)[j] - offset;
        assert!(from_zero(&nominal).abs() > 0.05, "joint {j}");
        assert!((from_zero(&biased) * 0.9 / from_zero(&nominal) - 1.0).abs() < 1e-12, "joint {j}");
    }
}

/// q_0 + scale (q_ref - q_0) + offset, that much later: where the motors track well.
#[test]
fn a_biased_reference_is_scaled_moved_and_late() {
    let controller =
        "law = \"pd\"\nbandwidth_hz = [60.0]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0";
    let mut bench = Bench::new(SLIDE, controller, Reference::Moves(one_move(vec![0.2], vec![0.5])));
    let nominal = bench.run(700);
    bench.bias = SimulatorBias { reference_scale: 1.1, reference_offset: 0.01, delay_s: 0.02, ..SimulatorBias::NONE };
    let biased = bench.run(700);
    for k in [60, 150, 300, 680] {
        let expected = 0.2 + 1.1 * (nominal.q.sample(k - 20)[0] - 0.2) + 0.01;
        let found = biased.q.sample(k)[0];
        assert!((found - expected).abs() < 1e-4, "{k}: {found} against {expected}");
    }
}

/// Two axes at right angles: the first sees `zz1 + xx2 sin^2 q2 + yy2 cos^2 q2`.
#[test]
fn the_inertia_of_a_motor_is_averaged_along_the_reference() {
    let robot = "name = \"elbow\"\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n[[joint]]\nname = \"b\"\n\
                 kind = \"revolute\"\nalpha_deg = 90\n[transmission]\nmatrix = [[1, 0], [0, 1]]\n\
                 [parameters]\nzz1 = 0.2\nxx2 = 0.9\nyy2 = 0.1\nzz2 = 0.3\n";
    let turn = |k: usize| 1.2 * k as f64 / RATE;
    let values = (0..=1000).flat_map(|k| [0.0, turn(k)]).collect();
    let reference = Reference::Sampled(SampledReference::new(Series::shaped(2, values), RATE));
    let bench = Bench::new(robot, "law = \"pd\"\nbandwidth_hz = [10.0]", reference);
    let inertia = bench.closed_loop().motor_inertia(&bench.robot.a_priori_parameters(), 1.0);
    // The mean of sin^2 over an angle that grows evenly from 0 to 1.2 rad.
    let mean_square_sine = 0.5 - (2.4_f64).sin() / 4.8;
    let expected = 0.2 + 0.9 * mean_square_sine + 0.1 * (1.0 - mean_square_sine);
    assert!((inertia[0] / expected - 1.0).abs() < 0.01, "{} against {expected}", inertia[0]);
    assert!((inertia[1] - 0.3).abs() < 1e-12);
}

/// A factor of one and an addition of zero change nothing.
#[test]
fn what_multiplies_is_a_factor_and_what_is_added_is_not() {
    use BiasKind::{ControllerGain, Delay, DriveGain, Friction, GearRatio, ReferenceOffset, ReferenceScale};
    for kind in [GearRatio, DriveGain, ControllerGain, Delay, ReferenceScale, ReferenceOffset, Friction] {
        let neutral = if kind.is_factor() { 1.0 } else { 0.0 };
        assert_eq!(SimulatorBias::NONE.with(kind, neutral), SimulatorBias::NONE, "{kind:?}");
        assert_ne!(SimulatorBias::NONE.with(kind, 1.0 - neutral), SimulatorBias::NONE, "{kind:?}");
    }
}

/// The torque of a slide at constant speed is its friction.
#[test]
fn biased_friction_is_a_factor() {
    let controller = "law = \"pd\"\nbandwidth_hz = [60.0]\nvelocity_feed_forward = 1.0";
    let mut bench = Bench::new(SLIDE, controller, Reference::Moves(one_move(vec![0.0], vec![1.0])));
    bench.bias = SimulatorBias { friction: 1.5, ..SimulatorBias::NONE };
    let motion = bench.run(600);
    let expected = 2.0 * motion.ddq.sample(400)[0] + 1.5 * 3.0 * motion.dq.sample(400)[0];
    assert!(motion.dq.sample(400)[0] > 0.5);
    assert!((motion.tau.sample(400)[0] - expected).abs() < 1e-9);
}

#[test]
fn the_default_solver_is_close_to_the_reference_solution() {
    let start = vec![0.3, -0.1];
    let controller = "law = \"pd\"\nbandwidth_hz = [40.0]\nvelocity_feed_forward = 1.0";
    let mut bench = Bench::new(COUPLED, controller, Reference::Moves(one_move(start, vec![0.9, 0.5])));
    let reference = bench.run(700);
    bench.solver = Solver::ODE45;
    let default = bench.run(700);
    let largest =
        |a: &Series, b: &Series| a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest(&default.q, &reference.q) < 1e-5);
    assert!(default.counts.evaluations < reference.counts.evaluations / 3);
}

#[test]
fn a_loop_that_runs_away_is_named_with_joint_and_time() {
    let text = "law = \"pd\"\nposition_gain = [500.0]\nvelocity_gain = [8.0]\nsample_time_s = 0.05";
    let bench = Bench::new(SLIDE, text, step(0.01, 20_000));
    match bench.try_run(20_000) {
        Err(SimulationError::Diverged { joint: 1, time_s, .. }) => assert!(time_s > 0.05),
        other => panic!("{:?}", other.map(|m| m.counts)),
    }
}

/// More simulations than lanes, of different lengths, parameters and biases, some of which fail, with a continuous and with
/// a sampled controller.
#[test]
fn simulations_side_by_side_have_the_bits_that_they_have_alone() {
    let continuous = "law = \"pd\"\nbandwidth_hz = [4]\ndamping = 0.7";
    let sampled = format!("{continuous}\nsample_time_s = 0.002\ndelay_s = 0.001");
    let implicit = Solver::Implicit { relative_tolerance: 1e-4, absolute_tolerance: 1e-7 };
    let [one, other] = [continuous, &sampled];
    for (controller, solver) in
        [(one, Solver::ODE45), (other, Solver::ODE45), (one, implicit), (other, implicit), (one, Solver::default())]
    {
        let reference = Reference::Moves(one_move(vec![0.3, -0.2], vec![1.0, 0.4]));
        let bench = Bench { solver, ..Bench::new(COUPLED, controller, reference) };
        let theta = bench.robot.a_priori_parameters();
        let inertia = bench.closed_loop().motor_inertia(&theta, 1.0);
        // The third has no mass matrix, the sixth runs away.
        let scaled: Vec<Vec<f64>> =
            [1.0, 1.1, -1.0, 0.7, 1.3, 1.0, 0.9].map(|s| theta.iter().map(|t| s * t).collect()).to_vec();
        let biases = (0..7).map(|k| SimulatorBias {
            gear_ratio: 1.0 - 0.01 * f64::from(k),
            controller_gain: if k == 5 { -1.0 } else { 1.0 },
            ..SimulatorBias::NONE
        });
        let jobs: Vec<Job<'_>> = biases
            .zip(&scaled)
            .enumerate()
            .map(|(k, (bias, theta))| Job {
                closed_loop: ClosedLoop { bias, ..bench.closed_loop() },
                theta,
                motor_inertia: &inertia,
                grid: OutputGrid { start_s: 0.0, sample_rate_hz: RATE, samples: 900 - 100 * k },
            })
            .collect();
        let together = simulate_all(&jobs);
        assert_eq!(together.len(), jobs.len());
        for (k, (job, result)) in jobs.iter().zip(&together).enumerate() {
            let alone = job.closed_loop.simulate(job.theta, job.motor_inertia, &job.grid);
            assert_eq!(result, &alone, "simulation {k}");
            assert_eq!(result.is_err(), k == 2 || k == 5, "simulation {k}: {:?}", result.as_ref().err());
        }
    }
}
