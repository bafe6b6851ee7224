use std::collections::BTreeMap;

use super::{
    error::LockError,
    locks::{LockedJoint, Locks},
    places::{Renumbering, frame_in_carrier, new_indices, placement, places},
    terms::{a_priori_of_terms, remaining_terms},
    transmission::{Remaining, remaining},
};
use crate::robot::{Doubt, INERTIAL, Joint, Mimic, Robot, Share, body::RigidBody};

impl Robot {
    /// The robot with these joints fixed at their values: the links of locked joints become part of the links that carry them,
    /// including their inertia. Joints that follow a locked one are locked with it. The remaining joints are renumbered.
    ///
    /// # Errors
    /// [`LockError`] for unknown names, impossible values, and motors that couple locked and moving joints.
    pub fn with_locks(&self, locks: &Locks) -> Result<Self, LockError> {
        merged(self, &locks.resolve(&self.joints)?)
    }
}

/// The joints that a joint follows, by their new numbers.
struct Followed {
    mimic: Option<Mimic>,
    also_follows: Vec<Share>,
}

/// What is left of the sum of joints that a joint follows: the shares of those that are locked are part of the offset.
fn followed(joint: &Joint, numbers: &[Option<usize>], locked: &[Option<f64>]) -> Followed {
    let left = |share: Share| Some(Share { of: numbers[share.of]?, ratio: share.ratio });
    let mut left = joint.follows().filter_map(left);
    let of_locked: f64 = joint.follows().filter_map(|share| Some(share.ratio * locked[share.of]?)).sum();
    let offset = joint.mimic.map_or(0.0, |mimic| mimic.offset) + of_locked;
    let mimic = left.next().map(|first| Mimic { of: first.of, ratio: first.ratio, offset });
    Followed { mimic, also_follows: left.collect() }
}

/// The robot with the joints locked that have a value.
pub(in crate::robot) fn merged(robot: &Robot, locked: &[Option<f64>]) -> Result<Robot, LockError> {
    if locked.iter().all(Option::is_none) {
        return Ok(robot.clone());
    }
    if !robot.loops.is_empty() {
        return Err(LockError::Loops);
    }
    let Remaining { motors, transmission } = remaining(robot, locked)?;
    let numbers = new_indices(locked);
    let places = places(&robot.joints, locked);
    let joint = |(j, joint): (usize, &Joint)| {
        let _moves = numbers[j]?;
        let Followed { mimic, also_follows } = followed(joint, &numbers, locked);
        let (parent, placement) = placement(joint, &places, locked);
        Some(Joint { parent: parent.and_then(|p| numbers[p]), placement, mimic, also_follows, ..joint.clone() })
    };
    let joints = robot.joints.iter().enumerate().filter_map(joint).collect();
    let names = robot.joints.iter().zip(locked).filter_map(|(joint, value)| {
        value.map(|value| LockedJoint { name: joint.name.clone(), kind: joint.kind, value })
    });
    let carried = |doubt: &Doubt| {
        let carrier = doubt.carrier.and_then(|j| places[j].carrier).and_then(|j| numbers[j]);
        doubt.clone().carried_by(carrier)
    };
    let mut merged = Robot {
        joints,
        transmission,
        a_priori: BTreeMap::new(),
        terms: Vec::new(),
        term_descriptions: Vec::new(),
        locked: robot.locked.iter().cloned().chain(names).collect(),
        doubts: robot.doubts.iter().map(carried).collect(),
        ..robot.clone()
    };
    let renumbering = Renumbering { joints: numbers, motors, places };
    merged.a_priori = a_priori(robot, &merged, &renumbering);
    let terms = remaining_terms(robot, &renumbering);
    merged.add_terms(&terms).map_err(|source| LockError::Term { source: Box::new(source) })?;
    let of_terms: Vec<(String, f64)> = a_priori_of_terms(robot, &merged, &renumbering).collect();
    merged.a_priori.extend(of_terms);
    Ok(merged)
}

/// The a-priori values of the remaining joints and motors, with the bodies of locked joints merged into their carriers. The
/// rotors and friction of locked joints are dropped: they do not affect any motion.
fn a_priori(whole: &Robot, rest: &Robot, renumbering: &Renumbering) -> BTreeMap<String, f64> {
    let mut values = BTreeMap::new();
    for parameter in whole.parameter_table().iter() {
        let Some(value) = whole.a_priori.get(&parameter.name()) else { continue };
        if let Some(number) = renumbering.number(whole, rest, parameter.quantity, parameter.number) {
            values.insert(format!("{}{number}", parameter.quantity.name()), *value);
        }
    }
    for j in 0..whole.joints.len() {
        let place = renumbering.places[j];
        let Some(carrier) = place.carrier else { continue };
        let body = body_of(whole, j);
        if carrier == j || body == RigidBody::default() {
            continue;
        }
        let seen = body.seen_in(&frame_in_carrier(whole, j, &place)).parameters();
        let number = renumbering.joints[carrier].map_or(0, |j| j + 1);
        for (quantity, value) in INERTIAL.into_iter().zip(seen).filter(|(_, value)| *value != 0.0) {
            *values.entry(format!("{}{number}", quantity.name())).or_insert(0.0) += value;
        }
    }
    values
}

/// The a-priori body of a link, in the link's axes.
fn body_of(robot: &Robot, joint: usize) -> RigidBody {
    let value = |name: &str| robot.a_priori.get(&format!("{name}{}", joint + 1)).copied().unwrap_or(0.0);
    RigidBody::from_parameters(INERTIAL.map(|quantity| value(quantity.name())))
}
