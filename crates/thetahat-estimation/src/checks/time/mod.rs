//! Checks of instants: time stamps, lags, drift, filters.

pub(in crate::checks) mod cutoff;
pub(in crate::checks) mod drift;
pub(in crate::checks) mod lag;
pub(in crate::checks) mod lag_search;
pub(in crate::checks) mod late_stamps;
pub(in crate::checks) mod long_lag;
pub(in crate::checks) mod stamps;
