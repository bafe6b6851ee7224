//! The columns of the rows from which the model is chosen: of all base parameters, those of friction for each velocity at which its
//! sign changes.

use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::Model,
    regressor::Regressor,
    robot::{JointQuantity, Quantity, Role},
};

/// The columns of each joint: those that act on it with the first transition, those that change with each further one, and last y.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModelColumns {
    /// The base parameters that act on each joint, in order.
    acting: Vec<Vec<usize>>,
    /// The base parameters whose columns change with the transition.
    changing: Vec<usize>,
    transitions: usize,
    parameters: usize,
}

impl ModelColumns {
    pub(crate) fn new(acting: Vec<Vec<usize>>, changing: Vec<usize>, [transitions, parameters]: [usize; 2]) -> Self {
        Self { acting, changing, transitions, parameters }
    }

    pub(crate) fn of_model(model: &Model, base: &BaseParameters, transitions: usize) -> Self {
        let regressor = Regressor::new(model, &base.columns());
        let acting = |joint: usize| {
            let entries = regressor.entries().iter().filter(|e| e.joint == joint);
            let mut columns: Vec<usize> = entries.map(|e| e.column).collect();
            columns.sort_unstable();
            columns
        };
        let acting = (0..model.coordinate_count()).map(acting).collect();
        Self::new(acting, changing(model, base), [transitions, base.len()])
    }

    pub(crate) fn joints(&self) -> usize {
        self.acting.len()
    }

    pub(crate) fn transitions(&self) -> usize {
        self.transitions
    }

    pub(crate) fn parameters(&self) -> usize {
        self.parameters
    }

    pub(crate) fn acting(&self, joint: usize) -> &[usize] {
        &self.acting[joint]
    }

    /// Those of a joint that change, in order.
    fn changing_of(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.acting[joint].iter().copied().filter(|column| self.changing.contains(column))
    }

    /// The transition and the base parameter of each column of a joint, in order; y comes after them.
    pub(crate) fn of_joint(&self, joint: usize) -> Vec<(usize, usize)> {
        let first = self.acting[joint].iter().map(|&column| (0, column));
        let further = (1..self.transitions).flat_map(|t| self.changing_of(joint).map(move |column| (t, column)));
        first.chain(further).collect()
    }

    /// Columns of a joint, with that of y.
    pub(crate) fn count(&self, joint: usize) -> usize {
        self.acting[joint].len() + (self.transitions - 1) * self.changing_of(joint).count() + 1
    }

    /// The factor of a law's columns of a joint, and of y, with those of all base parameters.
    pub(crate) fn spread(&self, joint: usize, factor: &Matrix) -> Matrix {
        let mut all = Matrix::zeros(factor.rows(), self.parameters + 1);
        for (c, &column) in self.acting[joint].iter().chain([&self.parameters]).enumerate() {
            all.column_mut(column).copy_from_slice(factor.column(c));
        }
        all
    }

    /// Columns of a joint as a law has them, in the order of the base parameters: for one that changes with the transition, the columns
    /// of all transitions are summed with these weights. That of y, and what follows it, stays.
    pub(crate) fn of_law(&self, joint: usize, weights: &[f64], all: &Matrix) -> Matrix {
        let places = self.of_joint(joint);
        let own = &self.acting[joint];
        let after = places.len()..all.columns();
        let mut of_law = Matrix::zeros(all.rows(), own.len() + after.len());
        for (k, column) in own.iter().enumerate() {
            let changes = self.changing.contains(column);
            for (place, (transition, _)) in places.iter().enumerate().filter(|(_, (_, other))| other == column) {
                let weight = if changes { weights[*transition] } else { 1.0 };
                let sums = of_law.column_mut(k).iter_mut();
                sums.zip(all.column(place)).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        for (k, place) in after.enumerate() {
            of_law.column_mut(own.len() + k).copy_from_slice(all.column(place));
        }
        of_law
    }
}

/// The base parameters whose columns depend on the sign of a velocity.
pub(crate) fn changing(model: &Model, base: &BaseParameters) -> Vec<usize> {
    let table = model.parameter_table();
    let columns = base.columns();
    (0..columns.len()).filter(|&c| takes_sign(table.get(columns[c]).quantity)).collect()
}

fn takes_sign(quantity: Quantity) -> bool {
    match quantity {
        Quantity::Joint(JointQuantity::Fvp | JointQuantity::Fvn) | Quantity::Term(_) => true,
        Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) => quantity.role() == Role::CoulombFriction,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joint one has parameters 0, 2 and 3, of which 2 changes; joint two has 1 and 3.
    #[test]
    fn a_law_has_the_columns_of_its_transition() {
        let columns = ModelColumns::new(vec![vec![0, 2, 3], vec![1, 3]], vec![2], [3, 4]);
        assert_eq!(columns.of_joint(0), [(0, 0), (0, 2), (0, 3), (1, 2), (2, 2)]);
        assert_eq!([columns.count(0), columns.count(1)], [6, 3]);
        let of_law = |joint: usize, weights: [f64; 3], values: &[f64]| {
            columns.of_law(joint, &weights, &Matrix::from_columns(1, values.to_vec())).into_values()
        };
        let first = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(of_law(0, [1.0, 0.0, 0.0], &first), [1.0, 2.0, 3.0, 6.0]);
        assert_eq!(of_law(0, [0.0, 0.0, 1.0], &first), [1.0, 5.0, 3.0, 6.0]);
        assert_eq!(of_law(0, [0.0, 0.5, 0.5], &first), [1.0, 4.5, 3.0, 6.0]);
        assert_eq!(of_law(1, [0.0, 0.0, 1.0], &[1.0, 2.0, 3.0, 4.0]), [1.0, 2.0, 3.0, 4.0]);
    }
}
