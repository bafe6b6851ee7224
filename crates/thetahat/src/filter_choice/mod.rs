//! The position filter's cut-off and the decimation chosen from the data.
//!
//! A lower cut-off always fits better, which gives no information about the parameters. What counts is the error of the *estimates*. So a
//! twin is made of the recording: its motion without noise, the torques of a preliminary estimate along it, and noise with the spectra of
//! the residuals of positions and torques. The estimates from several noisy copies of the twin, with every
//! filter of a small grid, are compared with the parameters that made it: their spread is the width of the intervals, their
//! mean deviation the bias that filter and noise bring. The filter with the smallest total error is chosen.
//!
//! ```
//! use thetahat::filter_choice::FilterGrid;
//! // A motion below 6 Hz, sampled at 1 kHz: the grid brackets it.
//! let grid = FilterGrid::around(6.0, 1000.0);
//! let cutoffs = || grid.filters.iter().map(|f| f.cutoff_hz);
//! assert!(cutoffs().any(|f| f < 6.0) && cutoffs().any(|f| f > 30.0));
//! ```

mod bands;
mod choose;
mod error;
mod grid;
mod low_pass;
mod recorder;
mod score;
mod separated;
mod static_friction;
mod twin;

pub use choose::choose_filter;
#[doc(hidden)]
pub use choose::estimate_with_filter;
pub use error::FilterChoiceError;
#[doc(hidden)]
pub use grid::FilterGrid;
pub(crate) use recorder::residual_of;
#[doc(hidden)]
pub use score::sizes;
