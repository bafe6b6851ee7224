//! Checks of the torques against the model.

mod alike;
mod clock;
pub(in crate::checks) mod copies;
mod described_weight;
pub(in crate::checks) mod external_force;
pub(in crate::checks) mod fault;
pub(in crate::checks) mod friction;
pub(in crate::checks) mod gear;
pub(in crate::checks) mod gravity;
mod gravity_fit;
pub(in crate::checks) mod hypotheses;
pub(in crate::checks) mod levels;
pub(in crate::checks) mod limit;
mod mixed_units;
mod order;
pub(in crate::checks) mod passive;
mod screening;
pub(in crate::checks) mod spikes;
pub(in crate::checks) mod unexplained;
mod weight;
