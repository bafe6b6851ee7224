//! The exact sensitivities of the closed loop, against central differences of simulations with the same steps.

use std::path::Path;

use thetahat::{
    ControllerDescription, Matrix, Robot, Series,
    base_parameters::BaseParameters,
    dynamics::Model,
    robot::Transmission,
    simulation::{
        ClosedLoop, OutputGrid, Reference, SampledReference, SensitiveTo, Sensitivities, SimulatedMotion,
        SimulatorBias, Solver,
    },
    trajectory::{MotionLimits, plan},
};
use thetahat_estimation::simulation::{Job, Motors, simulate_all};

/// Relative, in the norm of a column: what central differences leave.
const EXACT: f64 = 1e-6;

/// Positioning system of one prismatic joint, as EMPS.
const SLIDE: &str = "name = \"slide\"\n[[joint]]\nname = \"s\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[10.0]]\ndrive_gain = [3.5]\n[parameters]\n\
                     m1 = 95.0\nfv1 = 203.0\nfc1 = 20.0\noff1 = -3.2\n";
const CASCADE: &str = "law = \"cascaded\"\nposition_gain = [160.0]\nvelocity_gain = [240.0]\nsaturation = [10.0]\n\
                       sample_time_s = 0.001\nvelocity = \"averaged-difference\"";
const COUPLED: &str = "name = \"wrist\"\ngravity = [0, 0, -9.81]\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
                       [[joint]]\nname = \"b\"\nkind = \"revolute\"\nalpha_deg = 90\n[transmission]\n\
                       matrix = [[45, 0], [32, 32]]\noffset_deg = [20, -10]\ndrive_gain = [0.1, 0.2]\n[parameters]\n\
                       zz1 = 0.5\nzz2 = 0.2\nxx2 = 0.1\nyy2 = 0.1\nmx2 = 0.2\nfv1 = 0.4\nfc1 = 0.3\nfcm2 = 0.1\nia2 = 0.1\n";

/// A loop whose every part may be moved.
#[derive(Clone)]
struct Bench {
    model: Model,
    transmission: Transmission,
    controller: ControllerDescription,
    reference: Reference,
    /// What acts in an open loop.
    drive_signals: Option<Series>,
    bias: SimulatorBias,
    theta: Vec<f64>,
    /// Inertia for the gains; none where they follow from theta.
    inertia: Option<Vec<f64>>,
    solver: Solver,
    scale: f64,
    grid: OutputGrid,
    /// Step of the central differences: of logarithms, and of parameters relative to their size.
    by: f64,
}

impl Bench {
    fn new(robot: &Robot, controller: &str, reference: Reference, samples: usize) -> Self {
        let controller: ControllerDescription = toml::from_str(controller).unwrap();
        controller.validate(robot.coordinate_count()).unwrap();
        let mut bench = Self {
            model: Model::new(robot),
            transmission: robot.transmission.clone(),
            controller,
            reference,
            drive_signals: None,
            bias: SimulatorBias::NONE,
            theta: robot.a_priori_parameters(),
            inertia: None,
            solver: Solver::Fixed { step_s: 5e-4 },
            scale: 0.01,
            grid: OutputGrid { start_s: 0.0, sample_rate_hz: 1000.0, samples },
            by: 3e-4,
        };
        bench.inertia = Some(bench.motor_inertia());
        bench
    }

    fn closed_loop(&self) -> ClosedLoop<'_> {
        ClosedLoop {
            model: &self.model,
            transmission: &self.transmission,
            controller: &self.controller,
            reference: &self.reference,
            added_signal: self.drive_signals.as_ref().map(|signals| (signals, 1000.0)),
            channels: None,
            bias: self.bias,
            solver: self.solver,
            sign_velocity_scale: self.scale,
        }
    }

    fn motor_inertia(&self) -> Vec<f64> {
        self.closed_loop().motor_inertia(&self.theta, 1.0)
    }

    fn with_job<T>(&self, use_job: impl FnOnce(&Job<'_>) -> T) -> T {
        let inertia = self.inertia.clone().unwrap_or_else(|| self.motor_inertia());
        use_job(&Job { closed_loop: self.closed_loop(), theta: &self.theta, motor_inertia: &inertia, grid: self.grid })
    }

    fn simulate(&self) -> SimulatedMotion {
        self.with_job(|job| simulate_all(&[*job]).remove(0).unwrap())
    }

    /// The derivatives of positions and torques by each of `to`, and the motion.
    fn sensitivities(&self, to: &[SensitiveTo]) -> (Vec<[Vec<f64>; 2]>, SimulatedMotion) {
        let slopes = self.inertia.is_none().then(|| self.closed_loop().motor_inertia_slopes(to, 1.0));
        self.with_job(|job| {
            let mut simulation = Sensitivities::new(job, to, slopes.as_deref()).unwrap();
            let mut columns = vec![[Vec::new(), Vec::new()]; to.len()];
            let mut samples = 0;
            while let Some(sample) = simulation.next_sample().unwrap() {
                for (p, [q, tau]) in columns.iter_mut().enumerate() {
                    q.extend(sample.q_slopes.iter().skip(p).step_by(to.len()));
                    tau.extend(sample.tau_slopes.iter().skip(p).step_by(to.len()));
                }
                samples += 1;
            }
            assert_eq!(samples, self.grid.samples);
            (columns, simulation.into_motion().unwrap())
        })
    }

    /// The same loop with what it is sensitive to moved: logarithms by `by`.
    fn moved(&self, to: SensitiveTo, by: f64) -> Self {
        let mut bench = self.clone();
        let motors = self.theta.len().min(self.model.coordinate_count());
        let scaled = |list: &[f64], moved: Motors| -> Vec<f64> {
            let one = |i: usize| list.get(i).unwrap_or(&list[0]) * if moved.contains(i) { by.exp() } else { 1.0 };
            (0..motors).map(one).collect()
        };
        match to {
            SensitiveTo::Parameter(index) => bench.theta[index] += by,
            SensitiveTo::PositionGain(m) => bench.controller.position_gain = scaled(&self.controller.position_gain, m),
            SensitiveTo::VelocityGain(m) => bench.controller.velocity_gain = scaled(&self.controller.velocity_gain, m),
            SensitiveTo::DriveGain(m) => {
                let matrix: Matrix = self.transmission.matrix().clone();
                let own = self.transmission.drive_to_joint_units();
                let gain: Vec<f64> = (0..motors).map(|i| own[i] / matrix.at(i, i)).collect();
                let offset = self.transmission.offset().to_vec();
                bench.transmission = Transmission::new(matrix, offset, scaled(&gain, m)).unwrap();
            }
            SensitiveTo::GearRatio => bench.bias.gear_ratio *= by.exp(),
            SensitiveTo::Delay => bench.bias.delay_s += by,
            SensitiveTo::FrictionTransition => bench.scale *= by.exp(),
        }
        bench
    }

    /// Of fourth order: `(8 (f(h) - f(-h)) - (f(2 h) - f(-2 h))) / (12 h)`.
    fn central_differences(&self, to: SensitiveTo, by: f64) -> [Vec<f64>; 2] {
        let motions = [by, -by, 2.0 * by, -2.0 * by].map(|by| self.moved(to, by).simulate());
        let difference = |values: [&[f64]; 4]| {
            let at = |k: usize| values.map(|of_motion| of_motion[k]);
            let each = (0..values[0].len()).map(at);
            each.map(|[a, b, c, d]| (8.0 * (a - b) - (c - d)) / (12.0 * by)).collect::<Vec<f64>>()
        };
        [difference(motions.each_ref().map(|m| m.q.values())), difference(motions.each_ref().map(|m| m.tau.values()))]
    }

    fn check(&self, to: &[SensitiveTo], tolerance: f64) {
        let (columns, motion) = self.sensitivities(to);
        assert!(motion == self.simulate(), "the motion is that of the plain simulation");
        for (to, found) in to.iter().zip(&columns) {
            let by = match to {
                SensitiveTo::Parameter(index) => self.by * self.theta[*index].abs().max(0.1),
                SensitiveTo::Delay => 1e-6,
                SensitiveTo::PositionGain(_)
                | SensitiveTo::VelocityGain(_)
                | SensitiveTo::DriveGain(_)
                | SensitiveTo::GearRatio
                | SensitiveTo::FrictionTransition => self.by,
            };
            let differences = self.central_differences(*to, by);
            for (what, (found, expected)) in ["q", "tau"].iter().zip(found.iter().zip(&differences)) {
                if norm(found).max(norm(expected)) == 0.0 {
                    continue;
                }
                let error = distance(found, expected) / norm(expected);
                println!("{what} by {to:?}: {error:.1e} of {:.3e}", norm(expected));
                assert!(error < tolerance, "{what} by {to:?}: {error:e}, norm {:e}", norm(expected));
            }
        }
    }
}

fn norm(a: &[f64]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

fn robot(text: &str) -> Robot {
    Robot::parse(text, Path::new("robot.toml")).unwrap()
}

fn tx40() -> Robot {
    Robot::read(&thetahat_testing::root().join("robots/tx40.toml")).unwrap()
}

fn moves(start: Vec<f64>, ends: &[Vec<f64>], velocity: f64) -> Reference {
    let limits = MotionLimits {
        max_velocity: vec![velocity; start.len()],
        acceleration_time_s: 0.1,
        smoothing_time_s: 0.03,
        dwell_s: 0.02,
    };
    Reference::Moves(plan(start, ends, &limits, 0.05).unwrap())
}

fn parameters(bench: &Bench, names: &[&str]) -> Vec<SensitiveTo> {
    let table = bench.model.parameter_table();
    names.iter().map(|name| SensitiveTo::Parameter(table.index_of(name).unwrap())).collect()
}

const GAINS: [SensitiveTo; 4] = [
    SensitiveTo::PositionGain(Motors::All),
    SensitiveTo::VelocityGain(Motors::All),
    SensitiveTo::DriveGain(Motors::All),
    SensitiveTo::GearRatio,
];

fn slide(controller: &str) -> Bench {
    let bench = Bench::new(&robot(SLIDE), controller, moves(vec![0.02], &[vec![0.08], vec![0.04]], 0.3), 500);
    // Small enough that no sample comes to its limit or leaves it.
    Bench { by: 1e-5, ..bench }
}

/// Sampled cascade with the averaged difference of positions; the limit acts on part of the motion.
#[test]
fn a_sampled_cascade_on_a_slide() {
    let mut bench = slide(CASCADE);
    bench.bias.gear_ratio = 0.97;
    let limited = bench.simulate().tau.values().iter().filter(|tau| tau.abs() > 0.97 * 349.9).count();
    assert!(limited > 20, "the limit was meant to act: {limited}");
    let mut to = parameters(&bench, &["m1", "fv1", "fc1", "off1"]);
    to.extend(GAINS);
    bench.check(&to, EXACT);
}

/// Recorded signals act alone, held from sample to sample or linear between samples, on coupled motors that start in motion.
#[test]
fn an_open_loop() {
    for sampled in ["", "\nsample_time_s = 0.001"] {
        let moving = SampledReference::new(Series::shaped(2, vec![0.3, -0.1, 0.3005, -0.1004]), 1000.0);
        let mut bench =
            Bench::new(&robot(COUPLED), &format!("law = \"open-loop\"{sampled}"), Reference::Sampled(moving), 300);
        let wave = |k: usize| [8.0 * (0.02 * k as f64).sin(), 3.0 * (0.03 * k as f64).cos()];
        bench.drive_signals = Some(Series::shaped(2, (0..300).flat_map(wave).collect()));
        bench.bias.gear_ratio = 0.97;
        let motion = bench.simulate();
        let start = motion.dq.sample(0);
        assert!((start[0] - 0.5 / 0.97).abs() < 1e-9 && (start[1] + 0.4 / 0.97).abs() < 1e-9, "{start:?}");
        let mut to = parameters(&bench, &["zz1", "zz2", "mx2", "fv1", "fc1", "fcm2", "ia2"]);
        to.extend([SensitiveTo::DriveGain(Motors::All), SensitiveTo::GearRatio]);
        bench.check(&to, EXACT);
    }
}

/// The signals act one and a half samples later, in part between two samples.
#[test]
fn a_sampled_controller_with_a_delay() {
    let mut bench = slide(&format!("{}\ndelay_s = 0.0015", CASCADE.replace("[10.0]", "[100.0]")));
    bench.by = 3e-4;
    let mut to = parameters(&bench, &["m1", "fv1", "fc1", "off1"]);
    to.push(SensitiveTo::FrictionTransition);
    to.extend(GAINS);
    bench.check(&to, EXACT);
}

fn wrist(controller: &str) -> Bench {
    let start = vec![0.3, -0.1];
    let mut bench = Bench::new(&robot(COUPLED), controller, moves(start, &[vec![0.5, 0.2], vec![0.1, 0.1]], 1.0), 400);
    bench.bias = SimulatorBias {
        gear_ratio: 0.95,
        drive_gain: 1.03,
        controller_gain: 0.9,
        friction: 1.2,
        ..SimulatorBias::NONE
    };
    bench
}

/// Gains of single motors, in both laws, continuous and sampled with the velocity known.
#[test]
fn the_gains_of_one_motor() {
    for law in ["pd", "cascaded"] {
        for sampled in ["", "sample_time_s = 0.002\ndelay_s = 0.001\n"] {
            let bench = wrist(&format!(
                "law = \"{law}\"\nposition_gain = [60.0, 40.0]\nvelocity_gain = [5.0, 3.0]\nvelocity_feed_forward = 0.9\n\
                 acceleration_feed_forward = 0.8\nsaturation = [2.5, 1.8]\n{sampled}"
            ));
            let mut to = parameters(&bench, &["zz1", "xx2", "mx2", "fv1", "fc1", "fcm2", "iam2"]);
            to.push(SensitiveTo::FrictionTransition);
            to.extend(GAINS);
            to.extend([0, 1].map(|motor| SensitiveTo::PositionGain(Motors::One(motor))));
            to.extend([0, 1].map(|motor| SensitiveTo::VelocityGain(Motors::One(motor))));
            to.extend([0, 1].map(|motor| SensitiveTo::DriveGain(Motors::One(motor))));
            bench.check(&to, EXACT);
        }
    }
}

/// All base parameters of six joints with a coupled motor; gains by bandwidth, kept and updated; the gear ratio of the
/// paper's biased simulator.
#[test]
fn every_parameter_of_a_robot_of_six_joints() {
    let robot = tx40();
    let start = vec![0.0, -1.4, 1.5, 0.1, 0.2, 0.0];
    let ends = [vec![0.2, -1.2, 1.2, 0.3, 0.4, 0.3], vec![0.0, -1.3, 1.4, 0.0, 0.1, -0.1]];
    let controller = "law = \"pd\"\nbandwidth_hz = [10]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 0.9";
    let mut bench = Bench::new(&robot, controller, moves(start, &ends, 1.0), 250);
    bench.bias.gear_ratio = 0.9;
    bench.solver = Solver::Fixed { step_s: 1e-3 };
    bench.by = 3e-3;
    for (i, parameter) in bench.model.parameter_table().iter().enumerate() {
        bench.theta[i] += match parameter.quantity.name() {
            "fv" | "fvm" => 2.0,
            "fc" | "fcm" => 1.0,
            "ia" => 0.3,
            _ => 0.0,
        };
    }
    bench.inertia = Some(bench.motor_inertia());
    let base = BaseParameters::of(&bench.model, &[]).unwrap();
    let mut to: Vec<SensitiveTo> = base.columns().into_iter().map(SensitiveTo::Parameter).collect();
    assert_eq!(to.len(), 61);
    to.push(SensitiveTo::GearRatio);
    bench.check(&to, EXACT);
    bench.inertia = None;
    bench.check(&to, EXACT);
}

/// The delay of a sampled controller's signals, within a sample and of a whole one, and that of a continuous controller's
/// reference.
#[test]
fn the_delay() {
    let gains = "position_gain = [60.0, 40.0]\nvelocity_gain = [5.0, 3.0]\nvelocity_feed_forward = 0.9\n\
                 acceleration_feed_forward = 0.8";
    let wave =
        (0..500).flat_map(|k| [0.3 - 0.3 * (0.008 * f64::from(k)).cos(), 0.2 - 0.2 * (0.011 * f64::from(k)).cos()]);
    let recorded = Reference::Sampled(SampledReference::new(Series::shaped(2, wave.collect()), 1000.0));
    for controller in [
        format!("law = \"pd\"\n{gains}\nsample_time_s = 0.002\ndelay_s = 0.0013"),
        format!("law = \"cascaded\"\n{gains}\nsample_time_s = 0.002\ndelay_s = 0.0027"),
        format!("law = \"pd\"\n{gains}"),
    ] {
        let mut bench = wrist(&controller);
        // Between the stages of the steps, so that none comes to a sample of the reference.
        bench.bias.delay_s = 0.000137;
        bench.check(&[SensitiveTo::Delay], EXACT);
        bench.reference = recorded.clone();
        // A later signal moves the steps behind it: they are short enough that their error does not count.
        bench.solver = Solver::Fixed { step_s: 1e-4 };
        bench.check(&[SensitiveTo::Delay], EXACT);
    }
}

fn implicit(tolerance: f64) -> Solver {
    Solver::Implicit { relative_tolerance: tolerance, absolute_tolerance: tolerance / 1e3 }
}

/// The linearly implicit method against the explicit one at tight tolerance: continuous, sampled, and with friction that is
/// stiff against the inertia.
#[test]
fn the_implicit_method_converges_to_the_explicit_one() {
    let gains = "position_gain = [60.0, 40.0]\nvelocity_gain = [5.0, 3.0]\nvelocity_feed_forward = 0.9";
    for (controller, scale) in [
        (format!("law = \"pd\"\n{gains}"), 0.01),
        (format!("law = \"pd\"\n{gains}"), 1e-3),
        (format!("law = \"cascaded\"\n{gains}\nsample_time_s = 0.002\ndelay_s = 0.001\nsaturation = [2.5, 1.8]"), 0.01),
    ] {
        let mut bench = wrist(&controller);
        bench.scale = scale;
        let mut to = parameters(&bench, &["zz1", "xx2", "mx2", "fv1", "fc1", "fcm2", "iam2"]);
        to.extend(GAINS);
        bench.solver = Solver::Adaptive { relative_tolerance: 1e-11, absolute_tolerance: 1e-13 };
        let (exact, _) = bench.sensitivities(&to);
        for tolerance in [1e-4, 1e-6, 1e-8] {
            bench.solver = implicit(tolerance);
            let (found, motion) = bench.sensitivities(&to);
            assert!(motion == bench.simulate());
            let errors = found.iter().zip(&exact).map(|(found, exact)| {
                [0, 1].map(|i| distance(&found[i], &exact[i]) / norm(&exact[i])).into_iter().fold(0.0, f64::max)
            });
            let errors: Vec<f64> = errors.collect();
            let shown: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
            println!("{scale} {tolerance:e} {:?}: {}", motion.counts, shown.join(" "));
            let largest = errors.iter().copied().fold(0.0, f64::max);
            assert!(largest < 1e3 * tolerance, "{controller}: {largest:e} at {tolerance:e}");
        }
    }
}
