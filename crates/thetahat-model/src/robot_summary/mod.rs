//! A robot as data for people and programs: its structure, its standard and its base parameters.
//!
//! ```
//! use thetahat_model::{robot::RobotSource, robot_summary::RobotSummary};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let robots = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots");
//! let source = RobotSource::read(&robots.join("tx40.toml"))?;
//! let summary = RobotSummary::new(&source, &source.robot()?);
//! assert_eq!((summary.coordinates(), summary.counts.base.all()), (6, summary.base_parameters.len()));
//! # Ok(())
//! # }
//! ```

mod motion;
mod summarise;
mod values;

pub use motion::{FrameJoint, MovingFrames};
pub use values::{
    BaseParameterSummary, JointSummary, MimicSummary, ParameterCount, ParameterCounts, RobotSummary, ShareSummary,
    StandardParameterSummary, TransmissionSummary,
};
