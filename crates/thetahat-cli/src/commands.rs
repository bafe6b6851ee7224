use std::{
    error::Error,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use thetahat::{
    Experiment, Results,
    experiment::{ExperimentError, PredictionRequest, predict},
    report::Published,
    results::{ResultsError, SideBySide},
    robot::{Locks, RobotSource, RobotSummary, XacroOptions},
    symbolic::BaseFormulas,
};
use thetahat_ground::output::{FileKind, OutputGuard, replace_file};
use thetahat_report::{
    report,
    results::{IntervalsAgainstPrediction, PredictedIntervals, PredictionError},
};

use crate::{
    arguments::{Arguments, Check, Command, Compare, Identify, Model, Output, Predict, Sensitivity, Simulate},
    campaign, design, export, generate,
    inputs::{read_experiment, results_file, threads},
    progress::{Counter, Progress},
    proposal, reduction, remedied, shell,
    shown::{Remark, show},
    terminal::{Ending, print, width},
    watch,
};

pub fn run(arguments: Arguments) -> Result<Ending, Box<dyn Error>> {
    match arguments.command {
        Command::Demo(output) => run_experiment(&Experiment::demo()?, Path::new(""), &output, None),
        Command::Inspect(inspect) => proposal::inspect_recordings(&inspect),
        Command::Init(init) => proposal::write_experiment(&init),
        Command::Check(check) => check_experiment(&check),
        Command::Compare(request) => compare_results(&request),
        Command::Identify(identify) => identify_experiment(&identify),
        Command::Export(request) => export::export_robot(&request),
        Command::Sample(request) => export::sample_robots(&request),
        Command::Predict(request) => predict_torques(&request),
        Command::Watch(request) => watch::run(&request),
        Command::Campaign(request) => campaign::run(&request),
        Command::Sensitivity(sensitivity) => sweep_errors(&sensitivity),
        Command::Reduce(request) => reduction::reduce(&request),
        Command::Solve(request) => reduction::solve(&request),
        Command::Design(request) => design::run(&request),
        Command::Simulate(simulate) => record_twin(&simulate),
        Command::Model(request) => show_model(&request),
        Command::Generate(request) => generate::run(&request),
        Command::Completions(request) => shell::print_completions(request.shell),
        Command::Man(request) => shell::write_manual(&request),
    }
}

fn check_experiment(check: &Check) -> Result<Ending, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&check.described)?;
    let findings = experiment.check(&data)?;
    let problem = findings.iter().any(|r| !r.held_back && r.has_problem());
    if check.json {
        print(&report::findings_json(&findings)?)?;
    } else {
        print(&report::findings_text(&findings, width()))?;
    }
    if !problem && !check.json {
        compare_filters(&experiment, &data)?;
    }
    Ok(if problem { Ending::NotTrusted } else { Ending::Good })
}

/// Compares the errors of the estimates with the experiment's filter and others, or says why not.
fn compare_filters(experiment: &Experiment, data: &Path) -> Result<(), Box<dyn Error>> {
    let progress = Progress::of("comparing filters on a simulated twin of the recording");
    let choice = experiment.choose_filter(data, experiment.settings.signal.filter(), threads(None));
    drop(progress);
    match choice {
        Ok(choice) => print(&report::filter_text(&choice, width()))?,
        Err(ExperimentError::Filter { source, .. }) => print(&format!("\nFilters are not compared: {source}.\n"))?,
        Err(error) => print(&format!("\nFilters are not compared: {error}.\n"))?,
    }
    Ok(())
}

fn compare_results(request: &Compare) -> Result<Ending, Box<dyn Error>> {
    if let Some(path) = &request.out {
        OutputGuard::new(request.results.iter().cloned(), request.force.force).file(path, report::COMPARISON_PAGE)?;
    }
    if let Some(predicted) = request.results.first().filter(|path| path.extension().is_some_and(|e| e == "csv")) {
        return compare_with_prediction(request, predicted);
    }
    let read = |path: &PathBuf| {
        let path = results_file(path);
        Results::read(&path).map(|results| (path, results))
    };
    let results = request.results.iter().map(read).collect::<Result<Vec<_>, ResultsError>>()?;
    let compared = SideBySide::new(&results, &request.case, request.method)?;
    print(&report::comparison_text(&compared, width()))?;
    if let Some(path) = &request.out {
        report::write_comparison(&compared, path)?;
        print(&format!("\nwritten: {}\n", path.display()))?;
    }
    Ok(Ending::Good)
}

/// Compares the intervals of each of the results with those that a design predicted.
fn compare_with_prediction(request: &Compare, predicted: &Path) -> Result<Ending, Box<dyn Error>> {
    let intervals = PredictedIntervals::read(predicted)?;
    let against = |path: &PathBuf| -> Result<IntervalsAgainstPrediction, Box<dyn Error>> {
        let path = results_file(path);
        let results = Results::read(&path)?;
        let compared = intervals
            .against(&results, &request.case, request.method)
            .map_err(|source| PredictionError::NoEstimate { path: path.clone(), source })?;
        if compared.parameters.is_empty() {
            return Err(PredictionError::NothingInCommon { predicted: predicted.to_owned(), results: path }.into());
        }
        Ok(compared)
    };
    let compared = request.results.iter().skip(1).map(against).collect::<Result<Vec<_>, _>>()?;
    for compared in &compared {
        print(&report::predicted_intervals_text(compared, width()))?;
    }
    if let Some(path) = &request.out {
        report::write_predicted_intervals(&compared, path)?;
        print(&format!("\nwritten: {}\n", path.display()))?;
    }
    Ok(Ending::Good)
}

fn identify_experiment(identify: &Identify) -> Result<Ending, Box<dyn Error>> {
    if !identify.apply.is_empty() {
        return remedied::identify_with_remedies(identify);
    }
    let (experiment, data) = read_experiment(&identify.described)?;
    let apply = remedied::command(&identify.described, &identify.output);
    run_experiment(&experiment, &data, &identify.output, Some(&apply))
}

fn run_experiment(
    experiment: &Experiment,
    data: &Path,
    output: &Output,
    apply: Option<&str>,
) -> Result<Ending, Box<dyn Error>> {
    if let Some(directory) = &output.out {
        let guard = OutputGuard::new(experiment.input_files(data), output.force.force).of_robot(&experiment.robot.name);
        guard.folder(directory, report::files())?;
    }
    let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
    let mut progress = Progress::new();
    let results = experiment.run(data, &mut |stage| progress.show(stage))?;
    drop(progress);
    show(&results, published.as_ref(), output, &Remark { note: "", apply })
}

fn predict_torques(request: &Predict) -> Result<Ending, Box<dyn Error>> {
    if let Some(path) = &request.out {
        let inputs = [&request.results, &request.recording].into_iter().chain(&request.torque_file).cloned();
        OutputGuard::new(inputs, request.force.force).file(path, FileKind::Prediction)?;
    }
    let prediction = predict(&PredictionRequest {
        results: request.results.clone(),
        recording: request.recording.clone(),
        torque_file: request.torque_file.clone(),
        position: request.columns.position.clone(),
        torque: request.columns.torque.clone(),
        time: request.columns.time.clone(),
        time_unit: request.columns.time_unit,
        window_s: request.window_s.as_ref().map(|w| [w[0], w[1]]),
        case: request.case.clone(),
        method: request.method,
    })?;
    print(&report::prediction_text(&prediction, width()))?;
    if let Some(path) = &request.out {
        report::write_prediction(&prediction, path)?;
        print(&format!("\nwritten: {}\n", path.display()))?;
    }
    Ok(Ending::of(Some(prediction.verdict)))
}

fn sweep_errors(sensitivity: &Sensitivity) -> Result<Ending, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&sensitivity.described)?;
    if let Some(directory) = &sensitivity.out {
        let guard = OutputGuard::new(experiment.input_files(&data), sensitivity.force.force);
        guard.folder(directory, report::SENSITIVITY_FILES)?;
    }
    let threads = threads(sensitivity.threads);
    let counter = Mutex::new(Counter::new("estimations"));
    let report_progress = |done: usize, of: usize| {
        counter.lock().unwrap_or_else(PoisonError::into_inner).show(done, of, String::new());
    };
    let found = experiment.sensitivity(&data, threads, &report_progress)?;
    drop(counter);
    print(&report::sensitivity_text(&found, width()))?;
    if let Some(directory) = &sensitivity.out {
        let files = report::write_sensitivity(&found, directory)?;
        let names: String = files.iter().map(|f| format!("  {}\n", f.display())).collect();
        print(&format!("\nwritten:\n{names}"))?;
    }
    Ok(Ending::Good)
}

fn record_twin(simulate: &Simulate) -> Result<Ending, Box<dyn Error>> {
    let experiment = Experiment::read(&simulate.experiment, Path::new(""))?;
    OutputGuard::new(experiment.input_files(Path::new("")), simulate.force.force)
        .file(&simulate.out, FileKind::Recording)?;
    let recording = experiment.record_twin()?;
    report::write_recording(&recording, &simulate.out)?;
    let (samples, rate) = (recording.position.len(), recording.sample_rate_hz);
    print(&format!(
        "{samples} samples at {rate} Hz of {} joints: time_s, position_1 ..., torque_1 ... (rad and N m, or m and N)\n\
         written: {}\n",
        recording.joints.len(),
        simulate.out.display()
    ))?;
    Ok(Ending::Good)
}

fn show_model(request: &Model) -> Result<Ending, Box<dyn Error>> {
    let folder = request.data.clone().unwrap_or_default();
    let mut xacro = XacroOptions::default();
    request.xacro_arg.iter().try_for_each(|text| xacro.add_argument(text))?;
    request.package.iter().try_for_each(|text| xacro.add_package(text))?;
    let path = folder.join(&request.robot);
    let source = RobotSource::read_with_xacro(&path, &xacro)?;
    if let Some(out) = &request.expand {
        OutputGuard::new(source.paths().iter().cloned(), request.force.force).file(out, FileKind::Unmarked)?;
        replace_file(out, source.to_text().as_bytes())
            .map_err(|e| format!("{}: cannot be written: {e}", out.display()))?;
        print(&format!("written: {}\n", out.display()))?;
        return Ok(Ending::Good);
    }
    let locks = Locks { locked: request.lock.iter().cloned().collect(), until: request.until.clone() };
    let robot = source.robot_with_locks(&locks, Path::new("the command line"))?;
    if request.symbolic {
        print(&BaseFormulas::of(&robot)?.to_string())?;
        return Ok(Ending::Good);
    }
    let summary = RobotSummary::new(&source, &robot);
    print(&if request.json { report::model_json(&summary)? } else { report::model_text(&summary, width()) })?;
    Ok(if summary.problem.is_none() { Ending::Good } else { Ending::NotTrusted })
}
