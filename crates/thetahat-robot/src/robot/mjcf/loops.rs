//! `<connect>` and `<weld>` between bodies of different links: conditions that close loops.

use super::{
    actuators::Actuators,
    assembly::Assembly,
    classes::Properties,
    element::{Attribute, Element},
    error::MjcfError,
    world::World,
};
use crate::robot::{Joint, Loop, LoopFrame, LoopKind, Robot, body::Frame};
use thetahat_ground::vector::quaternion_rotation;

/// An equality that closes a loop.
pub(super) struct ClosedBodies<'a> {
    element: Element<'a>,
    of_loop: Loop,
}

/// A body, none for the world.
type Body = Option<usize>;

/// The loop that an equality closes; none if it joins bodies of one link.
///
/// # Errors
/// [`MjcfError`] for an equality of sites, and bodies that the model does not have.
pub(super) fn closed_bodies<'a>(
    equality: &Properties<'a>,
    world: &World<'a>,
    assembly: &Assembly<'a>,
) -> Result<Option<ClosedBodies<'a>>, MjcfError> {
    let element = equality.element();
    let why = "it closes a loop by its sites; give body1, body2 and the anchor, or active=\"false\" to read the open tree";
    let first = body(element, "body1", world)?.ok_or_else(|| element.unsupported(why))?;
    let second = body(element, "body2", world)?.unwrap_or(None);
    let carrier = |body: Body| body.and_then(|body| assembly.places[body].carrier);
    if carrier(first) == carrier(second) {
        return Ok(None);
    }
    let [in_world_first, in_world_second] = [first, second].map(|body| in_world(body, world));
    let between = in_world_second.inverse().then(&in_world_first);
    let (kind, on_first, on_second) = match element.tag() {
        "weld" => {
            let second_in_first = stated_pose(equality)?.unwrap_or_else(|| between.inverse());
            (LoopKind::Pose, second_in_first, Frame::SAME)
        }
        _ => {
            let anchor = equality.attribute("anchor").ok_or_else(|| element.missing("anchor", "give the point"))?;
            let on_first = Frame { origin: anchor.numbers()?, ..Frame::SAME };
            (LoopKind::Point, on_first, between.then(&on_first))
        }
    };
    let on_link = |body: Body, frame: &Frame| {
        let frame = body.map_or(*frame, |body| assembly.places[body].in_link(frame));
        LoopFrame { joint: carrier(body), rotation: frame.rotation, origin: frame.origin }
    };
    // The model is closed in its own pose.
    let near = assembly.moving.iter().enumerate().map(|(joint, moving)| (joint, moving.reference)).collect();
    let (from, to) = (on_link(first, &on_first), on_link(second, &on_second));
    let of_loop = Loop { name: element.name(), kind, from, to, near };
    Ok(Some(ClosedBodies { element, of_loop }))
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
    let Some([x, y, z, quaternion @ ..]) = equality.attribute("relpose").map(Attribute::numbers::<7>).transpose()? else {
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
    if actuators.drives.is_empty() {
        return Err(first.element.unsupported(
            "it closes a loop, and without actuators it is not known which joints move passively; add actuators of the driven \
             joints, or give it active=\"false\" and write [[loop]] with `passive` into a TOML on this model",
        ));
    }
    let is_free = |j: usize| robot.joints[j].has_coordinate() && held[j].is_none() && actuators.of_joint(j).next().is_none();
    let on_loops = closed.iter().flat_map(|closed| on_loop(&robot.joints, &closed.of_loop));
    let mut passive: Vec<usize> = on_loops.filter(|&j| is_free(j)).collect();
    passive.sort_unstable();
    passive.dedup();
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
