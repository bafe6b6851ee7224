//! Designs for the Staubli TX40: moves against those of its record, and predicts against a Monte Carlo of its twin.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use thetahat::{
    Experiment, Robot, Series,
    base_parameters::BaseParameters,
    design::{Criterion, Design, ExpectedRecording, Information},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    trajectory::Moves,
};
use thetahat_estimation::trajectory::reconstruct;
use thetahat_testing::{Folder, ensure, project, shared};

const JOINTS: usize = 6;
/// Samples per second of the record, and of the criterion.
const RECORD_HZ: f64 = 5000.0;
const RATE_HZ: f64 = 1000.0;
/// The duration of the record's motion, s.
const DURATION_S: f64 = 7.4;
/// Friction as it is identified from the record: of every joint viscous and dry, and those of motor 6 that turns with joint 5.
const FRICTION: &str = "fv1 = 8.11\nfv2 = 5.6\nfv3 = 1.99\nfv4 = 1.1\nfv5 = 1.85\nfv6 = 0.655\nfc1 = 6.93\nfc2 = 8.04\nfc3 = 6.26\n\
    fc4 = 2.51\nfc5 = 3.05\nfc6 = 2.2\nfvm6 = 0.61\nfcm6 = 1.7\niam6 = 0.01\n";
/// Standard deviations of the torques' error that the record has, N m.
const NOISE: [f64; JOINTS] = [1.607, 1.578, 1.047, 0.474, 1.001, 0.515];

/// The robot with friction, in a folder.
fn robot(folder: &Folder) -> Result<Robot, Failed> {
    let text = std::fs::read_to_string(project("robots/tx40.toml"))?;
    folder.write("tx40.toml", text + FRICTION);
    Ok(Robot::read(&folder.path().join("tx40.toml"))?)
}

/// The moves that the record is made of, from time zero.
fn moves_of_the_record(robot: &Robot) -> Result<Moves, Failed> {
    let mut reader = csv::Reader::from_path(shared().join("datasets/tx40/pos_read_data.csv"))?;
    let mut values = Vec::new();
    for row in reader.records() {
        for cell in &row? {
            values.push(cell.trim().parse()?);
        }
    }
    let q = robot.transmission.joint_positions(&Series::shaped(JOINTS, values));
    Ok(reconstruct(&q, &velocity(&q), RECORD_HZ)?.moves)
}

/// Central differences of positions that are smoothed twice over 51 samples.
fn velocity(position: &Series) -> Series {
    let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
    let smoothed = |x: &[f64]| -> Vec<f64> {
        (0..x.len()).map(|k| mean(&x[k.saturating_sub(25)..(k + 26).min(x.len())])).collect()
    };
    let channel = |j: usize| {
        let x = smoothed(&smoothed(&position.channel(j)));
        let last = x.len() - 1;
        (0..x.len()).map(|k| (x[(k + 1).min(last)] - x[k.saturating_sub(1)]) * RECORD_HZ / 2.0).collect()
    };
    Series::side_by_side(&(0..JOINTS).map(channel).collect::<Vec<_>>())
}

/// Smallest and largest value of each joint.
fn ranges(series: &Series) -> Vec<[f64; 2]> {
    let of = |j: usize| [f64::min, f64::max].map(|better| series.channel(j).into_iter().reduce(better).unwrap_or(0.0));
    (0..JOINTS).map(of).collect()
}

fn largest(series: &Series) -> Vec<f64> {
    ranges(series).iter().map(|[low, high]| low.abs().max(high.abs())).collect()
}

fn torques(robot: &Robot, [q, dq, ddq]: [&Series; 3]) -> Series {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let (mut tau, mut workspace) = (Series::zeros(q.len(), JOINTS), Workspace::new(&model));
    for k in 0..q.len() {
        let state = State::new(q.sample(k), dq.sample(k));
        model.inverse_dynamics(&parameters, state, ddq.sample(k), Sign::Exact, &mut workspace, tau.sample_mut(k));
    }
    tau
}

/// The best moves within what the record's own moves reach of position, velocity, acceleration and torque, as smooth as the
/// least smooth of them: how much smaller the deviations are.
fn thirteen_moves() -> Result<(), Failed> {
    let folder = Folder::new();
    let robot = robot(&folder)?;
    let record = moves_of_the_record(&robot)?;
    ensure(record.moves().len() == 13, format!("{} moves", record.moves().len()))?;
    let first = (record.start_s() * RATE_HZ) as usize;
    let all = record.sample(RATE_HZ, first + (DURATION_S * RATE_HZ) as usize);
    let [q, dq, ddq] = [&all.q, &all.dq, &all.ddq].map(|s| s.window(first..s.len()));
    let smoothing_s = record.moves().iter().map(|m| m.law.t3_s).fold(f64::INFINITY, f64::min);
    let degrees = |values: Vec<f64>| values.iter().map(|v| v.to_degrees()).collect::<Vec<_>>();
    let position: Vec<[f64; 2]> = ranges(&q).iter().map(|range| range.map(f64::to_degrees)).collect();
    let text = format!(
        "title = 'moves'\nrobot = 'tx40.toml'\nduration_s = {DURATION_S}\nsample_rate_hz = {RATE_HZ}\n[motion]\nkind = 'moves'\n\
         moves = 13\nsmoothing_s = {smoothing_s}\nstarts = 6\n[limits]\nmargin = 0.002\nposition = {position:?}\nvelocity = {:?}\n\
         acceleration = {:?}\ntorque = {:?}\n[noise]\ntorque = {NOISE:?}\n[signal]\ncutoff_hz = 50\ndecimation = 20\n\
         [uncertainty]\novershoot_percent = 0\n",
        degrees(largest(&dq)),
        degrees(largest(&ddq)),
        largest(&torques(&robot, [&q, &dq, &ddq])),
    );
    let design = Design::parse(&text, &folder.path().join("design.toml"))?;
    let began = std::time::Instant::now();
    let results = design.run(2)?;
    let seconds = began.elapsed().as_secs_f64();
    let model = Model::new(&robot);
    let base = BaseParameters::of(&model, &[])?;
    let information = Information::new(&model, &base.columns(), &NOISE);
    let value = |motion: [&Series; 3]| -> Result<f64, Failed> {
        Criterion::D.value(&information.of(motion, 1.0, Sign::Exact)).ok_or_else(|| "shows too little".into())
    };
    let (before, found) = (value([&q, &dq, &ddq])?, value([&results.q, &results.dq, &results.ddq])?);
    let times = (0.5 * (before - found) / base.len() as f64).exp();
    println!(
        "smoothing {:.1} ms; record {before:.2}, found {found:.2} nats: deviations of {} parameters {times:.2} times smaller; {seconds:.1} s; searches {:?}",
        1e3 * smoothing_s,
        base.len(),
        results.starts
    );
    for (name, found, of_record) in [
        ("position", &results.q, &q),
        ("velocity", &results.dq, &dq),
        ("acceleration", &results.ddq, &ddq),
        ("torque", &results.torque, &torques(&robot, [&q, &dq, &ddq])),
    ] {
        let within = |(found, of_record): (&[f64; 2], &[f64; 2])| {
            let largest = of_record[0].abs().max(of_record[1].abs());
            let range = if name == "position" { *of_record } else { [-largest, largest] };
            found[0] >= range[0] && found[1] <= range[1]
        };
        let (found, of_record) = (ranges(found), ranges(of_record));
        ensure(found.iter().zip(&of_record).all(within), format!("{name}: {found:?} {of_record:?}"))?;
    }
    ensure(results.moves.as_ref().is_some_and(|m| m.moves().len() == 13), "13 moves")?;
    ensure(times > 1.2, format!("deviations {times} times smaller"))
}

/// Records of the Monte Carlo: the deviation of each estimate is then known to 5 %.
const RECORDS: u64 = 200;

/// The design of a Fourier series whose record the twin makes in the closed loop, tracking errors included.
fn predict() -> String {
    format!(
        "title = 'prediction'\nrobot = 'tx40.toml'\nduration_s = 8\nsample_rate_hz = {RATE_HZ}\n[motion]\nstarts = 2\n[limits]\n\
         position = [[-170, 170], [-120, 120], [-130, 130], [-260, 260], [-115, 130], [-260, 260]]\n\
         velocity = [280, 280, 420, 400, 310, 690]\nacceleration = [860, 860, 1150, 1430, 1430, 2290]\n\
         [noise]\ntorque = {NOISE:?}\n[signal]\ncutoff_hz = 50\ndecimation = 20\n[controller]\nlaw = 'pd'\n\
         bandwidth_hz = [10]\ndamping = 1.0\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0\n"
    )
}

/// The deviations of estimates from many records of the closed loop are those that were predicted: within 15 % for 95 % of the
/// parameters.
fn the_promise_is_kept() -> Result<(), Failed> {
    let folder = Folder::new();
    robot(&folder)?;
    let design = Design::parse(&predict(), &folder.path().join("design.toml"))?;
    let results = design.run(2)?;
    let out = folder.path().join("out");
    thetahat_report::report::write_design(&results, &out)?;
    let experiment = Experiment::read(&out.join("rehearsal.toml"), Path::new(""))?;
    let twin = experiment.file.twin.as_ref().ok_or("no twin")?;
    let motion = experiment.twin_motion(twin)?.motion;
    let record = ExpectedRecording {
        robot: &design.robot,
        settings: &design.settings,
        sample_rate_hz: RATE_HZ,
        q: &motion.q,
        tau: &motion.tau,
        torque_noise: &NOISE,
        torque_spectrum: None,
        position_noise: &[0.0; JOINTS],
    };
    let estimates: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let half = |numbers: std::ops::Range<u64>| {
            let record = &record;
            scope.spawn(move || {
                numbers
                    .map(|k| record.estimate(Path::new(""), 99, k).map(|e| e.fit.theta).map_err(Box::new))
                    .collect::<Result<Vec<_>, _>>()
            })
        };
        let halves = [half(0..RECORDS / 2), half(RECORDS / 2..RECORDS)];
        halves.into_iter().map(|h| h.join().unwrap_or_else(|_| Ok(Vec::new()))).collect::<Result<Vec<_>, _>>()
    })?
    .concat();
    let n = RECORDS as f64;
    ensure(estimates.len() as u64 == RECORDS, format!("{} estimates", estimates.len()))?;
    let mut ratios = Vec::new();
    for (i, predicted) in results.predicted.iter().enumerate() {
        let mean = estimates.iter().map(|e| e[i]).sum::<f64>() / n;
        let found = (estimates.iter().map(|e| (e[i] - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        ratios.push(found / predicted.standard_deviation);
    }
    let kept = ratios.iter().filter(|ratio| (*ratio - 1.0).abs() < 0.15).count();
    let [least, most] = [f64::min, f64::max].map(|better| ratios.iter().copied().reduce(better).unwrap_or(f64::NAN));
    println!(
        "{kept} of {} parameters within 15 %; found over predicted from {least:.3} to {most:.3}, mean {:.3}",
        ratios.len(),
        ratios.iter().sum::<f64>() / ratios.len() as f64
    );
    ensure(kept as f64 >= 0.95 * ratios.len() as f64, format!("{ratios:?}"))
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::slow_trials(
        &["datasets/tx40"],
        vec![("thirteen_moves", thirteen_moves), ("the_promise_is_kept", the_promise_is_kept)],
    )
}
