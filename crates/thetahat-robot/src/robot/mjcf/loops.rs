//! `<connect>` and `<weld>` between bodies of different links, and tendons of a constant length: conditions that close loops.

use super::{
    actuators::Actuators,
    assembly::Assembly,
    classes::Properties,
    element::{Attribute, Element},
    error::MjcfError,
    world::World,
};
use crate::robot::{Joint, Loop, LoopFrame, LoopKind, MOST_JOINTS, Robot, body::Frame};
use thetahat_ground::vector::{norm, quaternion_rotation, sub};

/// An equality that closes a loop.
pub(super) struct ClosedBodies<'a> {
    element: Element<'a>,
    of_loop: Loop,
}

/// A body, none for the world.
type Body = Option<usize>;

/// A frame of a body.
type OnBody = (Body, Frame);

/// The loop that an equality closes; none if it joins bodies of one link.
///
/// # Errors
/// [`MjcfError`] for bodies and sites that the model does not have.
pub(super) fn closed_bodies<'a>(
    equality: &Properties<'a>,
    world: &World<'a>,
    assembly: &Assembly<'a>,
    positions: &[f64],
) -> Result<Option<ClosedBodies<'a>>, MjcfError> {
    let element = equality.element();
    let kind = if element.tag() == "weld" { LoopKind::Pose } else { LoopKind::Point };
    let ends = match (element.text_of("site1"), element.text_of("site2")) {
        (Some(first), Some(second)) => [site(element, first, world)?, site(element, second, world)?],
        (None | Some(_), None | Some(_)) => {
            let why = "it closes a loop; give body1, body2 and the anchor, or site1 and site2";
            let first = body(element, "body1", world)?.ok_or_else(|| element.unsupported(why))?;
            let bodies = [first, body(element, "body2", world)?.unwrap_or(None)];
            if carrier(bodies[0], assembly) == carrier(bodies[1], assembly) {
                return Ok(None);
            }
            frames_of_bodies(equality, bodies, world)?
        }
    };
    Ok(joined(element, kind, ends, assembly, positions))
}

/// The loop that joins frames of two bodies; none if they are of one link.
fn joined<'a>(
    element: Element<'a>,
    kind: LoopKind,
    ends: [OnBody; 2],
    assembly: &Assembly<'a>,
    positions: &[f64],
) -> Option<ClosedBodies<'a>> {
    let [from, to] = ends.map(|(body, frame)| {
        let frame = body.map_or(frame, |body| assembly.places[body].in_link(&frame));
        LoopFrame { joint: carrier(body, assembly), rotation: frame.rotation, origin: frame.origin }
    });
    let near = positions.iter().copied().enumerate().collect();
    let of_loop = Loop { name: element.name(), kind, from, to, near };
    (from.joint != to.joint).then_some(ClosedBodies { element, of_loop })
}

/// The joint that carries a body.
fn carrier(body: Body, assembly: &Assembly<'_>) -> Option<usize> {
    body.and_then(|body| assembly.places[body].carrier)
}

/// The loop of a tendon between two sites whose length is constant, as a rod without mass; none if they are of one link.
///
/// # Errors
/// [`MjcfError`] for other tendons, unknown sites, and a length that is not above zero.
pub(super) fn rod<'a>(
    equality: &Properties<'a>,
    tendon: Element<'a>,
    world: &World<'a>,
    assembly: &Assembly<'a>,
    positions: &[f64],
) -> Result<Option<ClosedBodies<'a>>, MjcfError> {
    let element = equality.element();
    let parts: Vec<Element<'a>> = tendon.elements().collect();
    let sites: Vec<&str> = parts.iter().filter_map(|part| part.text_of("site")).collect();
    let (None, [first, second], 2) = (element.attribute("tendon2"), &sites[..], parts.len()) else {
        return Err(element.unsupported(
            "a spatial tendon keeps its length only as a rod between two sites; give the equality active=\"false\"",
        ));
    };
    let ends = [site(element, first, world)?, site(element, second, world)?];
    let [from, to] = ends.map(|(body, frame)| in_world(body, world).then(&frame).origin);
    let [longer, ..] = equality.leading("polycoef", [0.0, 1.0, 0.0, 0.0, 0.0])?;
    let length = norm(sub(to, from)) + longer;
    if length <= 0.0 {
        return Err(element.unsupported("its tendon has no length; place its two sites apart"));
    }
    Ok(joined(element, LoopKind::Distance { length }, ends, assembly, positions))
}

/// The frames that an equality of bodies joins, in the pose of the model.
fn frames_of_bodies(
    equality: &Properties<'_>,
    [first, second]: [Body; 2],
    world: &World<'_>,
) -> Result<[OnBody; 2], MjcfError> {
    let between = in_world(second, world).inverse().then(&in_world(first, world));
    if equality.element().tag() == "weld" {
        let second_in_first = stated_pose(equality)?.unwrap_or_else(|| between.inverse());
        return Ok([(first, second_in_first), (second, Frame::SAME)]);
    }
    let missing = || equality.element().missing("anchor", "give the point in body1");
    let anchor = equality.attribute("anchor").ok_or_else(missing)?;
    let on_first = Frame { origin: anchor.numbers()?, ..Frame::SAME };
    Ok([(first, on_first), (second, between.then(&on_first))])
}

/// The body and frame of a site.
fn site(element: Element<'_>, name: &str, world: &World<'_>) -> Result<OnBody, MjcfError> {
    world.site(name).ok_or_else(|| element.unknown("site", name))
}

/// Positions of the joints near which loops are closed: those of the first `<key>` where an equality joins sites or has a tendon,
/// otherwise those of the pose of the model, in which bodies are joined.
pub(super) fn closed_positions(root: Element<'_>, assembly: &Assembly<'_>) -> Vec<f64> {
    let of_model = || assembly.moving.iter().map(|moving| moving.reference).collect::<Vec<f64>>();
    let sections = root.named("equality").flat_map(|section| section.elements());
    let has_sites = |element: Element<'_>| element.text_of("site1").is_some() || element.tag() == "tendon";
    let by_sites = sections.into_iter().any(has_sites);
    let key = root.named("keyframe").flat_map(|keyframe| keyframe.named("key")).next();
    let Some(stated) = key.and_then(|key| key.attribute("qpos")).filter(|_| by_sites) else { return of_model() };
    let mut positions = vec![0.0; assembly.joints.len()];
    // Another number of positions, as of a model with a free joint, is not that of these joints.
    let is_whole = stated.overlay(&mut positions).is_ok_and(|count| count == assembly.joints.len());
    if is_whole { positions } else { of_model() }
}

/// A body that an attribute names; none without the attribute.
fn body(element: Element<'_>, key: &'static str, world: &World<'_>) -> Result<Option<Body>, MjcfError> {
    match element.text_of(key) {
        None => Ok(None),
        Some("world") => Ok(Some(None)),
        Some(name) => world.body(name).map(|body| Some(Some(body))).ok_or_else(|| element.unknown("body", name)),
    }
}

/// The frame of a body in that of the world, in the pose of the model.
fn in_world(body: Body, world: &World<'_>) -> Frame {
    let chain = std::iter::successors(body, |&body| world.bodies[body].parent);
    chain.fold(Frame::SAME, |frame, body| world.bodies[body].frame.then(&frame))
}

/// The pose of the second body in the first; none if the pose of the model is meant.
fn stated_pose(equality: &Properties<'_>) -> Result<Option<Frame>, MjcfError> {
    let Some([x, y, z, quaternion @ ..]) = equality.attribute("relpose").map(Attribute::numbers::<7>).transpose()?
    else {
        return Ok(None);
    };
    let length = quaternion.iter().map(|v| v * v).sum::<f64>().sqrt();
    let rotation = || quaternion_rotation(quaternion.map(|v| v / length));
    Ok((length > 0.0).then(|| Frame { rotation: rotation(), origin: [x, y, z] }))
}

/// Closes the loops of a model: the joints on them that no actuator drives are passive.
pub(super) fn close(
    robot: &mut Robot,
    closed: &[ClosedBodies<'_>],
    (actuators, held): (&Actuators<'_>, &[Option<f64>]),
) -> Result<(), MjcfError> {
    let Some(first) = closed.first() else { return Ok(()) };
    if closed.len() > MOST_JOINTS {
        let path = first.element.path().to_owned();
        return Err(MjcfError::TooLarge { path, what: "equalities that close loops", limit: MOST_JOINTS });
    }
    if actuators.drives.is_empty() {
        return Err(first.element.unsupported(
            "it closes a loop, and without actuators it is not known which joints move passively; add actuators of the driven \
             joints, or give it active=\"false\" and write [[loop]] with `passive` into a TOML on this model",
        ));
    }
    let is_free =
        |j: usize| robot.joints[j].has_coordinate() && held[j].is_none() && actuators.of_joint(j).next().is_none();
    let on_loops = closed.iter().flat_map(|closed| on_loop(&robot.joints, &closed.of_loop));
    let mut passive: Vec<usize> = on_loops.filter(|&j| is_free(j)).collect();
    passive.sort_unstable();
    passive.dedup();
    if passive.is_empty() {
        return Err(first.element.unsupported(
            "it closes a loop on which every joint has an actuator, and more of them than can move independently are not supported; \
             remove the actuators of passive joints, or give it active=\"false\" to read the open tree",
        ));
    }
    let loops = closed.iter().map(|closed| closed.of_loop.clone()).collect();
    let why = "an actuator of a joint that the loop moves turns with another joint as well";
    robot.close(loops, &passive).ok_or_else(|| first.element.unsupported(why))
}

/// The joints that move one end of a loop and not the other.
fn on_loop(joints: &[Joint], of_loop: &Loop) -> Vec<usize> {
    let chain = |end: &LoopFrame| std::iter::successors(end.joint, |&j| joints[j].parent).collect::<Vec<_>>();
    let (from, to) = (chain(&of_loop.from), chain(&of_loop.to));
    let moves_one = |j: &usize| from.contains(j) != to.contains(j);
    from.iter().chain(&to).copied().filter(moves_one).collect()
}
