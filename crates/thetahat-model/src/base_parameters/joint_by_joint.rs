//! Dependencies joint by joint: the cost grows with the square of the number of joints.
//!
//! A column enters at the last coordinate on which it acts. The coordinates are passed from the last to the first. At
//! each coordinate, the new columns and the combinations carried along are combined such that they do not act on it:
//! these are all combinations of the columns entered so far that act on none of the coordinates passed. A combination
//! that inertial columns of the links before reproduce entirely, on all coordinates, is a dependency and leaves; the
//! others are carried along.

use std::collections::BTreeSet;

use super::{
    combination::Combination,
    dependencies::Dependencies,
    left_to_right::{Column, LeftToRight},
    null_space::NullSpace,
    observations::Observations,
};
use crate::dynamics::Model;

/// States beyond the number of columns examined together, so that random ones cannot be dependent by chance.
const MARGIN: usize = 16;

/// The dependencies of the standard parameters at `considered`; `None` if this number of states is not enough, or a decision is
/// not clear.
pub(super) fn dependencies(model: &Model, considered: &[usize], states: usize) -> Option<Dependencies> {
    let observations = Observations::new(model, considered, states)?;
    let inertial = considered.iter().map(|&i| model.parameter_table().get(i).quantity.is_inertial()).collect();
    let mut search = Search::new(&observations, inertial, model.coordinate_count());
    (0..model.coordinate_count()).rev().try_for_each(|coordinate| search.pass(coordinate))?;
    if !search.carried.is_empty() {
        // They act on each coordinate by less than rounding, on all together by more.
        return None;
    }
    search.null_space.dependencies(&observations)
}

struct Search<'a> {
    observations: &'a Observations,
    /// Whether each column belongs to an inertial parameter of a link.
    inertial: Vec<bool>,
    /// The columns that enter at each coordinate, rising.
    entering: Vec<Vec<usize>>,
    /// Combinations that act on none of the coordinates passed, but on others.
    carried: Vec<Combination>,
    null_space: NullSpace,
}

impl<'a> Search<'a> {
    fn new(observations: &'a Observations, inertial: Vec<bool>, coordinates: usize) -> Self {
        let mut entering = vec![Vec::new(); coordinates];
        for column in 0..observations.columns() {
            observations.coordinates(column).take(1).for_each(|last| entering[last].push(column));
        }
        let null_space = NullSpace::new(observations.columns());
        Self { observations, inertial, entering, carried: Vec::new(), null_space }
    }

    /// Advances from the combinations that act on no coordinate after this one to those that also do not act on this one.
    fn pass(&mut self, coordinate: usize) -> Option<()> {
        let new = units(&self.entering[coordinate]).chain(std::mem::take(&mut self.carried));
        let mut unseen = self.unseen(coordinate, new)?;
        unseen.sort_by_key(|combination| combination.last_key_value().map(|(column, _)| *column));
        if unseen.is_empty() {
            return Some(());
        }
        self.carried = self.take_up(unseen, &self.before(coordinate))?;
        Some(())
    }

    /// The combinations that do not act on a coordinate.
    fn unseen(&self, coordinate: usize, combinations: impl Iterator<Item = Combination>) -> Option<Vec<Combination>> {
        let mut examined = Examined::default();
        for combination in combinations {
            examined.push(self.observations.torques(coordinate, &combination), combination)?;
        }
        Some(examined.dependent)
    }

    /// Stores the combinations that the columns of earlier links reproduce, and returns the others.
    fn take_up(&mut self, unseen: Vec<Combination>, before: &[usize]) -> Option<Vec<Combination>> {
        let mut examined = Examined::default();
        for column in units(before) {
            examined.push(self.observations.combined(&column), column)?;
        }
        let columns = examined.independent.len();
        examined.dependent.clear();
        for combination in unseen {
            examined.push(self.observations.combined(&combination), combination)?;
        }
        examined.dependent.iter().try_for_each(|combination| self.null_space.insert(combination))?;
        Some(examined.independent.split_off(columns))
    }

    /// The inertial columns of earlier links than those entering at a coordinate.
    fn before(&self, coordinate: usize) -> Vec<usize> {
        let inertial = |column: &usize| self.inertial[*column];
        let links = self.entering[coordinate].iter().copied().filter(inertial);
        let before: BTreeSet<usize> = links.filter_map(|link| self.observations.coordinates(link).nth(1)).collect();
        before.into_iter().flat_map(|c| self.entering[c].iter().copied().filter(inertial)).collect()
    }
}

fn units(columns: &[usize]) -> impl Iterator<Item = Combination> {
    columns.iter().map(|&column| Combination::from([(column, 1.0)]))
}

/// Combinations examined one after the other.
#[derive(Default)]
struct Examined {
    columns: LeftToRight,
    independent: Vec<Combination>,
    /// Sums of combinations, whose values are zero and whose coefficients have norm 1.
    dependent: Vec<Combination>,
}

impl Examined {
    /// Adds the next combination, with its values; `None` if it is not clear whether it is independent.
    fn push(&mut self, values: Vec<f64>, combination: Combination) -> Option<()> {
        if self.independent.len() + MARGIN >= values.len() {
            return None;
        }
        match self.columns.push(values)? {
            Column::Independent => self.independent.push(combination),
            Column::Spanned(factors) => self.dependent.push(self.difference(combination, &factors)),
        }
        Some(())
    }

    fn difference(&self, mut combination: Combination, factors: &[f64]) -> Combination {
        for (independent, factor) in self.independent.iter().zip(factors) {
            for (&column, value) in independent {
                *combination.entry(column).or_insert(0.0) -= factor * value;
            }
        }
        let size = combination.values().map(|v| v * v).sum::<f64>().sqrt();
        combination.values_mut().for_each(|v| *v /= size);
        combination
    }
}
