//! Filtering, differentiation and decimation of recorded signals, all without delay.
//!
//! The processing of a recording (Brunot and others, section III, see [`Decimator`]): the positions are band-passed
//! ([`band_pass`]), that is filtered by a zero-phase Butterworth low-pass ([`zero_phase`]) and differentiated by central
//! differences ([`central_difference`]); the still periods at both ends are detected ([`moving_samples`]) and cut; the torques and
//! every column of the observation matrix pass the same parallel filter and are down-sampled ([`Decimator`]). The remaining bandwidth is
//! measured on the result ([`minus_3_db_bandwidth_hz`]).
//!
//! Frequencies are in hertz, gains are of one pass unless stated; a [`Series`](thetahat_ground::series::Series) holds many channels and
//! each is processed independently. NaN spreads over the whole channel; check a recording before filtering it.
//!
//! ```
//! use std::f64::consts::TAU;
//! use thetahat_estimation::signal::{central_difference, zero_phase, Padding, SecondOrderSections};
//! use thetahat_ground::series::Series;
//! // A sine of 1 Hz, sampled at 1 kHz: its velocity in the middle, to a part in ten thousand.
//! let q = Series::from_values(1, (0..1000).map(|k| (TAU * k as f64 / 1000.0).sin()).collect())?;
//! let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, 1000.0)?;
//! let dq = central_difference(&zero_phase(&filter, &q, Padding::Matlab)?, 1000.0);
//! assert!((dq.sample(500)[0] + TAU).abs() < 1e-4 * TAU);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band_pass;
mod bandwidth;
mod causal;
mod decimate;
mod delay;
mod design;
mod differentiate;
mod error;
mod forward_backward;
mod hold;
mod join;
mod motion;
mod pieces;
mod pole_sums;
mod random_walk;
mod smoother;
mod smoothing;
mod spectrum;
mod spectrum_end;
mod zero_phase;

#[doc(hidden)]
pub use band_pass::velocity_noise_per_density;
pub use band_pass::{Motion, band_pass};
pub use bandwidth::minus_3_db_bandwidth_hz;
#[doc(hidden)]
pub use causal::CausalBandPass;
pub use decimate::{Decimator, Joiner};
pub use delay::delayed;
pub use design::SecondOrderSections;
pub use differentiate::{Derivative, central_difference};
pub use error::SignalError;
#[doc(hidden)]
pub use hold::CentredHold;
pub use hold::centred_hold;
pub use motion::{moving_samples, moving_thresholds, peaks};
pub use pieces::DecimatedPiece;
#[doc(hidden)]
pub use smoother::{SmoothedMotion, smooth_motion};
pub use smoothing::{Smoothed, smooth};
#[doc(hidden)]
pub use smoothing::{densities_of_squares, noise_densities, squared_differences};
pub use spectrum::Spectrum;
pub use spectrum_end::spectrum_end_hz;
pub use zero_phase::{Padding, zero_phase};
