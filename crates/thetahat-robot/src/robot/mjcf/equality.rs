//! `<equality>`: joints that follow others, or are held; bodies and tendons that close loops.

use std::collections::HashMap;

use super::{
    assembly::Assembly,
    classes::{Classes, MAIN, Properties},
    element::{Attribute, Element, elements_of},
    error::MjcfError,
    loops::{ClosedBodies, closed_bodies, closed_positions, rod},
    world::World,
};
use crate::robot::{LARGEST, Mimic, tree};

/// What the equalities make of the joints.
pub(super) struct Equalities<'a> {
    /// The joint that each joint follows.
    pub(super) mimics: Vec<Option<Mimic>>,
    /// The coordinate at which each joint is held.
    pub(super) held: Vec<Option<f64>>,
    /// The bodies that close loops.
    pub(super) loops: Vec<ClosedBodies<'a>>,
}

impl<'a> Equalities<'a> {
    pub(super) fn read(
        root: Element<'a>,
        classes: &Classes<'a>,
        world: &World<'a>,
        assembly: &Assembly<'a>,
    ) -> Result<Self, MjcfError> {
        let n = assembly.joints.len();
        let mut reader = Reader { assembly, mimics: vec![None; n], held: vec![None; n], stated: vec![None; n] };
        let [tendons, spatial] = ["fixed", "spatial"].map(|kind| tendons(root, kind));
        let mut loops = Vec::new();
        let positions = closed_positions(root, assembly);
        for element in elements_of(root, "equality")? {
            let equality = classes.of(element, MAIN, &["equality"])?;
            let active = equality.attribute("active").map(Attribute::flag).transpose()?.flatten();
            match element.tag() {
                _ if active == Some(false) => {}
                "joint" => reader.follow(&equality)?,
                "connect" | "weld" => loops.extend(closed_bodies(&equality, world, assembly, &positions)?),
                "tendon" => match element.text_of("tendon1").and_then(|name| spatial.get(name)) {
                    Some(tendon) => loops.extend(rod(&equality, *tendon, world, assembly, &positions)?),
                    None => reader.couple(&equality, &tendons)?,
                },
                // Equalities of flexible bodies move no joint.
                _ => {}
            }
        }
        Ok(Self { loops, ..reader.resolved()? })
    }
}

/// The tendons of a kind by name.
fn tendons<'a>(root: Element<'a>, kind: &'static str) -> HashMap<&'a str, Element<'a>> {
    let tendons = root.named("tendon").flat_map(|tendon| tendon.named(kind));
    tendons.filter_map(|tendon| Some((tendon.text_of("name")?, tendon))).collect()
}

struct Reader<'r, 'a> {
    assembly: &'r Assembly<'a>,
    mimics: Vec<Option<Mimic>>,
    held: Vec<Option<f64>>,
    /// The element that makes each joint follow.
    stated: Vec<Option<Element<'a>>>,
}

impl<'a> Reader<'_, 'a> {
    /// `q1 - ref1 = c0 + c1 (q2 - ref2)`, or `q1 - ref1 = c0` without a second joint.
    fn follow(&mut self, equality: &Properties<'a>) -> Result<(), MjcfError> {
        let element = equality.element();
        let first = self.joint(element.required("joint1", "name the joint that follows")?.text, element)?;
        let second = element.text_of("joint2").map(|name| self.joint(name, element)).transpose()?;
        let [constant, ratio, powers @ ..] = equality.leading("polycoef", [0.0, 1.0, 0.0, 0.0, 0.0])?;
        if second.is_some() && powers != [0.0; 3] {
            return Err(self.error(
                first,
                element,
                "its polycoef has powers above one; only c0 and c1 may differ from zero",
            ));
        }
        self.bind(first, second.filter(|_| ratio != 0.0), [constant, ratio], element)
    }

    /// `c1 (q1 - ref1) + c2 (q2 - ref2) = c0` for a tendon of two joints, or of one.
    fn couple(&mut self, equality: &Properties<'a>, tendons: &HashMap<&'a str, Element<'a>>) -> Result<(), MjcfError> {
        let element = equality.element();
        let name = element.required("tendon1", "name the tendon")?.text;
        let [constant, ..] = equality.leading("polycoef", [0.0, 1.0, 0.0, 0.0, 0.0])?;
        let mut joints = Vec::new();
        for part in tendons.get(name).into_iter().flat_map(|tendon| tendon.named("joint")).take(3) {
            let joint = self.joint(part.required("joint", "name the joint of the tendon")?.text, part)?;
            let coefficient = part.required("coef", "give the coefficient of the joint")?.number()?;
            joints.extend((coefficient != 0.0).then_some((joint, coefficient)));
        }
        match (element.attribute("tendon2"), &joints[..]) {
            (None, &[(only, coefficient)]) => self.bind(only, None, [constant / coefficient, 0.0], element),
            (None, &[(first, own), (second, other)]) => {
                self.bind(first, Some(second), [constant / own, -other / own], element)
            }
            (None | Some(_), _) => Err(element.unsupported(
                "only a fixed tendon of one or two joints makes a joint follow another, and one between two sites a rod; give the equality active=\"false\"",
            )),
        }
    }

    /// `q1 - ref1 = c0 + c1 (q2 - ref2)`, or `q1 - ref1 = c0` without a second joint.
    fn bind(
        &mut self,
        first: usize,
        second: Option<usize>,
        [constant, ratio]: [f64; 2],
        element: Element<'a>,
    ) -> Result<(), MjcfError> {
        if self.stated[first].replace(element).is_some() {
            return Err(self.error(first, element, "it follows another already; remove one of the two"));
        }
        let reference = |joint: usize| self.assembly.moving[joint].reference;
        let at_rest = reference(first) + constant;
        match second {
            Some(of) => self.mimics[first] = Some(Mimic { of, ratio, offset: at_rest - ratio * reference(of) }),
            None => self.held[first] = Some(at_rest),
        }
        Ok(())
    }

    fn joint(&self, name: &str, element: Element<'_>) -> Result<usize, MjcfError> {
        let found = self.assembly.joints.iter().position(|joint| joint.name == name);
        found.ok_or_else(|| element.unknown("joint", name))
    }

    fn error(&self, joint: usize, element: Element<'_>, problem: &'static str) -> MjcfError {
        MjcfError::Follower { place: element.place(), joint: self.assembly.joints[joint].name.clone(), problem }
    }

    fn resolved(self) -> Result<Equalities<'a>, MjcfError> {
        let circle = "it follows itself in the end, or by a ratio beyond 1e9; one joint must follow none";
        let mut mimics = tree::resolve_mimics(&self.mimics).map_err(|joint| self.circular(joint, circle))?;
        let mut held = self.held;
        for joint in 0..mimics.len() {
            // A joint that follows a held one is held as well.
            let Some((mimic, leader)) = mimics[joint].and_then(|mimic| Some((mimic, held[mimic.of]?))) else {
                continue;
            };
            held[joint] = Some(mimic.ratio * leader + mimic.offset).filter(|value| value.abs() <= LARGEST);
            mimics[joint] = None;
        }
        Ok(Equalities { mimics, held, loops: Vec::new() })
    }

    fn circular(&self, joint: usize, problem: &'static str) -> MjcfError {
        let name = self.assembly.joints[joint].name.clone();
        let place = self.stated[joint].map_or_else(|| self.assembly.moving[joint].element.place(), Element::place);
        MjcfError::Follower { place, joint: name, problem }
    }
}
