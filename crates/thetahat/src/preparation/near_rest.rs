//! From which velocity on the sign of a joint's friction is known.

use super::settings::{Mask, NamedMask, SignalOptions, StatedMask};
use crate::{
    identification::NearRest,
    series::Series,
    signal::{noise_densities, velocity_noise_per_density},
};

/// Scales of the simulator's smooth sign at which it is within a thousandth of one: `tanh(4) = 0.9993`.
const SCALES: f64 = 4.0;
/// Standard deviations of the velocity's noise: it changes the sign of one sample in 700.
const DEVIATIONS: f64 = 3.0;

/// What counts as near rest in a window of recorded positions, `q` behind the position filter; none where every sample makes
/// rows.
///
/// A joint is near rest below four velocity scales of the simulator's smooth sign, and below three standard deviations of its
/// velocity's noise. What lies above the position filter is taken as white noise. The filter smears a rest over its
/// neighbours: a period of its cut-off on either side is near rest as well.
#[must_use]
pub fn near_rest(
    signal: &SignalOptions,
    sign_velocity_scale: f64,
    [position, q]: [&Series; 2],
    sample_rate_hz: f64,
) -> Option<NearRest> {
    let joints = position.channels();
    let samples = |time_s: f64| (time_s * sample_rate_hz).ceil() as usize;
    match signal.mask {
        Mask::Named(NamedMask::None) => None,
        Mask::Stated(StatedMask { velocity, widened_s }) => {
            Some(NearRest { velocity: vec![velocity; joints], widened: samples(widened_s) })
        }
        Mask::Named(NamedMask::NearRest) => {
            let SignalOptions { filter_order, cutoff_hz, derivative, .. } = *signal;
            let per_density = velocity_noise_per_density(filter_order, cutoff_hz, sample_rate_hz, derivative);
            let densities = noise_densities(position, q, &(0..position.len()), sample_rate_hz, cutoff_hz);
            let of_friction = SCALES * sign_velocity_scale;
            let limit = |density: f64| (DEVIATIONS * (density * per_density).sqrt()).max(of_friction);
            Some(NearRest { velocity: densities.into_iter().map(limit).collect(), widened: samples(1.0 / cutoff_hz) })
        }
    }
}
