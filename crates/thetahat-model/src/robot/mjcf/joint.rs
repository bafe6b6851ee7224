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

/// What a joint element does.
pub(super) enum JointElement<'a> {
    Moving(Moving<'a>),
    /// Its body moves freely.
    Free,
}

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

impl<'a> JointElement<'a> {
    pub(super) fn read(part: &Part<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<Self, MjcfError> {
        if part.element.tag() == "freejoint" {
            return Ok(Self::Free);
        }
        let joint = classes.of(part.element, part.class, &["joint"])?;
        let kind = joint.attribute("type");
        let kind = match kind.map_or("hinge", |kind| kind.text) {
            "hinge" => JointKind::Revolute,
            "slide" => JointKind::Prismatic,
            "free" => return Ok(Self::Free),
            "ball" => {
                let why = "a ball joint has no single coordinate; replace it by three hinges in one body, or remove it to \
                           fix the body";
                return Err(part.element.unsupported(why));
            }
            _ => {
                return Err(
                    kind.map_or_else(|| part.element.unsupported(""), |k| k.wrong("hinge, slide, ball or free"))
                );
            }
        };
        let coordinate = |value: f64| match kind {
            JointKind::Revolute => settings.angle(value),
            JointKind::Prismatic => value,
        };
        let axis = joint.numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let length = norm(axis);
        if length < SHORTEST_AXIS
            && let Some(attribute) = joint.attribute("axis")
        {
            return Err(attribute.wrong("an axis other than zero, such as 0 0 1"));
        }
        let range = limits(&joint, "range", "limited", settings)?.map(|range| range.map(coordinate));
        let force = limits(&joint, "actuatorfrcrange", "actuatorfrclimited", settings)?;
        Ok(Self::Moving(Moving {
            element: part.element,
            kind,
            axis: times(&part.frame.rotation, scale(1.0 / length, axis)),
            anchor: part.frame.of_point(joint.numbers("pos")?.unwrap_or_default()),
            reference: coordinate(joint.number("ref")?.unwrap_or(0.0)),
            limits: Limits {
                lower: range.map(|[lower, _]| lower),
                upper: range.map(|[_, upper]| upper),
                velocity: None,
                effort: force.map(|[low, high]| low.abs().max(high.abs())),
            },
            armature: joint.number("armature")?.unwrap_or(0.0),
            friction: joint.number("frictionloss")?.unwrap_or(0.0),
            damping: joint.leading("damping", [0.0; 3])?,
            stiffness: joint.leading("stiffness", [0.0; 3])?,
            rest: coordinate(joint.number("springref")?.unwrap_or(0.0)),
            has_time_constant: joint
                .numbers::<2>("springdamper")?
                .is_some_and(|[time, ratio]| time > 0.0 && ratio > 0.0),
        }))
    }
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
