//! The frames of the joints.

use super::{geometry::BASE, model::Model};
use thetahat_ground::vector::{Mat3, Vec3, add, cross, dot, product, scale, times};

/// The z axis of a frame in its own coordinates.
const Z: Vec3 = [0.0, 0.0, 1.0];

/// A joint's frame relative to the base.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointFrame {
    /// Its axes as columns.
    pub(crate) rotation: Mat3,
    pub(crate) origin: Vec3,
}

impl Model {
    /// The frames of all joints at the coordinates `q`.
    pub(crate) fn frames(&self, q: &[f64]) -> Vec<JointFrame> {
        if let Some(closed) = self.closed() {
            return closed.tree.frames(&closed.positions(q));
        }
        let mut frames = Vec::with_capacity(self.joints.len());
        self.frames_into(q, &mut frames);
        frames
    }

    /// The same into a list that is used again.
    pub(super) fn frames_into(&self, q: &[f64], frames: &mut Vec<JointFrame>) {
        frames.clear();
        for joint in &self.joints {
            let (rotation, place) = joint.placement(q);
            let turned = |x: Vec3| joint.turn.as_ref().map_or(x, |turn| turn.times(x));
            let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], Z].map(|axis| turned(rotation.times(axis)));
            let own = JointFrame {
                rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|k: usize| columns[k][i])),
                origin: turned(place),
            };
            frames.push(match frames.get(joint.parent) {
                None => own,
                Some(JointFrame { rotation, origin }) => JointFrame {
                    rotation: product(rotation, &own.rotation),
                    origin: add(times(rotation, own.origin), *origin),
                },
            });
        }
    }

    /// Adds the derivatives of a point's position along a direction with respect to the coordinates; joint `j` moves the point.
    pub(crate) fn add_point_slopes(
        &self,
        frames: &[JointFrame],
        j: usize,
        point: Vec3,
        direction: Vec3,
        slopes: &mut [f64],
    ) {
        let mut carrier = j;
        while let (Some(joint), Some(frame)) = (self.joints.get(carrier), frames.get(carrier)) {
            let axis = frame.rotation.map(|row| row[2]);
            let moved = if joint.revolute { cross(axis, add(point, scale(-1.0, frame.origin))) } else { axis };
            joint.shares().for_each(|(c, ratio)| slopes[c] += ratio * dot(moved, direction));
            carrier = joint.parent;
        }
    }

    /// Adds the derivatives of the rotation of link `j` about a direction with respect to the coordinates.
    pub(super) fn add_turn_slopes(&self, frames: &[JointFrame], j: usize, direction: Vec3, slopes: &mut [f64]) {
        let mut carrier = j;
        while let (Some(joint), Some(frame)) = (self.joints.get(carrier), frames.get(carrier)) {
            let turn = if joint.revolute { dot(frame.rotation.map(|row| row[2]), direction) } else { 0.0 };
            joint.shares().for_each(|(c, ratio)| slopes[c] += ratio * turn);
            carrier = joint.parent;
        }
    }

    /// The origin of joint `j`'s frame and its z axis, in the frame of the base, at the coordinates `q`.
    #[doc(hidden)]
    pub fn frame(&self, j: usize, q: &[f64]) -> (Vec3, Vec3) {
        if let Some(closed) = self.closed() {
            return closed.frame(j, q);
        }
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

    /// The joint that carries joint `j`; none for a joint on the base.
    #[doc(hidden)]
    pub fn carrier(&self, j: usize) -> Option<usize> {
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
        // All frames at once are the same, and the slopes of a point of the slide agree with differences.
        let q = [0.3, -0.7, 0.2];
        let frames = model.frames(&q);
        for (j, frame) in frames.iter().enumerate() {
            let (origin, axis) = model.frame(j, &q);
            assert!(close(origin, frame.origin) && close(axis, frame.rotation.map(|row| row[2])));
        }
        let (own, direction) = ([0.1, 0.2, 0.3], [0.4, -0.5, 0.6]);
        let place = |q: &[f64]| {
            let frame = model.frames(q)[2];
            add(times(&frame.rotation, own), frame.origin)
        };
        let mut slopes = [0.0; 3];
        model.add_point_slopes(&frames, 2, place(&q), direction, &mut slopes);
        for (k, slope) in slopes.iter().enumerate() {
            let along = |h: f64| {
                let mut moved = q;
                moved[k] += h;
                dot(place(&moved), direction)
            };
            assert!(((along(1e-6) - along(-1e-6)) / 2e-6 - slope).abs() < 1e-9);
        }
        Ok(())
    }
}
