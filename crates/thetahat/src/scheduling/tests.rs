//! A twin of two legs: simulated apart and as a whole.

use std::path::Path;

use super::{
    EstimationJob,
    simulator::{Output, Parameters},
};
use crate::{
    preparation::{Case, LoopParameter, Recording, Settings},
    run::Identification,
};
use thetahat_estimation::{
    identification::{Method, Response},
    simulation::Solver,
};
use thetahat_ground::series::Series;
use thetahat_model::robot::Robot;

const RATE_HZ: f64 = 200.0;

/// Two legs of two joints each, whose joints are numbered leg by leg.
fn legs() -> Robot {
    let link = |name: &str, mass: f64| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.02 0.01 -0.1'/><mass value='{mass}'/>\
             <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.012' iyz='0' izz='0.004'/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, axis: &str, origin: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><axis xyz='{axis}'/>\
             <origin xyz='{origin}'/><limit lower='-2' upper='2' effort='40' velocity='20'/></joint>"
        )
    };
    let mut text = "<robot name='legs'><link name='base'/>".to_owned();
    for (side, mass) in [("left", 1.5), ("right", 1.1)] {
        let [hip, shank] = ["hip", "shank"].map(|part| format!("{side} {part}"));
        text += &(link(&hip, mass) + &link(&shank, 0.4 * mass));
        text += &joint(&format!("{hip} joint"), "base", &hip, "1 0 0", "0 0.1 0");
        text += &joint(&format!("{side} knee"), &hip, &shank, "0 1 0", "0 0 -0.25");
    }
    Robot::parse(&(text + "</robot>"), Path::new("legs.urdf")).unwrap()
}

fn recording() -> Recording {
    let wave = |k: usize, j: usize, late: f64| {
        let t = k as f64 / RATE_HZ - late;
        0.4 * (5.0 * t + 1.3 * j as f64).sin() + 0.1 * ((11.0 + j as f64) * t).cos()
    };
    let series = |late: f64| Series::shaped(4, (0..600 * 4).map(|i| wave(i / 4, i % 4, late)).collect());
    Recording { reference: Some(series(0.0)), ..Recording::without_torque(RATE_HZ, series(0.02)) }
}

fn identification(loop_parameters: &[LoopParameter]) -> Identification {
    let mut settings = Settings::new(30.0, 4).with_methods([Method::CLOE]);
    let controller = "law = 'pd'\nposition_gain = [30, 20, 25, 35]\nvelocity_gain = 1.5\nsaturation = 30";
    settings.controller = Some(toml::from_str(controller).unwrap());
    // Equal steps, so that only rounding differs between the whole and its parts.
    settings.simulation.solver = Solver::Fixed { step_s: 1e-3 };
    settings.simulation.sign_velocity_scale = 0.1;
    settings.estimation.loop_parameters = loop_parameters.to_vec();
    Identification::new(&legs(), vec![recording()], settings).unwrap()
}

/// The described robot with friction and rotors, and factors near one.
fn theta(job: &EstimationJob<'_>) -> Vec<f64> {
    let estimated = &job.problem.estimated;
    let table = job.problem.model.parameter_table();
    let of_robot = estimated.parameters().iter().zip(&job.start).map(|(p, start)| {
        start
            + match table.get(p.kept).quantity.name() {
                "ia" => 0.02,
                "fv" => 0.3,
                "fc" => 0.4,
                "off" => 0.05,
                _ => 0.0,
            }
    });
    of_robot.chain(job.names_of_loop().iter().map(|_| 0.03)).collect()
}

fn assert_close(parts: &[f64], whole: &[f64], what: &str) {
    let size = whole.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
    let worst = parts.iter().zip(whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(parts.len() == whole.len() && worst <= 1e-9 * size, "{what}: {worst:e} of {size:e}");
}

#[test]
fn responses_and_sensitivities_of_parts_are_those_of_the_whole() {
    let loop_parameters = [LoopParameter::VelocityGains, LoopParameter::DriveGain];
    let identification = identification(&loop_parameters);
    let problems = identification.problems(&mut |_| {}).unwrap();
    let job = |apart: bool| {
        let mut job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
        let simulator = job.simulator.as_mut().unwrap();
        assert_eq!(simulator.branches.len(), 2);
        if !apart {
            simulator.branches.clear();
        }
        job
    };
    let [parts, whole] = [job(true), job(false)];
    let parameters = Parameters::Fitted { theta: theta(&parts), tolerance: 1.0 };
    for response in [Response::Position, Response::Torque] {
        let [a, b] = [(&parts, 2), (&whole, 1)].map(|(job, threads)| {
            let simulator = job.simulator.as_ref().unwrap();
            simulator.response_with_sensitivities(&parameters, response, threads).unwrap()
        });
        assert_close(&a.response, &b.response, "response");
        for column in 0..a.sensitivities.columns() {
            let [a, b] = [&a, &b].map(|found| found.sensitivities.column(column));
            assert_close(a, b, &format!("column {column} of {response:?}"));
        }
    }
}

/// Equal steps of the explicit method: sensitivities are the derivatives of the response itself.
#[test]
fn sensitivities_of_parts_are_differences_of_responses() {
    let identification = identification(&[LoopParameter::PositionGain]);
    let problems = identification.problems(&mut |_| {}).unwrap();
    let job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
    let (simulator, at) = (job.simulator.as_ref().unwrap(), theta(&job));
    let found = |theta: &[f64]| {
        let parameters = Parameters::Fitted { theta: theta.to_vec(), tolerance: 1.0 };
        simulator.response_with_sensitivities(&parameters, Response::Position, 2).unwrap()
    };
    let exact = found(&at).sensitivities;
    for column in 0..at.len() {
        let h = 1e-5 * at[column].abs().max(0.01);
        let [after, before] = [h, -h].map(|by| {
            let mut theta = at.clone();
            theta[column] += by;
            found(&theta).response
        });
        let differences = after.iter().zip(&before).map(|(a, b)| (a - b) / (2.0 * h));
        let size = exact.column(column).iter().fold(1e-3_f64, |size, v| size.max(v.abs()));
        let worst = differences.zip(exact.column(column)).map(|(d, e)| (d - e).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-5 * size, "column {column}: {worst:e} of {size:e}");
    }
}

/// In its own simulated motion the controller asks for the torques that were simulated.
#[test]
fn commanded_torques_of_a_simulated_motion_are_its_torques() {
    let identification = identification(&[]);
    let problems = identification.problems(&mut |_| {}).unwrap();
    let job = identification.job(&problems[0], &Case::nominal(), Method::CLOE);
    assert!(job.commanded.is_some());
    let simulator = job.simulator.as_ref().unwrap();
    let resolved = simulator.resolve(&Parameters::Fitted { theta: theta(&job), tolerance: 1.0 });
    let simulation = simulator.jobs(&resolved, Output::Motion { step: 1 })[0];
    let motion = simulation.closed_loop.simulate(simulation.theta, simulation.motor_inertia, &simulation.grid).unwrap();
    let commanded = simulation.commanded_torques(&motion.q, &motion.dq);
    assert_close(commanded.values(), motion.tau.values(), "torques");
}
