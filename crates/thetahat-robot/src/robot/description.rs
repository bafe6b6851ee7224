use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    joint::{Joint, JointKind},
    locking::LockedJoint,
    loops::Loop,
    parameters::{Parameter, ParameterTable},
    quantity::{Friction, JointQuantity, Quantity},
    terms::{TermColumn, TermDescription, channels_of},
    transmission::Transmission,
};

/// A robot, serial or a tree, perhaps with loops of links, with its transmission, friction model and a-priori parameters.
///
/// Joint and link k have index k - 1 in `joints`, and own the parameters with number k. The *coordinates*, by which q, tau,
/// motors and recorded channels are indexed, are the joints that follow no other and that no loop moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: [f64; 3],
    /// The moving joints, parents before children.
    pub joints: Vec<Joint>,
    /// Conditions that close loops of links.
    pub loops: Vec<Loop>,
    /// Motors to coordinates.
    pub transmission: Transmission,
    /// The friction model of the joints.
    pub friction: Friction,
    /// A-priori values by parameter name, for example from CAD; parameters not listed are zero.
    pub a_priori: BTreeMap<String, f64>,
    /// Joints of the description that were locked and are no longer joints of this robot.
    pub locked: Vec<LockedJoint>,
    /// Physically impossible values in its description, notes of how it was interpreted, and what it states beyond a robot.
    pub doubts: Vec<Doubt>,
    /// Descriptions of torque terms in addition to those of links and drives; [`Robot::add_terms`] adds them.
    pub term_descriptions: Vec<TermDescription>,
    /// The columns of the terms.
    pub terms: Vec<TermColumn>,
}

/// A value of a description that is physically impossible and used unchanged, such as a negative mass in a URDF; a note of how
/// something was interpreted; or something that a [`Robot`] cannot hold, such as a free joint of an MJCF.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Doubt {
    /// How serious it is.
    pub grade: DoubtGrade,
    /// File, line and element.
    pub place: String,
    /// What it is, in words.
    pub what: String,
    /// The impossible value, or the number of elements that are left out; zero for a note without one.
    pub value: f64,
    /// The unit of the value; empty for a number of elements.
    pub unit: &'static str,
    /// The joint, from zero, that moves what has the value; none if nothing moves it.
    #[serde(skip)]
    pub carrier: Option<usize>,
    /// What to do.
    pub remedy: &'static str,
}

/// How serious a doubt is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DoubtGrade {
    /// The value is physically impossible, and estimates or simulations may suffer from it.
    Impossible,
    /// The description says less than it should; how it was interpreted is stated.
    Note,
}

impl Doubt {
    /// A note of how something was interpreted.
    pub(super) fn note(place: String, what: String, remedy: &'static str) -> Self {
        Self { grade: DoubtGrade::Note, place, what, value: 0.0, unit: "", carrier: None, remedy }
    }

    /// The same of what another joint moves, by its number from zero. A value that nothing moves is in no equation: a note.
    pub(super) fn carried_by(self, carrier: Option<usize>) -> Self {
        let doubt = if carrier.is_none() { self.into_note() } else { self };
        Self { carrier, ..doubt }
    }

    pub(super) fn into_note(self) -> Self {
        Self { grade: DoubtGrade::Note, ..self }
    }
}

impl Robot {
    /// Number of coordinates: the number of joints that follow no other.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.coordinates().count()
    }

    /// Number of moving joints, followers included, and of moving links.
    #[must_use]
    pub fn link_count(&self) -> usize {
        self.joints.len()
    }

    /// The joints that follow no other, in the order of q, tau, motors and recorded channels.
    pub fn coordinates(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| joint.has_coordinate())
    }

    /// Index in `joints` of the joint of each coordinate.
    #[must_use]
    pub fn coordinate_joints(&self) -> Vec<usize> {
        (0..self.joints.len()).filter(|&j| self.joints[j].has_coordinate()).collect()
    }

    /// Index in `joints` of the joint of one coordinate, from zero.
    ///
    /// # Panics
    /// If the robot has no such coordinate.
    #[must_use]
    pub fn joint_of(&self, coordinate: usize) -> usize {
        self.coordinate_joints()[coordinate]
    }

    /// The coordinate, from zero, of the joint with a number, from one; none if that joint does not move or follows another.
    #[must_use]
    pub fn coordinate_of_number(&self, number: usize) -> Option<usize> {
        self.coordinate_joints().iter().position(|joint| joint + 1 == number)
    }

    /// The table of standard parameters.
    #[must_use]
    pub fn parameter_table(&self) -> ParameterTable {
        let kinds: Vec<JointKind> = self.joints.iter().map(|j| j.kind).collect();
        let joints = self.coordinate_joints();
        let coupled = self.transmission.coupled_motors();
        let motors: Vec<usize> = coupled.into_iter().filter_map(|i| joints.get(i).copied()).collect();
        let table = ParameterTable::new(&kinds, self.friction, &motors).with_terms(&self.terms);
        let root = self.root_joint();
        if self.loops.is_empty() && root.is_none() { table } else { table.without(|p| self.lacks(p, root)) }
    }

    /// Whether a joint has no such parameter. One that a loop moves has bearings, but no motor; those of a base have neither, and
    /// one body.
    fn lacks(&self, parameter: &Parameter, root: Option<usize>) -> bool {
        let joint = parameter.number - 1;
        match parameter.quantity {
            Quantity::Joint(JointQuantity::Ia | JointQuantity::Off) if self.joints[joint].passive => true,
            Quantity::Joint(_) => self.joints[joint].of_base,
            Quantity::Link(_) => self.joints[joint].of_base && Some(joint) != root,
            Quantity::Motor(_) | Quantity::Term(_) => false,
        }
    }

    /// The recorded channels that its terms use, without duplicates.
    #[must_use]
    pub fn channels(&self) -> Vec<String> {
        channels_of(&self.terms)
    }

    /// The parameter of a term that depends on accelerations and therefore cannot be simulated.
    #[must_use]
    pub fn term_of_acceleration(&self) -> Option<&str> {
        self.terms.iter().find(|term| term.shape.needs_acceleration()).map(|term| term.parameter.as_str())
    }

    /// The a-priori values in the order of the robot's table, zero if not given.
    #[must_use]
    pub fn a_priori_parameters(&self) -> Vec<f64> {
        self.a_priori_parameters_for(&self.parameter_table())
    }

    /// The a-priori values in the order of a table, for example of the same robot with another friction model.
    #[must_use]
    pub fn a_priori_parameters_for(&self, table: &ParameterTable) -> Vec<f64> {
        table.iter().map(|p| self.a_priori.get(&p.name()).copied().unwrap_or(0.0)).collect()
    }

    /// Replaces the friction model; a-priori friction for both signs of the velocity is converted.
    pub(super) fn set_friction(&mut self, friction: Friction) {
        self.friction = friction;
        let own = friction.quantities();
        let others =
            Friction::ALL.iter().flat_map(|other| other.quantities()).filter(|quantity| !own.contains(quantity));
        for quantity in others {
            let sides: Vec<&JointQuantity> = quantity.sides().iter().filter(|side| own.contains(side)).collect();
            if sides.is_empty() {
                continue;
            }
            for number in 1..=self.joints.len() {
                if let Some(value) = self.a_priori.remove(&format!("{}{number}", quantity.name())) {
                    sides.iter().for_each(|side| _ = self.a_priori.insert(format!("{}{number}", side.name()), value));
                }
            }
        }
    }
}
