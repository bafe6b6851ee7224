//! Code of a robot's models.

use std::{
    error::Error,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use thetahat::{
    Robot,
    dynamics::FrictionTransition,
    experiment::{EstimateRequest, IdentifiedRobot},
    results::{ModelResult, NOMINAL},
    robot::{Locks, RobotSource},
    symbolic::{Function, ParameterSet, Request, SymbolicError},
};
use thetahat_ground::output::{FileKind, OutputGuard, replace_file};

use crate::{
    arguments::{Generate, GeneratedParameters},
    terminal::{Ending, print},
};

/// A robot with the values of its standard parameters, if the code contains them.
struct Source {
    robot: Robot,
    theta: Option<Vec<f64>>,
    /// The origin of the values.
    about: Vec<String>,
    /// The files that were read.
    files: Vec<PathBuf>,
    /// Velocities at which the friction changes its sign.
    friction_transition: Option<FrictionTransition>,
}

pub fn run(request: &Generate) -> Result<Ending, Box<dyn Error>> {
    let Source { robot, theta, about, files, friction_transition } = read(request)?;
    if let Some(path) = &request.out {
        OutputGuard::new(files, request.force.force).file(path, FileKind::Code)?;
    }
    let parameters = if request.base { ParameterSet::Base } else { ParameterSet::Standard };
    let model =
        Request { model: request.model, parameters, values: theta, drives: request.drives, about, friction_transition };
    let function = Function::new(&robot, &model)?;
    let code = request.to.code(&function, request.name.as_deref())?;
    let Some(path) = &request.out else {
        print(&code)?;
        return Ok(Ending::Good);
    };
    replace_file(path, code.as_bytes()).map_err(|error| format!("{}: cannot be written: {error}", path.display()))?;
    print(&format!("{}\nwritten: {}\n", function.program.count(), path.display()))?;
    Ok(Ending::Good)
}

fn read(request: &Generate) -> Result<Source, Box<dyn Error>> {
    let path = request.data.clone().unwrap_or_default().join(&request.source);
    if is_json(&path) { read_results(request, path) } else { read_robot(request, &path) }
}

fn read_robot(request: &Generate, path: &Path) -> Result<Source, Box<dyn Error>> {
    let source = RobotSource::read(path)?;
    let locks = Locks { locked: request.lock.iter().cloned().collect(), until: request.until.clone() };
    let robot = source.robot_with_locks(&locks, Path::new("the command line"))?;
    let theta = match request.parameters.unwrap_or(GeneratedParameters::Symbolic) {
        GeneratedParameters::Symbolic => None,
        GeneratedParameters::Values if !request.model.takes_parameters() => None,
        GeneratedParameters::Values if robot.a_priori.is_empty() => {
            return Err(SymbolicError::NoValues { robot: path.display().to_string() }.into());
        }
        GeneratedParameters::Values => Some(robot.a_priori_parameters()),
    };
    Ok(Source { robot, theta, about: Vec::new(), files: source.paths().to_vec(), friction_transition: None })
}

fn read_results(request: &Generate, path: PathBuf) -> Result<Source, Box<dyn Error>> {
    if !request.lock.is_empty() || !request.until.is_empty() {
        return Err("the results say which joints are locked; leave --lock and --until out".into());
    }
    let identified = IdentifiedRobot::read(
        &path,
        &EstimateRequest {
            case: request.case.clone().unwrap_or_else(|| NOMINAL.to_owned()),
            method: request.method,
            robot: request.robot.clone(),
            data: None,
            untrusted: request.trust.untrusted,
        },
    )?;
    let theta = match request.parameters.unwrap_or(GeneratedParameters::Values) {
        GeneratedParameters::Symbolic => None,
        GeneratedParameters::Values => Some(identified.theta()),
    };
    let mut about = vec![identified.origin()];
    if theta.is_some() && identified.model.is_none() {
        about.push(
            "values are estimates of base parameters, each assigned to the standard parameter of the same name"
                .to_owned(),
        );
    }
    let friction_transition = identified.model.as_ref().map(ModelResult::transition);
    Ok(Source { robot: identified.robot, theta, about, files: identified.files, friction_transition })
}

/// Whether a file begins like JSON; its reader reports a file that cannot be read.
fn is_json(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(64).read_to_end(&mut head));
    read.is_ok() && head.trim_ascii_start().starts_with(b"{")
}
