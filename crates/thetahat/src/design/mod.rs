//! The motion to record and the intervals that its recording will give: designed before the robot moves.
//!
//! A [`Design`] searches, within the limits of the joints, the motion whose recording has the most information on the base
//! parameters (friction, motor inertias and offsets included); verifies the limits at 1 kHz; and predicts the interval of each
//! parameter by running the later identification on simulated noisy recordings.
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `M` | information: the inverse covariance of the base parameters | b x b | |
//! | `C` | their covariance, `M^-1` | b x b | |
//! | `J` | criterion, such as `-log det M` | 1 | nats |
//! | `x` | unknowns of a motion | | 1 |
//!
//! | folder | what it does |
//! | --- | --- |
//! | `text` | the design file and its validation; the results; the experiment file that follows |
//! | `motions` | motions as functions of unknowns: sums of functions of time that rest at both ends, point-to-point moves, sweeps |
//! | `limits` | limits of joints, loads and distances between shapes; their verification at 1 kHz |
//! | `search` | the criterion with its derivatives, one descent, and the searches |
//! | `prediction` | prior data, noise, predicted intervals, and the motion that would identify what stays unknown |
//! | `run` | all of it |

mod error;
mod limits;
mod motions;
mod prediction;
mod run;
mod search;
mod text;

pub use error::DesignError;
#[doc(hidden)]
pub use prediction::expected::{Expected, ExpectedRecording, NoisyEstimate};
#[doc(hidden)]
pub use search::watch::DesignProgress;
#[doc(hidden)]
pub use search::{
    criterion::{Criterion, CriterionName},
    information::{Information, MotionCriterion},
};
pub use text::description::Design;
#[doc(hidden)]
pub use text::{
    collision_options::{CapsuleOptions, CollisionOptions, ObstacleOptions},
    description::DesignFile,
    options::{DesignObjective, LimitOptions, MotionKind, MotionOptions, NoiseOptions, UncertaintyOptions},
};
