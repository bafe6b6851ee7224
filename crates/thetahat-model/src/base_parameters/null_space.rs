use super::{combination::Combination, dependencies::Dependencies, observations::Observations};
use thetahat_ground::linear_algebra::{Matrix, norm};

/// Size of a factor, relative to a norm of 1, below which it is rounding.
const ROUNDING: f64 = 1e-11;
/// Size above which a factor can be a pivot. Between the two limits the whole matrix must decide.
const PIVOT: f64 = 1e-5;
/// Largest effect of a dependent combination in the check states: rounding leaves less than 1e-13.
const SEEN: f64 = 1e-11;

/// Combinations of columns that are zero, each with its last column, which is the last column of no other combination.
pub(super) struct NullSpace {
    /// By the last column, whose factor is 1: the factors of all columns.
    by_last: Vec<Option<Vec<f64>>>,
}

impl NullSpace {
    /// An empty null space for this number of columns.
    pub(super) fn new(columns: usize) -> Self {
        Self { by_last: vec![None; columns] }
    }

    /// Adds a combination; `None` if its last column is not clear.
    pub(super) fn insert(&mut self, combination: &Combination) -> Option<()> {
        let mut factors = vec![0.0; self.by_last.len()];
        combination.iter().for_each(|(&column, &factor)| factors[column] = factor);
        loop {
            let last = factors.iter().rposition(|f| f.abs() > ROUNDING)?;
            factors[last + 1..].fill(0.0);
            let pivot = factors[last];
            if pivot.abs() < PIVOT {
                return None;
            }
            factors.iter_mut().for_each(|f| *f /= pivot);
            let Some(same) = &self.by_last[last] else {
                self.by_last[last] = Some(factors);
                return Some(());
            };
            subtract(&mut factors, 1.0, same);
            factors[last] = 0.0;
        }
    }

    /// Expresses each last column by those that are not last; `None` if the check states contradict.
    pub(super) fn dependencies(mut self, observations: &Observations) -> Option<Dependencies> {
        let effective = (0..self.by_last.len()).filter(|&column| observations.scale(column) > 0.0);
        let (spanned, kept): (Vec<usize>, Vec<usize>) = effective.partition(|&column| self.by_last[column].is_some());
        if kept.is_empty() {
            return None;
        }
        self.reduce();
        let scale = |column: usize| observations.scale(column);
        let mut coefficients = Matrix::zeros(kept.len(), spanned.len());
        for (k, &column) in spanned.iter().enumerate() {
            let factors = self.by_last[column].as_ref()?;
            check(observations, factors)?;
            for (row, &other) in kept.iter().enumerate() {
                *coefficients.at_mut(row, k) = -factors[other] * scale(other) / scale(column);
            }
        }
        Some(Dependencies { kept, spanned, coefficients })
    }

    /// Substitutes columns before the last that are themselves the last of another combination.
    fn reduce(&mut self) {
        for last in 0..self.by_last.len() {
            let (before, from) = self.by_last.split_at_mut(last);
            let Some(factors) = &mut from[0] else { continue };
            for (column, other) in before.iter().enumerate() {
                if let Some(other) = other.as_ref().filter(|_| factors[column] != 0.0) {
                    let factor = factors[column];
                    subtract(factors, factor, other);
                    factors[column] = 0.0;
                }
            }
        }
    }
}

fn subtract(from: &mut [f64], factor: f64, other: &[f64]) {
    from.iter_mut().zip(other).for_each(|(a, b)| *a -= factor * b);
}

fn check(observations: &Observations, factors: &[f64]) -> Option<()> {
    let combination: Combination = factors.iter().copied().enumerate().filter(|(_, f)| *f != 0.0).collect();
    let seen = norm(&observations.check(&combination));
    (seen <= SEEN * combination.values().map(|f| f.abs()).sum::<f64>()).then_some(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{dynamics::Model, robot::Robot};

    const STATES: usize = 12;

    /// Inertia of the link, of the motor, and viscous friction of a joint without gravity: in this order, scaled columns 0 and 1
    /// are the same.
    fn observations() -> Observations {
        let text = "name = 'r'\ngravity = [0, 0, 0]\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
        let model = Model::new(&Robot::parse(text, Path::new("r.toml")).unwrap());
        let index = |name: &str| model.parameter_table().iter().position(|p| p.name() == name).unwrap();
        Observations::new(&model, &["zz1", "ia1", "fv1"].map(index), STATES).unwrap()
    }

    fn dependencies(combination: &[(usize, f64)]) -> Option<Dependencies> {
        let mut space = NullSpace::new(3);
        space.insert(&combination.iter().copied().collect()).unwrap();
        space.dependencies(&observations())
    }

    #[test]
    fn a_combination_that_the_states_to_check_by_show_is_no_dependency() {
        let equal = dependencies(&[(0, -1.0), (1, 1.0)]).unwrap();
        assert_eq!((equal.kept, equal.spanned), (vec![0, 2], vec![1]));
        assert!((equal.coefficients.at(0, 0) - 1.0).abs() < 1e-12 && equal.coefficients.at(1, 0) == 0.0);
        for wrong in [[(0, -1.0), (2, 1.0)], [(0, -1.0), (1, 1.0 + 1e-9)], [(1, 1e-9), (2, 1.0)]] {
            assert!(dependencies(&wrong).is_none(), "{wrong:?}");
        }
    }
}
