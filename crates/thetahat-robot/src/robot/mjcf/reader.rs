use std::{collections::BTreeMap, path::Path};

use super::{
    actuators::Actuators,
    assembly::Assembly,
    classes::Classes,
    compiler::Settings,
    element::{Attribute, Element, Source},
    equality::Equalities,
    error::MjcfError,
    joined::Origins,
    loops::{self, ClosedBodies},
    notes::Noted,
    terms::{add_terms, damping},
    world::World,
};
use crate::robot::{
    Friction, INERTIAL, Robot, RobotError, Transmission,
    body::RigidBody,
    floating::{BASE_JOINTS, Base},
    locking::merged,
    parse_xml,
    urdf::Transmissions,
};

/// MuJoCo's gravity if a model states none, m/s^2.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
/// The name of a model without one.
const UNNAMED: &str = "robot";
/// Root elements of models, and of parts that models include.
const ROOTS: [&str; 2] = ["mujoco", "mujocoinclude"];

/// Whether a text is XML whose root element is that of an MJCF.
pub(in crate::robot) fn is_mjcf(text: &str) -> bool {
    root_tag(text).is_some_and(|tag| ROOTS.contains(&tag))
}

/// The name of the first element, after declarations and comments.
fn root_tag(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}');
    loop {
        rest = rest.trim_start().strip_prefix('<')?;
        let end = if rest.starts_with("!--") {
            "-->"
        } else if rest.starts_with(['?', '!']) {
            ">"
        } else {
            break;
        };
        rest = &rest[rest.find(end)? + end.len()..];
    }
    rest.split(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).next()
}

/// The robot of an MJCF; `path` is its name in messages, and `origins` are the files that the text was joined from.
///
/// # Errors
/// [`MjcfError`] with file, line and element.
pub(in crate::robot) fn read(
    text: &str,
    path: &Path,
    origins: &Origins,
    transmissions: Transmissions,
    base: Base,
) -> Result<Robot, RobotError> {
    let text = text.trim_start_matches('\u{feff}');
    let document = parse_xml(text, path).map_err(MjcfError::from)?;
    let source = Source { path, text, origins };
    let root = Element::root(&document, &source);
    if root.tag() != "mujoco" {
        return Err(MjcfError::Part { place: root.place() }.into());
    }
    if let Some(include) = root.descendants().find(|element| element.tag() == "include") {
        let why = "a text within another file includes nothing; give the file of the model";
        return Err(include.unsupported(why).into());
    }
    let mut model = ParsedModel::read(root, base)?;
    if model.held.iter().all(Option::is_some) {
        return Err(MjcfError::NoMovingJoint { path: path.to_owned() }.into());
    }
    let mut robot = model.robot(root, path, transmissions)?;
    add_terms(&mut robot, &model.assembly, &model.actuators)?;
    if base == Base::Floating {
        robot = floated(robot, &model.assembly.root_body, path)?;
        model.held.splice(0..0, [None; BASE_JOINTS]);
    }
    merged(&robot, &model.held).map_err(|source| RobotError::lock(path, source))
}

/// The robot on a base that floats, with its terms on the joints of the same names.
fn floated(mut robot: Robot, root: &RigidBody, path: &Path) -> Result<Robot, RobotError> {
    robot.terms.clear();
    let terms = std::mem::take(&mut robot.term_descriptions);
    let mut floated = robot.on_floating_base(root);
    floated.add_terms(&terms).map_err(|source| RobotError::Term { path: path.to_owned(), source: Box::new(source) })?;
    Ok(floated)
}

/// The parts of a model.
struct ParsedModel<'a> {
    classes: Classes<'a>,
    world: World<'a>,
    assembly: Assembly<'a>,
    actuators: Actuators<'a>,
    /// The coordinate at which each joint is held.
    held: Vec<Option<f64>>,
    loops: Vec<ClosedBodies<'a>>,
}

impl<'a> ParsedModel<'a> {
    fn read(root: Element<'a>, base: Base) -> Result<Self, MjcfError> {
        let (settings, classes) = (Settings::read(root)?, Classes::read(root)?);
        let world = World::read(root, &settings, &classes)?;
        let mut assembly = Assembly::of(&world, &settings, &classes, base)?;
        refuse_makers(&world, &assembly)?;
        let Equalities { mimics, held, loops } = Equalities::read(root, &classes, &world, &assembly)?;
        let actuators = Actuators::read(root, &settings, &classes, &assembly.joints, &world)?;
        assembly.joints.iter_mut().zip(mimics).for_each(|(joint, mimic)| joint.mimic = mimic);
        limit_efforts(&mut assembly, &actuators);
        Ok(Self { classes, world, assembly, actuators, held, loops })
    }

    /// The robot without terms, in which held joints move.
    fn robot(&self, root: Element<'a>, path: &Path, transmissions: Transmissions) -> Result<Robot, MjcfError> {
        let Self { classes, world, assembly, actuators, .. } = self;
        let mut robot = Robot {
            name: name_of(root, path),
            gravity: gravity(root)?,
            joints: assembly.joints.clone(),
            transmission: match transmissions {
                Transmissions::Read => actuators.transmission(&assembly.joints),
                Transmissions::Ignored => direct(assembly),
            },
            friction: Friction::Symmetric,
            a_priori: a_priori(assembly, actuators),
            loops: Vec::new(),
            locked: Vec::new(),
            doubts: Noted { root, classes, world, assembly, actuators }.doubts()?,
            term_descriptions: Vec::new(),
            terms: Vec::new(),
        };
        loops::close(&mut robot, &self.loops, (actuators, &self.held))?;
        Ok(robot)
    }
}

/// Refuses elements that make bodies, unless they cannot move.
fn refuse_makers(world: &World<'_>, assembly: &Assembly<'_>) -> Result<(), MjcfError> {
    for (element, owner) in &world.makers {
        let moves = owner.is_some_and(|owner| assembly.places[owner].carrier.is_some());
        let has_joint = element.descendants().any(|inner| matches!(inner.tag(), "joint" | "freejoint"));
        if moves || has_joint || element.tag() == "attach" {
            let why = "the bodies that it makes are not followed; write them out, as MuJoCo's `mj_saveLastXML` does";
            return Err(element.unsupported(why));
        }
    }
    Ok(())
}

/// The smaller one of the limits that a joint and its actuator state.
fn limit_efforts(assembly: &mut Assembly<'_>, actuators: &Actuators<'_>) {
    for (j, joint) in assembly.joints.iter_mut().enumerate() {
        let efforts = joint.limits.effort.into_iter().chain(actuators.effort(j));
        joint.limits.effort = efforts.reduce(f64::min);
    }
}

fn direct(assembly: &Assembly<'_>) -> Transmission {
    Transmission::direct(assembly.joints.iter().filter(|joint| joint.mimic.is_none()).count())
}

fn name_of(root: Element<'_>, path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let own = root.text_of("model").filter(|name| !name.is_empty()).map(str::to_owned);
    own.or(stem).unwrap_or_else(|| UNNAMED.to_owned())
}

fn gravity(root: Element<'_>) -> Result<[f64; 3], MjcfError> {
    let mut gravity = GRAVITY;
    for option in root.named("option") {
        gravity = option.attribute("gravity").map_or(Ok(gravity), Attribute::numbers)?;
    }
    let mut flags = root.named("option").flat_map(|option| option.named("flag"));
    let off = flags.any(|flag| flag.text_of("gravity") == Some("disable"));
    Ok(if off { [0.0; 3] } else { gravity })
}

/// The inertial parameters, motor inertias and friction that differ from zero.
fn a_priori(assembly: &Assembly<'_>, actuators: &Actuators<'_>) -> BTreeMap<String, f64> {
    let mut values = BTreeMap::new();
    for (k, (link, moving)) in assembly.links.iter().zip(&assembly.moving).enumerate() {
        let inertial = INERTIAL.iter().map(|quantity| quantity.name()).zip(link.parameters());
        let [viscous, ..] = damping(assembly, actuators, k);
        let armature = moving.armature + actuators.armature(k);
        let drive = [("ia", armature), ("fv", viscous), ("fc", moving.friction)];
        let given = inertial.chain(drive).filter(|(_, value)| *value != 0.0);
        values.extend(given.map(|(name, value)| (format!("{name}{}", k + 1), value)));
    }
    values
}
