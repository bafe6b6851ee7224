//! Mass, centre and inertia of a body as MuJoCo's compiler makes them.

use super::{
    classes::{Classes, Properties},
    compiler::{FromGeoms, Settings},
    element::Attribute,
    error::MjcfError,
    pose::ORIENTATIONS,
    principal::Principal,
    shape::geom_body,
    world::{Body, Part},
};
use crate::robot::body::{Frame, RigidBody};
use thetahat_ground::vector::{IDENTITY, Mat3, scale};

/// A mass with its centre, and the inertia about it in the axes of the body.
#[derive(Clone, Copy)]
pub(super) struct MassProperties {
    pub(super) mass: f64,
    pub(super) centre: [f64; 3],
    pub(super) inertia: Mat3,
}

impl MassProperties {
    const NOTHING: Self = Self { mass: 0.0, centre: [0.0; 3], inertia: [[0.0; 3]; 3] };

    /// Of a body with a mass.
    fn of(body: &RigidBody) -> Self {
        let centre = scale(1.0 / body.m, body.ms);
        let about_centre = Frame { rotation: IDENTITY, origin: scale(-1.0, centre) };
        Self { mass: body.m, centre, inertia: body.seen_in(&about_centre).inertia }
    }

    /// The same about the origin of the body's frame.
    pub(super) fn body(&self) -> RigidBody {
        let about_centre = RigidBody { m: self.mass, ms: [0.0; 3], inertia: self.inertia };
        about_centre.seen_in(&Frame { rotation: IDENTITY, origin: self.centre })
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { mass: factor * self.mass, inertia: self.inertia.map(|row| scale(factor, row)), ..*self }
    }

    fn within_bounds(mut self, settings: &Settings) -> Self {
        // A bound of zero is none: impossible values stay, and are among the doubts.
        let raised = |value: f64, bound: f64| if bound > 0.0 { value.max(bound) } else { value };
        self.mass = raised(self.mass, settings.least_mass);
        let principal = Principal::of(&self.inertia);
        let raised = principal.values.map(|value| raised(value, settings.least_inertia));
        let balanced = if settings.balances { balanced(raised) } else { raised };
        if balanced != principal.values {
            self.inertia = principal.with(balanced);
        }
        self
    }
}

/// Equal principal inertias, if the largest is above the sum of the others.
fn balanced([a, b, c]: [f64; 3]) -> [f64; 3] {
    let sum = a + b + c;
    if 2.0 * a.max(b).max(c) > sum { [sum / 3.0; 3] } else { [a, b, c] }
}

/// The mass of a body.
pub(super) fn mass_properties_of<'a>(
    body: &Body<'a>,
    settings: &Settings,
    classes: &Classes<'a>,
) -> Result<MassProperties, MjcfError> {
    let from_geoms = match settings.from_geoms {
        FromGeoms::Always => true,
        FromGeoms::Never => false,
        FromGeoms::Auto => body.inertial.is_none(),
    };
    let of_geoms = if from_geoms { of_geoms(body, settings, classes)? } else { RigidBody::default() };
    let found = match body.inertial {
        // Geoms without mass replace no <inertial>.
        Some(inertial) if of_geoms.m == 0.0 => stated(&inertial, settings)?,
        // MuJoCo places the mass that a bound gives to an empty body as if the body's pose were that of its inertia.
        None if of_geoms.m == 0.0 => MassProperties { centre: body.frame.origin, ..MassProperties::NOTHING },
        Some(_) | None => MassProperties::of(&of_geoms),
    };
    Ok(found.within_bounds(settings))
}

fn of_geoms<'a>(body: &Body<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<RigidBody, MjcfError> {
    let [first, last] = settings.groups;
    let mut sum = RigidBody::default();
    for part in &body.geoms {
        let geom = classes.of(part.element, part.class, &["geom"])?;
        let group = geom.number("group")?.unwrap_or(0.0);
        if (first..=last).contains(&group)
            && let Some(found) = geom_body(&geom, settings, || body.element.name())?
        {
            sum.absorb(&found.seen_in(&part.frame));
        }
    }
    Ok(sum)
}

/// The `<inertial>` of a body.
fn stated(part: &Part<'_>, settings: &Settings) -> Result<MassProperties, MjcfError> {
    let element = part.element;
    let mass = element.required("mass", "give it, or leave out the whole <inertial>")?.number()?;
    let inertial = Properties::own(element);
    let inertia = match (element.attribute("fullinertia"), element.attribute("diaginertia")) {
        (Some(_), Some(both)) => return Err(both.wrong("either diaginertia or fullinertia; remove one")),
        (Some(full), None) => of_full(full, &inertial)?,
        (None, Some(diagonal)) => {
            let [x, y, z] = diagonal.numbers()?;
            [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
        }
        (None, None) => return Err(element.missing("diaginertia or fullinertia", "give one of them")),
    };
    let frame = part.frame.then(&settings.frame(&inertial)?);
    let body = RigidBody { m: mass, ms: [0.0; 3], inertia };
    let turned = body.seen_in(&Frame { origin: [0.0; 3], ..frame }).inertia;
    Ok(MassProperties { mass, centre: frame.origin, inertia: turned })
}

fn of_full(full: Attribute<'_>, inertial: &Properties<'_>) -> Result<Mat3, MjcfError> {
    let [xx, yy, zz, xy, xz, yz] = full.numbers()?;
    match ORIENTATIONS.into_iter().find_map(|key| inertial.attribute(key)) {
        Some(turned) => Err(turned.wrong("none next to fullinertia, which is in the axes of the body; remove it")),
        None => Ok([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
    }
}
