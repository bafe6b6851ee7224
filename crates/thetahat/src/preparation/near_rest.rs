//! From which velocity on the sign of a joint's friction is known.

use std::convert::Infallible;

use super::settings::{Mask, NamedMask, PositionFilter, SignalOptions, StatedMask};
use thetahat_estimation::{
    identification::NearRest,
    signal::{noise_densities, velocity_noise_per_density},
};
use thetahat_ground::series::Series;

/// Scales of the simulator's smooth sign at which it is within a thousandth of one: `tanh(4) = 0.9993`.
const SCALES: f64 = 4.0;
/// Standard deviations of the velocity's noise: it changes the sign of one sample in 700.
const DEVIATIONS: f64 = 3.0;
/// Cut-off of the parallel filter, of the sample rate over the decimation.
const PARALLEL: f64 = 0.4;
/// Cut-off of a usual position filter over that of the parallel filter: five times the motion's bandwidth over twice it (Brunot and
/// others, section V-A).
const USUAL: f64 = 2.5;

/// What counts as near rest in a window of recorded positions, `q` after the position filter; none if every sample makes
/// rows.
///
/// A joint is near rest below four velocity scales of the simulator's smooth sign, and below three standard deviations of its
/// velocity's noise. What lies above the position filter is taken as white noise. The filter smears a rest over its
/// neighbours: a period of its cut-off on either side is near rest as well; of a usual cut-off, where the smoother found a higher one.
#[must_use]
pub fn near_rest(
    signal: &SignalOptions,
    sign_velocity_scale: f64,
    [position, q]: [&Series; 2],
    sample_rate_hz: f64,
) -> Option<NearRest> {
    let densities = || noise_densities(position, q, &(0..position.len()), sample_rate_hz, signal.cutoff_hz);
    let Ok(rule) = near_rest_of_noise(signal, sign_velocity_scale, (position.channels(), sample_rate_hz), || {
        Ok::<_, Infallible>(densities())
    });
    rule
}

/// The frequency whose period a mask is widened by: the cut-off, but with the smoother at most that of a usual position filter. A
/// likelihood that finds no noise finds a cut-off far above the motion, and friction is as far from its law near rest as before.
fn widening_hz(signal: &SignalOptions, sample_rate_hz: f64) -> f64 {
    match signal.position {
        PositionFilter::Butterworth => signal.cutoff_hz,
        PositionFilter::Smoother => {
            let parallel_hz = PARALLEL * sample_rate_hz / signal.decimation as f64;
            signal.cutoff_hz.min(USUAL * parallel_hz)
        }
    }
}

/// The same from the noise densities of so many joints' positions (variance per Hz), which are asked for only where the mask
/// depends on them.
pub(crate) fn near_rest_of_noise<E>(
    signal: &SignalOptions,
    sign_velocity_scale: f64,
    (joints, sample_rate_hz): (usize, f64),
    densities: impl FnOnce() -> Result<Vec<f64>, E>,
) -> Result<Option<NearRest>, E> {
    let samples = |time_s: f64| (time_s * sample_rate_hz).ceil() as usize;
    match signal.mask {
        Mask::Named(NamedMask::None) => Ok(None),
        Mask::Stated(StatedMask { velocity, widened_s }) => {
            Ok(Some(NearRest { velocity: vec![velocity; joints], widened: samples(widened_s) }))
        }
        Mask::Named(NamedMask::NearRest) => {
            let SignalOptions { filter_order, cutoff_hz, derivative, .. } = *signal;
            let per_density = velocity_noise_per_density(filter_order, cutoff_hz, sample_rate_hz, derivative);
            let of_friction = SCALES * sign_velocity_scale;
            let limit = |density: f64| (DEVIATIONS * (density * per_density).sqrt()).max(of_friction);
            let velocity = densities()?.into_iter().map(limit).collect();
            Ok(Some(NearRest { velocity, widened: samples(1.0 / widening_hz(signal, sample_rate_hz)) }))
        }
    }
}
