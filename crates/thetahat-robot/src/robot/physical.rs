//! Physical bounds of parameters: motor inertias and friction are nonnegative, and links are rigid bodies.

use super::{
    parameters::ParameterTable,
    quantity::{Bound, INERTIAL, Quantity},
};
use thetahat_ground::{linear_algebra::Matrix, vector::norm};

/// Size of an inertia, relative to the largest, below which it is rounding.
const ROUNDING: f64 = 1e-12;
/// Magnitudes of gravity that are accepted, m/s^2: from below that of the Moon, to allow rounding in inclined frames, to three
/// times that of the Earth. Smaller numbers are probably given in g.
const GRAVITY: std::ops::RangeInclusive<f64> = 1.5..=30.0;

/// What [`is_gravity`] accepts, in words.
pub const EXPECTED_GRAVITY: &str =
    "m/s^2 in the base frame, of length 1.5 to 30, such as [0, 0, -9.81] (1 g is 9.81 m/s^2), or zeros";

/// Whether a vector is gravity in m/s^2, or zeros.
#[must_use]
pub fn is_gravity(gravity: [f64; 3]) -> bool {
    let length = norm(gravity);
    length == 0.0 || GRAVITY.contains(&length)
}

/// Why a set of standard parameters is physically impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotPhysical {
    /// A motor inertia or friction below zero.
    #[error("{name} = {value:.3e}, below zero")]
    Negative {
        /// Name of the parameter.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A link, some of whose inertial parameters are not zero, has no mass above zero.
    #[error("link {link}: its mass is {mass:.3e}")]
    Mass {
        /// Number of the link, from one.
        link: usize,
        /// Its mass, kg.
        mass: f64,
    },
    /// The inertia of this link about its centre of mass is physically impossible.
    #[error(
        "link {link}: its principal inertias about the centre of mass are {:.3e}, {:.3e} and {:.3e}: not all positive, \
         or the largest above the sum of the others", principal[0], principal[1], principal[2]
    )]
    Inertia {
        /// Number of the link, from one.
        link: usize,
        /// Principal inertias about the centre of mass, rising, kg m^2.
        principal: [f64; 3],
    },
}

impl ParameterTable {
    /// Checks that the standard parameters `theta` are physically possible. A link whose inertial parameters are all zero
    /// passes: it is unknown.
    ///
    /// # Errors
    /// [`NotPhysical`]: the first parameter below its bound, otherwise the first impossible link.
    pub fn check_physical(&self, theta: &[f64]) -> Result<(), NotPhysical> {
        let below = |(parameter, value): &(&super::parameters::Parameter, &f64)| match parameter.quantity.bound() {
            Bound::NotNegative => **value < 0.0,
            Bound::Free | Bound::Body => false,
        };
        if let Some((parameter, value)) = self.iter().zip(theta).find(below) {
            return Err(NotPhysical::Negative { name: parameter.name(), value: *value });
        }
        let links = self.iter().filter(|p| p.quantity.is_inertial()).map(|p| p.number).max().unwrap_or(0);
        (0..links).try_for_each(|link| {
            let value = |quantity| self.index(Quantity::Link(quantity), link).map_or(0.0, |i| theta[i]);
            check_link(link + 1, INERTIAL.map(value))
        })
    }
}

/// Checks that the parameters of link number `link`, in the order of [`INERTIAL`], are those of a rigid body.
fn check_link(link: usize, inertial: [f64; 10]) -> Result<(), NotPhysical> {
    if inertial.iter().all(|v| *v == 0.0) {
        return Ok(());
    }
    let mass = inertial[9];
    if mass <= 0.0 {
        return Err(NotPhysical::Mass { link, mass });
    }
    let principal = principal_inertias(inertial);
    let [smallest, middle, largest] = principal;
    let body = smallest > 0.0 && smallest + middle >= largest * (1.0 - ROUNDING);
    if body { Ok(()) } else { Err(NotPhysical::Inertia { link, principal }) }
}

/// Principal inertias about the centre of mass, rising, of a link with a mass, by its parameters in the order of
/// [`INERTIAL`].
pub(super) fn principal_inertias([xx, xy, xz, yy, yz, zz, mx, my, mz, mass]: [f64; 10]) -> [f64; 3] {
    // The inertia about the centre of mass, by the theorem of Huygens and Steiner.
    let square = mx * mx + my * my + mz * mz;
    let at = |i: usize, j: usize, about_origin: f64| {
        let s = [mx, my, mz];
        about_origin - (if i == j { square } else { 0.0 } - s[i] * s[j]) / mass
    };
    let upper = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    symmetric_eigenvalues(&Matrix::from_fn(3, 3, |i, j| at(i, j, upper[i][j])))
}

/// Whether these principal inertias, rising, are physically possible if their digits leave an error of the fraction `rounding`
/// of the largest.
pub(super) fn are_of_a_body([smallest, middle, largest]: [f64; 3], rounding: f64) -> bool {
    smallest >= -rounding * largest.abs() && smallest + middle >= largest - rounding * largest.abs()
}

/// Eigenvalues of a symmetric matrix of three rows, rising, in closed form (O. K. Smith, "Eigenvalues of a symmetric
/// 3 x 3 matrix", Communications of the ACM 4, 1961).
fn symmetric_eigenvalues(a: &Matrix) -> [f64; 3] {
    let mean = (a.at(0, 0) + a.at(1, 1) + a.at(2, 2)) / 3.0;
    let off = a.at(0, 1).powi(2) + a.at(0, 2).powi(2) + a.at(1, 2).powi(2);
    let spread = (0..3).map(|i| (a.at(i, i) - mean).powi(2)).sum::<f64>() + 2.0 * off;
    let p = (spread / 6.0).sqrt();
    if p <= f64::MIN_POSITIVE {
        return [mean; 3];
    }
    let b = Matrix::from_fn(3, 3, |i, j| (a.at(i, j) - if i == j { mean } else { 0.0 }) / p);
    let angle = (0.5 * determinant(&b)).clamp(-1.0, 1.0).acos() / 3.0;
    let largest = mean + 2.0 * p * angle.cos();
    let smallest = mean + 2.0 * p * (angle + 2.0 * std::f64::consts::FRAC_PI_3).cos();
    [smallest, 3.0 * mean - largest - smallest, largest]
}

fn determinant(a: &Matrix) -> f64 {
    let minor = |i: usize, j: usize| a.at(1, i) * a.at(2, j) - a.at(1, j) * a.at(2, i);
    a.at(0, 0) * minor(1, 2) - a.at(0, 1) * minor(0, 2) + a.at(0, 2) * minor(0, 1)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{joint::JointKind, quantity::Friction},
        *,
    };

    fn table() -> ParameterTable {
        ParameterTable::new(&[JointKind::Revolute], Friction::Symmetric, &[])
    }

    fn set(values: &[(&str, f64)]) -> Vec<f64> {
        let table = table();
        let mut theta = vec![0.0; table.len()];
        values.iter().for_each(|(name, v)| theta[table.index_of(name).unwrap()] = *v);
        theta
    }

    #[test]
    fn eigenvalues_are_those_of_a_turned_diagonal() {
        let (c, s) = (0.6, 0.8);
        let turn = Matrix::from_fn(3, 3, |i, j| [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]][i][j]);
        let diagonal = Matrix::from_fn(3, 3, |i, j| if i == j { [3.0, 1.0, 2.0][i] } else { 0.0 });
        let turned = turn.times_matrix(&diagonal).times_matrix(&turn.transpose());
        for (found, expected) in symmetric_eigenvalues(&turned).iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn a_body_away_from_its_frame_is_possible_and_a_defect_is_named() {
        // A ball of 2 kg, 0.02 kg m^2 about its centre, at x = 0.5 m.
        let ball = [("m1", 2.0), ("mx1", 1.0), ("xx1", 0.02), ("yy1", 0.52), ("zz1", 0.52), ("ia1", 0.1)];
        assert_eq!(table().check_physical(&set(&ball)), Ok(()));
        for (name, value, word) in
            [("m1", -2.0, "mass"), ("yy1", 0.49, "principal"), ("xx1", 0.05, "principal"), ("ia1", -0.1, "ia1")]
        {
            let mut wrong = set(&ball);
            wrong[table().index_of(name).unwrap()] = value;
            let found = table().check_physical(&wrong).unwrap_err().to_string();
            assert!(found.contains(word), "{name}: {found}");
        }
    }

    #[test]
    fn every_bound_counts_and_an_offset_has_none() {
        let table = ParameterTable::new(&[JointKind::Revolute; 2], Friction::Asymmetric, &[1]);
        for (i, parameter) in table.iter().enumerate() {
            let mut theta = vec![0.0; table.len()];
            theta[i] = -1.0;
            let possible = table.check_physical(&theta).is_ok();
            assert_eq!(possible, parameter.name().starts_with("off"), "{}", parameter.name());
        }
    }

    #[test]
    fn messages_name_the_parameter_or_the_link() {
        let message = |values: &[(&str, f64)]| table().check_physical(&set(values)).unwrap_err().to_string();
        assert_eq!(message(&[("fc1", -0.25)]), "fc1 = -2.500e-1, below zero");
        assert_eq!(message(&[("xx1", 1.0)]), "link 1: its mass is 0.000e0");
        assert_eq!(
            message(&[("m1", 1.0), ("xx1", 3.0), ("yy1", 1.0), ("zz1", 1.0)]),
            "link 1: its principal inertias about the centre of mass are 1.000e0, 1.000e0 and 3.000e0: not all positive, \
             or the largest above the sum of the others"
        );
    }
}
