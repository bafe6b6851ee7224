//! Principal inertias of a body, and what `<compiler>` makes of them.

use thetahat_ground::vector::{IDENTITY, Mat3, product, transpose, turned};

/// Most sweeps of the Jacobi method, which converges quadratically: six are usual.
const SWEEPS: usize = 30;

/// Principal inertias, with their axes as the columns of a rotation.
pub(super) struct Principal {
    pub(super) values: [f64; 3],
    axes: Mat3,
}

impl Principal {
    /// By the Jacobi method: it keeps the axes of a diagonal matrix.
    pub(super) fn of(inertia: &Mat3) -> Self {
        let (mut matrix, mut axes) = (*inertia, IDENTITY);
        for _ in 0..SWEEPS {
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let turn = annihilating(&matrix, i, j);
                matrix = turned(&transpose(&turn), &matrix);
                axes = product(&axes, &turn);
            }
        }
        Self { values: [matrix[0][0], matrix[1][1], matrix[2][2]], axes }
    }

    /// The inertia with other principal values.
    pub(super) fn with(&self, values: [f64; 3]) -> Mat3 {
        let diagonal = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { values[i] } else { 0.0 }));
        turned(&self.axes, &diagonal)
    }
}

/// The rotation in the plane of two axes that makes their product of inertia zero.
fn annihilating(matrix: &Mat3, i: usize, j: usize) -> Mat3 {
    let mut turn = IDENTITY;
    if matrix[i][j] == 0.0 {
        return turn;
    }
    let ratio = (matrix[j][j] - matrix[i][i]) / (2.0 * matrix[i][j]);
    let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    (turn[i][i], turn[j][j], turn[i][j], turn[j][i]) = (cosine, cosine, sine, -sine);
    turn
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::vector::axis_angle;

    #[test]
    fn the_inertia_comes_back_from_its_principal_values() {
        let turn = axis_angle([0.6, 0.0, 0.8], 0.7);
        let inertia = turned(&turn, &[[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]]);
        let principal = Principal::of(&inertia);
        let mut values = principal.values;
        values.sort_by(f64::total_cmp);
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(same(&values, &[1.0, 2.0, 3.0]), "{values:?}");
        assert!(same(principal.with(principal.values).as_flattened(), inertia.as_flattened()));
    }
}
