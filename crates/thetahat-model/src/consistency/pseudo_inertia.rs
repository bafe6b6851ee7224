//! The pseudo-inertia matrix of a link, and its inverse transformation.

use super::symmetric::Symmetric;
use crate::robot::{INERTIAL, LinkQuantity};

/// The entries of each inertial parameter in the pseudo-inertia matrix, on and below the diagonal.
///
/// `P = [[Sigma, h], [h^T, m]]` with the second moments `Sigma = tr(I)/2 1 - I`, the inertia tensor I about the origin of
/// the link's frame and the first moments `h = (mx, my, mz)` (Wensing, Kim and Slotine 2018, equation (12)).
pub(super) fn entries(quantity: LinkQuantity) -> &'static [(usize, usize, f64)] {
    match quantity {
        LinkQuantity::Xx => &[(0, 0, -0.5), (1, 1, 0.5), (2, 2, 0.5)],
        LinkQuantity::Yy => &[(0, 0, 0.5), (1, 1, -0.5), (2, 2, 0.5)],
        LinkQuantity::Zz => &[(0, 0, 0.5), (1, 1, 0.5), (2, 2, -0.5)],
        LinkQuantity::Xy => &[(1, 0, -1.0)],
        LinkQuantity::Xz => &[(2, 0, -1.0)],
        LinkQuantity::Yz => &[(2, 1, -1.0)],
        LinkQuantity::Mx => &[(3, 0, 1.0)],
        LinkQuantity::My => &[(3, 1, 1.0)],
        LinkQuantity::Mz => &[(3, 2, 1.0)],
        LinkQuantity::M => &[(3, 3, 1.0)],
    }
}

/// The pseudo-inertia matrix, 4 x 4, of the ten inertial parameters in the order of [`INERTIAL`].
///
/// It is positive semidefinite if and only if some distribution of mass has these parameters. kg m^2, kg m and kg.
#[must_use]
pub fn pseudo_inertia(inertial: [f64; 10]) -> Symmetric {
    let mut out = Symmetric::zeros(4);
    for (quantity, value) in INERTIAL.into_iter().zip(inertial) {
        entries(quantity).iter().for_each(|&(i, j, factor)| out.add(i, j, factor * value));
    }
    out
}

/// The ten inertial parameters, in the order of [`INERTIAL`], of a pseudo-inertia matrix.
#[must_use]
pub fn inertial_parameters(p: &Symmetric) -> [f64; 10] {
    let [x, y, z] = [p.at(0, 0), p.at(1, 1), p.at(2, 2)];
    let moments = [p.at(3, 0), p.at(3, 1), p.at(3, 2), p.at(3, 3)];
    let [mx, my, mz, m] = moments;
    [y + z, -p.at(1, 0), -p.at(2, 0), x + z, -p.at(2, 1), x + y, mx, my, mz, m]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inertial_parameters_come_back() {
        let given = [0.5, 0.01, -0.02, 0.4, 0.03, 0.3, 0.1, -0.2, 0.3, 2.0];
        let back = inertial_parameters(&pseudo_inertia(given));
        assert!(given.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn a_point_mass_has_rank_one() {
        let (m, [x, y, z]) = (2.0, [0.1, -0.3, 0.5]);
        let tensor =
            [m * (y * y + z * z), -m * x * y, -m * x * z, m * (x * x + z * z), -m * y * z, m * (x * x + y * y)];
        let [xx, xy, xz, yy, yz, zz] = tensor;
        let values = pseudo_inertia([xx, xy, xz, yy, yz, zz, m * x, m * y, m * z, m]).eigenvalues();
        assert!(values[..3].iter().all(|v| v.abs() < 1e-15));
        assert!((values[3] - m * (1.0 + x * x + y * y + z * z)).abs() < 1e-14);
    }
}
