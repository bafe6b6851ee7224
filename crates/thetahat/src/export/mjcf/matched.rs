//! The identified robot found in an MJCF: which body is which link, and where its frame is.

use std::path::Path;

use super::{
    element::Element,
    error::MjcfError,
    tree::{JointElement, Tree, WORLD},
};
use thetahat_ground::vector::{IDENTITY, Vec3, cross, norm, sub, times, transpose, with_z};
use thetahat_model::robot::{Frame, JointKind, Robot};

/// Angle in rad and distance in m within which the axes of the model are those of the robot.
const SAME: f64 = 1e-4;

/// A robot in an MJCF.
#[derive(Debug)]
pub(super) struct Matched<'a> {
    pub(super) tree: Tree<'a>,
    /// Of each joint of the robot, its place among those of the model.
    pub(super) joints: Vec<usize>,
    /// The link with which each body moves.
    pub(super) carriers: Vec<Option<usize>>,
    /// Each body in the world, with the joints of the robot at zero, locked ones where they are locked, and all others in the
    /// reference configuration.
    places: Vec<Frame>,
    /// Axis of each joint of the model in the world there: direction, and a point.
    axes: Vec<[Vec3; 2]>,
    /// The body that is the robot's base.
    pub(super) base: usize,
    /// The largest difference between the axes of the model and of the robot, rad and m.
    pub(super) difference: f64,
}

/// How far the axes of the model are from those of the robot on a base.
struct Distance {
    joint: usize,
    angle: f64,
    length: f64,
}

impl<'a> Matched<'a> {
    /// `root` is the `<mujoco>`, whose content is `tree`.
    pub(super) fn new(root: Element<'a>, tree: Tree<'a>, robot: &Robot, path: &Path) -> Result<Self, MjcfError> {
        let joints = joints(root, &tree, robot, path)?;
        let carriers = carriers(&tree, &joints, robot)?;
        let (places, axes) = places(&tree, &joints, robot);
        let mut matched = Self { tree, joints, carriers, places, axes, base: WORLD, difference: 0.0 };
        matched.require_same_tree(robot)?;
        matched.find_base(robot)?;
        Ok(matched)
    }

    /// The body of link `k`.
    pub(super) fn body(&self, k: usize) -> usize {
        self.tree.joints[self.joints[k]].body
    }

    /// The frame of link `k`, to which its inertial parameters refer, in the frame of its body.
    pub(super) fn link_in_body(&self, robot: &Robot, k: usize) -> Frame {
        let axes = robot.joints[k].link_axes.unwrap_or(IDENTITY);
        let link = places_of(robot)[k].then(&Frame { rotation: axes, origin: [0.0; 3] });
        self.places[self.body(k)].inverse().then(&self.places[self.base]).then(&link)
    }

    /// The bodies that move with the body of link `k`, with their frames in its frame.
    pub(super) fn moving_with(&self, k: usize) -> impl Iterator<Item = (usize, Frame)> {
        let body = self.body(k);
        let with = move |b: &usize| *b != body && self.carriers[*b] == Some(k);
        let placed = move |b: usize| (b, self.places[body].inverse().then(&self.places[b]));
        (0..self.tree.bodies.len()).filter(with).map(placed)
    }

    /// The frame of joint `k` as the model has it, z along the axis, in the frame of its body.
    pub(super) fn joint_in_body(&self, k: usize) -> Frame {
        self.places[self.body(k)].inverse().then(&self.joint_place(k))
    }

    /// The same in the frame of the joint before it, or of the base.
    pub(super) fn joint_in_parent(&self, robot: &Robot, k: usize) -> Frame {
        let before = robot.joints[k].parent.map_or(self.places[self.base], |parent| self.joint_place(parent));
        before.inverse().then(&self.joint_place(k))
    }

    fn joint_place(&self, k: usize) -> Frame {
        let [axis, origin] = self.axes[self.joints[k]];
        Frame { rotation: with_z(axis), origin }
    }

    /// A direction of the world in the robot's base.
    pub(super) fn in_base(&self, direction: Vec3) -> Vec3 {
        times(&transpose(&self.places[self.base].rotation), direction)
    }

    fn require_same_tree(&self, robot: &Robot) -> Result<(), MjcfError> {
        let name = |link: Option<usize>| match link {
            Some(k) => format!("the link of joint `{}`", robot.joints[k].name),
            None => "the base".to_owned(),
        };
        for (k, joint) in robot.joints.iter().enumerate() {
            let found = self.carriers[self.tree.bodies[self.body(k)].parent];
            if found != joint.parent {
                let place = self.tree.joints[self.joints[k]].element.place();
                return Err(MjcfError::OtherParent { place, found: name(found), expected: name(joint.parent) });
            }
        }
        Ok(())
    }

    /// The base is the first body around the first joint, from inside to the world, on which all axes are the robot's.
    fn find_base(&mut self, robot: &Robot) -> Result<(), MjcfError> {
        let first = robot.joints.iter().position(|joint| joint.parent.is_none()).unwrap_or(0);
        let mut base = self.tree.bodies[self.body(first)].parent;
        let mut nearest: Option<(usize, Distance)> = None;
        loop {
            let distance = self.distance(robot, base);
            if distance.angle.max(distance.length) <= SAME {
                (self.base, self.difference) = (base, distance.angle.max(distance.length));
                return Ok(());
            }
            // The more joints fit before the first that does not, the nearer.
            if nearest.as_ref().is_none_or(|(_, known)| distance.joint > known.joint) {
                nearest = Some((base, distance));
            }
            if base == WORLD {
                break;
            }
            base = self.tree.bodies[base].parent;
        }
        let Some((base, Distance { joint, angle, length })) = nearest else { return Ok(()) };
        Err(MjcfError::OtherAxis {
            place: self.tree.joints[self.joints[joint]].element.place(),
            base: self.tree.name(base),
            angle,
            distance: length,
        })
    }

    /// That of the first joint that is elsewhere, or else the largest.
    fn distance(&self, robot: &Robot, base: usize) -> Distance {
        let mut largest = Distance { joint: 0, angle: 0.0, length: 0.0 };
        for (joint, place) in places_of(robot).iter().enumerate() {
            let expected = self.places[base].then(place);
            let [axis, point] = self.axes[self.joints[joint]];
            let z = transpose(&expected.rotation)[2];
            let length = match robot.joints[joint].kind {
                JointKind::Revolute => norm(cross(z, sub(point, expected.origin))),
                JointKind::Prismatic => 0.0,
            };
            let angle = norm(sub(axis, z));
            if angle.max(length) > SAME {
                return Distance { joint, angle, length };
            }
            largest = Distance { joint, angle: largest.angle.max(angle), length: largest.length.max(length) };
        }
        largest
    }
}

/// The frames of the robot's joints in its base, joints at zero.
fn places_of(robot: &Robot) -> Vec<Frame> {
    let mut places: Vec<Frame> = Vec::with_capacity(robot.joints.len());
    for joint in &robot.joints {
        let own = Frame { rotation: joint.placement.rotation(), origin: joint.placement.origin };
        places.push(joint.parent.map_or(own, |parent| places[parent].then(&own)));
    }
    places
}

/// The joints of the robot among those of the model.
fn joints(root: Element<'_>, tree: &Tree<'_>, robot: &Robot, path: &Path) -> Result<Vec<usize>, MjcfError> {
    let of = |name: &str| -> Result<usize, MjcfError> {
        let mut found = (0..tree.joints.len()).filter(|&j| tree.joints[j].name == name);
        match (found.next(), found.next()) {
            (Some(_), Some(second)) => Err(MjcfError::SameName { place: tree.joints[second].element.place() }),
            (Some(joint), None) => Ok(joint),
            (None, _) => Err(no_joint(root, tree, name, path)),
        }
    };
    let mut places = Vec::with_capacity(robot.joints.len());
    for joint in &robot.joints {
        let place = of(&joint.name)?;
        require_kind(&tree.joints[place], joint.kind)?;
        places.push(place);
    }
    Ok(places)
}

fn no_joint(root: Element<'_>, tree: &Tree<'_>, name: &str, path: &Path) -> MjcfError {
    let in_default = root.named("default").flat_map(Element::descendants).any(|e| e.attribute("name") == Some(name));
    MjcfError::NoJoint {
        path: path.to_owned(),
        joint: name.to_owned(),
        in_default,
        found: tree.joints.iter().map(|joint| joint.element.name()).collect(),
    }
}

fn require_kind(joint: &JointElement<'_>, kind: JointKind) -> Result<(), MjcfError> {
    let (expected, meant) = match kind {
        JointKind::Revolute => ("hinge", "revolute (hinge)"),
        JointKind::Prismatic => ("slide", "prismatic (slide)"),
    };
    if joint.kind == expected {
        return Ok(());
    }
    let found = thetahat_ground::visible::visible(joint.kind).into_owned();
    Err(MjcfError::OtherKind { place: joint.element.place(), found, expected: meant })
}

/// The link with which each body moves.
fn carriers(tree: &Tree<'_>, joints: &[usize], robot: &Robot) -> Result<Vec<Option<usize>>, MjcfError> {
    let mut carriers: Vec<Option<usize>> = Vec::with_capacity(tree.bodies.len());
    for (b, body) in tree.bodies.iter().enumerate() {
        let own: Vec<usize> = (0..joints.len()).filter(|&k| tree.joints[joints[k]].body == b).collect();
        if own.len() > 1 {
            let names = own.iter().map(|&k| robot.joints[k].name.clone()).collect();
            return Err(MjcfError::SeveralJoints { place: body.element.place(), joints: names });
        }
        let around = if b == WORLD { None } else { carriers[body.parent] };
        carriers.push(own.first().copied().or(around));
    }
    Ok(carriers)
}

/// Where bodies and axes are in the world.
fn places(tree: &Tree<'_>, joints: &[usize], robot: &Robot) -> (Vec<Frame>, Vec<[Vec3; 2]>) {
    let value = |place: usize| {
        let JointElement { name, reference, .. } = &tree.joints[place];
        let locked = robot.locked.iter().find(|locked| locked.name == *name).map(|locked| locked.value);
        if joints.contains(&place) { 0.0 } else { locked.unwrap_or(*reference) }
    };
    let mut places: Vec<Frame> = Vec::with_capacity(tree.bodies.len());
    let mut axes = vec![[[0.0; 3]; 2]; tree.joints.len()];
    for (b, body) in tree.bodies.iter().enumerate() {
        let mut place = if b == WORLD { Frame::SAME } else { places[body.parent].then(&body.frame) };
        for (j, joint) in tree.joints.iter().enumerate().filter(|(_, joint)| joint.body == b) {
            let displaced = joint.displaced(value(j));
            axes[j] = [times(&place.rotation, joint.axis), place.then(&displaced).of_point(joint.place)];
            place = place.then(&displaced);
        }
        places.push(place);
    }
    (places, axes)
}

/// The reference configuration of joints that the robot does not have, in words; `None` if there are no such joints on its links.
pub(super) fn other_joints(matched: &Matched<'_>, robot: &Robot) -> Option<String> {
    let is_other = |(place, joint): &(usize, &JointElement<'_>)| {
        !matched.joints.contains(place)
            && matched.carriers[joint.body].is_some()
            && robot.locked.iter().all(|locked| locked.name != joint.name)
    };
    let others = matched.tree.joints.iter().enumerate().filter(is_other);
    let names: Vec<String> = others.map(|(_, joint)| joint.element.name()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: joints of the model that the identified robot does not have; what they carry counts as fixed, where the model \
             has it at first",
            names.join(", ")
        )
    })
}

/// Whether the gravity of the world differs from that of the robot.
pub(super) fn other_gravity(matched: &Matched<'_>, robot: &Robot, gravity: Vec3) -> bool {
    let difference = sub(matched.in_base(gravity), robot.gravity);
    norm(difference) > 1e-6 * norm(robot.gravity).max(1.0)
}
