//! The range of one base parameter in the physically consistent set, whatever the others are.

use super::{set::ConsistentSet, symmetric::Symmetric};
use crate::{
    base_parameters::BaseParameter,
    robot::{Bound, LinkQuantity, Quantity},
};

/// Size of an eigenvalue relative to the largest below which it is rounding.
const ROUNDING: f64 = 1e-12;

/// The least and the largest value of a base parameter in the set, ignoring known values: 0 or infinite.
///
/// A base parameter is `sum_l tr(C_l P_l) + sum_k c_k s_k` with the pseudo-inertia matrices P and the nonnegative parameters s.
/// It is nonnegative if and only if all C_l are positive semidefinite, no c_k is negative and it contains nothing else: the
/// dual cone.
#[must_use]
pub fn bounds_of(set: &ConsistentSet, parameter: &BaseParameter) -> [f64; 2] {
    let table = set.parameter_table();
    let mut links: Vec<Symmetric> = vec![Symmetric::zeros(4); set.links()];
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for &(i, c) in parameter.regrouped.iter().chain(&[(parameter.kept, 1.0)]) {
        let Quantity::Link(quantity) = table.get(i).quantity else {
            let free = table.get(i).quantity.bound() != Bound::NotNegative;
            (lowest, highest) = if free { (f64::NEG_INFINITY, f64::INFINITY) } else { (lowest.min(c), highest.max(c)) };
            continue;
        };
        for &(row, column, factor) in adjoint(quantity) {
            links[table.get(i).number - 1].add(row, column, factor * c);
        }
    }
    for values in links.iter().map(Symmetric::eigenvalues) {
        let size = ROUNDING * values.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let round = |v: f64| if v.abs() <= size { 0.0 } else { v };
        lowest = values.first().map_or(lowest, |v| lowest.min(round(*v)));
        highest = values.last().map_or(highest, |v| highest.max(round(*v)));
    }
    [if lowest >= 0.0 { 0.0 } else { f64::NEG_INFINITY }, if highest <= 0.0 { 0.0 } else { f64::INFINITY }]
}

/// The interval of a free estimate cut to the bounds of the set, and widened to contain the consistent estimate.
///
/// A true value within the bounds is in this interval if it is in the free interval, so the coverage does not fall. The
/// consistent estimate lies outside the free interval only if the data reject consistency; the interval then ends at it.
#[must_use]
pub fn interval_in([least, largest]: [f64; 2], [low, high]: [f64; 2], estimate: f64) -> [f64; 2] {
    [low.clamp(least, largest).min(estimate), high.clamp(least, largest).max(estimate)]
}

/// `C` with `tr(C P)` equal to the parameter, by its entries on and below the diagonal.
fn adjoint(quantity: LinkQuantity) -> &'static [(usize, usize, f64)] {
    match quantity {
        LinkQuantity::Xx => &[(1, 1, 1.0), (2, 2, 1.0)],
        LinkQuantity::Yy => &[(0, 0, 1.0), (2, 2, 1.0)],
        LinkQuantity::Zz => &[(0, 0, 1.0), (1, 1, 1.0)],
        LinkQuantity::Xy => &[(1, 0, -0.5)],
        LinkQuantity::Xz => &[(2, 0, -0.5)],
        LinkQuantity::Yz => &[(2, 1, -0.5)],
        LinkQuantity::Mx => &[(3, 0, 0.5)],
        LinkQuantity::My => &[(3, 1, 0.5)],
        LinkQuantity::Mz => &[(3, 2, 0.5)],
        LinkQuantity::M => &[(3, 3, 1.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{base_parameters::BaseParameters, consistency::completed_a_priori, dynamics::Model, robot::Robot};

    #[test]
    fn inertias_friction_and_masses_have_a_bound_and_the_rest_has_none() {
        let text = include_str!("../../../thetahat/demo/tx40.toml");
        let robot = Robot::parse(text, std::path::Path::new("tx40.toml")).unwrap();
        let set = ConsistentSet::new(&robot, &completed_a_priori(&robot, None)).unwrap();
        let base = BaseParameters::of(&Model::new(&robot), &[]).unwrap();
        let of = |name: &str| bounds_of(&set, base.parameters().iter().find(|p| p.name == name).unwrap());
        for name in ["zz1r", "zz6", "fv3", "fc1", "ia3", "fvm6"] {
            assert_eq!(of(name), [0.0, f64::INFINITY], "{name}");
        }
        for name in ["xx2r", "mx2r", "off1", "xz2r"] {
            assert_eq!(of(name), [f64::NEG_INFINITY, f64::INFINITY], "{name}");
        }
        assert_eq!(interval_in(of("fv3"), [-1.0, 2.0], 0.5), [0.0, 2.0]);
        assert_eq!(interval_in(of("fv3"), [-2.0, -1.0], 0.25), [0.0, 0.25]);
        assert_eq!(interval_in(of("off1"), [-2.0, -1.0], -1.5), [-2.0, -1.0]);
        // Every consistent vector keeps its bound.
        let theta = base.from_standard(set.a_priori());
        assert!(base.parameters().iter().zip(theta).all(|(p, v)| v >= bounds_of(&set, p)[0]));
    }
}
