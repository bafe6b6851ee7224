//! The new positions of joints, motors and links after some joints are locked.

use crate::robot::{Joint, JointKind, Placement, Quantity, Robot, body::Frame};
use thetahat_ground::vector::{IDENTITY, transpose};

/// The index of each joint among the remaining ones.
pub(super) fn new_indices(locked: &[Option<f64>]) -> Vec<Option<usize>> {
    let mut next = 0..;
    locked.iter().map(|value| if value.is_none() { next.next() } else { None }).collect()
}

/// The moving joint that carries a joint's link, none for the base, and the link's joint frame in the carrier's.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) carrier: Option<usize>,
    frame: Frame,
}

pub(super) fn places(joints: &[Joint], locked: &[Option<f64>]) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::with_capacity(joints.len());
    for (j, joint) in joints.iter().enumerate() {
        places.push(match locked[j] {
            None => Place { carrier: Some(j), frame: Frame::SAME },
            Some(value) => {
                let before = joint.parent.map_or(Place { carrier: None, frame: Frame::SAME }, |p| places[p]);
                let frame = before.frame.then(&frame_of(&joint.placement)).then(&motion(joint.kind, value));
                Place { frame, ..before }
            }
        });
    }
    places
}

/// The moving joint that carries a remaining joint, and the joint's frame there; unchanged placements keep their bits.
pub(super) fn placement(joint: &Joint, places: &[Place], locked: &[Option<f64>]) -> (Option<usize>, Placement) {
    match joint.parent {
        Some(parent) if locked[parent].is_some() => {
            let Place { carrier, frame } = places[parent];
            let Frame { rotation, origin } = frame.then(&frame_of(&joint.placement));
            (carrier, Placement::new(&rotation, origin))
        }
        parent => (parent, joint.placement),
    }
}

fn frame_of(placement: &Placement) -> Frame {
    Frame { rotation: placement.rotation(), origin: placement.origin }
}

fn motion(kind: JointKind, value: f64) -> Frame {
    match kind {
        JointKind::Prismatic => Frame { rotation: IDENTITY, origin: [0.0, 0.0, value] },
        JointKind::Revolute => {
            let (s, c) = value.sin_cos();
            Frame { rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] }
        }
    }
}

/// The new numbers of the joints and motors of the whole robot.
pub(super) struct Renumbering {
    pub(super) joints: Vec<Option<usize>>,
    /// The remaining motors.
    pub(super) motors: Vec<usize>,
    pub(super) places: Vec<Place>,
}

impl Renumbering {
    /// The new number, from one, of a quantity of joint or motor `number`; none if it is removed.
    pub(super) fn number(&self, whole: &Robot, rest: &Robot, quantity: Quantity, number: usize) -> Option<usize> {
        match quantity {
            Quantity::Term(_) => None,
            Quantity::Link(_) | Quantity::Joint(_) => self.joints[number - 1].map(|j| j + 1),
            Quantity::Motor(_) => {
                let motor = whole.coordinate_joints().iter().position(|&j| j + 1 == number)?;
                Some(rest.joint_of(self.motors.iter().position(|&m| m == motor)?) + 1)
            }
        }
    }
}

/// The frame of a link's axes in those of the link that carries it, or of the base.
pub(super) fn frame_in_carrier(whole: &Robot, joint: usize, place: &Place) -> Frame {
    let axes = |joint: usize| whole.joints[joint].link_axes.unwrap_or(IDENTITY);
    let of_carrier = place.carrier.map_or(IDENTITY, axes);
    let into_carrier = Frame { rotation: transpose(&of_carrier), origin: [0.0; 3] };
    let from_link = Frame { rotation: axes(joint), origin: [0.0; 3] };
    into_carrier.then(&place.frame).then(&from_link)
}
