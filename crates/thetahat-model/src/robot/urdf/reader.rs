use std::{collections::BTreeMap, path::Path};

use super::{
    UrdfError, document, doubts,
    element::Element,
    joints::{JointElement, Moving},
    links,
    shapes::{Solid, shapes_of},
    structure::{LinkPair, Structure, unknown},
    transmissions,
};
use crate::robot::{
    Friction, INERTIAL, Joint, MOST_JOINTS, Mimic, Placement, Robot, RobotError, Transmission,
    body::{Frame, RigidBody},
    locking::{LocksOf, resolve_all},
    tree,
};
use thetahat_ground::{
    linear_algebra::Matrix,
    vector::{product, times, transpose},
};

/// Acceleration of gravity in the frame of the root link, m/s^2.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Whether the file's transmissions are used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::robot) enum Transmissions {
    /// Their reductions are the diagonal of the transmission matrix.
    Read,
    /// Another transmission matrix replaces them.
    Ignored,
}

/// The robot of a URDF; `path` is its name in messages. No joint is locked yet: `locks` lists joints whose transmissions are
/// ignored.
///
/// # Errors
/// [`UrdfError`] with file, line and element; [`RobotError::Lock`] for joints that cannot be locked.
pub(in crate::robot) fn read(
    text: &str,
    path: &Path,
    transmissions: Transmissions,
    locks: &[LocksOf<'_>],
) -> Result<Robot, RobotError> {
    let document = document::parse(text, path)?;
    let element = document::robot(&document, path)?;
    let name = element.required("name", "give it one: <robot name=\"my_robot\">")?.to_owned();
    let structure = Structure::read(element)?;
    let mut assembly = Assembly::new(&structure);
    for &joint in &structure.order {
        let LinkPair { parent, child } = structure.ends[joint];
        assembly.add(&structure.joints[joint], parent, child)?;
    }
    if assembly.joints.len() > MOST_JOINTS {
        let path = path.to_owned();
        return Err(UrdfError::TooLarge { path, what: "moving joints", limit: MOST_JOINTS }.into());
    }
    assembly.follow()?;
    let locked = resolve_all(&assembly.joints, locks)?;
    let transmission = match transmissions {
        Transmissions::Read => assembly.transmission(element, &structure, &locked)?,
        Transmissions::Ignored => Transmission::direct(assembly.coordinates().count()),
    };
    Ok(Robot {
        term_descriptions: Vec::new(),
        terms: Vec::new(),
        name,
        gravity: GRAVITY,
        a_priori: assembly.a_priori(),
        joints: assembly.joints,
        transmission,
        friction: Friction::Symmetric,
        locked: Vec::new(),
        doubts: doubts::of(&structure.links, &structure.joints)?,
    })
}

/// A link of a URDF with its rigid body.
pub(in crate::robot) struct LinkBody {
    pub(in crate::robot) name: String,
    /// The moving joint that carries it, by its index in the robot without locks; none for links on the base.
    pub(in crate::robot) carrier: Option<usize>,
    /// Whether it is the link of that joint itself.
    pub(in crate::robot) is_carrier: bool,
    /// Its frame relative to that of the joint's link.
    pub(in crate::robot) frame: Frame,
    pub(in crate::robot) body: RigidBody,
    /// Its collision shapes in its frame; none for the solid of a mesh.
    pub(in crate::robot) shapes: Vec<(Frame, Option<Solid>)>,
}

/// The links of a URDF in the order of the file.
///
/// # Errors
/// As [`read`].
pub(in crate::robot) fn link_bodies(text: &str, path: &Path) -> Result<Vec<LinkBody>, UrdfError> {
    let document = document::parse(text, path)?;
    let structure = Structure::read(document::robot(&document, path)?)?;
    let mut assembly = Assembly::new(&structure);
    for &joint in &structure.order {
        let LinkPair { parent, child } = structure.ends[joint];
        assembly.add(&structure.joints[joint], parent, child)?;
    }
    let moved = |link: usize| {
        structure.ends.iter().zip(&structure.joints).any(|(pair, j)| pair.child == link && j.moving.is_some())
    };
    let link = |(k, element): (usize, &Element<'_>)| {
        let place = assembly.places[k].unwrap_or(LinkPlace { carrier: None, frame: Frame::SAME });
        Ok(LinkBody {
            name: element.attribute("name").unwrap_or_default().to_owned(),
            carrier: place.carrier,
            is_carrier: moved(k),
            frame: place.frame,
            body: links::body_of(*element)?,
            shapes: shapes_of(*element)?,
        })
    };
    structure.links.iter().enumerate().map(link).collect()
}

/// The robot under construction, from the base, joint by joint.
struct Assembly<'s, 'a> {
    links: &'s [Element<'a>],
    /// The carrier of each link, once it is reached.
    places: Vec<Option<LinkPlace>>,
    joints: Vec<Joint>,
    moving: Vec<&'s Moving<'a>>,
    /// The body of each joint's link, with everything fixed to it.
    bodies: Vec<RigidBody>,
}

/// The moving joint that carries a link, none for the base, and the link's frame in the frame of the carrier's own
/// link.
#[derive(Clone, Copy)]
struct LinkPlace {
    carrier: Option<usize>,
    frame: Frame,
}

impl<'s, 'a> Assembly<'s, 'a> {
    fn new(structure: &'s Structure<'a>) -> Self {
        let mut places = vec![None; structure.links.len()];
        if let Some(root) = places.get_mut(structure.root) {
            *root = Some(LinkPlace { carrier: None, frame: Frame::SAME });
        }
        Self { links: &structure.links, places, joints: Vec::new(), moving: Vec::new(), bodies: Vec::new() }
    }

    fn add(&mut self, joint: &'s JointElement<'a>, parent: usize, child: usize) -> Result<(), UrdfError> {
        let Some(LinkPlace { carrier, frame }) = self.places[parent] else { return Ok(()) };
        let frame = frame.then(&joint.frame);
        let body = links::body_of(self.links[child])?;
        self.places[child] = Some(match &joint.moving {
            None => {
                if let Some(carrier) = carrier {
                    self.bodies[carrier].absorb(&body.seen_in(&frame));
                }
                LinkPlace { carrier, frame }
            }
            Some(moving) => {
                self.joints.push(self.joint(joint.name, moving, carrier, &frame));
                self.moving.push(moving);
                self.bodies.push(body);
                LinkPlace { carrier: Some(self.joints.len() - 1), frame: Frame::SAME }
            }
        });
        Ok(())
    }

    /// The joint's frame is the link's, rotated so that z is the axis; so is the frame of its carrier.
    fn joint(&self, name: &str, moving: &Moving<'a>, carrier: Option<usize>, frame: &Frame) -> Joint {
        let rotation = product(&frame.rotation, &moving.axes);
        let (rotation, origin) = match carrier.and_then(|c| self.joints[c].link_axes) {
            None => (rotation, frame.origin),
            Some(axes) => (product(&axes, &rotation), times(&axes, frame.origin)),
        };
        Joint {
            name: name.to_owned(),
            kind: moving.kind,
            parent: carrier,
            placement: Placement::new(&rotation, origin),
            link_axes: (!moving.has_link_axes()).then(|| transpose(&moving.axes)),
            mimic: None,
            limits: moving.limits,
        }
    }

    /// Resolves the `<mimic>` of joints.
    fn follow(&mut self) -> Result<(), UrdfError> {
        let mimics = self.moving.iter().map(|m| self.mimic(m)).collect::<Result<Vec<_>, _>>()?;
        let resolved = tree::resolve_mimics(&mimics).map_err(|joint| self.follows_itself(joint))?;
        self.joints.iter_mut().zip(resolved).for_each(|(joint, mimic)| joint.mimic = mimic);
        Ok(())
    }

    fn mimic(&self, moving: &Moving<'_>) -> Result<Option<Mimic>, UrdfError> {
        let Some(mimic) = &moving.mimic else { return Ok(None) };
        match self.joints.iter().position(|joint| joint.name == mimic.joint) {
            Some(of) => Ok(Some(Mimic { of, ratio: mimic.ratio, offset: mimic.offset })),
            None => {
                let names: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
                Err(unknown(mimic.element, "moving joint", mimic.joint, names.iter()))
            }
        }
    }

    fn follows_itself(&self, joint: usize) -> UrdfError {
        let mimic = self.moving[joint].mimic.as_ref();
        let place = mimic.map_or_else(|| self.links[0].place(), |mimic| mimic.element.place());
        let joint = mimic.map_or(String::new(), |mimic| mimic.joint.to_owned());
        UrdfError::Mimic {
            place,
            joint,
            problem: "it follows itself in the end, or by a ratio beyond 1e9; one joint must follow none",
        }
    }

    fn coordinates(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| joint.mimic.is_none())
    }

    fn transmission(
        &self,
        robot: Element<'_>,
        structure: &Structure<'_>,
        locked: &[Option<f64>],
    ) -> Result<Transmission, UrdfError> {
        let names: Vec<&str> = structure.joints.iter().map(|joint| joint.name).collect();
        let is_locked = |name: &str| self.joints.iter().zip(locked).any(|(j, v)| v.is_some() && j.name == name);
        let reductions = transmissions::reductions(robot, &names, &is_locked)?;
        let of = |joint: &Joint| names.iter().position(|name| *name == joint.name).map_or(1.0, |i| reductions[i]);
        let diagonal: Vec<f64> = self.coordinates().map(of).collect();
        let n = diagonal.len();
        let matrix = Matrix::from_fn(n, n, |i, j| if i == j { diagonal[i] } else { 0.0 });
        let direct = || Transmission::direct(n);
        Ok(Transmission::new(matrix, vec![0.0; n], vec![1.0; n]).unwrap_or_else(direct))
    }

    /// The inertial parameters and friction that differ from zero.
    fn a_priori(&self) -> BTreeMap<String, f64> {
        let mut values = BTreeMap::new();
        for (k, (body, moving)) in self.bodies.iter().zip(&self.moving).enumerate() {
            let inertial = INERTIAL.iter().map(|quantity| quantity.name()).zip(body.parameters());
            let [viscous, coulomb] = moving.friction;
            let all = inertial.chain([("fv", viscous), ("fc", coulomb)]).filter(|(_, value)| *value != 0.0);
            values.extend(all.map(|(name, value)| (format!("{name}{}", k + 1), value)));
        }
        values
    }
}
