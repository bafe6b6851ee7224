//! Converts descriptions to columns of a robot.

use super::{
    column::{Shape, TermColumn},
    description::TermDescription,
    error::{MOST_COLUMNS, TermError},
};
use crate::robot::{Bound, JointKind, Robot, Role};

/// A description being resolved, with its context for messages and columns.
pub(super) struct Resolver<'a> {
    pub(super) robot: &'a Robot,
    pub(super) description: &'a TermDescription,
    pub(super) number: usize,
}

impl Robot {
    /// Adds torque terms after those that the robot has.
    ///
    /// # Errors
    /// [`TermError`], which names the term.
    pub fn add_terms(&mut self, descriptions: &[TermDescription]) -> Result<(), TermError> {
        for description in descriptions {
            let number = self.term_descriptions.len();
            let columns = Resolver { robot: self, description, number }.columns()?;
            self.terms.extend(columns);
            self.term_descriptions.push(description.clone());
        }
        Ok(())
    }

    /// The robot with other terms.
    ///
    /// # Errors
    /// As [`Robot::add_terms`].
    pub fn with_terms(&self, descriptions: &[TermDescription]) -> Result<Self, TermError> {
        let mut robot = Self { terms: Vec::new(), term_descriptions: Vec::new(), ..self.clone() };
        robot.add_terms(descriptions)?;
        Ok(robot)
    }
}

impl Resolver<'_> {
    fn columns(&self) -> Result<Vec<TermColumn>, TermError> {
        let columns = match self.between_points()? {
            Some(columns) => columns,
            None => {
                let of_joints = self.joints()?.into_iter().map(|j| self.of_joint(j)).collect::<Result<Vec<_>, _>>()?;
                of_joints.concat()
            }
        };
        if self.robot.terms.len() + columns.len() > MOST_COLUMNS {
            return Err(TermError::TooMany { limit: MOST_COLUMNS });
        }
        self.check_names(&columns)?;
        self.refuse_with_loops(&columns)?;
        Ok(columns)
    }

    /// Refuses columns that loops do not support yet.
    fn refuse_with_loops(&self, columns: &[TermColumn]) -> Result<(), TermError> {
        let is_supported = |column: &TermColumn| column.factor.is_none() && column.shape.is_of_joints_or_points();
        match self.robot.loops.is_empty() || columns.iter().all(is_supported) {
            true => Ok(()),
            false => Err(TermError::WithLoops { term: self.place() }),
        }
    }

    /// The joints of a term of joints; all that follow no other if it names none.
    fn joints(&self) -> Result<Vec<usize>, TermError> {
        match self.description.joints() {
            None => Ok(self.robot.coordinate_joints()),
            Some(names) => names.iter().map(|name| self.own_joint(name)).collect(),
        }
    }

    /// A joint that a term acts on.
    fn own_joint(&self, name: &str) -> Result<usize, TermError> {
        let joint = self.joint(name)?;
        match self.robot.joints[joint].also_follows.is_empty() {
            true => Ok(joint),
            false => Err(TermError::FollowsSeveral { term: self.place(), joint: name.to_owned() }),
        }
    }

    pub(super) fn joint(&self, name: &str) -> Result<usize, TermError> {
        let joints = &self.robot.joints;
        joints.iter().position(|joint| joint.name == name).ok_or_else(|| TermError::UnknownJoint {
            term: self.place(),
            joint: name.to_owned(),
            known: joints.iter().map(|joint| joint.name.clone()).collect(),
        })
    }

    fn check_names(&self, columns: &[TermColumn]) -> Result<(), TermError> {
        // A final r in a name marks a parameter with others regrouped into it.
        let bare = |name: &str| name.trim_end_matches('r').to_owned();
        let known: Vec<String> = self.robot.parameter_table().iter().map(|p| bare(&p.name())).collect();
        for (k, column) in columns.iter().enumerate() {
            let name = &column.parameter;
            let own = bare(name);
            if known.contains(&own) || columns[..k].iter().any(|other| bare(&other.parameter) == own) {
                let remedy = "state each law once for a joint, and give springs and expressions names of their own";
                return Err(TermError::Twice {
                    term: self.place(),
                    parameter: name.clone(),
                    remedy: remedy.to_owned(),
                });
            }
        }
        Ok(())
    }

    /// A column of a joint, whose parameter is named by the joint's number.
    pub(super) fn column(&self, joint: usize, name: &str, meaning: Meaning, shape: Shape) -> TermColumn {
        let Meaning { role, bound, units: [revolute, prismatic] } = meaning;
        let unit = match self.robot.joints[joint].kind {
            JointKind::Revolute => revolute,
            JointKind::Prismatic => prismatic,
        };
        TermColumn {
            parameter: format!("{name}{}", joint + 1),
            unit: unit.to_owned(),
            role,
            bound,
            joint,
            shape,
            factor: None,
            term: self.number,
        }
    }

    /// The position of the term in the file, for messages.
    pub(super) fn place(&self) -> String {
        format!("[[term]] {} ({})", self.number + 1, self.description.kind())
    }

    pub(super) fn require(&self, holds: bool, key: &str, expected: &str, found: f64) -> Result<(), TermError> {
        if holds { Ok(()) } else { Err(self.value(key, expected, &found.to_string())) }
    }

    pub(super) fn value(&self, key: &str, expected: &str, found: &str) -> TermError {
        TermError::Value {
            term: self.place(),
            key: key.to_owned(),
            expected: expected.to_owned(),
            found: found.to_owned(),
        }
    }
}

/// The meaning of a parameter: role, bound, and units for a revolute and a prismatic joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meaning {
    pub(super) role: Role,
    pub(super) bound: Bound,
    pub(super) units: [&'static str; 2],
}

impl Meaning {
    pub(super) const STIFFNESS: Self = Self { role: Role::Load, bound: Bound::NotNegative, units: ["N m/rad", "N/m"] };
    pub(super) const TORQUE: Self = Self { role: Role::Load, bound: Bound::Free, units: ["N m", "N"] };
    pub(super) const COULOMB: Self =
        Self { role: Role::CoulombFriction, bound: Bound::NotNegative, units: ["N m", "N"] };
}
