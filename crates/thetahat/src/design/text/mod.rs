//! The design file and its validation; the results and the experiment file that follows.

pub(in crate::design) mod collision_options;
pub(in crate::design) mod description;
pub(in crate::design) mod experiment_text;
pub(in crate::design) mod options;
pub(in crate::design) mod outcome;
pub(in crate::design) mod pictures;
mod proposal;
pub(in crate::design) mod validation;
pub(in crate::design) mod validation_of_limits;
pub(in crate::design) mod validation_of_motion;
