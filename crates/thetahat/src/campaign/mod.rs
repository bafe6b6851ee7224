//! A Monte Carlo campaign: one TOML file that describes many runs on simulated recordings, and the runs.
//!
//! The true motion is simulated once; noise is on the measurements alone. [`Campaign::read`] checks the file,
//! [`Campaign::run`] runs what is missing in a [`Store`] and returns all [`Row`]s, [`summarise`] computes their statistics.
//! Every recording draws its random numbers from its own stream, so that rows depend neither on the number of threads nor on which
//! runs were made before. A [`Bench`] runs any of the recordings, so that parts can be made elsewhere.
//!
//! ```
//! use thetahat::campaign::quantiles;
//!
//! // Least, lower quartile, median, upper quartile and largest value of a figure over many runs.
//! let found = quantiles([3.0, 1.0, 2.0, 5.0, 4.0]).unwrap();
//! assert_eq!(found.median, 3.0);
//! ```

mod bench;
mod checks;
mod description;
mod error;
mod facts;
#[cfg(feature = "parquet")]
mod files;
#[cfg(not(feature = "parquet"))]
mod no_store;
mod noise;
#[cfg(feature = "parquet")]
mod parquet_file;
mod results;
mod row;
mod run;
mod starts;
#[cfg(feature = "parquet")]
mod store;
mod summary;

#[doc(hidden)]
pub use bench::Bench;
pub use description::{Campaign, Subset};
#[doc(hidden)]
pub use description::{CampaignFile, Claim, NoiseLevel, Starts};
pub use error::CampaignError;
#[doc(hidden)]
pub use facts::{CampaignParameter, Facts};
#[cfg(not(feature = "parquet"))]
pub use no_store::Store;
pub use row::{Key, Row};
pub use run::{CampaignRuns, Progress};
#[cfg(feature = "parquet")]
pub use store::Store;
#[doc(hidden)]
pub use summary::{parameter_summaries, quantiles, summarise};
