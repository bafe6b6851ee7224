//! Recordings of robots from text, NumPy, MATLAB, Parquet and ROS 2 bags.

pub mod recording;
