//! Descriptions of robots as data, read from URDF, xacro, MJCF and Denavit-Hartenberg tables.

pub mod robot;
