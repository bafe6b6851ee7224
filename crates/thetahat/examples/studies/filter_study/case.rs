use std::error::Error;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Recording, Series, Settings,
    base_parameters::BaseParameters,
    dynamics::Model,
    filter_choice::{choose_filter, estimate_with_filter, sizes},
    signal::{Padding, SecondOrderSections, zero_phase},
};
use thetahat_estimation::signal::delayed;
use thetahat_report::results::Filter;

use super::twins::{
    reference::Kind,
    robots::Subject,
    twin::{Noise, Sampling, Twin},
};

/// Records with other noise over which errors are averaged.
const RECORDS: u64 = 6;
const THREADS: usize = 2;
/// Velocity, rad/s or m/s, below which a joint rests.
const REST: f64 = 2e-4;
/// Cases up to this one move periodically; the others have all kinds of motion.
const PERIODIC: u64 = 100;
const KINDS: [Kind; 4] = [Kind::Moves, Kind::OneByOne, Kind::Slow, Kind::Periodic];

/// A recording of a twin.
pub struct Case {
    number: u64,
    sampling: Sampling,
    noise: Noise,
    /// Cut-off of the low-pass through which positions and torques were recorded, where they were; part of the rate.
    low_pass: Option<f64>,
    /// Samples by which the torques are late.
    late: f64,
    /// Step of the encoders, where positions have no noise.
    encoder: Option<f64>,
}

pub struct Outcome {
    pub row: String,
    /// Error with the chosen filter over that with the best of the grid.
    pub ratio: f64,
}

impl Case {
    /// Rate, length and noise at random.
    pub fn draw(number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let mut between = |low: f64, high: f64| low * (high / low).powf(rng.random::<f64>());
        let kind = if number <= PERIODIC { Kind::Periodic } else { KINDS[number as usize % KINDS.len()] };
        let longer = if kind == Kind::OneByOne { 3.0 } else { 1.0 };
        let sampling =
            Sampling { kind, duration_s: longer * between(8.0, 20.0), rate_hz: between(30.0, 5000.0).round() };
        let noise = Noise { name: "", position: between(1e-6, 3e-4), torque: between(2e-3, 1e-1) };
        // Every fourth log was filtered; every third has torques that are late.
        let low_pass = number.is_multiple_of(4).then(|| between(0.05, 0.2).max(8.0 / sampling.rate_hz));
        let late = if number.is_multiple_of(3) { between(0.1, 0.5) } else { 0.0 };
        // Every fifth log of the others has steps of an encoder in place of noise.
        let encoder = (number > PERIODIC && number.is_multiple_of(5)).then(|| between(1e-5, 1e-3));
        Self { number, sampling, noise, low_pass, late, encoder }
    }

    fn record(&self, twin: &Twin, seed: u64) -> Result<Recording, Box<dyn Error>> {
        let noise = if self.encoder.is_some() { Noise { position: 0.0, ..self.noise } } else { self.noise };
        let mut recording = twin.record(noise, 1000 * self.number + seed);
        if let Some(step) = self.encoder {
            let values = recording.position.values().iter().map(|q| (q / step).round() * step).collect();
            recording.position = Series::shaped(recording.position.channels(), values);
        }
        recording.torque = recording.torque.map(|torque| self.with_static_friction(torque, twin, seed));
        let delay = |series: Series| delayed(&series, &vec![self.late; series.channels()]);
        let recording = Recording { torque: recording.torque.map(delay), ..recording };
        let Some(part) = self.low_pass else { return Ok(recording) };
        let rate = recording.sample_rate_hz;
        let filter = SecondOrderSections::butterworth_lowpass(2, part.min(0.4) * rate, rate)?;
        let filtered = |series: &Series| zero_phase(&filter, series, Padding::Matlab);
        let torque = recording.torque.as_ref().map(filtered).transpose()?;
        Ok(Recording { position: filtered(&recording.position)?, torque, ..recording })
    }

    /// Torques to which each rest of a joint adds its own part of the joint's Coulomb friction, as static friction does, and the
    /// smooth friction of the simulation does not.
    fn with_static_friction(&self, mut torque: Series, twin: &Twin, seed: u64) -> Series {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 * self.number + seed);
        let coulomb = twin.coulomb_friction();
        for (j, fc) in coulomb.into_iter().enumerate() {
            let mut level = 0.0;
            let mut rests = false;
            for k in 0..torque.len() {
                let stands = twin.motion.dq.sample(k)[j].abs() < REST;
                if stands && !rests {
                    level = fc * rng.random_range(-1.0..1.0);
                }
                rests = stands;
                torque.sample_mut(k)[j] += if rests { level } else { 0.0 };
            }
        }
        torque
    }

    pub fn run(&self, subject: Subject, verbose: bool) -> Result<Outcome, Box<dyn Error>> {
        let twin = Twin::new(subject, self.sampling, self.number)?;
        let first = self.record(&twin, 0)?;
        let started = std::time::Instant::now();
        let choice = choose_filter(&twin.robot, &Settings::new(1.0, 1), std::slice::from_ref(&first), None, THREADS)?;
        let seconds = started.elapsed().as_secs_f64();
        let records: Vec<Recording> = (1..=RECORDS).map(|seed| self.record(&twin, seed)).collect::<Result<_, _>>()?;
        let grid: Vec<Filter> = wide_grid(self.sampling.rate_hz).chain([choice.best]).collect();
        let errors: Vec<Option<Vec<f64>>> = grid.iter().map(|f| squares(&twin, &records, *f)).collect();
        let parameters = errors.iter().flatten().map(Vec::len).next().ok_or("no filter gives an estimate")?;
        let least: Vec<f64> =
            (0..parameters).map(|p| errors.iter().flatten().map(|e| e[p]).fold(f64::INFINITY, f64::min)).collect();
        let rms = |e: &Vec<f64>| {
            (e.iter().zip(&least).map(|(e, l)| e / l.max(f64::MIN_POSITIVE)).sum::<f64>() / parameters as f64).sqrt()
        };
        let of_grid: Vec<f64> = errors.iter().map(|e| e.as_ref().map_or(f64::INFINITY, rms)).collect();
        let (last, others) = of_grid.split_last().ok_or("an empty grid")?;
        let best = (0..others.len()).min_by(|a, b| others[*a].total_cmp(&others[*b])).ok_or("an empty grid")?;
        let ratio = last / others[best];
        if verbose {
            for compared in &choice.compared {
                let actual = squares(&twin, &records, compared.filter).map_or(f64::INFINITY, |e| rms(&e));
                let (cutoff, decimation) = (compared.filter.cutoff_hz, compared.filter.decimation);
                let (total, bias) = compared.error.map_or((0.0, 0.0), |e| (e.total, e.bias));
                println!(
                    "    {cutoff:6} Hz {decimation:4}: predicted {total:7.3} of which bias {bias:7.3}, actual {:7.3}",
                    actual / others[best]
                );
            }
            println!("    dynamics {:.2} Hz, {seconds:.1} s", choice.dynamics_hz);
        }
        let of = |f: &Filter| format!("{} Hz, {}", f.cutoff_hz, f.decimation);
        let row = format!(
            "| {} | {} | {:?} | {} | {:.1} | {} | {:.1} | {} | {} | {} | {} | {ratio:.2} | {seconds:.1} |",
            self.number,
            twin.name,
            self.sampling.kind,
            self.sampling.rate_hz,
            self.sampling.duration_s,
            self.encoder.map_or_else(|| format!("{:.1e}", self.noise.position), |step| format!("steps {step:.1e}")),
            100.0 * self.noise.torque,
            self.low_pass.map_or("-".to_owned(), |part| format!("{:.0}", part * self.sampling.rate_hz)),
            if self.late > 0.0 { format!("{:.1}", self.late) } else { "-".to_owned() },
            of(&choice.best),
            of(&grid[best]),
        );
        Ok(Outcome { row, ratio })
    }
}

/// Parallel filters from 0.5 Hz to 0.4 of the rate, and for each position filters from half to six times that.
fn wide_grid(rate_hz: f64) -> impl Iterator<Item = Filter> {
    let steps = (2.0 * (0.4 * rate_hz / 0.5_f64).log2()) as i32;
    let mut decimations: Vec<usize> =
        (0..=steps).map(|i| (0.4 * rate_hz / (0.5 * f64::from(i).exp2().sqrt())).round().max(1.0) as usize).collect();
    decimations.dedup();
    decimations.into_iter().filter(move |d| *d as f64 <= 0.4 * rate_hz).flat_map(move |decimation| {
        let parallel_hz = 0.4 * rate_hz / decimation as f64;
        let lower: &[f64] = if decimation == 1 { &[0.06, 0.125, 0.25] } else { &[] };
        let factors = lower.iter().chain(&[0.7, 1.4, 2.8, 5.6]);
        let cutoffs: Vec<f64> =
            factors.map(|f| f * parallel_hz).filter(|f| *f < 0.45 * rate_hz && *f < 200.0).collect();
        cutoffs.into_iter().map(move |cutoff_hz| Filter { cutoff_hz, decimation })
    })
}

/// Mean squared error of each parameter over the recordings, at most the square of its size; `None` if a recording gives no estimate.
fn squares(twin: &Twin, records: &[Recording], filter: Filter) -> Option<Vec<f64>> {
    let model = Model::new(&twin.robot);
    let base = BaseParameters::of(&model, &[]).ok()?;
    let truth = base.from_standard(&twin.truth);
    let mut sum = vec![0.0; truth.len()];
    for record in records {
        let found = estimate_with_filter(&twin.robot, record, filter).ok()?;
        let squares = found.iter().zip(&truth).map(|(found, truth)| (found - truth).powi(2));
        sum.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square / records.len() as f64);
    }
    let sizes = sizes(&model, &base, &truth);
    Some(sum.iter().zip(sizes).map(|(square, size)| square.min(size * size)).collect())
}
