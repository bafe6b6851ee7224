//! Code of a robot's models.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use thetahat::{
    output::{OutputGuard, replace_file},
    robot::{Locks, Robot, RobotSource},
    symbolic::{Function, ParameterSet, Request},
};

use crate::{
    arguments::Generate,
    terminal::{Ending, print},
};

/// A robot, and the values of its parameters where they are to be folded in.
struct Source {
    robot: Robot,
    inputs: Vec<PathBuf>,
}

pub fn run(request: &Generate) -> Result<Ending, Box<dyn Error>> {
    let Source { robot, inputs } = read(request)?;
    if let Some(path) = &request.out {
        OutputGuard::new(inputs, request.force.force).file(path)?;
    }
    let function = Function::new(
        &robot,
        &Request {
            model: request.model,
            parameters: if request.base { ParameterSet::Base } else { ParameterSet::Standard },
            values: None,
            with_drives: !request.without_friction,
        },
    )?;
    let code = request.to.code(&function, request.name.as_deref())?;
    match &request.out {
        None => print(&code)?,
        Some(path) => {
            replace_file(path, code.as_bytes())
                .map_err(|error| format!("{}: cannot be written: {error}", path.display()))?;
            print(&format!("written: {}\n", path.display()))?;
        }
    }
    Ok(Ending::Good)
}

fn read(request: &Generate) -> Result<Source, Box<dyn Error>> {
    let path = request.data.clone().unwrap_or_default().join(&request.source);
    let source = RobotSource::read(&path)?;
    let locks = Locks { locked: request.lock.iter().cloned().collect(), until: request.until.clone() };
    let robot = source.robot_with_locks(&locks, Path::new("the command line"))?;
    let inputs = [Some(path), source.urdf_path().map(Path::to_owned)].into_iter().flatten().collect();
    Ok(Source { robot, inputs })
}
