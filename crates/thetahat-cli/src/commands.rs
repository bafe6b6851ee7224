use std::{
    error::Error,
    io::Write,
    path::{Path, PathBuf},
};

use thetahat::{
    experiment::{Experiment, PredictionRequest, predict},
    report::{self, ModelReport, Published},
    robot::RobotSource,
};

use crate::{
    arguments::{Arguments, Command, Identify, Model, Output, Predict},
    progress::Progress,
};

/// What a finished command says of its result.
pub enum Verdict {
    Good,
    NotTrusted,
}

pub fn run(arguments: Arguments) -> Result<Verdict, Box<dyn Error>> {
    match arguments.command {
        Command::Demo(output) => run_experiment(&Experiment::demo()?, Path::new(""), &output),
        Command::Identify(identify) => identify_experiment(&identify),
        Command::Predict(request) => predict_torques(&request),
        Command::Model(request) => show_model(&request),
    }
}

fn identify_experiment(identify: &Identify) -> Result<Verdict, Box<dyn Error>> {
    let experiment = Experiment::read(&identify.experiment)?;
    let beside = identify.experiment.parent().map_or_else(PathBuf::new, Path::to_owned);
    run_experiment(&experiment, identify.data.as_ref().unwrap_or(&beside), &identify.output)
}

fn run_experiment(experiment: &Experiment, data: &Path, output: &Output) -> Result<Verdict, Box<dyn Error>> {
    if let Some(directory) = &output.out {
        report::check_folder(directory)?;
    }
    let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
    let mut progress = Progress::new();
    let results = experiment.run(data, &mut |stage| progress.tell(stage))?;
    drop(progress);
    let text = report::text::all(&results, published.as_ref());
    print(&text)?;
    match &output.out {
        Some(directory) => {
            let files = report::write_all(&results, published.as_ref(), directory)?;
            let names: String = files.iter().map(|f| format!("  {}\n", f.display())).collect();
            print(&format!("\nwritten:\n{names}"))?;
        }
        None => print("\nno files written; with --out DIR: results.json, parameters.csv, report.html\n")?,
    }
    Ok(if results.is_trustworthy() { Verdict::Good } else { Verdict::NotTrusted })
}

fn predict_torques(request: &Predict) -> Result<Verdict, Box<dyn Error>> {
    let prediction = predict(&PredictionRequest {
        results: request.results.clone(),
        recording: request.recording.clone(),
        torque: request.torque.clone(),
        case: request.case.clone(),
        method: request.method.map(Into::into),
    })?;
    print(&report::prediction_text(&prediction))?;
    if let Some(path) = &request.out {
        report::write_prediction(&prediction, path)?;
        print(&format!("\nwritten: {}\n", path.display()))?;
    }
    Ok(Verdict::Good)
}

fn show_model(request: &Model) -> Result<Verdict, Box<dyn Error>> {
    let folder = request.data.clone().unwrap_or_default();
    let source = RobotSource::read(&folder.join(&request.robot))?;
    let report = ModelReport::new(&source, &source.robot()?);
    print(&if request.json { report::model_json(&report)? } else { report::model_text(&report) })?;
    Ok(if report.problem.is_none() { Verdict::Good } else { Verdict::NotTrusted })
}

/// Prints. A reader that has gone away (`| head`) is no reason not to write the files.
fn print(text: &str) -> Result<(), std::io::Error> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
