//! What `<compiler>` makes of the numbers of an MJCF.

use super::{element::Element, error::MjcfError};
use thetahat_ground::{
    vector::{IDENTITY, Mat3, Vec3, axis_angle, cross, norm, product, quaternion_rotation, scale, transpose, with_z},
    visible::visible,
};
use thetahat_model::robot::{Frame, RigidBody};

/// Settings that later `<compiler>` elements of a file replace.
#[derive(Debug, Clone)]
pub(super) struct Settings<'a> {
    degrees: bool,
    order: String,
    /// Whether geoms weigh where a body has no `<inertial>`.
    pub(super) geoms_weigh: bool,
    /// Groups of geoms that weigh.
    pub(super) groups: [f64; 2],
    /// `boundmass` and `boundinertia`, with the elements that set them.
    pub(super) bounds: Vec<(&'static str, f64, Element<'a>)>,
}

impl<'a> Settings<'a> {
    /// Those of a file, unless they change inertias that the file states.
    pub(super) fn read(root: Element<'a>) -> Result<Self, MjcfError> {
        let mut settings =
            Self { degrees: true, order: "xyz".to_owned(), geoms_weigh: true, groups: [0.0, 5.0], bounds: Vec::new() };
        root.named("compiler").try_for_each(|compiler| settings.take(compiler))?;
        Ok(settings)
    }

    fn take(&mut self, compiler: Element<'a>) -> Result<(), MjcfError> {
        refuse(compiler)?;
        if let Some(angle) = compiler.attribute("angle") {
            self.degrees = angle != "radian";
        }
        if let Some(order) = compiler.attribute("eulerseq") {
            if order.len() != 3 || !order.chars().all(|c| "xyzXYZ".contains(c)) {
                let found = visible(order).into_owned();
                let (place, key) = (compiler.place(), "eulerseq".to_owned());
                return Err(MjcfError::Value { place, key, expected: "three of x y z X Y Z", found });
            }
            order.clone_into(&mut self.order);
        }
        if let Some(from_geoms) = compiler.attribute("inertiafromgeom") {
            self.geoms_weigh = from_geoms != "false";
        }
        if let Some(groups) = compiler.numbers("inertiagrouprange")? {
            self.groups = groups;
        }
        for key in ["boundmass", "boundinertia"] {
            if let Some(bound) = compiler.number(key)? {
                self.bounds.retain(|(known, ..)| *known != key);
                self.bounds.push((key, bound, compiler));
            }
        }
        Ok(())
    }

    fn angle(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }

    /// A joint's coordinate of the reference configuration, rad or m.
    pub(super) fn coordinate(&self, value: f64, turns: bool) -> f64 {
        if turns { self.angle(value) } else { value }
    }

    /// `pos` and the orientation of an element in the frame that it is given in.
    pub(super) fn frame(&self, element: Element<'_>) -> Result<Frame, MjcfError> {
        let origin = element.numbers("pos")?.unwrap_or_default();
        Ok(Frame { rotation: self.rotation(element)?, origin })
    }

    fn rotation(&self, element: Element<'_>) -> Result<Mat3, MjcfError> {
        let unit = |key: &'static str, v: Vec3| match norm(v) {
            length if length > SHORTEST => Ok(scale(1.0 / length, v)),
            _ => Err(element.no_direction(key)),
        };
        if let Some([x, y, z, angle]) = element.numbers("axisangle")? {
            return Ok(axis_angle(unit("axisangle", [x, y, z])?, self.angle(angle)));
        }
        if let Some(angles) = element.numbers::<3>("euler")? {
            return Ok(self.euler(angles));
        }
        if let Some([a, b, c, d, e, f]) = element.numbers("xyaxes")? {
            let x = unit("xyaxes", [a, b, c])?;
            let z = unit("xyaxes", cross(x, [d, e, f]))?;
            return Ok(transpose(&[x, cross(z, x), z]));
        }
        if let Some(z) = element.numbers("zaxis")? {
            return Ok(shortest_turn(unit("zaxis", z)?));
        }
        let quaternion: [f64; 4] = element.numbers("quat")?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let length = quaternion.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length <= SHORTEST {
            return Err(element.no_direction("quat"));
        }
        Ok(quaternion_rotation(quaternion.map(|v| v / length)))
    }

    /// Small letters turn about the axes that were turned before, large ones about those of the parent.
    fn euler(&self, angles: Vec3) -> Mat3 {
        let mut rotation = IDENTITY;
        for (letter, angle) in self.order.chars().zip(angles) {
            let place = ['x', 'y', 'z'].iter().position(|axis| *axis == letter.to_ascii_lowercase());
            let mut axis = [0.0; 3];
            axis[place.unwrap_or(0)] = 1.0;
            let turn = axis_angle(axis, self.angle(angle));
            rotation = if letter.is_ascii_lowercase() { product(&rotation, &turn) } else { product(&turn, &rotation) };
        }
        rotation
    }

    /// The body of an `<inertial>`, about the origin and in the axes of its body's frame.
    pub(super) fn body(&self, inertial: Element<'_>) -> Result<RigidBody, MjcfError> {
        let m = inertial.number("mass")?.unwrap_or(0.0);
        let inertia = match (inertial.numbers("fullinertia")?, inertial.numbers("diaginertia")?) {
            (Some([xx, yy, zz, xy, xz, yz]), _) => [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
            (None, Some([xx, yy, zz])) => [[xx, 0.0, 0.0], [0.0, yy, 0.0], [0.0, 0.0, zz]],
            (None, None) => [[0.0; 3]; 3],
        };
        Ok(RigidBody { m, ms: [0.0; 3], inertia }.seen_in(&self.frame(inertial)?))
    }
}

/// A direction shorter than this is none.
const SHORTEST: f64 = 1e-9;

/// The shortest turn of the z axis to a direction.
fn shortest_turn(z: Vec3) -> Mat3 {
    let axis = cross([0.0, 0.0, 1.0], z);
    let sine = norm(axis);
    if sine <= SHORTEST { with_z(z) } else { axis_angle(scale(1.0 / sine, axis), sine.atan2(z[2])) }
}

/// Refuses settings that change what `<inertial>` says.
fn refuse(compiler: Element<'_>) -> Result<(), MjcfError> {
    let setting = |key: &'static str, consequence| {
        let found = visible(compiler.attribute(key).unwrap_or_default()).into_owned();
        Err(MjcfError::Setting { place: compiler.place(), key, found, consequence })
    };
    if compiler.attribute("inertiafromgeom") == Some("true") {
        return setting(
            "inertiafromgeom",
            "replaces every <inertial> by the geoms' inertia; take the setting out: bodies with an <inertial> then have that one",
        );
    }
    if compiler.number("settotalmass")?.is_some_and(|mass| mass > 0.0) {
        return setting("settotalmass", "scales every mass; take the setting out");
    }
    if compiler.attribute("coordinate") == Some("global") {
        return setting(
            "coordinate",
            "gives frames in that of the world; write the model anew with a MuJoCo that still reads it (2.3.3), in local coordinates",
        );
    }
    Ok(())
}
