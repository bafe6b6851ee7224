//! What noise of the recorded positions does to IV through the reference: the table of `docs/evidence/closed_loop.md`. Twins of a
//! two-joint arm make moves, a periodic motion, and one that is neither; IV follows the recorded reference, or what is made
//! of the recording.
//!
//! `cargo run --release --example studies -p thetahat -- reference_study experiments/two_joint.toml`

use std::{error::Error, f64::consts::TAU, path::Path};

use thetahat::{
    ControllerDescription, Experiment, Identification, Method, Recording, Results, Robot, Series, Settings,
    dynamics::Model,
    results::RunResult,
    signal::{Derivative, band_pass},
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatorBias, Solver},
};
use thetahat_estimation::simulation::{NoisySignals, RecordingNoise, SignalNoise, random_numbers};
use thetahat_estimation::{
    signal::smooth,
    simulation::{Job, simulate_all},
};

const RATE_HZ: f64 = 500.0;
const DURATION_S: f64 = 25.0;
const CUTOFF_HZ: f64 = 20.0;
/// Sign of the friction in rad/s, of twin and simulations.
const SCALE: f64 = 0.005;
const SEEDS: u64 = 10;
/// Standard deviation of the position noise, rad.
const NOISES: [f64; 2] = [2e-5, 5e-4];
/// Standard deviation of the torque noise, N m.
const TORQUE_NOISE: f64 = 0.1;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let path = super::arguments().next().ok_or("usage: reference_study EXPERIMENT")?;
    let experiment = Experiment::read(Path::new(&path), Path::new("."))?;
    let study = Study::new(&experiment)?;
    println!("| motion | IV follows | position noise rad | IV: bias, deviations: max | rms | LS: max | rms | failed |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let moves = experiment.file.twin.as_ref().ok_or("no twin")?;
    let moves =
        experiment.twin_motion(moves)?.reference.moves().ok_or("the twin follows no moves")?.sample(RATE_HZ, 1500).q;
    study.print("moves", moves, &[Follows::Recorded, Follows::Found, Follows::Filtered])?;
    let ways = [Follows::Recorded, Follows::Found, Follows::Smoothed, Follows::Filtered];
    study.print("periodic", motion(|h, _| 0.2 * h), &ways)?;
    study.print(
        "neither",
        motion(|h, j| 0.2 * h.powf(0.9 + 0.1 * j as f64)),
        &[Follows::Recorded, Follows::Found, Follows::Filtered],
    )?;
    Ok(())
}

/// What IV's simulations follow.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Follows {
    /// The true reference.
    Recorded,
    /// The reference that is found from the recording by default.
    Found,
    /// The recording, smoothed.
    Smoothed,
    /// The recording after the position filter.
    Filtered,
}

/// Five waves for each joint.
fn motion(frequency_hz: impl Fn(f64, usize) -> f64) -> Series {
    let wave = |t: f64, j: usize| -> f64 {
        let of = |h: f64| (TAU * frequency_hz(h, j) * t + h * h * (1.0 + j as f64)).sin();
        [1.0, 2.0, 3.0, 4.0, 5.0].iter().map(|h| 0.6 * of(*h) / h).sum()
    };
    let samples = (DURATION_S * RATE_HZ) as usize;
    let time = (0..samples).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [wave(t, 0), wave(t, 1)]).collect())
}

struct Study<'a> {
    robot: &'a Robot,
    model: Model,
    controller: ControllerDescription,
    settings: Settings,
}

impl<'a> Study<'a> {
    fn new(experiment: &'a Experiment) -> Result<Self, Box<dyn Error>> {
        let controller = experiment.settings.controller.clone().ok_or("no controller")?;
        let mut settings = experiment.settings.clone();
        settings.signal.cutoff_hz = CUTOFF_HZ;
        settings.cases.clear();
        settings.estimation.methods = vec![Method::IDIM_LS, Method::IDIM_IV];
        settings.simulation.sign_velocity_scale = SCALE;
        Ok(Self { robot: &experiment.robot, model: Model::new(&experiment.robot), controller, settings })
    }

    fn print(&self, name: &str, reference: Series, ways: &[Follows]) -> Result<(), Box<dyn Error>> {
        let (q, tau) = self.twin(&reference)?;
        for noise in NOISES {
            for way in ways {
                let (mut ls, mut iv, mut failed, mut origin) = (Bias::default(), Bias::default(), 0, String::new());
                for seed in 0..SEEDS {
                    let record = self.record(&q, &tau, noise, seed).with_reference(reference.clone());
                    let results = self.identify(record, *way)?;
                    ls.add(&results.runs[0]);
                    iv.add(&results.runs[1]);
                    failed += usize::from(results.runs[1].reason.is_some());
                    origin = origin_of(&results, *way);
                }
                let [iv, ls] = [iv, ls].map(|b| b.max_and_rms());
                println!(
                    "| {name} | {origin} | {noise:.0e} | {:.2} | {:.2} | {:.2} | {:.2} | {failed} |",
                    iv.0, iv.1, ls.0, ls.1
                );
            }
        }
        Ok(())
    }

    /// Positions and torques of the twin that follows a reference.
    fn twin(&self, reference: &Series) -> Result<(Series, Series), Box<dyn Error>> {
        let theta = self.robot.a_priori_parameters();
        let reference_of_loop = Reference::Sampled(SampledReference::new(reference.clone(), RATE_HZ));
        let closed_loop = ClosedLoop {
            model: &self.model,
            transmission: &self.robot.transmission,
            controller: &self.controller,
            reference: &reference_of_loop,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver: Solver::Adaptive { relative_tolerance: 1e-6, absolute_tolerance: 1e-9 },
            sign_velocity_scale: SCALE,
        };
        let motor_inertia = closed_loop.motor_inertia(&theta, DURATION_S);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: RATE_HZ, samples: reference.len() };
        let job = Job { closed_loop, theta: &theta, motor_inertia: &motor_inertia, grid };
        let motion = simulate_all(&[job]).remove(0)?;
        Ok((motion.q, motion.tau))
    }

    fn record(&self, q: &Series, tau: &Series, noise: f64, seed: u64) -> Recording {
        let [positions, torques] = [noise, TORQUE_NOISE].map(|deviation| vec![deviation; q.channels()]);
        let noise = RecordingNoise { position: SignalNoise::White(&positions), torque: SignalNoise::White(&torques) };
        let NoisySignals { position, torque } = noise.record(q.clone(), tau.clone(), &mut random_numbers(seed, 0));
        let truth = Some(self.robot.a_priori_parameters());
        Recording { truth, ..Recording::new(RATE_HZ, position, torque) }
    }

    fn identify(&self, record: Recording, way: Follows) -> Result<Results, Box<dyn Error>> {
        let order = self.settings.signal.filter_order;
        let filtered = band_pass(&record.position, RATE_HZ, order, CUTOFF_HZ, Derivative::Central)?.q;
        let edge = (5.0 * RATE_HZ / CUTOFF_HZ) as usize;
        let window = edge..record.position.len() - edge;
        let reference = match way {
            Follows::Recorded => record.reference.clone(),
            Follows::Found => None,
            Follows::Smoothed => Some(smooth(&record.position, &filtered, &window, RATE_HZ, order, CUTOFF_HZ)?.q),
            Follows::Filtered => Some(filtered),
        };
        let record = Recording { reference, ..record };
        Ok(Identification::new(self.robot, vec![record], self.settings.clone())?.run()?)
    }
}

/// What is followed, in words.
fn origin_of(results: &Results, way: Follows) -> String {
    let found = results.recordings[0].reference.as_ref();
    match (way, found) {
        (Follows::Recorded, _) => "the recorded reference".to_owned(),
        (Follows::Smoothed, _) => "the motion, smoothed".to_owned(),
        (Follows::Filtered, _) => format!("the motion below {CUTOFF_HZ} Hz"),
        (Follows::Found, None) => "nothing".to_owned(),
        (Follows::Found, Some(found)) => match (found.moves, found.periodic, found.smoothing_cutoff_hz) {
            (Some(moves), _, _) => format!("{moves} moves found"),
            (None, Some(periodic), _) => format!("Fourier series of {} harmonics", periodic.harmonics),
            (None, None, hz) => format!("the motion, smoothed at {:.1} Hz", hz.unwrap_or_default()),
        },
    }
}

/// Sums over seeds of errors in deviations.
#[derive(Default)]
struct Bias {
    sums: Vec<f64>,
    count: f64,
}

impl Bias {
    fn add(&mut self, run: &RunResult) {
        let error = |p: &thetahat::results::ParameterResult| Some((p.estimate - p.true_value?) / p.deviation()?);
        let errors: Vec<f64> = run.parameters.iter().filter_map(error).collect();
        self.sums.resize(errors.len().max(self.sums.len()), 0.0);
        self.sums.iter_mut().zip(&errors).for_each(|(s, e)| *s += e);
        self.count += f64::from(u8::from(!errors.is_empty()));
    }

    fn max_and_rms(&self) -> (f64, f64) {
        let means: Vec<f64> = self.sums.iter().map(|s| (s / self.count).abs()).collect();
        let squares: f64 = means.iter().map(|m| m * m).sum();
        (means.iter().copied().fold(0.0, f64::max), (squares / means.len() as f64).sqrt())
    }
}
