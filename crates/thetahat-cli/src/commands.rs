use std::{
    error::Error,
    io::Write,
    num::NonZero,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use thetahat::{
    experiment::{Experiment, PredictionRequest, predict},
    report::{self, Published},
};

use crate::{
    arguments::{Arguments, Command, Described, Identify, Output, Predict, Sensitivity, Simulate},
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
        Command::Sensitivity(sensitivity) => sweep_errors(&sensitivity),
        Command::Simulate(simulate) => record_twin(&simulate),
    }
}

fn identify_experiment(identify: &Identify) -> Result<Verdict, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&identify.described)?;
    run_experiment(&experiment, &data, &identify.output)
}

/// The experiment, and the folder of its data.
fn read_experiment(described: &Described) -> Result<(Experiment, PathBuf), Box<dyn Error>> {
    let beside = described.experiment.parent().map_or_else(PathBuf::new, Path::to_owned);
    let data = described.data.clone().unwrap_or(beside);
    let experiment = match &described.robot {
        Some(robot) => Experiment::read_with_robot(&described.experiment, robot)?,
        None => Experiment::read(&described.experiment, &data)?,
    };
    Ok((experiment, data))
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

fn sweep_errors(sensitivity: &Sensitivity) -> Result<Verdict, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&sensitivity.described)?;
    if let Some(directory) = &sensitivity.out {
        report::check_folder(directory)?;
    }
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = sensitivity.threads.map_or_else(cores, NonZero::get);
    let progress = Mutex::new(Progress::new());
    let tell = |done: usize, of: usize| {
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.tell(&format!("{done} of {of} estimations"));
    };
    let found = experiment.sensitivity(&data, threads, &tell)?;
    drop(progress);
    print(&report::sensitivity_text(&found))?;
    if let Some(directory) = &sensitivity.out {
        let files = report::write_sensitivity(&found, directory)?;
        let names: String = files.iter().map(|f| format!("  {}\n", f.display())).collect();
        print(&format!("\nwritten:\n{names}"))?;
    }
    Ok(Verdict::Good)
}

fn record_twin(simulate: &Simulate) -> Result<Verdict, Box<dyn Error>> {
    let record = Experiment::read(&simulate.experiment, Path::new(""))?.record_twin()?;
    report::write_record(&record, &simulate.out)?;
    let (samples, rate) = (record.position.len(), record.sample_rate_hz);
    print(&format!(
        "{samples} samples at {rate} Hz of {} joints: time_s, position_1 ..., torque_1 ... (rad and N m, or m and N)\n\
         written: {}\n",
        record.joints.len(),
        simulate.out.display()
    ))?;
    Ok(Verdict::Good)
}

/// Prints. A reader that has gone away (`| head`) is no reason not to write the files.
fn print(text: &str) -> Result<(), std::io::Error> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
