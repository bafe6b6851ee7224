//! Simulations that are asked for, run side by side.

use super::simulator::{Output, Parameters, Simulator};
use thetahat_estimation::{
    identification::SimulatedResponse,
    simulation::{Job, SimulatedMotion, SimulationError, simulate_all},
};
use thetahat_ground::{linear_algebra::Matrix, pool::in_parallel, series::Series};

/// What a simulation gave.
#[derive(Debug, Clone)]
pub(crate) enum Simulated {
    Instruments(Matrix),
    Motions(Vec<SimulatedMotion>),
    Response(SimulatedResponse),
}

/// A simulation that is asked for.
pub(crate) struct Request<'a> {
    pub(crate) simulator: &'a Simulator<'a>,
    pub(crate) theta: Parameters,
    pub(crate) output: Output,
}

impl Request<'_> {
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.simulator.is_like(other.simulator) && self.theta == other.theta && self.output == other.output
    }
}

/// Runs the simulations of requests side by side, equal ones once. Results are bit-identical alone or batched.
pub(crate) fn simulate_side_by_side(
    requests: &[Request<'_>],
    threads: usize,
) -> Vec<Result<Simulated, SimulationError>> {
    let first_like =
        |request: &Request<'_>| requests.iter().position(|other| request.is_like(other)).unwrap_or_default();
    let first: Vec<usize> = requests.iter().map(first_like).collect();
    let mut simulated: Vec<_> = (0..requests.len()).map(|_| None).collect();
    let (places, different): (Vec<usize>, Vec<&Request<'_>>) =
        requests.iter().enumerate().filter(|(k, _)| first[*k] == *k).unzip();
    let results = simulate_different(&different, threads);
    places.into_iter().zip(results).for_each(|(k, result)| simulated[k] = Some(result));
    for k in 0..requests.len() {
        if first[k] != k {
            simulated[k] = simulated[first[k]].clone();
        }
    }
    simulated.into_iter().flatten().collect()
}

/// Z with base parameters `theta` by each of some simulators of one problem, where the simulation succeeds.
pub(crate) fn instruments_side_by_side(
    simulators: &[Simulator<'_>],
    theta: &[f64],
    threads: usize,
) -> Vec<Option<Matrix>> {
    let request =
        |simulator| Request { simulator, theta: Parameters::Estimated(theta.to_vec()), output: Output::Instruments };
    let simulated = simulate_side_by_side(&simulators.iter().map(request).collect::<Vec<_>>(), threads);
    simulated.into_iter().map(|s| if let Ok(Simulated::Instruments(z)) = s { Some(z) } else { None }).collect()
}

/// Runs different simulations: those with sensitivities side by side on threads, the others in lanes.
fn simulate_different(requests: &[&Request<'_>], threads: usize) -> Vec<Result<Simulated, SimulationError>> {
    let response =
        |r: &&Request<'_>| if let Output::Sensitivities(response) = r.output { Some(response) } else { None };
    let (with, without): (Vec<usize>, Vec<usize>) =
        (0..requests.len()).partition(|&k| response(&requests[k]).is_some());
    let plain = simulate_in_lanes(&without.iter().map(|&k| requests[k]).collect::<Vec<_>>(), threads);
    let threads_of_each = (threads / with.len().max(1)).max(1);
    let sensitive = in_parallel(with.len(), threads, |i| {
        let request = requests[with[i]];
        let simulate =
            |response| request.simulator.response_with_sensitivities(&request.theta, response, threads_of_each);
        let found = response(&request).map(simulate);
        found.map(|found| found.map(Simulated::Response))
    });
    let mut all: Vec<_> =
        without.into_iter().zip(plain).chain(with.into_iter().zip(sensitive.into_iter().flatten())).collect();
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, simulated)| simulated).collect()
}

fn simulate_in_lanes(requests: &[&Request<'_>], threads: usize) -> Vec<Result<Simulated, SimulationError>> {
    let resolved: Vec<_> = requests.iter().map(|w| w.simulator.resolve(&w.theta)).collect();
    let of_requests: Vec<Vec<Job<'_>>> =
        requests.iter().zip(&resolved).map(|(w, resolved)| w.simulator.motion_jobs(resolved, w.output)).collect();
    let counts: Vec<usize> = of_requests.iter().map(Vec::len).collect();
    let jobs: Vec<Job<'_>> = of_requests.into_iter().flatten().collect();
    let groups: Vec<&[Job<'_>]> = jobs.chunks(jobs.len().div_ceil(threads.max(1)).max(1)).collect();
    let mut all = in_parallel(groups.len(), threads, |g| simulate_all(groups[g])).into_iter().flatten();
    let of_request = |k: usize| {
        let found = all.by_ref().take(counts[k]).collect();
        let motions = requests[k].simulator.whole_motions(&resolved[k], found)?;
        Ok(if requests[k].output == Output::Instruments { without_torques(motions) } else { motions })
    };
    let motions: Vec<Result<Vec<SimulatedMotion>, SimulationError>> = (0..requests.len()).map(of_request).collect();
    let instruments = |k: usize| match &motions[k] {
        Ok(motions) if requests[k].output == Output::Instruments => Some(requests[k].simulator.instruments_of(motions)),
        _ => None,
    };
    let instruments = in_parallel(requests.len(), threads, instruments);
    let results = motions.into_iter().zip(instruments);
    let result = |(motions, z)| match z {
        Some(z) => Result::map(z, Simulated::Instruments),
        None => Result::map(motions, Simulated::Motions),
    };
    results.map(result).collect()
}

/// What instruments are made of: torques of long recordings would take a quarter of the memory.
fn without_torques(mut motions: Vec<SimulatedMotion>) -> Vec<SimulatedMotion> {
    motions.iter_mut().for_each(|motion| motion.tau = Series::zeros(0, motion.tau.channels()));
    motions
}
