//! What the estimates predict of data left out, and how sure that is.

pub(in crate::run) mod cross_validation;
pub(in crate::run) mod no_predictive_power;
pub(in crate::run) mod uncertain;
pub(in crate::run) mod unmasked_comparison;
