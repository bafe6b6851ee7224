use super::{UrdfError, element::Element, links};
use crate::robot::{JointKind, Limits, body::Frame};
use thetahat_ground::vector::{IDENTITY, Mat3, norm, scale, with_z};

/// An axis shorter than this has no direction.
const SHORTEST_AXIS: f64 = 1e-9;

/// A `<joint>` as read from the file.
pub(super) struct JointElement<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: &'a str,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    /// The link's frame at coordinate zero, in the parent link's frame.
    pub(super) frame: Frame,
    /// None for a fixed joint.
    pub(super) moving: Option<Moving<'a>>,
}

/// The properties of a moving joint.
pub(super) struct Moving<'a> {
    pub(super) kind: JointKind,
    /// From the joint's frame, whose z axis is the axis, to the link's frame.
    pub(super) axes: Mat3,
    pub(super) limits: Limits,
    /// Viscous and Coulomb friction.
    pub(super) friction: [f64; 2],
    /// One for each joint that it follows: the coordinate is the sum.
    pub(super) mimics: Vec<MimicElement<'a>>,
}

pub(super) struct MimicElement<'a> {
    pub(super) element: Element<'a>,
    pub(super) joint: &'a str,
    pub(super) ratio: f64,
    pub(super) offset: f64,
}

impl<'a> JointElement<'a> {
    pub(super) fn read(element: Element<'a>) -> Result<Self, UrdfError> {
        let name = element.required("name", "every joint has one")?;
        let link = |tag| {
            let remedy = "a joint is between <parent link=\"...\"/> and <child link=\"...\"/>";
            element.required_child(tag, remedy)?.required("link", remedy)
        };
        Ok(Self {
            element,
            name,
            parent: link("parent")?,
            child: link("child")?,
            frame: links::origin_of(element)?,
            moving: Moving::read(element)?,
        })
    }
}

impl<'a> Moving<'a> {
    fn read(element: Element<'a>) -> Result<Option<Self>, UrdfError> {
        let types = "give revolute, continuous, prismatic or fixed";
        let kind = match element.required("type", types)? {
            "revolute" | "continuous" => JointKind::Revolute,
            "prismatic" => JointKind::Prismatic,
            "fixed" => return Ok(None),
            other => return Err(unsupported(element, other)),
        };
        Ok(Some(Self {
            kind,
            axes: axes(element)?,
            limits: limits(element)?,
            friction: friction(element)?,
            mimics: element.children("mimic").map(MimicElement::read).collect::<Result<_, _>>()?,
        }))
    }

    /// Whether the joint's frame differs from the link's.
    pub(super) fn has_link_axes(&self) -> bool {
        self.axes == IDENTITY
    }
}

impl<'a> MimicElement<'a> {
    fn read(element: Element<'a>) -> Result<Self, UrdfError> {
        Ok(Self {
            element,
            joint: element.required("joint", "name the joint that it follows")?,
            ratio: element.bounded_number("multiplier")?.unwrap_or(1.0),
            offset: element.bounded_number("offset")?.unwrap_or(0.0),
        })
    }
}

fn unsupported(element: Element<'_>, kind: &str) -> UrdfError {
    let why = match kind {
        "floating" => {
            "for a floating base, remove it with the link above, and write a TOML with urdf = \"...\" and floating_base = true"
        }
        "planar" => "use two prismatic joints and a revolute one, or fix it",
        _ => "the types are revolute, continuous, prismatic and fixed",
    };
    UrdfError::UnsupportedJoint { place: element.place(), kind: super::element::shortened(kind), why }
}

/// The rotation from a frame whose z axis is the joint's axis to the link's frame.
fn axes(element: Element<'_>) -> Result<Mat3, UrdfError> {
    let Some(axis) = element.child("axis") else { return Ok(with_z([1.0, 0.0, 0.0])) };
    let xyz = axis.vector("xyz")?.ok_or_else(|| axis.missing("attribute xyz", "give the axis in the link's frame"))?;
    let length = norm(xyz);
    if !length.is_finite() || length < SHORTEST_AXIS {
        let found = axis.attribute("xyz").unwrap_or_default();
        return Err(axis.value("xyz", "an axis other than zero, such as 0 0 1", found));
    }
    Ok(with_z(scale(1.0 / length, xyz)))
}

fn limits(element: Element<'_>) -> Result<Limits, UrdfError> {
    let Some(limit) = element.child("limit") else { return Ok(Limits::default()) };
    let (lower, upper) = (limit.number("lower")?, limit.number("upper")?);
    let turns = element.attribute("type") == Some("continuous");
    let bounds = if turns { (None, None) } else { (lower, upper) };
    if let (Some(lower), Some(upper)) = bounds
        && lower > upper
    {
        return Err(UrdfError::LimitOrder { place: limit.place(), lower, upper });
    }
    Ok(Limits {
        lower: bounds.0,
        upper: bounds.1,
        velocity: limit.number("velocity")?,
        effort: limit.number("effort")?,
    })
}

fn friction(element: Element<'_>) -> Result<[f64; 2], UrdfError> {
    let Some(dynamics) = element.child("dynamics") else { return Ok([0.0; 2]) };
    Ok([dynamics.bounded_number("damping")?.unwrap_or(0.0), dynamics.bounded_number("friction")?.unwrap_or(0.0)])
}
