//! How the standard parameters nearest to the a-priori ones change with the base parameters that they keep.

use super::{
    elimination::Elimination, error::ConsistencyError, pseudo_inertia::entries, set::ConsistentSet,
    symmetric::Symmetric,
};
use crate::{
    base_parameters::BaseParameters,
    robot::{Quantity, Role},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

/// Curvature, in usual sizes, of parameters without a divergence: almost zero, so that they absorb what they can.
const FLAT: f64 = 1e-9;
/// Fraction of its usual size below which a motor inertia without a-priori value is at zero, and stays there.
const AT_ZERO: f64 = 1e-6;
/// Fraction of a base parameter, in usual sizes, below which its remaining freedom is rounding.
const BOUND: f64 = 1e-9;

/// How standard parameters depend on base parameters, within the freedom that known values leave.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// The base parameters as functions of the free ones, base by free: the identity if no known value binds one.
    pub base: Matrix,
    /// The standard parameters as functions of the free ones, standard by free.
    pub standard: Matrix,
}

/// Of all small changes `d theta` with `K d theta = d theta_b`, the one that minimises `d theta^T H d theta`, H the second
/// derivatives of `sum_l D(P_l | P_l0)` at `standard`.
///
/// Known values of the set are kept. `standard` must have definite pseudo-inertia matrices.
///
/// # Errors
/// [`ConsistencyError`] for known values that contradict each other; [`ConsistencyError::NotSolved`] if the base parameters
/// depend on one another.
pub fn dependence_on_base(
    set: &ConsistentSet,
    base: &BaseParameters,
    standard: &[f64],
) -> Result<Dependence, ConsistencyError> {
    let count = set.parameter_table().len();
    let elimination = set.elimination()?;
    let n = elimination.matrix(&Matrix::identity(count));
    let scale = unknown_scales(set, &elimination);
    let combinations = combinations(base, count);
    let sizes = row_sizes(&combinations.scale_columns(set.scale()));
    // Relative to the usual size of each base parameter.
    let all = elimination.matrix(&combinations);
    let (free, base_by_free) = free_of(&all.scale_columns(&scale).scale_rows(&reciprocals(&sizes)), &sizes);
    let k = all.transpose().select_columns(&free).transpose();
    let h = n.transposed_times(&curvature(set, standard).times_matrix(&n));
    let (unknowns, bases) = (n.columns(), k.rows());
    // In usual sizes, because the entries of H are reciprocal squares of masses and of moments.
    let entry = |i: usize, j: usize| match (i < unknowns, j < unknowns) {
        (true, true) => h.at(i, j) * scale[i] * scale[j],
        (true, false) => k.at(j - unknowns, i) * scale[i],
        (false, true) => k.at(i - unknowns, j) * scale[j],
        (false, false) => 0.0,
    };
    let system = Matrix::from_fn(unknowns + bases, unknowns + bases, entry);
    let right = Matrix::from_fn(unknowns + bases, bases, |i, j| if i == unknowns + j { 1.0 } else { 0.0 });
    let solved = PivotedQr::new(&system).solve_matrix(&right);
    if !(0..bases).all(|j| solved.column(j).iter().all(|v| v.is_finite())) {
        return Err(ConsistencyError::NotSolved);
    }
    let standard = n.times_matrix(&Matrix::from_fn(unknowns, bases, |i, j| scale[i] * solved.at(i, j)));
    Ok(Dependence { base: base_by_free, standard })
}

/// The independent rows of a matrix, and all rows, divided by the given sizes, expressed by them.
fn free_of(rows: &Matrix, sizes: &[f64]) -> (Vec<usize>, Matrix) {
    let columns = rows.transpose();
    let qr = PivotedQr::new(&columns);
    let rank = qr.rank(BOUND);
    if rank == rows.rows() {
        return ((0..rank).collect(), Matrix::identity(rank));
    }
    let mut free = qr.pivots()[..rank].to_vec();
    free.sort_unstable();
    if free.is_empty() {
        return (free, Matrix::zeros(rows.rows(), 0));
    }
    let by_free = PivotedQr::new(&columns.select_columns(&free)).solve_matrix(&columns);
    let entry = |i: usize, j: usize| {
        let own = free.iter().position(|f| *f == i);
        own.map_or_else(|| sizes[i] * by_free.at(j, i) / sizes[free[j]], |own| if own == j { 1.0 } else { 0.0 })
    };
    let base_by_free = Matrix::from_fn(rows.rows(), rank, entry);
    (free, base_by_free)
}

fn row_sizes(matrix: &Matrix) -> Vec<f64> {
    (0..matrix.rows()).map(|i| (0..matrix.columns()).map(|j| matrix.at(i, j).powi(2)).sum::<f64>().sqrt()).collect()
}

fn reciprocals(sizes: &[f64]) -> Vec<f64> {
    sizes.iter().map(|size| 1.0 / size).collect()
}

/// K: `theta_b = K theta`.
fn combinations(base: &BaseParameters, count: usize) -> Matrix {
    let mut k = Matrix::zeros(base.len(), count);
    for (row, parameter) in base.parameters().iter().enumerate() {
        for &(column, c) in parameter.regrouped.iter().chain(&[(parameter.kept, 1.0)]) {
            *k.at_mut(row, column) += c;
        }
    }
    k
}

fn unknown_scales(set: &ConsistentSet, elimination: &Elimination) -> Vec<f64> {
    elimination.unknowns_of(set.scale())
}

/// H: `tr(P^-1 E_v P^-1 E_w)` of each link, `1 / s^2` of motor inertias.
fn curvature(set: &ConsistentSet, standard: &[f64]) -> Matrix {
    let table = set.parameter_table();
    let mut h = Matrix::zeros(table.len(), table.len());
    for (link, p) in set.pseudo_inertias(standard).iter().enumerate() {
        let Some(inverse) = p.cholesky().map(|factor| factor.inverse()) else { continue };
        let own: Vec<(usize, Symmetric)> = table
            .iter()
            .enumerate()
            .filter_map(|(i, parameter)| match parameter.quantity {
                Quantity::Link(quantity) if parameter.number == link + 1 => {
                    Some((i, Symmetric::around(&inverse, entries(quantity), &inverse)))
                }
                Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_) => None,
            })
            .collect();
        for (i, around) in &own {
            for (j, _) in &own {
                if let Quantity::Link(quantity) = table.get(*j).quantity {
                    *h.at_mut(*i, *j) = along(around, entries(quantity));
                }
            }
        }
    }
    for (i, parameter) in table.iter().enumerate() {
        let size = set.scale()[i];
        match parameter.quantity.role() {
            Role::Inertial => {}
            Role::MotorInertia if set.a_priori()[i] > 0.0 => *h.at_mut(i, i) = standard[i].max(AT_ZERO * size).powi(-2),
            Role::MotorInertia if standard[i] < AT_ZERO * size => *h.at_mut(i, i) = (AT_ZERO * size).powi(-2),
            Role::MotorInertia | Role::ViscousFriction | Role::CoulombFriction | Role::Load => {
                *h.at_mut(i, i) = FLAT / (size * size);
            }
        }
    }
    h
}

/// `tr(A E)` of a symmetric A and E by its entries on and below the diagonal.
fn along(a: &Symmetric, entries: &[(usize, usize, f64)]) -> f64 {
    entries.iter().map(|&(i, j, v)| if i == j { v * a.at(i, i) } else { 2.0 * v * a.at(i, j) }).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        consistency::{LeastSquares, Prior, completed_a_priori, fit},
        dynamics::Model,
        robot::Robot,
    };

    /// The derivative equals the change of the nearest parameters for a small change of the base parameters.
    #[test]
    fn it_is_the_derivative_of_the_nearest_parameters() {
        let text = include_str!("../../../thetahat/demo/tx40.toml");
        let robot = Robot::parse(text, std::path::Path::new("tx40.toml")).unwrap();
        let a_priori = completed_a_priori(&robot, None);
        let set = ConsistentSet::new(&robot, &a_priori).unwrap();
        let base = BaseParameters::of(&Model::new(&robot), &[]).unwrap();
        let centre = base.from_standard(&a_priori);
        let count = a_priori.len();
        let nearest = |theta_b: &[f64]| {
            let bounds: Vec<[f64; 2]> = theta_b.iter().map(|v| [*v, *v]).collect();
            let kept = set.clone().with_base_between(&base, &bounds).unwrap();
            let nothing = LeastSquares::in_standard(Matrix::zeros(1, count), vec![0.0]);
            fit(&kept, &nothing, Prior::LogDet { weight: 1.0 }, None).unwrap().standard
        };
        let at = nearest(&centre);
        let g = dependence_on_base(&set, &base, &at).unwrap().standard;
        // Base parameters follow exactly.
        let identity = combinations(&base, count).times_matrix(&g);
        for i in 0..base.len() {
            for j in 0..base.len() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((identity.at(i, j) - expected).abs() < 1e-9, "{i} {j}: {}", identity.at(i, j));
            }
        }
        for (j, parameter) in base.parameters().iter().enumerate().filter(|(_, p)| !p.regrouped.is_empty()) {
            let step = 1e-4 * centre[j].abs().max(1e-3);
            let moved = |sign: f64| {
                let mut theta_b = centre.clone();
                theta_b[j] += sign * step;
                nearest(&theta_b)
            };
            let slope: Vec<f64> =
                moved(1.0).iter().zip(moved(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect();
            let size = slope.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for (i, slope) in slope.iter().enumerate() {
                let found = g.at(i, j);
                assert!((slope - found).abs() < 2e-3 * size, "{} {i}: {slope} {found}", parameter.name);
            }
        }
    }
}
