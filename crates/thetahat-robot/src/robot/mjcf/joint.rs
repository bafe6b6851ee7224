//! `<joint>` elements.

use super::{
    classes::{Classes, Properties},
    compiler::Settings,
    element::{Attribute, Element},
    error::MjcfError,
    world::Part,
};
use crate::robot::{JointKind, Limits};
use thetahat_ground::vector::{Vec3, norm, scale, times};

/// An axis shorter than this has no direction.
const SHORTEST_AXIS: f64 = 1e-9;

/// A hinge or slide.
pub(super) struct Moving<'a> {
    pub(super) element: Element<'a>,
    pub(super) kind: JointKind,
    /// In the axes of the body, of length one.
    pub(super) axis: Vec3,
    /// A point on the axis, in the frame of the body.
    pub(super) anchor: Vec3,
    /// Its coordinate in the pose of the model.
    pub(super) reference: f64,
    pub(super) limits: Limits,
    pub(super) armature: f64,
    pub(super) friction: f64,
    /// By the velocity, its square and its cube.
    pub(super) damping: [f64; 3],
    /// By the deflection, its square and its cube.
    pub(super) stiffness: [f64; 3],
    /// The coordinate at which the spring is at rest.
    pub(super) rest: f64,
    /// Whether MuJoCo finds stiffness and damping from a time constant.
    pub(super) has_time_constant: bool,
}

impl<'a> Moving<'a> {
    /// A joint element; none for a free joint.
    pub(super) fn read(part: &Part<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<Option<Self>, MjcfError> {
        if part.element.tag() == "freejoint" {
            return Ok(None);
        }
        let joint = classes.of(part.element, part.class, &["joint"])?;
        let Some(kind) = kind_of(&joint)? else { return Ok(None) };
        let coordinate = |value: f64| match kind {
            JointKind::Revolute => settings.angle(value),
            JointKind::Prismatic => value,
        };
        let of_key = |key| Ok::<f64, MjcfError>(joint.number(key)?.unwrap_or(0.0));
        Ok(Some(Self {
            element: part.element,
            kind,
            axis: times(&part.frame.rotation, axis_of(&joint)?),
            anchor: part.frame.of_point(joint.numbers("pos")?.unwrap_or_default()),
            reference: coordinate(of_key("ref")?),
            limits: limits_of(&joint, settings, coordinate)?,
            armature: of_key("armature")?,
            friction: of_key("frictionloss")?,
            damping: joint.leading("damping", [0.0; 3])?,
            stiffness: joint.leading("stiffness", [0.0; 3])?,
            rest: coordinate(of_key("springref")?),
            has_time_constant: has_time_constant(&joint)?,
        }))
    }
}

/// None for a free joint.
fn kind_of(joint: &Properties<'_>) -> Result<Option<JointKind>, MjcfError> {
    let Some(kind) = joint.attribute("type") else { return Ok(Some(JointKind::Revolute)) };
    match kind.text {
        "hinge" => Ok(Some(JointKind::Revolute)),
        "slide" => Ok(Some(JointKind::Prismatic)),
        "free" => Ok(None),
        "ball" => Err(joint.element().unsupported(
            "a ball joint has no single coordinate; replace it by three hinges in one body, or remove it to fix the body",
        )),
        _ => Err(kind.wrong("hinge, slide, ball or free")),
    }
}

/// Of length one.
fn axis_of(joint: &Properties<'_>) -> Result<Vec3, MjcfError> {
    let Some(attribute) = joint.attribute("axis") else { return Ok([0.0, 0.0, 1.0]) };
    let axis = attribute.numbers()?;
    match norm(axis) {
        length if length > SHORTEST_AXIS => Ok(scale(1.0 / length, axis)),
        _ => Err(attribute.wrong("an axis other than zero, such as 0 0 1")),
    }
}

fn limits_of(
    joint: &Properties<'_>,
    settings: &Settings,
    coordinate: impl Fn(f64) -> f64,
) -> Result<Limits, MjcfError> {
    let range = limits(joint, "range", "limited", settings)?.map(|range| range.map(coordinate));
    let force = limits(joint, "actuatorfrcrange", "actuatorfrclimited", settings)?;
    Ok(Limits {
        lower: range.map(|[lower, _]| lower),
        upper: range.map(|[_, upper]| upper),
        velocity: None,
        effort: force.map(|[low, high]| low.abs().max(high.abs())),
    })
}

fn has_time_constant(joint: &Properties<'_>) -> Result<bool, MjcfError> {
    Ok(joint.numbers("springdamper")?.is_some_and(|[time, ratio]: [f64; 2]| time > 0.0 && ratio > 0.0))
}

/// The two limits of an element, if `limited` or `autolimits` makes them count.
pub(super) fn limits(
    of: &Properties<'_>,
    range: &'static str,
    limited: &'static str,
    settings: &Settings,
) -> Result<Option<[f64; 2]>, MjcfError> {
    let limited = of.attribute(limited).map(Attribute::flag).transpose()?.flatten();
    let range = of.numbers::<2>(range)?.filter(|[lower, upper]| lower < upper);
    Ok(range.filter(|_| limited.unwrap_or(settings.limits_from_ranges)))
}
