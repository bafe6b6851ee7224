//! Physically impossible numbers of a description.

use std::collections::BTreeMap;

use super::reader::Reader;
use crate::robot::{
    Bound, INERTIAL, LARGEST, LinkQuantity, Quantity, Robot, RobotError,
    physical::{EXPECTED_GRAVITY, are_of_a_body, is_gravity, principal_inertias},
};
use thetahat_ground::{linear_algebra::Matrix, vector::norm};

/// Fraction of the largest inertia that truncated digits of a description may cause.
const ROUNDING: f64 = 1e-3;
/// Condition number of the motor-joint matrix, its rows scaled to one, above which its rows depend on one another.
const SINGULAR: f64 = 1e8;

impl Reader<'_> {
    /// Gravity is a vector of m/s^2, or zeros.
    pub(super) fn check_gravity(&self, gravity: [f64; 3]) -> Result<(), RobotError> {
        if is_gravity(gravity) {
            return Ok(());
        }
        let length = norm(gravity);
        Err(self.value("gravity", EXPECTED_GRAVITY, &format!("{gravity:?}, of length {length:.4}")))
    }

    /// Checks that a-priori values are possible for a joint, a motor or a body; `robot` holds them together with those of a
    /// URDF.
    pub(super) fn check_parameters(&self, robot: &Robot, given: &BTreeMap<String, f64>) -> Result<(), RobotError> {
        let table = robot.parameter_table();
        for parameter in table.iter() {
            let Some(&value) = given.get(&parameter.name()) else { continue };
            let joint = &robot.joints[parameter.number - 1].name;
            let key = format!("[parameters] {} (joint `{joint}`)", parameter.name());
            if !(-LARGEST..=LARGEST).contains(&value) {
                return Err(self.value(&key, "a finite number up to 1e9", &value.to_string()));
            }
            if value < 0.0 && cannot_be_negative(parameter.quantity) {
                return Err(self.value(&key, "zero or more", &value.to_string()));
            }
        }
        (0..robot.joints.len()).try_for_each(|joint| self.check_body(robot, joint, given))
    }

    /// A link with a mass and all principal entries of its inertia in the file must be a rigid body.
    fn check_body(&self, robot: &Robot, joint: usize, given: &BTreeMap<String, f64>) -> Result<(), RobotError> {
        let name = |quantity: LinkQuantity| format!("{}{}", quantity.name(), joint + 1);
        if !INERTIAL.iter().any(|quantity| given.contains_key(&name(*quantity))) {
            return Ok(());
        }
        let value = |quantity| robot.a_priori.get(&name(quantity)).copied().unwrap_or(0.0);
        let diagonal = [LinkQuantity::Xx, LinkQuantity::Yy, LinkQuantity::Zz];
        let is_complete =
            value(LinkQuantity::M) > 0.0 && diagonal.iter().all(|q| robot.a_priori.contains_key(&name(*q)));
        let principal = if is_complete { principal_inertias(INERTIAL.map(value)) } else { [0.0; 3] };
        if are_of_a_body(principal, ROUNDING) {
            return Ok(());
        }
        let ([a, b, c], joint) = (principal, &robot.joints[joint].name);
        let key = format!("[parameters] inertia of {} (joint `{joint}`)", name(LinkQuantity::M).replace('m', "link "));
        let expected = "that of a body, kg m^2 about the origin of the link's frame with m times the squared distance of its \
                        centre in it: principal inertias about the centre not below zero, none above the sum of the others";
        Err(self.value(&key, expected, &format!("{a:.3e} {b:.3e} {c:.3e} about the centre of mass")))
    }
}

fn cannot_be_negative(quantity: Quantity) -> bool {
    let is_diagonal =
        matches!(quantity, Quantity::Link(LinkQuantity::M | LinkQuantity::Xx | LinkQuantity::Yy | LinkQuantity::Zz));
    is_diagonal || quantity.bound() == Bound::NotNegative
}

/// Whether the transmission is nearly singular: its rows almost depend on one another.
pub(super) fn is_nearly_singular(matrix: &Matrix) -> bool {
    let n = matrix.columns();
    let largest = |i: usize| (0..n).map(|j| matrix.at(i, j).abs()).fold(0.0, f64::max);
    let scaled = Matrix::from_fn(n, n, |i, j| matrix.at(i, j) / largest(i));
    scaled.condition_number() > SINGULAR
}
