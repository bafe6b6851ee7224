//! Prior data, noise, the possible robots, and the predicted intervals.

pub(in crate::design) mod expected;
pub(in crate::design) mod gains;
pub(in crate::design) mod noise;
pub(in crate::design) mod prior_data;
pub(in crate::design) mod prior_model;
pub(in crate::design) mod recording_time;
pub(in crate::design) mod remedies;
pub(in crate::design) mod robots;
pub(in crate::design) mod wanted_torques;
