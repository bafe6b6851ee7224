//! The identified robot as files for simulators and controllers.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use thetahat::{
    export::{ExportRequest, IdentifiedModel},
    output::{OutputGuard, replace_file},
    results::Results,
};

use crate::{
    arguments::{Export as Request, Exported, Sample},
    terminal::{Ending, print, remark},
};

/// Writes the robot of results, or prints it.
pub fn export_robot(request: &Request) -> Result<Ending, Box<dyn Error>> {
    let sidecar = request.out.as_deref().map(beside);
    let guard = OutputGuard::new(inputs(&request.exported), request.exported.force);
    request.out.iter().chain(&sidecar).try_for_each(|path| guard.file(path))?;
    let model = model(&request.exported)?;
    let export = model.export(request.exported.to)?;
    let checked = if request.check { Some(export.check()?) } else { None };
    let said = model.in_words(&export, checked);
    let Some((path, sidecar)) = request.out.as_ref().zip(sidecar) else {
        remark(&said)?;
        print(&export.text)?;
        return Ok(Ending::of(model.verdict));
    };
    let covariance = model.covariance_json_if_known()?;
    replace_file(path, export.text.as_bytes())?;
    print(&format!("{said}\nwritten: {}\n", path.display()))?;
    if let Some(covariance) = covariance {
        replace_file(&sidecar, covariance.as_bytes())?;
        print(&format!("         {}\n", sidecar.display()))?;
    }
    Ok(Ending::of(model.verdict))
}

/// Writes robots drawn from the distribution of the estimates.
pub fn sample_robots(request: &Sample) -> Result<Ending, Box<dyn Error>> {
    let digits = request.count.to_string().len();
    let extension = request.exported.to.extension();
    let name = |number: u32| format!("{number:0digits$}.{extension}");
    let names: Vec<String> = (1..=request.count).map(name).collect();
    let guard = OutputGuard::new(inputs(&request.exported), request.exported.force);
    guard.folder(&request.out, names.iter().map(String::as_str))?;
    let model = model(&request.exported)?;
    // All are made before any is written.
    let mut files = Vec::with_capacity(names.len());
    for number in 1..=request.count {
        files.push(model.export_sample(&model.sample(number, request.seed)?, request.exported.to)?.text);
    }
    fs::create_dir_all(&request.out)?;
    for (name, text) in names.iter().zip(&files) {
        replace_file(&request.out.join(name), text.as_bytes())?;
    }
    print(&format!(
        "{}: {} samples of the estimates by {}, seed {}\nwritten: {} to {}\n",
        model.robot.name,
        request.count,
        model.method,
        request.seed,
        request.out.join(&names[0]).display(),
        names[names.len() - 1]
    ))?;
    Ok(Ending::of(model.verdict))
}

fn model(request: &Exported) -> Result<IdentifiedModel, Box<dyn Error>> {
    let results = Results::read(&request.results)?;
    let chosen = ExportRequest {
        method: request.method,
        robot: request.robot.clone(),
        data: request.data.clone(),
        force: request.force,
        ..ExportRequest::default()
    };
    Ok(IdentifiedModel::of_results(&request.results, &results, &chosen)?)
}

fn inputs(request: &Exported) -> Vec<PathBuf> {
    [&request.results].into_iter().chain(&request.robot).cloned().collect()
}

/// The file of the covariance.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".covariance.json");
    path.with_file_name(name)
}
