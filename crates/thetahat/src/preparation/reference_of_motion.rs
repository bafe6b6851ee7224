//! A reference found in the recorded motion: moves, a Fourier series, or the motion smoothed.

use super::{
    error::PreparationError,
    filtered::STILL,
    recording::Recording,
    reference::{FoundPeriod, RecordedReference},
    setup::Setup,
};
use thetahat_estimation::{
    signal::{self, Smoothed},
    simulation::{PeriodicReference, Reference, SampledReference},
    trajectory::{FourierSeries, LowPass, Moves, Periodic, find_periodic, reconstruct},
};
use thetahat_ground::series::Series;

/// Rms deviation of a joint's motion from reconstructed moves, relative to that from its mean, beyond which the motion is not
/// made of moves.
const BAD_FIT: f64 = 0.05;
/// The same up to which nothing else than moves is looked for.
const GOOD_FIT: f64 = 0.01;
/// Part of a period in which a periodic motion and its transients are joined, at each end of the stretch.
const JOINED: f64 = 0.25;

impl Setup<'_> {
    /// Moves where the motion is made of them, a Fourier series where it repeats, else the motion itself, smoothed.
    pub(crate) fn reference_of_motion(&self, recording: &Recording) -> Result<RecordedReference, PreparationError> {
        let rate = recording.sample_rate_hz;
        let motion = self.measured_motion(recording)?;
        let moves = reconstruct(&recording.position, &motion.dq, rate).ok();
        let fits = |limit: f64| {
            let found = moves.as_ref().filter(|found| fits(&found.rms_deviation, &motion.q, limit));
            found.map(|found| of_moves(&found.moves))
        };
        if let Some(good) = fits(GOOD_FIT) {
            return Ok(good);
        }
        let window = self.window(recording, &motion)?.samples;
        let options = &self.settings.signal;
        let (order, cutoff_hz) = (options.filter_order, options.cutoff_hz);
        let periodic = find_periodic(&motion.q, &window, LowPass { sample_rate_hz: rate, order, cutoff_hz });
        if let Some(acceptable) = fits(BAD_FIT).filter(|_| periodic.is_none()) {
            return Ok(acceptable);
        }
        let smoothed = signal::smooth(&recording.position, &motion.q, &window, rate, order, cutoff_hz)?;
        Ok(match periodic {
            Some(periodic) => of_periodic(periodic, smoothed, rate),
            None => RecordedReference {
                smoothing_cutoff_hz: Some(smoothed.cutoff_hz),
                ..RecordedReference::new(Reference::Sampled(SampledReference::new(smoothed.q, rate)), "filtered")
            },
        })
    }
}

fn of_moves(moves: &Moves) -> RecordedReference {
    RecordedReference::new(Reference::Moves(moves.clone()), "reconstructed")
}

/// The series where the motion repeats, and the smoothed motion before and after.
fn of_periodic(periodic: Periodic, smoothed: Smoothed, rate: f64) -> RecordedReference {
    let Periodic { series, stretch_s, periods } = periodic;
    let found = FoundPeriod {
        base_frequency_hz: series.base_frequency_hz(),
        harmonics: series.harmonics(),
        degree: series.degree(),
        periods,
        stretch_s,
    };
    let transient = transient(&series, &smoothed.q, stretch_s, rate);
    let reference = PeriodicReference::new(series, SampledReference::new(transient, rate));
    RecordedReference {
        periodic: Some(found),
        smoothing_cutoff_hz: Some(smoothed.cutoff_hz),
        ..RecordedReference::new(Reference::Periodic(reference), "periodic")
    }
}

/// Smoothed motion less series outside the stretch. It grows from zero with continuous accelerations inside, where both
/// describe the motion: outside, a motion may leave the series at once.
fn transient(series: &FourierSeries, smoothed: &Series, [from_s, to_s]: [f64; 2], rate: f64) -> Series {
    let mut transient = series.sample(rate, smoothed.len()).q;
    let length_s = JOINED / series.base_frequency_hz();
    for k in 0..smoothed.len() {
        let t = k as f64 / rate;
        let s = (1.0 - (t - from_s).min(to_s - t) / length_s).clamp(0.0, 1.0);
        let part = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let motion = smoothed.sample(k);
        transient.sample_mut(k).iter_mut().zip(motion).for_each(|(r, m)| *r = part * (m - *r));
    }
    transient
}

/// Whether each joint's deviation from moves is at most a part of its motion.
fn fits(rms_deviation: &[f64], q: &Series, limit: f64) -> bool {
    rms_deviation.iter().enumerate().all(|(j, deviation)| {
        let channel = q.channel(j);
        let mean = channel.iter().sum::<f64>() / channel.len() as f64;
        let squares = channel.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        *deviation <= (limit * (squares / channel.len() as f64).sqrt()).max(STILL)
    })
}
