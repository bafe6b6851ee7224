//! Volume, surface and inertia of the shapes of geoms.

use std::f64::consts::PI;

use super::{classes::Properties, compiler::Settings, element::Attribute, error::MjcfError, pose::shortest_turn};
use crate::robot::body::{Frame, RigidBody};
use thetahat_ground::vector::{Vec3, add, norm, scale, sub};

/// MuJoCo's density if a geom states neither mass nor density, kg/m^3.
const WATER: f64 = 1000.0;

/// A shape about its centre, axis along z; lengths are halves, as in the file.
#[derive(Clone, Copy)]
enum Shape {
    Sphere { radius: f64 },
    Capsule { radius: f64, half: f64 },
    Cylinder { radius: f64, half: f64 },
    Ellipsoid { half: Vec3 },
    Box { half: Vec3 },
}

/// Volume or surface with the principal second moments for a mass of one, m^2.
struct Content {
    size: f64,
    inertia: Vec3,
}

/// The rigid body of a geom in the frame in which it is given; none for a geom without mass. `body` is its name in messages.
pub(super) fn geom_body(
    geom: &Properties<'_>,
    settings: &Settings,
    body: impl Fn() -> String,
) -> Result<Option<RigidBody>, MjcfError> {
    let (mass, density) = (not_negative(geom, "mass")?, not_negative(geom, "density")?);
    if mass.unwrap_or(density.unwrap_or(WATER)) == 0.0 {
        return Ok(None);
    }
    let unweighed = |shape| MjcfError::Unweighed { place: geom.element().place(), body: body(), shape };
    let Some(shape) = shape_of(geom)?.map_err(unweighed)? else { return Ok(None) };
    let content = match (geom.is("shellinertia")?, shape) {
        (true, Shape::Ellipsoid { .. }) => return Err(unweighed("the shell of an ellipsoid")),
        (true, shape) => shell(shape),
        (false, shape) => solid(shape),
    };
    let m = mass.unwrap_or(density.unwrap_or(WATER) * content.size);
    let [x, y, z] = scale(m, content.inertia);
    let inertia = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
    let frame = geom_frame(geom, settings)?;
    Ok(Some(RigidBody { m, ms: [0.0; 3], inertia }.seen_in(&frame)))
}

fn not_negative(geom: &Properties<'_>, key: &'static str) -> Result<Option<f64>, MjcfError> {
    let Some(attribute) = geom.attribute(key) else { return Ok(None) };
    match attribute.number()? {
        value if value >= 0.0 => Ok(Some(value)),
        _ => Err(attribute.wrong("zero or more")),
    }
}

/// The ends of `fromto`.
fn ends(geom: &Properties<'_>) -> Result<Option<[Vec3; 2]>, MjcfError> {
    let ends = geom.numbers::<6>("fromto")?;
    Ok(ends.map(|[a, b, c, d, e, f]| [[a, b, c], [d, e, f]]))
}

fn geom_frame(geom: &Properties<'_>, settings: &Settings) -> Result<Frame, MjcfError> {
    let Some([from, to]) = ends(geom)? else { return settings.frame(geom) };
    let along = sub(from, to);
    Ok(Frame { rotation: shortest_turn(scale(1.0 / norm(along), along)), origin: scale(0.5, add(from, to)) })
}

/// The shape of a geom: none for one without volume, and in words if there is no formula for it.
fn shape_of(geom: &Properties<'_>) -> Result<Result<Option<Shape>, &'static str>, MjcfError> {
    let kind = geom.attribute("type");
    if geom.attribute("mesh").is_some() {
        return Ok(Err("a mesh"));
    }
    let length = half_length(geom)?;
    let size = Sizes { geom, of_file: geom.leading("size", [0.0; 3])?, length };
    Ok(Ok(Some(match kind.map_or("sphere", |kind| kind.text) {
        "plane" | "hfield" => return Ok(Ok(None)),
        "sphere" => Shape::Sphere { radius: size.at(0)? },
        "capsule" => Shape::Capsule { radius: size.at(0)?, half: size.long(1)? },
        "cylinder" => Shape::Cylinder { radius: size.at(0)?, half: size.long(1)? },
        "ellipsoid" => Shape::Ellipsoid { half: size.three()? },
        "box" => Shape::Box { half: size.three()? },
        "mesh" => return Ok(Err("a mesh")),
        "sdf" => return Ok(Err("a signed distance field")),
        _ => return Err(unknown_kind(geom, kind)),
    })))
}

fn unknown_kind(geom: &Properties<'_>, kind: Option<Attribute<'_>>) -> MjcfError {
    let kinds = "plane, hfield, sphere, capsule, ellipsoid, cylinder, box, mesh or sdf";
    kind.map_or_else(|| geom.element().missing("attribute type", kinds), |kind| kind.wrong(kinds))
}

/// Half the length between the ends of `fromto`.
fn half_length(geom: &Properties<'_>) -> Result<Option<f64>, MjcfError> {
    let Some([from, to]) = ends(geom)? else { return Ok(None) };
    match (0.5 * norm(sub(from, to)), geom.attribute("fromto")) {
        (0.0, Some(attribute)) => Err(attribute.wrong("two different points")),
        (half, _) => Ok(Some(half)),
    }
}

struct Sizes<'p, 'a> {
    geom: &'p Properties<'a>,
    of_file: Vec3,
    length: Option<f64>,
}

impl Sizes<'_, '_> {
    fn at(&self, place: usize) -> Result<f64, MjcfError> {
        let size = self.of_file[place];
        if size > 0.0 {
            return Ok(size);
        }
        let expected = "sizes above zero, as many as the type has";
        let missing = || self.geom.element().missing("attribute size", "give it sizes above zero");
        Err(self.geom.attribute("size").map_or_else(missing, |attribute| attribute.wrong(expected)))
    }

    /// The half length along z.
    fn long(&self, place: usize) -> Result<f64, MjcfError> {
        self.length.map_or_else(|| self.at(place), Ok)
    }

    /// With `fromto`, x and y have one size.
    fn three(&self) -> Result<Vec3, MjcfError> {
        let second = if self.length.is_some() { 0 } else { 1 };
        Ok([self.at(0)?, self.at(second)?, self.long(2)?])
    }
}

fn solid(shape: Shape) -> Content {
    match shape {
        Shape::Sphere { radius: r } => Content { size: sphere(r), inertia: [0.4 * r * r; 3] },
        Shape::Ellipsoid { half } => {
            let [a, b, c] = half.map(|v| 0.2 * v * v);
            let size = 4.0 / 3.0 * PI * half[0] * half[1] * half[2];
            Content { size, inertia: [b + c, a + c, a + b] }
        }
        Shape::Box { half } => {
            let [a, b, c] = half.map(|v| v * v / 3.0);
            Content { size: 8.0 * half[0] * half[1] * half[2], inertia: [b + c, a + c, a + b] }
        }
        Shape::Cylinder { radius: r, half: h } => {
            let across = 0.25 * r * r + h * h / 3.0;
            Content { size: 2.0 * PI * r * r * h, inertia: [across, across, 0.5 * r * r] }
        }
        Shape::Capsule { radius: r, half: h } => {
            let cylinder = solid(Shape::Cylinder { radius: r, half: h });
            // The centres of the half spheres are 3/8 of the radius from the ends of the cylinder.
            let across = 0.4 * r * r + h * h + 0.75 * h * r;
            with_caps(cylinder, Content { size: sphere(r), inertia: [across, across, 0.4 * r * r] })
        }
    }
}

/// The surface with a mass in proportion to its area.
fn shell(shape: Shape) -> Content {
    match shape {
        Shape::Sphere { radius: r } => Content { size: 4.0 * PI * r * r, inertia: [2.0 / 3.0 * r * r; 3] },
        Shape::Box { half } | Shape::Ellipsoid { half } => box_shell(half),
        Shape::Cylinder { radius: r, half: h } => {
            let across = 0.25 * r * r + h * h;
            let caps = Content { size: 2.0 * PI * r * r, inertia: [across, across, 0.5 * r * r] };
            with_caps(tube(r, h), caps)
        }
        Shape::Capsule { radius: r, half: h } => {
            // The centres of the half spheres are half the radius from the ends of the cylinder.
            let across = 2.0 / 3.0 * r * r + h * h + h * r;
            let caps = Content { size: 4.0 * PI * r * r, inertia: [across, across, 2.0 / 3.0 * r * r] };
            with_caps(tube(r, h), caps)
        }
    }
}

fn tube(r: f64, h: f64) -> Content {
    let across = 0.5 * r * r + h * h / 3.0;
    Content { size: 4.0 * PI * r * h, inertia: [across, across, r * r] }
}

fn box_shell([a, b, c]: Vec3) -> Content {
    let areas = [8.0 * b * c, 8.0 * a * c, 8.0 * a * b];
    let size: f64 = areas.iter().sum();
    // Second moment along each axis: plates across the axis are at its ends, the others spread along it.
    let second = [(0, a), (1, b), (2, c)].map(|(i, v)| v * v * (areas[i] + (size - areas[i]) / 3.0) / size);
    Content { size, inertia: [second[1] + second[2], second[0] + second[2], second[0] + second[1]] }
}

fn sphere(r: f64) -> f64 {
    4.0 / 3.0 * PI * r * r * r
}

/// The mean of two parts, each in proportion to its size.
fn with_caps(middle: Content, caps: Content) -> Content {
    let size = middle.size + caps.size;
    let weighed = add(scale(middle.size, middle.inertia), scale(caps.size, caps.inertia));
    Content { size, inertia: scale(1.0 / size, weighed) }
}
