//! Pinocchio in C++ in the same run: a program of ours, compiled with the headers that its Python package brings.

use std::{
    error::Error,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use thetahat::{
    Robot,
    symbolic::{DriveTorques, Function, ModelKind, ParameterSet, Request},
};
use thetahat_symbolic::symbolic::Inputs;

/// Finds the folder of its headers.
const PREFIX: &str = "import pathlib, pinocchio; print(pathlib.Path(pinocchio.__file__).parents[4])";

/// What its own build files define, and the flags of our C.
const FLAGS: [&str; 11] = [
    "-std=c++17",
    "-O3",
    "-w",
    "-march=native",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];

/// Part of the largest torque by which those of both programs differ at most.
const SAME: f64 = 1e-10;

/// Inverse dynamics, mass matrix, forward dynamics and regressor of the links of a chain of revolute joints, ns a call.
pub fn times(python: &str, robot: &Robot, folder: &Path) -> Result<[f64; 4], Box<dyn Error>> {
    let found = Command::new(python).args(["-c", PREFIX]).output()?;
    if !found.status.success() {
        return Err(format!("{python} has no pinocchio: pip install pin==4.1.0 cmeel-eigen").into());
    }
    let include = PathBuf::from(String::from_utf8(found.stdout)?.trim()).join("include");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/generated_times/pinocchio.cpp");
    let program = folder.join("pinocchio");
    let mut compiler = Command::new("c++");
    compiler.args(FLAGS).arg("-isystem").arg(&include).arg("-isystem").arg(include.join("eigen3"));
    if !compiler.arg(source).arg("-o").arg(&program).status()?.success() {
        return Err("c++ failed".into());
    }
    let mut running = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    running.stdin.take().ok_or("no standard input")?.write_all(joints(robot).as_bytes())?;
    let output = String::from_utf8(running.wait_with_output()?.stdout)?;
    let numbers: Vec<f64> = output.lines().map(str::parse).collect::<Result<_, _>>()?;
    let (torques, times) = numbers.split_at(robot.joints.len().min(numbers.len()));
    require_same(torques, &torques_of(robot)?)?;
    Ok(times.try_into()?)
}

/// A line of each joint: rotation, origin, and its link in the order of Pinocchio.
fn joints(robot: &Robot) -> String {
    let theta = robot.a_priori_parameters();
    let table = robot.parameter_table();
    let mut text = String::new();
    for (j, joint) in robot.joints.iter().enumerate() {
        let named = |name: &str| {
            let place = table.iter().position(|parameter| parameter.name() == format!("{name}{}", j + 1));
            place.map_or(0.0, |place| theta[place])
        };
        let link = ["m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz"].map(named);
        let rotation = joint.placement.rotation();
        let numbers = rotation.as_flattened().iter().chain(&joint.placement.origin).chain(&link);
        text += &(numbers.map(|number| format!("{number:e}")).collect::<Vec<_>>().join(" ") + "\n");
    }
    text
}

/// The torques of the links in the state that the program takes first.
fn torques_of(robot: &Robot) -> Result<Vec<f64>, Box<dyn Error>> {
    let request = Request {
        drives: DriveTorques::None,
        values: Some(robot.a_priori_parameters()),
        ..Request::new(ModelKind::InverseDynamics, ParameterSet::Standard)
    };
    let state: Vec<f64> = (0..robot.joints.len()).map(|k| (k * 37 % 101) as f64 / 50.0 - 1.0).collect();
    let inputs = Inputs { q: &state, dq: &state, ddq: &state, ..Inputs::default() };
    Ok(Function::new(robot, &request)?.program.evaluate(&inputs))
}

/// A race of two robots says nothing.
fn require_same(found: &[f64], expected: &[f64]) -> Result<(), Box<dyn Error>> {
    let largest = expected.iter().fold(0.0_f64, |largest, torque| largest.max(torque.abs()));
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME * largest;
    if found.len() == expected.len() && found.iter().zip(expected).all(same) {
        return Ok(());
    }
    Err(format!("Pinocchio has torques {found:?}, the library {expected:?}").into())
}
