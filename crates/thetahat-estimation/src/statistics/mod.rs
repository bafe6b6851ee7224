//! Tests that compare fits, tests of their assumptions, and covariances of estimates under weaker assumptions than the
//! classical one.
//!
//! Rows are ordered by joint, then by recording, then by time, as in [`RowLayout`](crate::regression::RowLayout).
//! [`Autoregressive`] noise describes correlation in time, which never crosses from one joint or recording to another.
//!
//! ```
//! use thetahat_estimation::statistics::{autocorrelation, t_quantile};
//! // 95 % of a t distribution with ten degrees of freedom lie within 2.228.
//! assert!(t_quantile(0.975, 10.0).is_some_and(|t| (t - 2.228).abs() < 1e-3));
//! // An alternating series changes its sign with each sample.
//! let alternating: Vec<f64> = (0..1000).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
//! assert!((autocorrelation(&[&alternating], 1)[0] + 1.0).abs() < 2e-3);
//! ```

mod autoregressive;
mod biased_simulator;
mod block;
mod chi_squared;
mod covariance_factor;
mod f_test;
mod homoscedasticity;
mod lagged;
mod noise;
mod normality;
#[doc(hidden)]
pub mod quantile;
mod relevance;
mod repeated;
mod sandwich;
mod stationary;
mod student;
mod whiteness;
mod wu_hausman;

pub use autoregressive::Autoregressive;
pub use biased_simulator::{BiasFit, SimulatorComparison};
pub use chi_squared::{ChiSquaredTest, chi_squared_test};
#[doc(hidden)]
pub use covariance_factor::CovarianceFactor;
pub use f_test::{FTest, f_probability, f_test};
pub use homoscedasticity::levene;
pub use noise::RowNoise;
pub use normality::jarque_bera;
#[doc(hidden)]
pub use quantile::{median, quantile};
pub use relevance::{InstrumentStrength, instrument_strength};
#[doc(hidden)]
pub use repeated::repeated_widening;
pub use sandwich::Sandwich;
pub use stationary::EstimatedVariance;
pub use student::t_quantile;
pub use whiteness::{autocorrelation, ljung_box, usual_lags};
pub use wu_hausman::{WuHausman, wu_hausman};
