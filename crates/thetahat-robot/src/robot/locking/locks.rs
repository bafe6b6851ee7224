use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use super::error::LockError;
use crate::robot::{Joint, JointKind, Limits, RobotError};
use thetahat_ground::one_or_each;

/// Largest angle of a locked joint, rad: more than two turns are probably degrees.
const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;
/// Largest travel of a locked joint, m: more is probably millimetres.
const LARGEST_TRAVEL: f64 = 100.0;
/// Fraction of its range by which a locked joint may exceed its limits: zeros and stops differ by as much.
const BEYOND_LIMITS: f64 = 0.05;

/// The joints of a robot that do not move.
///
/// `until` keeps the joints from the base to those named, and their followers; all others are locked, at the value in `locked`
/// or otherwise at their neutral one: 0, or the middle of their limits if 0 is outside.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Locks {
    /// Coordinates of locked joints by name, rad or m.
    pub locked: BTreeMap<String, f64>,
    /// The last joints that move; none means that all joints move except those in `locked`.
    #[serde(deserialize_with = "one_or_each::list")]
    pub until: Vec<String>,
}

/// A joint that was locked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LockedJoint {
    /// Its name.
    pub name: String,
    /// How it would move if unlocked.
    pub kind: JointKind,
    /// Its coordinate, rad or m.
    pub value: f64,
}

/// Locks and the file that states them.
#[derive(Clone, Copy)]
pub(in crate::robot) struct LocksOf<'a> {
    pub(in crate::robot) path: &'a Path,
    pub(in crate::robot) locks: &'a Locks,
}

/// The value of each joint that any of the locks fixes; the last lock of a joint determines its value.
pub(in crate::robot) fn resolve_all(joints: &[Joint], stated: &[LocksOf<'_>]) -> Result<Vec<Option<f64>>, RobotError> {
    let mut values = vec![None; joints.len()];
    for LocksOf { path, locks } in stated {
        let found = locks.resolve(joints).map_err(|source| RobotError::lock(path, source))?;
        values.iter_mut().zip(found).for_each(|(value, found)| *value = found.or(*value));
        refuse_standstill(&values).map_err(|source| RobotError::lock(path, source))?;
    }
    Ok(values)
}

impl Locks {
    /// The locks of these joints of a robot: other locked joints follow them, or are locked by the robot's own description.
    #[must_use]
    pub fn restating(locked: &[LockedJoint], joints: &[Joint]) -> Self {
        let is_free = |name: &str| joints.iter().any(|j| j.name == name && j.mimic.is_none());
        let locked = locked.iter().filter(|l| is_free(&l.name)).map(|l| (l.name.clone(), l.value)).collect();
        Self { locked, until: Vec::new() }
    }

    /// Whether nothing is locked.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.locked.is_empty() && self.until.is_empty()
    }

    /// The coordinate of each locked joint, followers of locked joints included; none for moving joints.
    ///
    /// # Errors
    /// [`LockError`] for unknown names, and impossible values.
    pub(in crate::robot) fn resolve(&self, joints: &[Joint]) -> Result<Vec<Option<f64>>, LockError> {
        let mut values = self.beyond(joints)?;
        for (name, &value) in &self.locked {
            let place = index_of(joints, "locked", name)?;
            let joint = &joints[place];
            if let Some(mimic) = joint.mimic {
                let leader = joints[mimic.of].name.clone();
                return Err(LockError::Follower { joint: name.clone(), leader });
            }
            check_value(joint, value)?;
            values[place] = Some(value);
        }
        for (j, joint) in joints.iter().enumerate() {
            if let Some(mimic) = joint.mimic {
                let shares: Option<Vec<f64>> =
                    joint.follows().map(|share| values[share.of].map(|leader| share.ratio * leader)).collect();
                values[j] = shares.map(|shares| shares.iter().sum::<f64>() + mimic.offset);
            }
        }
        refuse_standstill(&values).map(|()| values)
    }

    /// The neutral values of the joints that `until` excludes.
    fn beyond(&self, joints: &[Joint]) -> Result<Vec<Option<f64>>, LockError> {
        let mut moves = vec![self.until.is_empty(); joints.len()];
        for name in &self.until {
            let mut next = Some(index_of(joints, "until", name)?);
            while let Some(j) = next {
                moves[j] = true;
                joints[j].follows().for_each(|share| moves[share.of] = true);
                next = joints[j].parent;
            }
        }
        Ok(joints.iter().zip(moves).map(|(joint, moves)| (!moves).then(|| joint.limits.neutral())).collect())
    }
}

impl Limits {
    /// The default coordinate of a joint: 0, or the middle of the limits if 0 is outside.
    #[must_use]
    pub fn neutral(&self) -> f64 {
        match self.lower.zip(self.upper) {
            Some((lower, upper)) if lower <= upper && !(lower..=upper).contains(&0.0) => 0.5 * (lower + upper),
            _ => 0.0,
        }
    }
}

fn refuse_standstill(values: &[Option<f64>]) -> Result<(), LockError> {
    if values.iter().all(Option::is_some) { Err(LockError::NothingMoves) } else { Ok(()) }
}

fn index_of(joints: &[Joint], key: &'static str, name: &str) -> Result<usize, LockError> {
    joints.iter().position(|joint| joint.name == name).ok_or_else(|| LockError::UnknownJoint {
        key,
        name: name.to_owned(),
        known: joints.iter().map(|joint| joint.name.clone()).collect(),
    })
}

fn check_value(joint: &Joint, value: f64) -> Result<(), LockError> {
    let (unit, largest, remedy) = match joint.kind {
        JointKind::Revolute => ("rad", LARGEST_ANGLE, "rad, not degrees"),
        JointKind::Prismatic => ("m", LARGEST_TRAVEL, "m, not mm"),
    };
    let refuse = |expected: String| LockError::Value { joint: joint.name.clone(), value, unit, expected };
    if !value.is_finite() || value.abs() > largest {
        return Err(refuse(format!("expected a finite number up to {largest:.4}; give {remedy}")));
    }
    let Some((lower, upper)) = joint.limits.lower.zip(joint.limits.upper).filter(|(a, b)| a < b) else { return Ok(()) };
    let margin = BEYOND_LIMITS * (upper - lower);
    if (lower - margin..=upper + margin).contains(&value) {
        return Ok(());
    }
    Err(refuse(format!("its limits are {lower} to {upper} {unit}; give {remedy}, or put the limits right")))
}
