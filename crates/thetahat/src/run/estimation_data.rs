//! What estimations are made from: recordings, or a reduction of them.

use super::{
    identification::Identification, reduced::data::ReducedIdentification, validation::cross_validation::Folds,
};
use crate::preparation::{Problem, Setup};

/// Where the rows of a problem come from.
#[derive(Clone, Copy)]
pub(super) enum EstimationData<'a> {
    /// Recordings with all their samples.
    Samples(&'a Identification),
    /// Rows alone.
    Reduced(&'a ReducedIdentification<'a>),
}

impl<'a> EstimationData<'a> {
    pub(super) fn setup(self) -> Setup<'a> {
        match self {
            Self::Samples(identification) => identification.setup(),
            Self::Reduced(identification) => identification.setup(),
        }
    }

    /// What only samples give: simulations, curves and recordings that are held back.
    pub(super) fn samples(self) -> Option<&'a Identification> {
        match self {
            Self::Samples(identification) => Some(identification),
            Self::Reduced(_) => None,
        }
    }

    /// What is left out in turn.
    pub(super) fn folds(self, problem: &Problem) -> Option<Folds> {
        match self {
            Self::Samples(identification) => identification.folds(problem),
            Self::Reduced(identification) => identification.folds(),
        }
    }

    /// The true values of what a problem estimates, of twins.
    pub(super) fn truth_of(self, problem: &Problem) -> Option<Vec<f64>> {
        match self {
            Self::Samples(identification) => identification.truth_of(problem),
            Self::Reduced(identification) => identification.truth(),
        }
    }
}
