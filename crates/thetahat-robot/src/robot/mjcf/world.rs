//! The tree of bodies, without recursion: a hostile model may nest them deeply.

use std::collections::HashMap;

use super::{
    classes::{Classes, MAIN, Properties},
    compiler::Settings,
    element::Element,
    error::MjcfError,
};
use crate::robot::body::Frame;

/// Most bodies, joints and frames.
const MOST_PARTS: usize = 4000;
/// Most geoms.
const MOST_GEOMS: usize = 100_000;

/// A `<body>` with what it holds.
pub(super) struct Body<'a> {
    pub(super) element: Element<'a>,
    /// The body that holds it, none for the world.
    pub(super) parent: Option<usize>,
    /// Its frame in that of its parent.
    pub(super) frame: Frame,
    pub(super) inertial: Option<Part<'a>>,
    pub(super) joints: Vec<Part<'a>>,
    pub(super) geoms: Vec<Part<'a>>,
}

/// An element of a body.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) element: Element<'a>,
    /// The class of elements that name none.
    pub(super) class: &'a str,
    /// The frame of the `<frame>` elements around it, in that of the body.
    pub(super) frame: Frame,
}

/// The bodies of a model, parents before children, depth first.
pub(super) struct World<'a> {
    pub(super) bodies: Vec<Body<'a>>,
    /// Elements that make further bodies, with the body that holds them.
    pub(super) makers: Vec<(Element<'a>, Option<usize>)>,
    names: HashMap<&'a str, usize>,
    /// The sites by name: the body, none for the world, and the frame in it.
    sites: HashMap<&'a str, (Option<usize>, Frame)>,
    parts: usize,
    geoms: usize,
}

/// An element that waits to be read, with the body that holds it.
type Waiting<'a> = (Part<'a>, Option<usize>);

impl<'a> World<'a> {
    pub(super) fn read(root: Element<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<Self, MjcfError> {
        let (names, sites) = (HashMap::new(), HashMap::new());
        let mut world = Self { bodies: Vec::new(), makers: Vec::new(), names, sites, parts: 0, geoms: 0 };
        let tops: Vec<Element<'a>> = root.named("worldbody").collect();
        let mut waiting = Vec::new();
        for top in tops.into_iter().rev() {
            let class = classes.stated(top, "childclass")?.unwrap_or(MAIN);
            waiting.extend(children(Part { element: top, class, frame: Frame::SAME }, None));
        }
        while let Some((part, owner)) = waiting.pop() {
            waiting.extend(world.take(part, owner, settings, classes)?);
        }
        Ok(world)
    }

    /// Adds an element; returns those in it, the first one last.
    fn take(
        &mut self,
        part: Part<'a>,
        owner: Option<usize>,
        settings: &Settings,
        classes: &Classes<'a>,
    ) -> Result<Vec<Waiting<'a>>, MjcfError> {
        let body = owner.map(|owner| &mut self.bodies[owner]);
        match part.element.tag() {
            "body" => self.open(part, owner, settings, classes),
            "frame" => {
                self.count(part.element)?;
                Ok(children(placed(part, settings, classes)?, owner))
            }
            "joint" | "freejoint" => {
                let why = "the world does not move; put the joint into a <body>";
                body.ok_or_else(|| part.element.unsupported(why))?.joints.push(part);
                self.count(part.element)?;
                Ok(Vec::new())
            }
            "geom" => {
                body.into_iter().for_each(|body| body.geoms.push(part));
                self.geoms += 1;
                let (path, what) = (part.element.path().to_owned(), "geoms");
                if self.geoms > MOST_GEOMS {
                    return Err(MjcfError::TooLarge { path, what, limit: MOST_GEOMS });
                }
                Ok(Vec::new())
            }
            "inertial" => {
                body.into_iter().for_each(|body| body.inertial = Some(part));
                Ok(Vec::new())
            }
            "replicate" | "composite" | "flexcomp" | "attach" => {
                self.makers.push((part.element, owner));
                Ok(Vec::new())
            }
            "site" => {
                if let Some(name) = part.element.text_of("name") {
                    self.sites.insert(name, (owner, placed(part, settings, classes)?.frame));
                }
                Ok(Vec::new())
            }
            // Cameras, lights and plugins have no mass.
            _ => Ok(Vec::new()),
        }
    }

    fn open(
        &mut self,
        part: Part<'a>,
        owner: Option<usize>,
        settings: &Settings,
        classes: &Classes<'a>,
    ) -> Result<Vec<Waiting<'a>>, MjcfError> {
        self.count(part.element)?;
        let Part { element, class, frame } = placed(part, settings, classes)?;
        let body = Body { element, parent: owner, frame, inertial: None, joints: Vec::new(), geoms: Vec::new() };
        if let Some(first) = element.text_of("name").and_then(|name| self.names.insert(name, self.bodies.len())) {
            return Err(element.same_name(self.bodies[first].element));
        }
        self.bodies.push(body);
        Ok(children(Part { element, class, frame: Frame::SAME }, Some(self.bodies.len() - 1)))
    }

    fn count(&mut self, element: Element<'_>) -> Result<(), MjcfError> {
        self.parts += 1;
        let (path, what) = (element.path().to_owned(), "bodies, joints and frames");
        if self.parts > MOST_PARTS { Err(MjcfError::TooLarge { path, what, limit: MOST_PARTS }) } else { Ok(()) }
    }

    /// The body of a site, none for the world, and the site's frame in it.
    pub(super) fn site(&self, name: &str) -> Option<(Option<usize>, Frame)> {
        self.sites.get(name).copied()
    }

    /// The body of a name.
    pub(super) fn body(&self, name: &str) -> Option<usize> {
        self.names.get(name).copied()
    }
}

/// A body or frame with its own pose and the class of its children.
fn placed<'a>(part: Part<'a>, settings: &Settings, classes: &Classes<'a>) -> Result<Part<'a>, MjcfError> {
    let class = classes.stated(part.element, "childclass")?.unwrap_or(part.class);
    let frame = part.frame.then(&settings.frame(&Properties::own(part.element))?);
    Ok(Part { class, frame, ..part })
}

fn children(part: Part<'_>, owner: Option<usize>) -> Vec<Waiting<'_>> {
    part.element.elements().rev().map(|element| (Part { element, ..part }, owner)).collect()
}
