//! Positions and orientations in every notation.

use super::{classes::Properties, compiler::Settings, element::Attribute, element::Element, error::MjcfError};
use crate::robot::body::Frame;
use thetahat_ground::vector::{
    IDENTITY, Mat3, Vec3, axis_angle, cross, dot, norm, product, quaternion_rotation, scale, sub, transpose,
};

/// A vector shorter than this has no direction.
const SHORTEST: f64 = 1e-9;
/// Attributes that state an orientation.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

impl Settings {
    /// `pos` and the orientation of an element, in the frame in which it is given.
    pub(super) fn frame(&self, of: &Properties<'_>) -> Result<Frame, MjcfError> {
        let origin = of.numbers("pos")?.unwrap_or_default();
        Ok(Frame { rotation: self.rotation(of)?, origin })
    }

    /// The orientation that the element states, otherwise that of its class.
    fn rotation(&self, of: &Properties<'_>) -> Result<Mat3, MjcfError> {
        for level in of.levels() {
            if let Some(attribute) = orientation(*level)? {
                return self.rotation_of(attribute.0, attribute.1);
            }
        }
        Ok(IDENTITY)
    }

    fn rotation_of(&self, key: &str, attribute: Attribute<'_>) -> Result<Mat3, MjcfError> {
        match key {
            "axisangle" => {
                let [x, y, z, angle] = attribute.numbers()?;
                Ok(axis_angle(direction(attribute, [x, y, z])?, self.angle(angle)))
            }
            "xyaxes" => {
                let [a, b, c, d, e, f] = attribute.numbers()?;
                let x = direction(attribute, [a, b, c])?;
                let y = [d, e, f];
                let y = direction(attribute, sub(y, scale(dot(x, y), x)))?;
                Ok(transpose(&[x, y, cross(x, y)]))
            }
            "zaxis" => Ok(shortest_turn(direction(attribute, attribute.numbers()?)?)),
            "euler" => Ok(self.euler_rotation(attribute.numbers()?)),
            _ => {
                let quaternion: [f64; 4] = attribute.numbers()?;
                let length = quaternion.iter().map(|v| v * v).sum::<f64>().sqrt();
                if length < SHORTEST {
                    return Err(attribute.wrong("a quaternion other than zero"));
                }
                Ok(quaternion_rotation(quaternion.map(|v| v / length)))
            }
        }
    }

    /// Small letters turn about the axes that were turned before, capital ones about those of the parent.
    fn euler_rotation(&self, angles: Vec3) -> Mat3 {
        let mut rotation = IDENTITY;
        for (letter, angle) in self.euler.into_iter().zip(angles) {
            let axis = ['x', 'y', 'z'].map(|axis| f64::from(u8::from(letter.eq_ignore_ascii_case(&axis))));
            let turn = axis_angle(axis, self.angle(angle));
            rotation = if letter.is_ascii_lowercase() { product(&rotation, &turn) } else { product(&turn, &rotation) };
        }
        rotation
    }
}

/// The one orientation that an element states.
fn orientation(element: Element<'_>) -> Result<Option<(&'static str, Attribute<'_>)>, MjcfError> {
    let mut stated = ORIENTATIONS.into_iter().filter_map(|key| Some((key, element.attribute(key)?)));
    let first = stated.next();
    match stated.next() {
        Some((_, second)) => Err(second.wrong("one orientation, not two; remove it or the other one")),
        None => Ok(first),
    }
}

fn direction(attribute: Attribute<'_>, vector: Vec3) -> Result<Vec3, MjcfError> {
    match norm(vector) {
        length if length > SHORTEST => Ok(scale(1.0 / length, vector)),
        _ => Err(attribute.wrong("axes other than zero, and not parallel")),
    }
}

/// The rotation by the least angle that turns z to an axis of length one.
pub(super) fn shortest_turn(axis: Vec3) -> Mat3 {
    let turn = cross([0.0, 0.0, 1.0], axis);
    match norm(turn) {
        sine if sine > SHORTEST => axis_angle(scale(1.0 / sine, turn), sine.atan2(axis[2])),
        sine => axis_angle([1.0, 0.0, 0.0], sine.atan2(axis[2])),
    }
}
