use std::path::Path;

use super::{
    UrdfError,
    assembly::{Assembly, LinkPlace},
    document, doubts,
    element::Element,
    links,
    shapes::{Solid, shapes_of},
    structure::{LinkPair, Structure},
    transmissions,
};
use crate::robot::{
    Doubt, Friction, MOST_JOINTS, Robot, RobotError, Transmission,
    body::{Frame, RigidBody},
    floating::Base,
    locking::{LocksOf, resolve_all},
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
    base: Base,
) -> Result<Robot, RobotError> {
    let document = document::parse(text, path)?;
    let element = document::robot(&document, path)?;
    let name = element.required("name", "give it one: <robot name=\"my_robot\">")?.to_owned();
    let structure = Structure::read(element)?;
    let mut assembly = Assembly::new(&structure)?;
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
    let mut doubts = doubts::of(&structure, &assembly)?;
    doubts.extend(assembly.notes_of_sums());
    let mut a_priori = assembly.a_priori();
    let transmission = match transmissions {
        Transmissions::Read => {
            let drives = assembly.drives(element, &structure, &locked)?;
            a_priori.extend(assembly.motor_inertias(&drives));
            doubts.extend(assembly.unused_inertias(&drives));
            assembly.transmission(&drives)?
        }
        Transmissions::Ignored => {
            doubts.extend(transmissions::motor_inertias(element).into_iter().map(ignored_inertia));
            Transmission::direct(assembly.coordinates().count())
        }
    };
    let root = assembly.root_body;
    let robot = Robot {
        term_descriptions: Vec::new(),
        terms: Vec::new(),
        name,
        gravity: GRAVITY,
        a_priori,
        joints: assembly.joints,
        transmission,
        friction: Friction::Symmetric,
        loops: Vec::new(),
        locked: Vec::new(),
        doubts,
    };
    Ok(match base {
        Base::Fixed => robot,
        Base::Floating => robot.on_floating_base(&root),
    })
}

/// The note of a motor inertia whose reduction the file does not give.
fn ignored_inertia(element: Element<'_>) -> Doubt {
    let what = "the motor inertia is not used, since the transmission of the file is replaced by another".to_owned();
    Doubt::note(element.place().to_string(), what, "give ia, N^2 times the motor inertia, in [parameters]")
}

/// A link of a URDF with its rigid body.
pub(in crate::robot) struct LinkBody {
    pub(in crate::robot) name: String,
    /// The moving joint that carries it, by its index in the robot without locks; none for links on the base.
    pub(in crate::robot) carrier: Option<usize>,
    /// Whether it is the link of that joint itself.
    pub(in crate::robot) is_carrier: bool,
    /// Whether it is the root link.
    pub(in crate::robot) is_root: bool,
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
    let mut assembly = Assembly::new(&structure)?;
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
            is_root: k == structure.root,
            frame: place.frame,
            body: links::body_of(*element)?,
            shapes: shapes_of(*element)?,
        })
    };
    structure.links.iter().enumerate().map(link).collect()
}
