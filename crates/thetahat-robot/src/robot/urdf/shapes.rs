use super::{UrdfError, element::Element, links::origin_of};
use crate::robot::body::Frame;

/// A shape about its own origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid {
    /// A box with these edges along x, y and z, m.
    Box {
        /// Its edges.
        edges: [f64; 3],
    },
    /// A cylinder along z, m.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its length.
        length: f64,
    },
    /// A sphere, m.
    Sphere {
        /// Its radius.
        radius: f64,
    },
}

/// The `<collision>` shapes of a link in its frame; none for the solid of a mesh.
pub(super) fn shapes_of(link: Element<'_>) -> Result<Vec<(Frame, Option<Solid>)>, UrdfError> {
    let collisions = link.elements().filter(|element| element.tag() == "collision");
    collisions.map(|collision| Ok((origin_of(collision)?, solid_of(collision)?))).collect()
}

fn solid_of(collision: Element<'_>) -> Result<Option<Solid>, UrdfError> {
    let remedy = "give it, or leave out the <collision>";
    let geometry = collision.required_child("geometry", remedy)?;
    let number = |element: Element<'_>, key: &'static str| {
        element.required(key, remedy)?;
        element.bounded_number(key)?.ok_or_else(|| element.missing(&format!("attribute {key}"), remedy))
    };
    if let Some(of) = geometry.child("box") {
        let edges = of.vector("size")?.ok_or_else(|| of.missing("attribute size", remedy))?;
        return Ok(Some(Solid::Box { edges }));
    }
    if let Some(of) = geometry.child("cylinder") {
        return Ok(Some(Solid::Cylinder { radius: number(of, "radius")?, length: number(of, "length")? }));
    }
    if let Some(of) = geometry.child("sphere") {
        return Ok(Some(Solid::Sphere { radius: number(of, "radius")? }));
    }
    Ok(None)
}
