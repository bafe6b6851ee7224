//! The identified robot as files for simulators and controllers.

use std::{error::Error, path::PathBuf};

use thetahat::{
    export::{Export, ExportRequest, IdentifiedModel},
    output::{OutputGuard, replace_file},
    results::Results,
};

use crate::{
    arguments::{Export as Request, Exported},
    terminal::{Ending, print, remark},
};

/// Writes the robot of results, or prints it.
pub fn export_robot(request: &Request) -> Result<Ending, Box<dyn Error>> {
    if let Some(path) = &request.out {
        OutputGuard::new(inputs(&request.exported), request.exported.force).file(path)?;
    }
    let model = model(&request.exported)?;
    let export = model.export(request.exported.to)?;
    let checked = if request.check { Some(export.check()?) } else { None };
    let said = in_words(&model, &export, checked);
    match &request.out {
        None => {
            remark(&said)?;
            print(&export.text)?;
        }
        Some(path) => {
            replace_file(path, export.text.as_bytes())?;
            print(&format!("{said}\nwritten: {}\n", path.display()))?;
        }
    }
    Ok(Ending::of(model.verdict))
}

fn model(request: &Exported) -> Result<IdentifiedModel, Box<dyn Error>> {
    let results = Results::read(&request.results)?;
    let chosen = ExportRequest {
        method: request.method,
        robot: request.robot.clone(),
        data: request.data.clone(),
        force: request.force,
    };
    Ok(IdentifiedModel::of_results(&request.results, &results, &chosen)?)
}

fn inputs(request: &Exported) -> Vec<PathBuf> {
    [&request.results].into_iter().chain(&request.robot).cloned().collect()
}

/// What there is to say of an export, a line each.
fn in_words(model: &IdentifiedModel, export: &Export, checked: Option<f64>) -> String {
    let first = format!("{}: {}", model.robot.name, export.format.title());
    let checked = checked.map(|difference| {
        format!("read back: torques at 1000 random states differ by {difference:.1e} of the largest at most")
    });
    let lines = [vec![first], model.about(), export.notes.clone(), export.unsaid.clone(), checked.into_iter().collect()];
    lines.concat().into_iter().map(|line| line + "\n").collect()
}
