//! The stages of an identification of the TX40 recording, compared with a baseline in Python.

use std::{error::Error, path::Path};

use thetahat::{
    Experiment,
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    identification::{Assembly, idim_ls},
    recording::read_channels,
    regression::{Regression, RowLayout},
    signal::{Decimator, Padding, SecondOrderSections, central_difference, zero_phase},
    simulation::{ClosedLoop, OutputGrid, Reference, SimulatorBias},
};
use thetahat_estimation::{
    identification::Divisor,
    simulation::{Job, simulate_all},
    trajectory::reconstruct,
};

use super::{fastest, peers::Peers, table::Row};

/// Runs of each stage, of which the fastest counts.
const RUNS: usize = 7;

/// Loading, identification and simulation; the last at equal numbers of right-hand sides, and as a whole.
pub fn rows(data: &Path, peers: &Peers) -> Result<Vec<Row>, Box<dyn Error>> {
    let ours = our_stages(data)?;
    let simulation = peers.stages(&["closed-loop simulation (RK45)"]);
    let slopes = peers.stages(&["right-hand sides evaluated"]);
    let per_slope = simulation.zip(slopes).map(|(seconds, count)| seconds / count);
    let identification = peers.stages(&["band-pass", "regressor", "decimate", "least squares"]);
    Ok(vec![
        Row::ratio("loading", ours.loading, peers.stages(&["load"]), 1.0),
        Row::ratio("LS identification after loading", ours.identification, identification, 40.0),
        Row::ratio("closed-loop simulation, per right-hand side", ours.simulation / ours.slopes, per_slope, 40.0),
        Row::ratio("the same of four side by side", ours.of_four, per_slope, 40.0),
        Row::ratio("closed-loop simulation, as it is", ours.simulation, simulation, 1.0),
    ])
}

struct Stages {
    loading: f64,
    identification: f64,
    simulation: f64,
    /// A right-hand side of four simulations side by side.
    of_four: f64,
    /// Right-hand sides of the simulation.
    slopes: f64,
}

fn our_stages(data: &Path) -> Result<Stages, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/tx40_paper.toml");
    let experiment = Experiment::read(&root, Path::new(""))?;
    let recording = experiment.file.recording.first().ok_or("no recording")?;
    let transmission = &experiment.robot.transmission;
    let (loading, (q, tau)) = fastest(RUNS, || {
        let position = transmission.joint_positions(&read_channels(&recording.position, data)?);
        let torque = recording.torque.as_ref().ok_or("the recording has no torque")?;
        Ok((position, transmission.joint_torques(&read_channels(torque, data)?)))
    })?;
    let rate = 5000.0;
    let window = 300..37_100;
    let model = Model::new(&experiment.robot);
    let base = BaseParameters::of(&model, &experiment.settings.parameters.exclude)?;
    let assembly = Assembly::new(&model, &base.columns(), Decimator::new(100, window.len())?);
    let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, rate)?;
    let (identification, (dq, fit)) = fastest(RUNS, || {
        let qf = zero_phase(&filter, &q, Padding::Matlab)?;
        let dq = central_difference(&qf, rate);
        let ddq = central_difference(&dq, rate);
        let cut = |s: &thetahat::Series| s.window(window.clone());
        let x = assembly.observation_matrix(&cut(&qf), &cut(&dq), &cut(&ddq), Sign::Exact)?;
        let y = assembly.measurement_vector(&cut(&tau))?;
        let regression = Regression::new(x, y, RowLayout::new(model.coordinate_count(), &[assembly.rows_per_joint()]));
        Ok((dq, idim_ls(&regression, Divisor::default())?))
    })?;
    let reference = Reference::Moves(reconstruct(&q, &dq, rate)?.moves);
    let closed_loop = ClosedLoop {
        model: &model,
        transmission,
        controller: experiment.settings.controller.as_ref().ok_or("no controller")?,
        reference: &reference,
        added_signal: None,
        channels: None,
        bias: SimulatorBias::NONE,
        solver: experiment.settings.simulation.solver,
        sign_velocity_scale: experiment.settings.simulation.sign_velocity_scale,
    };
    let theta = base.to_standard(&fit.theta);
    let inertia = closed_loop.motor_inertia(&theta, 7.42);
    let grid = OutputGrid { start_s: 0.06, sample_rate_hz: rate, samples: window.len() };
    let (simulation, motion) = fastest(RUNS, || Ok(closed_loop.simulate(&theta, &inertia, &grid)?))?;
    let biases = [1.0, 0.99, 0.98, 0.97].map(|gear_ratio| SimulatorBias { gear_ratio, ..SimulatorBias::NONE });
    let job =
        |bias| Job { closed_loop: ClosedLoop { bias, ..closed_loop }, theta: &theta, motor_inertia: &inertia, grid };
    let (four, motions) = fastest(RUNS, || Ok(simulate_all(&biases.map(job))))?;
    let motions = motions.into_iter().collect::<Result<Vec<_>, _>>()?;
    let slopes_of_four: usize = motions.iter().map(|m| m.counts.evaluations).sum();
    eprintln!("LS relative error {:.4} %; simulation {:?}", fit.relative_error_percent, motion.counts);
    Ok(Stages {
        loading,
        identification,
        simulation,
        of_four: four / slopes_of_four as f64,
        slopes: motion.counts.evaluations as f64,
    })
}
