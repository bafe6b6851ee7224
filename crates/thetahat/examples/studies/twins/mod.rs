//! Twins of robots that several examples study: true parameters, a motion under control, and records of it with noise.

pub mod reference;
pub mod robots;
pub mod twin;
