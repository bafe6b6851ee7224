//! Generated code compiles without warnings, and gives what the library's own evaluation of the same functions gives, which
//! the unit tests of `symbolic` compare with the kernels.
//!
//! A language whose compiler or interpreter is not there counts as ignored.

mod c;
mod python;
mod rust;
mod text;

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Robot,
    dynamics::Model,
    robot::{Locks, RobotSource},
    symbolic::{Function, ModelKind, ParameterSet, Request},
};
use thetahat_symbolic::symbolic::{Array, Inputs};
use thetahat_testing::each_night;

const ROBOTS: [&str; 9] = [
    "two_joint.toml",
    WITH_TERMS,
    "scara.toml",
    "branching.urdf",
    "tx40.toml",
    "ur10.toml",
    "seven_axes.urdf",
    "mobile_manipulator.urdf",
    "quadruped.urdf",
];
/// The first of them, whose code a compiler reads soon.
const SMALL: usize = 4;

/// The two-joint robot with torque terms, and every function that they can take.
const WITH_TERMS: &str = "two_joint_with_terms.toml";
const TERMS: &str = r#"
[[term]]
kind = "exponential-stribeck"
velocity = 0.3
exponent = 1.3
[[term]]
kind = "load-friction"
[[term]]
kind = "motor-harmonics"
harmonics = [0.05]
[[term]]
kind = "hydraulic"
name = "balancer"
direction = "pull"
from = { point_m = [-0.6, 0.3, 1.0] }
to = { link_of = "elbow", point_m = [0.2, 0.0, 0.1] }
length_m = 1.0
gas_length_m = 0.8
exponent = 1.2
[[term]]
kind = "expression"
name = "own"
joint = "elbow"
expression = "exp(-abs(dq)) - ln(3 + q^2) * cbrt(sin(q) - 3) + tan(sin(q)) * asin(sin(q)/2) - acos(sin(dq)/2) * atan(q) + sinh(sin(q)) * cosh(sin(dq)) - tanh(dq)"
[[term]]
kind = "expression"
name = "other"
joint = "shoulder"
expression = "asinh(q) + acosh(3 + dq^2) * atanh(sin(q)/2) - floor(3*q) + (3 + q^2)^sin(dq) + atan2(q, dq) * (q min dq) - (q max 0.2) * sqrt(3 + q^2)"
"#;
/// Robots whose derivatives are generated: those of large ones take compilers long.
const WITH_DERIVATIVES: [&str; 4] = ["two_joint.toml", WITH_TERMS, "scara.toml", "tx40.toml"];

/// Relative to the largest entry.
const ROUNDING: f64 = 1e-12;
/// States that each function is called with.
const STATES: usize = 5;

/// A function with states to call it with.
struct Sample {
    function: Function,
    theta: Vec<f64>,
    /// Positions, velocities, accelerations and torques, entry by entry with the states of each side by side.
    arrays: [Vec<f64>; 4],
}

impl Sample {
    fn new(robot: &Robot, model: ModelKind, rng: &mut ChaCha8Rng) -> Self {
        let parameters = if rng.random_bool(0.5) { ParameterSet::Base } else { ParameterSet::Standard };
        let function = Function::new(robot, &Request::new(model, parameters)).unwrap();
        let mut random = |n: usize| -> Vec<f64> { (0..n).map(|_| rng.random_range(-2.0..2.0)).collect() };
        let n = Model::new(robot).coordinate_count();
        let theta = random(function.parameters.len());
        let arrays = [0; 4].map(|_| random(n * STATES));
        Self { function, theta, arrays }
    }

    /// The array that a function takes.
    fn array(&self, of: Array) -> &[f64] {
        match of {
            Array::Position => &self.arrays[0],
            Array::Velocity => &self.arrays[1],
            Array::Acceleration => &self.arrays[2],
            Array::Torque => &self.arrays[3],
            Array::Parameter => &self.theta,
        }
    }

    fn expected(&self, state: usize) -> Vec<f64> {
        let [q, dq, ddq, tau] =
            [0, 1, 2, 3].map(|i| self.arrays[i].iter().skip(state).step_by(STATES).copied().collect::<Vec<_>>());
        self.function.program.evaluate(&Inputs { q: &q, dq: &dq, ddq: &ddq, tau: &tau, theta: &self.theta })
    }

    /// Fails unless these are the entries of each state after the other.
    fn check(&self, found: &[f64]) -> Result<(), Failed> {
        let expected: Vec<f64> = (0..STATES).flat_map(|state| self.expected(state)).collect();
        let what = format!("{} {}", self.function.robot, self.function.model.identifier());
        thetahat_testing::ensure(found.len() == expected.len(), format!("{what}: {} entries", found.len()))?;
        for (found, expected) in found.chunks(found.len() / STATES).zip(expected.chunks(expected.len() / STATES)) {
            let size = expected.iter().fold(1e-3, |size: f64, value| size.max(value.abs()));
            for (a, b) in found.iter().zip(expected) {
                let is_close = (a - b).abs() <= ROUNDING * size || (!a.is_finite() && !b.is_finite());
                thetahat_testing::ensure(is_close, format!("{what}: {a} against {b}, of {size}"))?;
            }
        }
        Ok(())
    }
}

fn robot(file: &str) -> Robot {
    if file == WITH_TERMS {
        let text = std::fs::read_to_string(thetahat_testing::project("robots/two_joint.toml")).unwrap();
        return Robot::parse(&(text + TERMS), Path::new(file)).unwrap();
    }
    let source = RobotSource::read(&thetahat_testing::project("robots").join(file)).unwrap();
    let until = if file.starts_with("mobile") { vec!["arm_7_joint".to_owned()] } else { Vec::new() };
    source.robot_with_locks(&Locks { until, ..Locks::default() }, Path::new("the test")).unwrap()
}

/// A function of each model.
fn samples(file: &str) -> Vec<Sample> {
    let (robot, mut rng) = (robot(file), ChaCha8Rng::seed_from_u64(1640));
    let is_wanted =
        |model: &ModelKind| *model != ModelKind::InverseDynamicsDerivatives || WITH_DERIVATIVES.contains(&file);
    let models = ModelKind::ALL.iter().map(|(_, model)| *model).filter(is_wanted);
    models.map(|model| Sample::new(&robot, model, &mut rng)).collect()
}

/// Splits printed numbers among functions, and checks them.
fn check_printed(samples: &[Sample], printed: &str) -> Result<(), Failed> {
    let numbers = printed.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let mut rest = &numbers[..];
    for sample in samples {
        let [rows, columns] = sample.function.shape;
        let count = (rows * columns * STATES).min(rest.len());
        let (own, others) = rest.split_at(count);
        sample.check(own)?;
        rest = others;
    }
    thetahat_testing::ensure(rest.is_empty(), "more numbers than entries")
}

/// What a command prints that must succeed.
fn output(command: &mut Command) -> Result<String, Failed> {
    let output = command.output()?;
    let shown = thetahat_testing::shown(&output);
    thetahat_testing::ensure(output.status.success(), format!("{command:?}:\n{shown}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn is_there(program: &str, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

fn trials(language: &str, files: &[&'static str], is_there: bool, run: fn(&str) -> Result<(), Failed>) -> Vec<Trial> {
    if !is_there {
        eprintln!("\n*** SKIPPED: generated {language}: there is nothing that runs it ***\n");
    }
    let trial = |file: &&'static str| {
        let file = *file;
        Trial::test(format!("{language}_of_{}", file.replace('.', "_")), move || run(file)).with_ignored_flag(!is_there)
    };
    files.iter().map(trial).collect()
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    let python = python::interpreter();
    let all = [
        trials("c", &ROBOTS[..SMALL], is_there("cc", &["--version"]), c::run),
        each_night(trials("c", &ROBOTS[SMALL..], is_there("cc", &["--version"]), c::run)),
        each_night(vec![
            Trial::test("own_sines_of_c", c::own_sines).with_ignored_flag(!is_there("cc", &["--version"])),
        ]),
        trials("rust", &["two_joint.toml", WITH_TERMS, "scara.toml"], is_there("rustc", &["--version"]), rust::run),
        each_night(trials("rust", &["tx40.toml"], is_there("rustc", &["--version"]), rust::run)),
        trials("python", &ROBOTS, python.is_some(), python::run),
        vec![
            Trial::test("matlab", text::matlab),
            Trial::test("latex", text::latex),
            Trial::test("it_is_the_same_each_time", text::same_each_time),
        ],
    ];
    all.into_iter().flatten().collect()
}
