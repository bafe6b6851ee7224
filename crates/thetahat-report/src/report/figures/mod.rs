//! The figures of the page.

mod convergence;
mod correlation;
mod errors;
mod figure;
mod forest;
mod misfit;
mod recording_curves;
mod skeleton;
mod torques;
mod tracking;

pub(super) use convergence::convergence;
pub(super) use correlation::{confounded, correlation};
pub(super) use errors::{Heat, errors};
pub(super) use figure::{Figure, Key, keys_of};
pub(super) use forest::{Forest, forest, not_identified, predicted_forest};
pub(super) use misfit::misfit;
pub(super) use skeleton::{skeleton, skeleton_of};
pub(super) use torques::{held_back, torques};
pub(super) use tracking::tracking;
