//! EMPS against the figures that its authors print (A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of
//! EMPS", 2019), digit by digit.

use std::{collections::BTreeMap, sync::OnceLock};

use libtest_mimic::{Failed, Trial};
use thetahat::{
    ControllerDescription, Experiment, Method, Results, Robot,
    dynamics::Model,
    identification::Status,
    recording::{ChannelSource, read_channels},
    results::RunResult,
    simulation::{
        ClosedLoop, OutputGrid, Reference, SampledReference, SensitiveTo, Sensitivities, SimulatorBias, Solver,
    },
};
use thetahat_estimation::simulation::Job;
use thetahat_testing::{ensure, ensure_printed};

fn results() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| {
        let experiment =
            Experiment::read(&thetahat_testing::root().join("experiments/emps.toml"), &thetahat_testing::data())
                .unwrap();
        experiment.run(&thetahat_testing::data(), &mut |_| {}).unwrap()
    })
}

fn run(case: &str, method: Method) -> &'static RunResult {
    results().run(case, method).unwrap()
}

fn estimate(run: &RunResult, name: &str) -> f64 {
    run.parameter(name).unwrap().estimate
}

fn least_squares() -> Result<(), Failed> {
    let run = run("nominal", Method::IDIM_LS);
    let printed = [
        ("m1r", "95.1089", "0.1085"),
        ("fv1", "203.5034", "1.1460"),
        ("fc1", "20.3935", "0.1012"),
        ("off1", "-3.1648", "0.0444"),
    ];
    for (name, value, deviation) in printed {
        ensure_printed(estimate(run, name), value, name)?;
        ensure_printed(run.parameter(name).unwrap().standard_deviation.unwrap(), deviation, name)?;
    }
    ensure_printed(run.condition_number.unwrap(), "25.9883", "condition number")?;
    ensure_printed(run.relative_error_percent.unwrap(), "4.0834", "relative error")
}

fn cross_validation() -> Result<(), Failed> {
    let run = run("nominal", Method::IDIM_LS);
    ensure_printed(run.cross_validation_relative_error_percent.unwrap(), "5.9824", "relative error on the pulses")?;
    ensure_printed(run.validation_condition_number.unwrap(), "26.0217", "condition number on the pulses")
}

fn asymmetric_friction() -> Result<(), Failed> {
    let run = run("asymmetric", Method::IDIM_LS);
    let printed =
        [("m1r", "95.1540"), ("fvp1", "166.7061"), ("fcp1r", "20.1440"), ("fvn1", "240.4236"), ("fcn1r", "20.6277")];
    for (name, value) in printed {
        ensure_printed(estimate(run, name), value, name)?;
    }
    ensure_printed(run.condition_number.unwrap(), "26.0197", "condition number")?;
    ensure_printed(run.relative_error_percent.unwrap(), "3.1117", "relative error")
}

/// At or below the published closed-loop errors, with 2 % of their value allowed.
fn assert_simulation(errors: &BTreeMap<String, f64>, published: [f64; 3]) -> Result<(), Failed> {
    for (name, limit) in ["velocity", "acceleration", "torque"].into_iter().zip(published) {
        ensure(errors[name] <= 1.02 * limit, format!("{name}: {} above the published {limit}", errors[name]))?;
    }
    Ok(())
}

fn closed_loop() -> Result<(), Failed> {
    let run = run("nominal", Method::IDIM_LS);
    assert_simulation(run.simulation_relative_error_percent.as_ref().unwrap(), [0.22911, 8.6036, 5.848])?;
    let pulses = run.validation_simulation_relative_error_percent.as_ref().unwrap();
    assert_simulation(pulses, [0.47888, 19.8152, 8.9409])
}

fn iv_and_didim() -> Result<(), Failed> {
    let ls = run("nominal", Method::IDIM_LS).parameter("m1r").unwrap();
    for method in [Method::IDIM_IV, Method::DIDIM] {
        let run = run("nominal", method);
        ensure(run.status == Status::Converged, format!("{method:?}: {:?}", run.status))?;
        let distance = (estimate(run, "m1r") - ls.estimate).abs() / ls.standard_deviation.unwrap();
        ensure(distance <= 3.0, format!("{method:?}: M is {distance:.2} standard deviations from LS"))?;
    }
    Ok(())
}

/// The columns of the force's sensitivities, samples 49 to the end, at the authors' LS values: `emps_closed_loop.json`.
fn sensitivities() -> Result<(), Failed> {
    let golden = std::fs::read_to_string(thetahat_testing::shared().join("reference/emps_closed_loop.json"))?;
    let golden: serde_json::Value = serde_json::from_str(&golden)?;
    let robot = Robot::read(&thetahat_testing::root().join("robots/emps.toml"))?;
    let model = Model::new(&robot);
    let controller: ControllerDescription = toml::from_str(
        "law = \"cascaded\"\nposition_gain = [160.18]\nvelocity_gain = [243.45]\nsaturation = [10]\n\
         sample_time_s = 0.001\nvelocity = \"averaged-difference\"",
    )?;
    let source: ChannelSource = toml::from_str("file = \"emps/DATA_EMPS.mat\"\ncolumns = [\"qg\"]\nunit = \"m\"")?;
    let reference = read_channels(&source, &thetahat_testing::data())?;
    let grid = OutputGrid { start_s: 0.0, sample_rate_hz: 1000.0, samples: reference.len() };
    let reference = Reference::Sampled(SampledReference::new(reference, 1000.0));
    let table = model.parameter_table();
    let mut theta = vec![0.0; table.len()];
    let mut to = Vec::new();
    for (name, value) in [("m1", 95.1089), ("fv1", 203.5034), ("fc1", 20.3935), ("off1", -3.1648)] {
        let index = table.index_of(name).ok_or(name)?;
        theta[index] = value;
        to.push(SensitiveTo::Parameter(index));
    }
    for scale in [0.01, 0.002] {
        let closed_loop = ClosedLoop {
            model: &model,
            transmission: &robot.transmission,
            controller: &controller,
            reference: &reference,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver: Solver::Fixed { step_s: 1e-3 / 16.0 },
            sign_velocity_scale: scale,
        };
        let job = Job { closed_loop, theta: &theta, motor_inertia: &[1.0], grid };
        let mut simulation = Sensitivities::new(&job, &to, None)?;
        let (mut squares, mut k) = ([0.0; 4], 0);
        while let Some(sample) = simulation.next_sample()? {
            if k >= 49 {
                squares.iter_mut().zip(sample.tau_slopes).for_each(|(sum, slope)| *sum += slope * slope);
            }
            k += 1;
        }
        let expected = &golden[&format!("sens_{scale}")]["columns_norm"];
        for (column, square) in squares.iter().enumerate() {
            let (found, expected) = (f64::sqrt(*square), expected[column].as_f64().ok_or("a number")?);
            let error = (found / expected - 1.0).abs();
            println!("{scale} {column}: {found} against {expected}, {error:.1e}");
            ensure(error < 1e-6, format!("scale {scale}, column {column}: {found} against {expected}"))?;
        }
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::trials_on_shared_data(
        &["reference/emps_closed_loop.json", "datasets/emps"],
        vec![
            ("least_squares_meets_every_printed_digit", least_squares),
            ("cross_validation_on_the_pulses_meets_every_printed_digit", cross_validation),
            ("asymmetric_friction_meets_every_printed_digit", asymmetric_friction),
            ("closed_loop_errors_are_at_or_below_the_published_ones", closed_loop),
            ("iv_and_didim_find_the_mass_of_ls", iv_and_didim),
            ("sensitivities_are_those_of_the_reference_program", sensitivities),
        ],
    )
}
