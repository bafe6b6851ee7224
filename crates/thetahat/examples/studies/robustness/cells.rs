use std::{
    error::Error,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use thetahat::{
    ControllerDescription, Identification, Method, Robot, Settings,
    identification::{Needs, Status},
    results::RunResult,
};

use super::{
    arguments::Arguments,
    twins::twin::{BANDWIDTH_HZ, NOISE, Noise, SIGN_VELOCITY_SCALE, Twin},
};

/// Deviation of the start values, relative.
const CAD_ERROR: f64 = 0.3;
const CUTOFF_HZ: f64 = 50.0;
const DECIMATION: usize = 10;

/// Where an iteration starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    Cad,
    /// Each parameter with an error of 30 %, which may be no robot's.
    CadWithErrors,
    /// The motor inertias that the file has, and nothing else.
    MotorInertias,
}

impl Start {
    pub const ALL: [Self; 3] = [Self::Cad, Self::CadWithErrors, Self::MotorInertias];

    pub fn name(self) -> &'static str {
        match self {
            Self::Cad => "CAD",
            Self::CadWithErrors => "CAD 30 %",
            Self::MotorInertias => "motors",
        }
    }

    /// The robot whose a-priori values are the start.
    pub fn robot(self, twin: &Twin) -> Robot {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let table = twin.robot.parameter_table();
        let mut value = |(i, v): (usize, &f64)| match self {
            Self::Cad => *v,
            Self::CadWithErrors => {
                let normal: f64 = StandardNormal.sample(&mut rng);
                v * (1.0 + CAD_ERROR * normal)
            }
            Self::MotorInertias if table.get(i).quantity.is_motor_inertia() => *v,
            Self::MotorInertias => 0.0,
        };
        let values: Vec<f64> = twin.cad.iter().enumerate().map(&mut value).collect();
        let named = table.iter().zip(values).filter(|(_, v)| *v != 0.0);
        Robot { a_priori: named.map(|(p, v)| (p.name(), v)).collect(), ..twin.robot.clone() }
    }
}

/// One estimation of the table.
#[derive(Debug, Clone)]
pub struct Cell {
    pub robot: &'static str,
    pub method: Method,
    pub factor: f64,
    pub start: Start,
    pub noise: &'static str,
    pub status: Status,
    pub reason: String,
    pub iterations: usize,
    pub seconds: f64,
    /// The largest error of a base parameter in its deviations with correlated errors, and the parameter; none without an
    /// estimate.
    pub largest_error: Option<(f64, String)>,
}

impl Cell {
    pub fn has_converged(&self) -> bool {
        self.status == Status::Converged
    }
}

/// Factor of the bandwidth, start, noise and its seed.
type Place = (f64, Start, Noise, u64);

/// Every cell of a robot, several at a time.
pub fn run_cells(twin: &Twin, arguments: &Arguments) -> Result<Vec<Cell>, Box<dyn Error>> {
    let factors = &arguments.factors;
    let noise: &[Noise] = if arguments.quick { &NOISE[..1] } else { &NOISE };
    let of_start = |start| factors.iter().flat_map(move |&f| noise.iter().map(move |&n| (f, start, n)));
    let places: Vec<Place> = Start::ALL
        .into_iter()
        .flat_map(of_start)
        .zip(1000 * arguments.seed..)
        .map(|((f, s, n), seed)| (f, s, n, seed))
        .collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
            let cells = run(twin, *place, &arguments.methods).map_err(|e| e.to_string());
            found.lock().map(|mut found| found.push(cells)).ok();
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        (0..threads).for_each(|_| drop(scope.spawn(work)));
    });
    let mut cells = Vec::new();
    for of_place in found.into_inner()? {
        cells.extend(of_place?);
    }
    cells.sort_by(|a: &Cell, b| (a.method, a.start.name(), a.noise).cmp(&(b.method, b.start.name(), b.noise)));
    Ok(cells)
}

fn run(twin: &Twin, place: Place, methods: &[Method]) -> Result<Vec<Cell>, Box<dyn Error>> {
    let (factor, start, noise, seed) = place;
    let fits = |m: &&Method| m.needs() == Needs::Sensitivities;
    let (fitting, others): (Vec<Method>, Vec<Method>) = methods.iter().partition(fits);
    let robot = start.robot(twin);
    let mut cells = Vec::new();
    for (methods, controller) in
        [(others, ControllerDescription::pd(factor * BANDWIDTH_HZ)), (fitting, twin.controller(factor))]
    {
        if methods.is_empty() {
            continue;
        }
        let settings = Settings { controller: Some(controller), ..settings(&methods, factor) };
        let results = Identification::new(&robot, vec![twin.record(noise, seed)], settings)?.run()?;
        cells.extend(results.runs.into_iter().map(|run| cell(twin, place, run)));
    }
    Ok(cells)
}

/// Settings with a simulated PD loop of so many times the true bandwidth.
pub fn settings(methods: &[Method], factor: f64) -> Settings {
    let mut settings = Settings::new(CUTOFF_HZ, DECIMATION)
        .with_methods(methods.iter().copied())
        .with_controller(ControllerDescription::pd(factor * BANDWIDTH_HZ));
    settings.simulation.sign_velocity_scale = SIGN_VELOCITY_SCALE;
    settings
}

fn cell(twin: &Twin, (factor, start, noise, _): Place, run: RunResult) -> Cell {
    let errors = run.parameters.iter().filter_map(|p| {
        let deviation = p.standard_deviation_robust.filter(|d| *d > 0.0)?;
        Some(((p.estimate - p.true_value?).abs() / deviation, p.name.clone()))
    });
    Cell {
        robot: twin.name,
        method: run.method,
        factor,
        start,
        noise: noise.name,
        status: run.status,
        largest_error: errors.max_by(|a, b| a.0.total_cmp(&b.0)),
        reason: run.reason.unwrap_or_default(),
        iterations: run.iterations,
        seconds: run.seconds,
    }
}
