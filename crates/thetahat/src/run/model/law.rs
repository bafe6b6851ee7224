//! What the model is fitted in: a law of friction, with the rows that it makes.

use super::{columns::ModelColumns, law_factors::LawFactors, rows::ModelRows};
use thetahat_model::{
    base_parameters::BaseParameters, consistency::ConsistentSet, dynamics::FrictionTransition, robot::TermDescription,
};

/// A law of friction: a transition of the robot as described, or one with more torque terms.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    pub(super) set: &'a ConsistentSet,
    pub(super) base: &'a BaseParameters,
    pub(super) columns: &'a ModelColumns,
    pub(super) factors: &'a LawFactors,
    /// The rows in the order of time; none of a reduction.
    pub(super) rows: Option<&'a ModelRows>,
    pub(super) transition: FrictionTransition,
    /// In addition to the robot's.
    pub(super) terms: &'a [TermDescription],
}
