//! The chain of joints and links that the bodies make.

use std::collections::HashMap;

use super::{
    classes::Classes,
    compiler::Settings,
    element::Element,
    error::MjcfError,
    inertia::{MassProperties, mass_properties_of},
    joint::Moving,
    world::World,
};
use crate::robot::{
    Joint, JointKind, MOST_JOINTS, Placement,
    body::{Frame, RigidBody},
    floating::Base,
};
use thetahat_ground::vector::{IDENTITY, Mat3, axis_angle, product, scale, times, transpose, with_z};

/// The robot under construction, from the world, body by body.
pub(super) struct Assembly<'a> {
    pub(super) joints: Vec<Joint>,
    pub(super) moving: Vec<Moving<'a>>,
    /// The body of each joint's link, with everything fixed to it.
    pub(super) links: Vec<RigidBody>,
    /// Where each body is.
    pub(super) places: Vec<BodyPlace>,
    /// Bodies with a free joint, which are fixed.
    pub(super) free: Vec<Element<'a>>,
    /// Mass and inertia of each moving body, as the model states them.
    pub(super) masses: Vec<WeighedBody<'a>>,
    /// The root body of a base that floats, with everything fixed to it.
    pub(super) root_body: RigidBody,
}

/// A moving body with the joint that carries it, from zero, and what the model states of it.
pub(super) struct WeighedBody<'a> {
    pub(super) element: Element<'a>,
    pub(super) carrier: usize,
    pub(super) properties: MassProperties,
}

/// The joint that carries a body, none for the world, and the body's frame in that of the joint's link.
#[derive(Clone, Copy)]
pub(super) struct BodyPlace {
    pub(super) carrier: Option<usize>,
    frame: Frame,
    /// Whether it is below the body of a base that floats.
    is_on_root: bool,
}

impl BodyPlace {
    /// A frame of the body, in that of the link.
    pub(super) fn in_link(&self, frame: &Frame) -> Frame {
        self.frame.then(frame)
    }
}

impl<'a> Assembly<'a> {
    pub(super) fn of(
        world: &World<'a>,
        settings: &Settings,
        classes: &Classes<'a>,
        base: Base,
    ) -> Result<Self, MjcfError> {
        let (joints, moving, links) = (Vec::new(), Vec::new(), Vec::new());
        let (places, root_body) = (Vec::new(), RigidBody::default());
        let mut assembly = Self { joints, moving, links, places, free: Vec::new(), masses: Vec::new(), root_body };
        for body in &world.bodies {
            let parent = body.parent.map(|parent| assembly.places[parent]);
            let before = parent.unwrap_or(BodyPlace { carrier: None, frame: Frame::SAME, is_on_root: false });
            let mut place = BodyPlace { frame: before.frame.then(&body.frame), ..before };
            for joint in &body.joints {
                match (Moving::read(joint, settings, classes)?, base) {
                    (Some(moving), _) => place = assembly.add(moving, &place)?,
                    (None, Base::Fixed) => assembly.free.push(body.element),
                    (None, Base::Floating) => place = assembly.root(body.element, &place)?,
                }
            }
            assembly.places.push(place);
        }
        if base == Base::Floating {
            assembly.require_one_tree(world)?;
        }
        assembly.name_joints(world)?;
        assembly.weigh(world, settings, classes)?;
        Ok(assembly)
    }

    /// The place of the root body of a base that floats: its frame is that whose pose is measured.
    fn root(&self, element: Element<'a>, place: &BodyPlace) -> Result<BodyPlace, MjcfError> {
        if place.carrier.is_some() || self.places.iter().any(|place| place.is_on_root) {
            let why = "with floating_base one body has a free joint, and every joint is below it; remove the others";
            return Err(element.unsupported(why));
        }
        Ok(BodyPlace { carrier: None, frame: Frame::SAME, is_on_root: true })
    }

    /// Refuses a base that floats without a free joint, and joints that are not below it.
    fn require_one_tree(&self, world: &World<'a>) -> Result<(), MjcfError> {
        let apart =
            world.bodies.iter().zip(&self.places).find(|(body, place)| !place.is_on_root && !body.joints.is_empty());
        match apart {
            None => Ok(()),
            Some((body, _)) => {
                let why = "floating_base = true needs one <freejoint/> whose body carries every joint";
                Err(body.element.unsupported(why))
            }
        }
    }

    /// Adds a joint whose body is at `place`; returns the place of the body on the link of this joint, whose origin is on the axis.
    fn add(&mut self, moving: Moving<'a>, place: &BodyPlace) -> Result<BodyPlace, MjcfError> {
        if self.joints.len() >= MOST_JOINTS {
            let path = moving.element.path().to_owned();
            return Err(MjcfError::TooLarge { path, what: "moving joints", limit: MOST_JOINTS });
        }
        let anchor = match moving.kind {
            JointKind::Revolute => moving.anchor,
            JointKind::Prismatic => [0.0; 3],
        };
        let link = place.frame.then(&Frame { rotation: IDENTITY, origin: anchor }).then(&at_zero(&moving));
        self.joints.push(self.joint(&moving, place.carrier, &link));
        self.moving.push(moving);
        self.links.push(RigidBody::default());
        let frame = Frame { rotation: IDENTITY, origin: scale(-1.0, anchor) };
        Ok(BodyPlace { carrier: Some(self.joints.len() - 1), frame, ..*place })
    }

    /// The joint's frame is the link's, rotated so that z is the axis; so is the frame of its carrier.
    fn joint(&self, moving: &Moving<'_>, carrier: Option<usize>, link: &Frame) -> Joint {
        let axes = with_z(moving.axis);
        let rotation = product(&link.rotation, &axes);
        let (rotation, origin) = match carrier.and_then(|carrier| self.joints[carrier].link_axes) {
            None => (rotation, link.origin),
            Some(axes) => (product(&axes, &rotation), times(&axes, link.origin)),
        };
        Joint {
            name: moving.element.text_of("name").unwrap_or_default().to_owned(),
            kind: moving.kind,
            parent: carrier,
            placement: Placement::new(&rotation, origin),
            also_follows: Vec::new(),
            link_axes: link_axes(&axes),
            mimic: None,
            passive: false,
            of_base: false,
            limits: moving.limits,
        }
    }

    /// Refuses a name that two joints have, and names the joints without one after their bodies.
    fn name_joints(&mut self, world: &World<'a>) -> Result<(), MjcfError> {
        let mut first: HashMap<String, Element<'a>> = HashMap::new();
        for (joint, moving) in self.joints.iter().zip(&self.moving).filter(|(joint, _)| !joint.name.is_empty()) {
            if let Some(first) = first.insert(joint.name.clone(), moving.element) {
                return Err(moving.element.same_name(first));
            }
        }
        let bodies =
            world.bodies.iter().flat_map(|body| body.joints.iter().map(move |part| (part.element, body.element)));
        let bodies: Vec<(Element<'a>, Element<'a>)> = bodies.collect();
        for (k, (joint, moving)) in self.joints.iter_mut().zip(&self.moving).enumerate() {
            if joint.name.is_empty() {
                let body = bodies.iter().find(|(part, _)| part.is(moving.element)).and_then(|(_, b)| b.text_of("name"));
                let mut name = body.map_or(format!("joint{}", k + 1), |body| format!("{body}_joint"));
                while first.contains_key(&name) {
                    name = format!("{name}_{}", k + 1);
                }
                first.insert(name.clone(), moving.element);
                joint.name = name;
            }
        }
        Ok(())
    }

    fn weigh(&mut self, world: &World<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<(), MjcfError> {
        let counts = |place: &BodyPlace| place.carrier.is_some() || place.is_on_root || settings.total_mass.is_some();
        let bodies = world.bodies.iter().zip(&self.places).filter(|(_, place)| counts(place));
        let masses =
            bodies.map(|(body, place)| Ok((body.element, *place, mass_properties_of(body, settings, classes)?)));
        let masses = masses.collect::<Result<Vec<_>, MjcfError>>()?;
        let total: f64 = masses.iter().map(|(_, _, properties)| properties.mass).sum();
        let factor =
            settings.total_mass.filter(|wanted| *wanted > 0.0 && total > 0.0).map_or(1.0, |wanted| wanted / total);
        for (element, place, properties) in masses {
            let own = properties.scaled(factor).body().seen_in(&place.frame);
            let Some(carrier) = place.carrier else {
                if place.is_on_root {
                    self.root_body.absorb(&own);
                }
                continue;
            };
            self.links[carrier].absorb(&own);
            self.masses.push(WeighedBody { element, carrier, properties });
        }
        Ok(())
    }
}

/// The frame of a link at coordinate zero, in its frame in the pose of the model.
fn at_zero(moving: &Moving<'_>) -> Frame {
    match moving.kind {
        JointKind::Revolute => Frame { rotation: axis_angle(moving.axis, -moving.reference), origin: [0.0; 3] },
        JointKind::Prismatic => Frame { rotation: IDENTITY, origin: scale(-moving.reference, moving.axis) },
    }
}

fn link_axes(axes: &Mat3) -> Option<Mat3> {
    (*axes != IDENTITY).then(|| transpose(axes))
}
