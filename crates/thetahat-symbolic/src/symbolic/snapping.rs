//! Replaces angles and lengths close to special values: a URDF's 1.57079632679 is a right angle.

use std::f64::consts::FRAC_PI_2;

use thetahat_model::robot::{Placement, Robot};

/// Distance in rad within which an angle is replaced by a multiple of a right angle.
const ANGLE: f64 = 1e-9;
/// Length in m that is replaced by zero.
const LENGTH: f64 = 1e-12;
/// Fraction of a direction that is replaced by zero.
const DIRECTION: f64 = 1e-9;

/// A number of the description that was replaced by a special value.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapped {
    /// The joint, from one.
    pub joint: usize,
    /// The part of its placement: `gamma`, `alpha`, `theta`, `x`, `y`, `z`, or `axes` of its link.
    pub what: &'static str,
    /// The number of the description.
    pub from: f64,
    /// The special value.
    pub to: f64,
}

/// The robot with exact right angles and zeros where its description is within rounding of them, and the list of changes.
///
/// Changes below the last digit of a number are not listed.
#[must_use]
pub fn snapped(robot: &Robot) -> (Robot, Vec<Snapped>) {
    let (mut robot, mut changes) = (robot.clone(), Vec::new());
    for (j, joint) in robot.joints.iter_mut().enumerate() {
        let mut replace = |what, number: &mut f64, to: f64| {
            let from = std::mem::replace(number, to);
            if (from - to).abs() > f64::EPSILON * to.abs().max(1.0) {
                changes.push(Snapped { joint: j + 1, what, from, to });
            }
        };
        let Placement { gamma, alpha, theta, origin: [x, y, z] } = &mut joint.placement;
        for (what, angle) in [("gamma", gamma), ("alpha", alpha), ("theta", theta)] {
            let to = special_angle(*angle);
            replace(what, angle, to);
        }
        for (what, length) in [("x", x), ("y", y), ("z", z)] {
            let to = if length.abs() < LENGTH { 0.0 } else { *length };
            replace(what, length, to);
        }
        for entry in joint.link_axes.iter_mut().flat_map(|axes| axes.as_flattened_mut()) {
            let to = if (*entry - entry.round()).abs() < DIRECTION { entry.round() } else { *entry };
            replace("axes", entry, to);
        }
    }
    (robot, changes)
}

/// The multiple of a right angle close to the angle, or the angle itself.
fn special_angle(angle: f64) -> f64 {
    let quarters = (angle / FRAC_PI_2).round();
    if (angle - quarters * FRAC_PI_2).abs() < ANGLE { quarters * FRAC_PI_2 } else { angle }
}

/// Sine and cosine, exact at multiples of a right angle.
pub(super) fn exact_sin_cos(angle: f64) -> (f64, f64) {
    let quarters = (angle / FRAC_PI_2).round();
    if angle != quarters * FRAC_PI_2 {
        return angle.sin_cos();
    }
    match quarters.rem_euclid(4.0) as u8 {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_angles_are_exact() {
        let as_written = |angle: f64, decimals: i32| (angle * 10f64.powi(decimals)).trunc() / 10f64.powi(decimals);
        for (quarters, expected) in [(0.0, (0.0, 1.0)), (1.0, (1.0, 0.0)), (-1.0, (-1.0, 0.0)), (-6.0, (0.0, -1.0))] {
            let angle = quarters * FRAC_PI_2;
            assert_eq!(exact_sin_cos(special_angle(as_written(angle, 11))), expected);
            let coarse = special_angle(as_written(angle, 6));
            assert_eq!(coarse == angle, quarters == 0.0, "{coarse} is as it was written");
        }
    }
}
