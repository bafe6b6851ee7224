//! The motion to record, and what it will tell of each parameter: designed before the robot moves.
//!
//! A [`Design`] searches the motion within the limits of its joints whose record knows the base parameters best, friction,
//! motor inertias and offsets among them; verifies the limits at 1 kHz; and predicts the interval of each parameter, by
//! the identification that the record will go through.
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `M` | information: the inverse covariance of the base parameters | b x b | |
//! | `C` | their covariance, `M^-1` | b x b | |
//! | `J` | criterion, such as `-log det M` | 1 | nats |
//! | `x` | unknowns of a motion | | 1 |
//!
//! | file | what it does |
//! | --- | --- |
//! | `description`, `options`, `validation`, `validation_of_limits`, `validation_of_motion` | a design file, and what is refused of it |
//! | `limits` | what the joints may do |
//! | `fourier`, `splines`, `basis`, `sums` | motions as sums of functions of time that rest at both ends |
//! | `moves`, `motions` | point-to-point moves; either kind at the instants where it is looked at |
//! | `criterion`, `information` | the criterion with its derivatives |
//! | `constraints`, `loads` | limits of positions and their derivatives; limits of torque and power |
//! | `move_slopes`, `move_draws` | derivatives of moves by their unknowns; where searches of moves begin |
//! | `sweep`, `sweep_room`, `move_sweeps`, `sweeps` | sweeps of single joints at constant velocities behind the moves |
//! | `surroundings_options`, `surroundings`, `clearances` | shapes that must stay apart |
//! | `quadratic`, `optimiser` | one descent |
//! | `starts`, `crossing`, `searches` | where descents begin: random motions, and those put together from what others found; the searches |
//! | `verification`, `verified` | the limits at 1 kHz |
//! | `noise`, `prior_data` | the noise of a record; what earlier recordings tell of it and of the parameters |
//! | `robots` | the robots that it may be, with a payload and without |
//! | `prediction`, `gains`, `remedies` | what a record will tell, and one with a payload beside it; what would show what it leaves unknown |
//! | `pictures` | what the report draws of the motion |
//! | `run` | all of it |

mod basis;
mod clearances;
mod constraints;
mod criterion;
mod crossing;
mod description;
mod error;
mod experiment_text;
mod fourier;
mod gains;
mod information;
mod limits;
mod loads;
mod motions;
mod move_draws;
mod move_slopes;
mod move_sweeps;
#[cfg(test)]
mod move_tests;
mod moves;
mod noise;
mod optimiser;
mod options;
mod outcome;
mod pictures;
mod prediction;
mod prior_data;
mod problem;
mod quadratic;
mod remedies;
mod robots;
mod run;
mod searches;
mod splines;
mod starts;
mod sums;
mod surroundings;
mod surroundings_options;
mod sweep;
mod sweep_room;
mod sweeps;
mod validation;
mod validation_of_limits;
mod validation_of_motion;
mod verification;
mod verified;

#[doc(hidden)]
pub use criterion::{Criterion, CriterionName};
pub use description::Design;
#[doc(hidden)]
pub use description::DesignFile;
pub use error::DesignError;
#[doc(hidden)]
pub use information::{Information, Judgement};
#[doc(hidden)]
pub use options::{DesignObjective, LimitOptions, MotionKind, MotionOptions, NoiseOptions, UncertaintyOptions};
#[doc(hidden)]
pub use prediction::{Expected, ExpectedRecord, NoisyEstimate};
#[doc(hidden)]
pub use surroundings_options::{CapsuleOptions, CollisionOptions, ObstacleOptions};
