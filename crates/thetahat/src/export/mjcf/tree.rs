//! The bodies and joints of an MJCF.

use std::collections::HashMap;

use roxmltree::NodeId;

use super::{
    defaults::{Defaults, MAIN},
    element::Element,
    error::MjcfError,
    settings::Settings,
};
use thetahat_ground::vector::{Vec3, axis_angle, norm, scale, sub, times};
use thetahat_model::robot::Frame;

/// The body of the world.
pub(super) const WORLD: usize = 0;

/// A `<body>`, or the world.
#[derive(Debug)]
pub(super) struct BodyElement<'a> {
    pub(super) element: Element<'a>,
    /// The body that carries it; the world carries itself.
    pub(super) parent: usize,
    /// Its frame in that of the body that carries it, joints in the reference configuration.
    pub(super) frame: Frame,
    /// What says its inertia.
    pub(super) inertial: Option<Element<'a>>,
    /// A geom that gives it inertia where there is no `<inertial>`.
    pub(super) heavy: Option<Element<'a>>,
    /// An element that makes bodies in it.
    pub(super) made: Option<Element<'a>>,
}

/// A joint of a body.
#[derive(Debug)]
pub(super) struct JointElement<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: &'a str,
    pub(super) body: usize,
    /// `hinge`, `slide`, `ball` or `free`.
    pub(super) kind: &'a str,
    /// Its direction in its body's frame.
    pub(super) axis: Vec3,
    /// A point of the axis there, m.
    pub(super) place: Vec3,
    /// Its coordinate in the reference configuration, rad or m.
    pub(super) reference: f64,
    /// The class of its sibling elements that name none.
    class: &'a str,
}

/// Bodies, those that carry others before, and joints in the order of the file.
#[derive(Debug)]
pub(super) struct Tree<'a> {
    pub(super) bodies: Vec<BodyElement<'a>>,
    pub(super) joints: Vec<JointElement<'a>>,
    defaults: Defaults<'a>,
}

/// What holds for the content of an element.
#[derive(Debug, Clone, Copy)]
struct Inside<'a> {
    body: usize,
    frame: Frame,
    class: &'a str,
}

struct Reader<'a, 's> {
    tree: Tree<'a>,
    inside: HashMap<NodeId, Inside<'a>>,
    settings: &'s Settings<'a>,
}

impl<'a> Tree<'a> {
    pub(super) fn read(root: Element<'a>, settings: &Settings<'a>) -> Result<Self, MjcfError> {
        let world =
            BodyElement { element: root, parent: WORLD, frame: Frame::SAME, inertial: None, heavy: None, made: None };
        let tree = Self { bodies: vec![world], joints: Vec::new(), defaults: Defaults::read(root) };
        let mut reader = Reader { tree, inside: HashMap::new(), settings };
        for section in root.named("worldbody") {
            let class = section.attribute("childclass").unwrap_or(MAIN);
            reader.inside.insert(section.node.id(), Inside { body: WORLD, frame: Frame::SAME, class });
            // What is around stands before: so deep files need no recursion.
            section.descendants().skip(1).try_for_each(|element| reader.take(element))?;
        }
        Ok(reader.tree)
    }

    /// A number of a joint, from its class where it has none; zero without one.
    pub(super) fn number(&self, joint: usize, key: &str) -> Result<f64, MjcfError> {
        let JointElement { element, class, .. } = &self.joints[joint];
        let text = self.defaults.of(*element, class, key);
        text.map_or(Ok(0.0), |text| element.parsed(key, text).map(|[value]| value))
    }

    /// The body's name in messages.
    pub(super) fn name(&self, body: usize) -> String {
        if body == WORLD { "the world".to_owned() } else { self.bodies[body].element.name() }
    }
}

impl<'a> Reader<'a, '_> {
    fn take(&mut self, element: Element<'a>) -> Result<(), MjcfError> {
        let around = element.node.parent().and_then(|node| self.inside.get(&node.id()).copied());
        let Some(around) = around else { return Ok(()) };
        let class = element.attribute("childclass").unwrap_or(around.class);
        match element.tag() {
            "body" => {
                let frame = around.frame.then(&self.settings.frame(element)?);
                let body = self.tree.bodies.len();
                let [inertial, heavy, made] = [None; 3];
                self.tree.bodies.push(BodyElement { element, parent: around.body, frame, inertial, heavy, made });
                self.inside.insert(element.node.id(), Inside { body, frame: Frame::SAME, class });
            }
            "frame" => {
                let frame = around.frame.then(&self.settings.frame(element)?);
                self.inside.insert(element.node.id(), Inside { frame, class, ..around });
            }
            "joint" | "freejoint" => {
                let joint = self.joint(element, &around)?;
                self.tree.joints.push(joint);
            }
            "inertial" => self.tree.bodies[around.body].inertial = Some(element),
            "geom" if self.weighs(element, around.class) => self.tree.bodies[around.body].heavy = Some(element),
            "attach" | "replicate" | "composite" | "flexcomp" => self.tree.bodies[around.body].made = Some(element),
            _ => {}
        }
        Ok(())
    }

    fn joint(&self, element: Element<'a>, around: &Inside<'a>) -> Result<JointElement<'a>, MjcfError> {
        let of = |key: &str| self.tree.defaults.of(element, around.class, key);
        let vector = |key: &str, usual: Vec3| of(key).map_or(Ok(usual), |text| element.parsed(key, text));
        let kind = if element.tag() == "freejoint" { "free" } else { of("type").unwrap_or("hinge") };
        let (axis, place) = (vector("axis", [0.0, 0.0, 1.0])?, vector("pos", [0.0; 3])?);
        let [reference] = of("ref").map_or(Ok([0.0]), |text| element.parsed("ref", text))?;
        let length = norm(axis);
        if length < 1e-9 {
            return Err(element.no_direction("axis"));
        }
        Ok(JointElement {
            element,
            name: element.attribute("name").unwrap_or_default(),
            body: around.body,
            kind,
            axis: times(&around.frame.rotation, scale(1.0 / length, axis)),
            place: around.frame.of_point(place),
            reference: self.settings.coordinate(reference, kind == "hinge"),
            class: around.class,
        })
    }

    /// Whether a geom gives its body inertia.
    fn weighs(&self, geom: Element<'a>, class: &'a str) -> bool {
        let number =
            |key: &str| self.tree.defaults.of(geom, class, key).and_then(|text| text.trim().parse::<f64>().ok());
        let group = number("group").unwrap_or(0.0);
        let [first, last] = self.settings.groups;
        let massless = number("mass").map_or(number("density") == Some(0.0), |mass| mass == 0.0);
        self.settings.geoms_weigh && (first..=last).contains(&group) && !massless
    }
}

impl JointElement<'_> {
    /// The displacement of its body at a coordinate, in the frame of the body before it.
    pub(super) fn displaced(&self, value: f64) -> Frame {
        let by = value - self.reference;
        if self.kind == "slide" {
            return Frame { origin: scale(by, self.axis), ..Frame::SAME };
        }
        let rotation = axis_angle(self.axis, by);
        Frame { rotation, origin: sub(self.place, times(&rotation, self.place)) }
    }
}
