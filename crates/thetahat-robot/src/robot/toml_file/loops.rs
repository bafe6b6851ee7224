//! `[[loop]]`: conditions that close loops of links.

use std::collections::BTreeMap;

use super::{
    file::{LoopEntry, LoopFrameEntry, LoopKindEntry},
    reader::Reader,
};
use crate::robot::{
    JointKind, LARGEST, Loop, LoopFrame, LoopKind, MOST_JOINTS, Robot, RobotError, urdf::roll_pitch_yaw,
};

impl Reader<'_> {
    /// Closes the loops of the file; the joints that are passive lose their coordinates.
    pub(super) fn close_loops(&self, robot: &mut Robot, entries: Vec<LoopEntry>) -> Result<(), RobotError> {
        if entries.is_empty() {
            return Ok(());
        }
        if entries.len() > MOST_JOINTS {
            return Err(RobotError::TooLarge { path: self.path.to_owned(), what: "loops", limit: MOST_JOINTS });
        }
        let mut passive = Vec::new();
        for entry in &entries {
            for name in &entry.passive {
                let joint = self.joint_of_loop(robot, entry, name)?;
                if robot.joints[joint].mimic.is_some() {
                    return Err(self.loop_problem(entry, &format!("names `{name}`, which follows another joint")));
                }
                if passive.contains(&joint) {
                    return Err(self.loop_problem(entry, &format!("names the passive joint `{name}` a second time")));
                }
                passive.push(joint);
            }
        }
        let last = &entries[entries.len() - 1];
        if passive.is_empty() {
            let problem = "names no passive joint; list in `passive` the joints that the loops move";
            return Err(self.loop_problem(last, problem));
        }
        let joints = robot.joints.iter().enumerate();
        if joints.filter(|(_, joint)| joint.has_coordinate()).all(|(j, _)| passive.contains(&j)) {
            return Err(self.loop_problem(last, "leaves no joint that is driven; leave one out of `passive`"));
        }
        let loops = entries.iter().map(|entry| self.of_entry(robot, entry)).collect::<Result<Vec<_>, _>>()?;
        let coupled = "has a passive joint that shares a motor with another joint; a passive joint has no motor";
        robot.close(loops, &passive).ok_or_else(|| self.loop_problem(last, coupled))
    }

    fn of_entry(&self, robot: &Robot, entry: &LoopEntry) -> Result<Loop, RobotError> {
        let kind = match (entry.kind, entry.length_m) {
            (LoopKindEntry::Point, None) => LoopKind::Point,
            (LoopKindEntry::Axis, None) => LoopKind::Axis,
            (LoopKindEntry::Pose, None) => LoopKind::Pose,
            (LoopKindEntry::Distance, Some(length)) if length > 0.0 && length <= LARGEST => {
                LoopKind::Distance { length }
            }
            (LoopKindEntry::Distance, _) => {
                return Err(self.loop_problem(entry, "needs length_m, the length of the rod above zero in m"));
            }
            (LoopKindEntry::Point | LoopKindEntry::Axis | LoopKindEntry::Pose, Some(_)) => {
                return Err(self.loop_problem(entry, "has length_m, which belongs to kind = \"distance\""));
            }
        };
        let (from, to) = (self.frame_of_loop(robot, entry, &entry.from)?, self.frame_of_loop(robot, entry, &entry.to)?);
        if from.joint == to.joint {
            return Err(self.loop_problem(entry, "joins a link to itself; `from` and `to` are on two links"));
        }
        Ok(Loop { name: entry.name.clone(), kind, from, to, near: self.near(robot, entry)? })
    }

    fn frame_of_loop(&self, robot: &Robot, entry: &LoopEntry, of: &LoopFrameEntry) -> Result<LoopFrame, RobotError> {
        let joint = of.link_of.as_ref().map(|name| self.joint_of_loop(robot, entry, name)).transpose()?;
        if !of.point_m.iter().chain(&of.rpy_deg).all(|v| v.abs() <= LARGEST) {
            return Err(self.loop_problem(entry, "has a number that is not finite, or beyond 1e9"));
        }
        let rotation = roll_pitch_yaw(of.rpy_deg.map(f64::to_radians));
        Ok(LoopFrame { joint, rotation, origin: of.point_m })
    }

    /// The positions near which the loop is closed.
    fn near(&self, robot: &Robot, entry: &LoopEntry) -> Result<Vec<(usize, f64)>, RobotError> {
        let of = |kind: JointKind, positions: &BTreeMap<String, f64>| {
            let (key, other, factor) = match kind {
                JointKind::Revolute => ("near_deg", "near_m", 1f64.to_radians()),
                JointKind::Prismatic => ("near_m", "near_deg", 1.0),
            };
            let position = |(name, value): (&String, &f64)| {
                let joint = self.joint_of_loop(robot, entry, name)?;
                if robot.joints[joint].kind != kind {
                    return Err(self.loop_problem(entry, &format!("has `{name}` in {key}; give it in {other}")));
                }
                if value.is_nan() || value.abs() > LARGEST {
                    return Err(
                        self.loop_problem(entry, &format!("has {key} of `{name}` = {value}; give a finite number"))
                    );
                }
                Ok((joint, value * factor))
            };
            positions.iter().map(position).collect::<Result<Vec<_>, _>>()
        };
        Ok([of(JointKind::Revolute, &entry.near_deg)?, of(JointKind::Prismatic, &entry.near_m)?].concat())
    }

    fn joint_of_loop(&self, robot: &Robot, entry: &LoopEntry, name: &str) -> Result<usize, RobotError> {
        let found = robot.joints.iter().position(|joint| joint.name == name);
        found.ok_or_else(|| {
            let known: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
            self.loop_problem(entry, &format!("names the unknown joint `{name}`; the joints are {}", known.join(" ")))
        })
    }

    fn loop_problem(&self, entry: &LoopEntry, problem: &str) -> RobotError {
        RobotError::Loop { path: self.path.to_owned(), name: entry.name.clone(), problem: problem.to_owned() }
    }
}
