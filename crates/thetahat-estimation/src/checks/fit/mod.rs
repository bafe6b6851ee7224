//! What several checks fit, and on which samples.

pub(in crate::checks) mod affine;
pub(in crate::checks) mod friction_shapes;
pub(in crate::checks) mod orthogonal_fit;
pub(in crate::checks) mod thinned_recording;
