//! The robot as described or with more torque terms, with the rows that the model is fitted to.

use super::{
    beliefs::beliefs,
    folds::ModelFolds,
    law::Law,
    law_factors::{LawFactors, ModelData},
    of_rows::data_of_rows,
    rows::ModelRows,
};
use crate::{
    preparation::{Case, PreparationError, Problem},
    run::{identification::Identification, prepared::filtered},
};
use thetahat_model::{consistency::ConsistentSet, dynamics::FrictionTransition, robot::TermDescription};

/// The same recordings of a robot with more torque terms.
pub(super) struct WithTerms {
    pub(super) identification: Identification,
    pub(super) problem: Problem,
    pub(super) terms: Vec<TermDescription>,
}

impl WithTerms {
    /// None if the robot cannot have the terms.
    pub(super) fn new(
        identification: &Identification,
        terms: &[TermDescription],
    ) -> Result<Option<Self>, PreparationError> {
        let Some(identification) = identification.with_terms(terms) else { return Ok(None) };
        let problem = identification.setup().problem(&Case::nominal(), &filtered(&identification.main))?;
        Ok(Some(Self { identification, problem, terms: terms.to_vec() }))
    }
}

/// A robot with its physical set and its rows.
pub(super) struct Variant<'a> {
    pub(super) identification: &'a Identification,
    pub(super) problem: &'a Problem,
    pub(super) set: ConsistentSet,
    /// In addition to the robot's.
    pub(super) terms: &'a [TermDescription],
    /// The rows of each velocity at which friction changes its sign.
    pub(super) rows: Vec<(FrictionTransition, ModelRows)>,
    data: ModelData,
    /// The same rows as triangular factors.
    pub(super) factors: Vec<LawFactors>,
}

impl<'a> Variant<'a> {
    /// None with the reason if no such robot is physical.
    pub(super) fn new(
        identification: &'a Identification,
        problem: &'a Problem,
        terms: &'a [TermDescription],
        transitions: &[FrictionTransition],
    ) -> Result<Result<Self, String>, PreparationError> {
        let set = match problem.consistent_set(identification.setup()) {
            Ok(set) => set,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let first = ModelRows::new(identification.setup(), &identification.main, problem, transitions[0])?;
        let mut rows = vec![(transitions[0], first)];
        for transition in &transitions[1..] {
            let found = rows[0].1.with_transition(identification, problem, *transition)?;
            rows.push((*transition, found));
        }
        let data = data_of_rows(identification.setup(), &identification.main, problem, &rows);
        let factors = data.laws();
        let mean_position = data.recordings.first().map_or(&[][..], |(_, first)| &first.mean_position);
        let beliefs = beliefs(identification.setup(), problem, (&factors[0], mean_position), set);
        match set.clone().with_beliefs(beliefs) {
            Ok(set) => Ok(Ok(Self { identification, problem, set, terms, rows, data, factors })),
            Err(error) => Ok(Err(error.to_string())),
        }
    }

    /// The same with another velocity at which friction changes its sign, and no other.
    pub(super) fn with_transition(&self, transition: FrictionTransition) -> Result<Self, PreparationError> {
        let Self { identification, problem, terms, .. } = *self;
        let rows = vec![(transition, self.rows[0].1.with_transition(identification, problem, transition)?)];
        let data = data_of_rows(identification.setup(), &identification.main, problem, &rows);
        let factors = data.laws();
        Ok(Self { identification, problem, set: self.set.clone(), terms, rows, data, factors })
    }

    pub(super) fn folds(&self) -> ModelFolds {
        self.data.folds()
    }

    pub(super) fn laws(&self) -> impl Iterator<Item = Law<'_>> + Clone {
        self.rows.iter().zip(&self.factors).map(|((transition, rows), factors)| Law {
            set: &self.set,
            base: &self.problem.base,
            columns: &self.data.columns,
            factors,
            rows: Some(rows),
            transition: *transition,
            terms: self.terms,
        })
    }
}
