//! Checks of the controller and of the reference.

pub(in crate::checks) mod controller;
pub(in crate::checks) mod reference;
pub(in crate::checks) mod reference_fit;
