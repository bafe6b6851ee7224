//! CLIE and CLOE on recorded data: EMPS against `shared/reference/emps_closed_loop.json`, another program's Gauss-Newton on the
//! same loop, and the TX40 with its gear ratios at 90 % in the simulator.

use libtest_mimic::{Failed, Trial};
use thetahat::{Experiment, Method, Results, identification::Status, preparation::LoopParameter, results::RunResult};
use thetahat_testing::{data, each_night, ensure, root, shared};

/// Relative; the reference program integrates with other steps.
const TOLERANCE: f64 = 1e-6;

fn experiment(name: &str) -> Experiment {
    Experiment::read(&root().join("experiments").join(name), &data()).unwrap()
}

fn run(experiment: &Experiment) -> Results {
    experiment.run(&data(), &mut |_| {}).unwrap()
}

fn golden() -> Result<serde_json::Value, Failed> {
    Ok(serde_json::from_str(&std::fs::read_to_string(shared().join("reference/emps_closed_loop.json"))?)?)
}

/// Estimates, deviations and relative error of a run are those of the reference.
fn ensure_golden(run: &RunResult, golden: &serde_json::Value) -> Result<(), Failed> {
    ensure(run.status == Status::Converged, format!("{}: {:?}", run.method, run.reason))?;
    let relative_error = run.relative_error_percent.ok_or("an error")?;
    let close = |found: f64, expected: &serde_json::Value, what: &str| {
        let expected = expected.as_f64().ok_or("a number")?;
        println!("{} {} {what}: {found} against {expected}, {:.1e}", run.case, run.method, found / expected - 1.0);
        ensure((found / expected - 1.0).abs() < TOLERANCE, format!("{what}: {found} against {expected}"))
    };
    for (i, parameter) in run.parameters.iter().enumerate() {
        close(parameter.estimate, &golden["theta"][i], &parameter.name)?;
        close(parameter.standard_deviation.ok_or("a deviation")?, &golden["sd"][i], "its deviation")?;
    }
    close(relative_error, &golden["rel"], "relative error")
}

/// The estimates at one scale of the velocities of the friction's transition.
fn emps_is_that_of_the_reference_program(scale: &str) -> Result<(), Failed> {
    let (golden, case) = (golden()?, format!("scale_{scale}"));
    let mut experiment = experiment("emps_prediction_error.toml");
    experiment.settings.cases.retain(|own| own.name == case);
    let results = run(&experiment);
    for method in [Method::CLIE, Method::CLOE] {
        let run = results.run(&case, method).ok_or("a run")?;
        ensure_golden(run, &golden[&format!("{method}_{scale}")])?;
    }
    Ok(())
}

/// CLOE does not look at torques: without them its numbers are the same.
fn positions_alone_give_the_same_numbers() -> Result<(), Failed> {
    let mut experiment = experiment("emps_prediction_error.toml");
    experiment.file.recording[0].torque = None;
    experiment.settings.estimation.methods = vec![Method::CLOE];
    experiment.settings.cases.clear();
    let results = run(&experiment);
    let run = results.run("nominal", Method::CLOE).ok_or("a run")?;
    ensure_golden(run, &golden()?["cloe_0.01"])
}

fn other_methods_need_torques() -> Result<(), Failed> {
    let mut experiment = experiment("emps_prediction_error.toml");
    experiment.file.recording[0].torque = None;
    let message = experiment.run(&data(), &mut |_| {}).map(|_| ()).unwrap_err().to_string();
    ensure(message.contains("no torque is recorded") && message.contains("idim-ls"), message)
}

/// The simulated torque of CLIE is nearer to the record than that of DIDIM, whose sensitivities are approximations; an unknown
/// gear ratio takes up the 10 % that the simulator was given, and the estimates are those without them.
fn the_tx40_with_an_unknown_gear_ratio() -> Result<(), Failed> {
    let mut experiment = experiment("tx40_paper.toml");
    experiment.settings.estimation.methods = vec![Method::DIDIM, Method::CLIE];
    experiment.settings.estimation.weighting.clear();
    let fixed = run(&experiment);
    let torque = |run: &RunResult| run.simulation_relative_error_percent.as_ref().map(|e| e["torque"]);
    for case in ["nominal", "gear_ratio_0.9"] {
        let [didim, clie] = [Method::DIDIM, Method::CLIE].map(|m| fixed.run(case, m).unwrap());
        ensure(clie.status == Status::Converged, format!("{case}: {:?}", clie.reason))?;
        println!("{case}: torque of DIDIM {:?} %, CLIE {:?} %", torque(didim), torque(clie));
        ensure(torque(clie) < torque(didim), format!("{case}: the simulated torque of CLIE is worse"))?;
    }
    experiment.settings.estimation.methods = vec![Method::CLIE];
    experiment.settings.estimation.loop_parameters = vec![LoopParameter::GearRatio];
    let free = run(&experiment);
    let [nominal, biased] = ["nominal", "gear_ratio_0.9"].map(|case| free.run(case, Method::CLIE).unwrap());
    let ratio = |run: &RunResult| run.loop_parameters[0].estimate;
    let (product, deviation) = (0.9 * ratio(biased), nominal.loop_parameters[0].standard_deviation);
    println!("gear ratio {} nominal, 0.9 x {} = {product}", ratio(nominal), ratio(biased));
    ensure(biased.status == Status::Converged, format!("{:?}", biased.reason))?;
    ensure((product - ratio(nominal)).abs() < deviation, "the gear ratio does not take up the bias")?;
    for (a, b) in nominal.parameters.iter().zip(&biased.parameters) {
        let deviation = a.standard_deviation.ok_or("a deviation")?;
        let change = (a.estimate - b.estimate).abs() / deviation;
        ensure(change < 1.0, format!("{}: {change} standard deviations from the nominal case", a.name))?;
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    const DATA: [&str; 3] = ["reference/emps_closed_loop.json", "datasets/emps", "datasets/tx40"];
    let mut trials = thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("emps_is_that_of_the_reference_program", || emps_is_that_of_the_reference_program("0.01")),
            ("other_methods_need_torques", other_methods_need_torques),
        ],
    );
    trials.extend(each_night(thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("emps_with_friction_that_sets_in_faster", || emps_is_that_of_the_reference_program("0.002")),
            ("positions_alone_give_the_same_numbers", positions_alone_give_the_same_numbers),
            ("the_tx40_with_an_unknown_gear_ratio", the_tx40_with_an_unknown_gear_ratio),
        ],
    )));
    trials
}
