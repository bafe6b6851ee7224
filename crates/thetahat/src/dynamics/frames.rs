//! Where the frames of the joints stand.

use super::{geometry::BASE, model::Model};
use crate::vector::{Vec3, add};

/// A vector of the z axis of a frame.
const Z: Vec3 = [0.0, 0.0, 1.0];

impl Model {
    /// The origin of joint `j`'s frame and its z axis, in the frame of the base, at the coordinates `q`.
    pub(crate) fn frame(&self, j: usize, q: &[f64]) -> (Vec3, Vec3) {
        let (mut origin, mut axis) = ([0.0; 3], Z);
        let mut carrier = j;
        while let Some(joint) = self.joints.get(carrier) {
            let (rotation, place) = joint.placement(q);
            (origin, axis) = (add(rotation.times(origin), place), rotation.times(axis));
            if let Some(turn) = &joint.turn {
                (origin, axis) = (turn.times(origin), turn.times(axis));
            }
            carrier = joint.parent;
        }
        (origin, axis)
    }

    /// The joint that carries joint `j`; none for one on the base.
    pub(crate) fn carrier(&self, j: usize) -> Option<usize> {
        Some(self.joints[j].parent).filter(|parent| *parent != BASE)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::{Robot, RobotError};

    /// A column of 0.5 m, an arm of 0.4 m that turns about a horizontal axis, and a slide along that axis.
    const ROBOT: &str = r#"
name = "a column, an arm and a slide"
[[joint]]
name = "column"
kind = "revolute"
d_m = 0.5
[[joint]]
name = "arm"
kind = "revolute"
alpha_deg = 90
[[joint]]
name = "slide"
kind = "prismatic"
a_m = 0.4
"#;

    fn close(a: Vec3, b: Vec3) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn frames_stand_where_the_geometry_puts_them() -> Result<(), RobotError> {
        let model = Model::new(&Robot::parse(ROBOT, Path::new("arm.toml"))?);
        let quarter = std::f64::consts::FRAC_PI_2;
        // The arm points up; the slide runs along the arm's axis, which is -y after alpha = 90 degrees.
        let (origin, axis) = model.frame(2, &[0.0, quarter, 0.1]);
        assert!(close(origin, [0.0, -0.1, 0.9]) && close(axis, [0.0, -1.0, 0.0]), "{origin:?} {axis:?}");
        // A quarter turn of the column turns -y to x.
        let (origin, axis) = model.frame(2, &[quarter, quarter, 0.1]);
        assert!(close(origin, [0.1, 0.0, 0.9]) && close(axis, [1.0, 0.0, 0.0]), "{origin:?} {axis:?}");
        assert_eq!([0, 1, 2].map(|j| model.carrier(j)), [None, Some(0), Some(1)]);
        Ok(())
    }
}
