//! Seeds on threads, and what they say together. The result does not depend on the number of threads.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    thread,
};

use super::trial::{Estimate, KINDS, Outcome, Trials};

/// Runs the seeds 1 to `seeds` on `threads` threads; the outcomes are in the order of the seeds.
///
/// # Errors
/// The first that a seed has.
pub fn run_seeds(trials: &Trials<'_>, seeds: u64, threads: usize) -> Result<Vec<Outcome>, String> {
    let next = AtomicU64::new(1);
    let work = || {
        let mut outcomes = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed > seeds {
                return Ok(outcomes);
            }
            outcomes.push((seed, trials.run(seed).map_err(|e| format!("seed {seed}: {e}"))?));
        }
    };
    let mut all: Vec<(u64, Outcome)> = thread::scope(|scope| -> Result<_, String> {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        let joined = workers.into_iter().map(|w| w.join().unwrap_or_else(|_| Err("a thread failed".to_owned())));
        Ok(joined.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    })?;
    all.sort_by_key(|(seed, _)| *seed);
    Ok(all.into_iter().map(|(_, outcome)| outcome).collect())
}

/// What the seeds of one method say.
pub struct Tally<'a> {
    estimates: Vec<&'a Estimate>,
    parameters: usize,
}

impl<'a> Tally<'a> {
    /// `None` if no seed has an estimate.
    pub fn new(estimates: impl Iterator<Item = Option<&'a Estimate>>) -> Option<Self> {
        let estimates: Vec<&Estimate> = estimates.flatten().collect();
        let parameters = estimates.first()?.error.len();
        Some(Self { estimates, parameters })
    }

    pub fn seeds(&self) -> usize {
        self.estimates.len()
    }

    /// Part of a parameter's intervals of a kind that contain the true value.
    pub fn coverage(&self, kind: usize, parameter: usize) -> f64 {
        let holds = |e: &&&Estimate| e.error[parameter].abs() <= e.half_width[kind][parameter];
        self.estimates.iter().filter(holds).count() as f64 / self.seeds() as f64
    }

    /// The same of all parameters together.
    pub fn pooled(&self, kind: usize) -> f64 {
        (0..self.parameters).map(|i| self.coverage(kind, i)).sum::<f64>() / self.parameters as f64
    }

    /// Standard error of [`Tally::pooled`]: seeds are independent, parameters of a seed are not.
    pub fn pooled_error(&self, kind: usize) -> f64 {
        let share = |e: &&Estimate| {
            let held = e.error.iter().zip(&e.half_width[kind]).filter(|(e, h)| e.abs() <= **h).count();
            held as f64 / self.parameters as f64
        };
        let shares: Vec<f64> = self.estimates.iter().map(share).collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let squares: f64 = shares.iter().map(|s| (s - mean).powi(2)).sum();
        (squares / (shares.len() as f64 - 1.0).max(1.0)).sqrt() / (shares.len() as f64).sqrt()
    }

    /// Mean and standard deviation of a parameter's error.
    pub fn bias_and_deviation(&self, parameter: usize) -> (f64, f64) {
        let n = self.seeds() as f64;
        let errors = || self.estimates.iter().map(|e| e.error[parameter]);
        let mean = errors().sum::<f64>() / n;
        let squares: f64 = errors().map(|e| (e - mean).powi(2)).sum();
        (mean, (squares / (n - 1.0).max(1.0)).sqrt())
    }

    /// Least and largest coverage of a single parameter.
    pub fn extremes(&self, kind: usize) -> (f64, f64) {
        let all = (0..self.parameters).map(|i| self.coverage(kind, i));
        all.fold((1.0, 0.0), |(low, high), c| (c.min(low), c.max(high)))
    }

    /// Root mean square, over the parameters, of the rms error over a bound.
    pub fn over_bound(&self, bound: &[f64]) -> f64 {
        let squares = |i: usize| {
            let (bias, deviation) = self.bias_and_deviation(i);
            (bias * bias + deviation * deviation) / (bound[i] * bound[i])
        };
        ((0..self.parameters).map(squares).sum::<f64>() / self.parameters as f64).sqrt()
    }

    /// Largest bias of a parameter in standard deviations of its estimates.
    pub fn largest_bias(&self) -> f64 {
        let ratio = |i| {
            let (bias, deviation) = self.bias_and_deviation(i);
            bias.abs() / deviation
        };
        (0..self.parameters).map(ratio).fold(0.0, f64::max)
    }
}

/// The kind of interval that the program writes.
pub const INTERVAL: usize = KINDS.len() - 1;
