//! Checks of recordings with one another.

pub(in crate::checks) mod across_recordings;
pub(in crate::checks) mod companion;
pub(in crate::checks) mod contradiction;
pub(in crate::checks) mod same_recording;
