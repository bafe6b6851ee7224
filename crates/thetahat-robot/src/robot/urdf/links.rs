use super::{UrdfError, element::Element};
use crate::robot::body::{Frame, RigidBody};
use thetahat_ground::vector::{Mat3, Vec3};

/// The `<origin>` of an element; missing entries are zero.
pub(super) fn origin_of(element: Element<'_>) -> Result<Frame, UrdfError> {
    let Some(origin) = element.child("origin") else { return Ok(Frame::SAME) };
    let xyz = origin.vector("xyz")?.unwrap_or_default();
    let rpy = origin.angles("rpy")?.unwrap_or_default();
    Ok(Frame { rotation: roll_pitch_yaw(rpy), origin: xyz })
}

/// `Rot(z, yaw) Rot(y, pitch) Rot(x, roll)`.
#[doc(hidden)]
pub fn roll_pitch_yaw([roll, pitch, yaw]: Vec3) -> Mat3 {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// The `<inertial>` of a link, about the origin of the link's frame; zero without one.
pub(super) fn body_of(link: Element<'_>) -> Result<RigidBody, UrdfError> {
    match inertial_of(link)? {
        Some((inertial, body)) => Ok(body.seen_in(&origin_of(inertial)?)),
        None => Ok(RigidBody::default()),
    }
}

/// The `<inertial>` of a link, if it has one, with the body it describes about its own origin.
pub(super) fn inertial_of<'a>(link: Element<'a>) -> Result<Option<(Element<'a>, RigidBody)>, UrdfError> {
    let Some(inertial) = link.child("inertial") else { return Ok(None) };
    let remedy = "give it, or leave out the whole <inertial>";
    let mass = inertial.required_child("mass", remedy)?;
    let m = required_number(mass, "value", remedy)?;
    let inertia = inertial.required_child("inertia", remedy)?;
    let entry = |key| required_number(inertia, key, "all six of ixx ixy ixz iyy iyz izz are needed");
    let (xx, xy, xz) = (entry("ixx")?, entry("ixy")?, entry("ixz")?);
    let (yy, yz, zz) = (entry("iyy")?, entry("iyz")?, entry("izz")?);
    let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    Ok(Some((inertial, RigidBody { m, ms: [0.0; 3], inertia })))
}

fn required_number(element: Element<'_>, key: &'static str, remedy: &'static str) -> Result<f64, UrdfError> {
    element.required(key, remedy)?;
    element.bounded_number(key)?.ok_or_else(|| element.missing(&format!("attribute {key}"), remedy))
}
