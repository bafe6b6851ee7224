//! The robot as described or with more torque terms, with the rows that the model is fitted to.

use super::{beliefs::beliefs, law::Law, rows::ModelRows};
use crate::{
    preparation::{Case, PreparationError, Problem},
    run::{identification::Identification, prepared::filtered},
};
use thetahat_model::{consistency::ConsistentSet, robot::TermDescription};

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
    pub(super) rows: Vec<(f64, ModelRows)>,
}

impl<'a> Variant<'a> {
    /// None with the reason if no such robot is physical.
    pub(super) fn new(
        identification: &'a Identification,
        problem: &'a Problem,
        terms: &'a [TermDescription],
        transitions: &[f64],
    ) -> Result<Result<Self, String>, PreparationError> {
        let set = match problem.consistent_set(identification.setup()) {
            Ok(set) => set,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let first = ModelRows::new(identification.setup(), &identification.main, problem, transitions[0])?;
        let beliefs = beliefs(identification, problem, &first, set);
        let set = match set.clone().with_beliefs(beliefs) {
            Ok(set) => set,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let mut rows = vec![(transitions[0], first)];
        for transition in &transitions[1..] {
            let found = rows[0].1.with_transition(identification, problem, *transition)?;
            rows.push((*transition, found));
        }
        Ok(Ok(Self { identification, problem, set, terms, rows }))
    }

    pub(super) fn laws(&self) -> impl Iterator<Item = Law<'_>> {
        self.rows.iter().map(|(transition, rows)| Law {
            set: &self.set,
            base: &self.problem.base,
            rows,
            transition: *transition,
            terms: self.terms,
        })
    }
}
