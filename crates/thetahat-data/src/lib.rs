//! Recordings of robots from text, NumPy, MATLAB, Parquet and ROS bags.

pub mod recording;
