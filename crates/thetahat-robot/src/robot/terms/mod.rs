//! Torque terms in addition to those of the links and drives, as data: springs, friction laws, motor harmonics, a user-defined
//! column.
//!
//! A file has a list of [`TermDescription`]s; with a robot they become [`TermColumn`]s, each a column of the observation
//! matrix with its parameter. The value of a column in a state is defined in `dynamics/term_torques.rs`.

mod column;
mod description;
mod error;
mod expression;
mod formula;
mod joint_terms;
mod point_terms;
mod resolve;

pub use column::{
    ChannelFactor, Cylinder, LinkPoint, Shape, Stribeck, StribeckLaw, TermColumn, TwoPoints, channels_of,
};
pub use description::{Direction, PointDescription, TermDescription};
pub use error::TermError;
pub use expression::{Expression, Variable};
pub use formula::{Formula, MathFunction};
