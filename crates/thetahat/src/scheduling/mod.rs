//! Closed-loop simulations that estimators ask for, run side by side.
//!
//! A [`Simulator`] simulates the loops of all recordings for one case. Estimations ask for simulations instead of calling
//! for them ([`thetahat_estimation::identification::Estimation`]); [`run_all`] collects what all of them want, and runs up to four
//! simulations in the lanes of a vector. Results are bit-identical alone or batched.

mod apart;
mod branches;
mod fitting;
mod job;
mod physical;
mod requests;
mod response;
mod scheduler;
mod simulator;
#[cfg(test)]
mod tests;

pub(crate) use job::EstimationJob;
pub(crate) use requests::instruments_side_by_side;
pub(crate) use scheduler::{Finished, FitUnderWay, RunOptions, SIDE_BY_SIDE, UnderWay, run_all};
pub(crate) use simulator::{Simulator, closed_loop};
