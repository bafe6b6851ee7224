//! Checks of the positions and of the motion.

pub(in crate::checks) mod dither;
pub(in crate::checks) mod excitation;
pub(in crate::checks) mod jumps;
pub(in crate::checks) mod levels;
pub(in crate::checks) mod position_range;
pub(in crate::checks) mod repeats;
pub(in crate::checks) mod resolution;
pub(in crate::checks) mod still;
pub(in crate::checks) mod velocity;
