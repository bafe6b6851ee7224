//! Parts of a robot on a fixed base that move independently: the legs of a robot that hangs, the arms of a torso that is held.

use std::collections::BTreeMap;

use super::{
    description::Robot,
    joint::{Joint, Mimic},
    quantity::Quantity,
};

/// A part of a robot whose accelerations depend on nothing of the other parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The part as a robot.
    pub robot: Robot,
    /// Its joints among those of the whole robot.
    pub joints: Vec<usize>,
    /// Its coordinates among those of the whole robot.
    pub coordinates: Vec<usize>,
    /// Its motors among those of the whole robot.
    pub motors: Vec<usize>,
    /// Index of each of its standard parameters in the table of the whole robot.
    pub parameters: Vec<usize>,
}

impl Robot {
    /// The parts that move independently, in the order of their first joints: joints belong together that share a chain from the
    /// base, that follow one another, or that one motor turns. A robot with torque terms is one part: a term may join any joints.
    #[must_use]
    pub fn branches(&self) -> Vec<Branch> {
        let together = self.joints_together();
        let mut first: Vec<usize> = together.clone();
        first.sort_unstable();
        first.dedup();
        let branch = |&first: &usize| {
            let joints: Vec<usize> = (0..self.joints.len()).filter(|&j| together[j] == first).collect();
            self.branch(&joints)
        };
        let branches: Option<Vec<Branch>> = first.iter().map(branch).collect();
        branches.unwrap_or_else(|| vec![self.whole()])
    }

    /// For each joint the first of those that belong together with it.
    fn joints_together(&self) -> Vec<usize> {
        let mut first: Vec<usize> = (0..self.joints.len()).collect();
        let mut join = |a: usize, b: usize| {
            let (low, high) = (first[a].min(first[b]), first[a].max(first[b]));
            first.iter_mut().filter(|f| **f == high).for_each(|f| *f = low);
        };
        for (j, joint) in self.joints.iter().enumerate() {
            joint.parent.into_iter().chain(joint.mimic.map(|m| m.of)).for_each(|other| join(j, other));
        }
        for of_loop in &self.loops {
            let passive = (0..self.joints.len()).filter(|&j| self.joints[j].passive);
            let joints: Vec<usize> = of_loop.from.joint.into_iter().chain(of_loop.to.joint).chain(passive).collect();
            joints.windows(2).for_each(|pair| join(pair[0], pair[1]));
        }
        let coordinates = self.coordinate_joints();
        for motor in 0..self.transmission.joints() {
            let turned = self.transmission.coordinates_of(motor);
            turned.windows(2).for_each(|pair| join(coordinates[pair[0]], coordinates[pair[1]]));
        }
        if !self.terms.is_empty() {
            (1..self.joints.len()).for_each(|j| join(0, j));
        }
        first
    }

    fn whole(&self) -> Branch {
        let all: Vec<usize> = (0..self.coordinate_count()).collect();
        let parameters = (0..self.parameter_table().len()).collect();
        let joints = (0..self.joints.len()).collect();
        Branch { robot: self.clone(), joints, coordinates: all.clone(), motors: all, parameters }
    }

    /// The robot of some joints, which depend on no others; none if their motors do.
    fn branch(&self, joints: &[usize]) -> Option<Branch> {
        if joints.len() == self.joints.len() {
            return Some(self.whole());
        }
        let place = |j: usize| joints.iter().position(|&own| own == j);
        let coordinate_joints = self.coordinate_joints();
        let coordinates: Vec<usize> =
            (0..coordinate_joints.len()).filter(|&c| joints.contains(&coordinate_joints[c])).collect();
        let turns = |motor: &usize| self.transmission.coordinates_of(*motor).iter().any(|c| coordinates.contains(c));
        let motors: Vec<usize> = (0..coordinate_joints.len()).filter(turns).collect();
        let renumbered = |&j: &usize| {
            let joint = &self.joints[j];
            let mimic = joint.mimic.and_then(|m| Some(Mimic { of: place(m.of)?, ..m }));
            Joint { parent: joint.parent.and_then(place), mimic, ..joint.clone() }
        };
        let robot = Robot {
            joints: joints.iter().map(renumbered).collect(),
            transmission: self.transmission.part(&motors, &coordinates)?,
            loops: self.loops.iter().filter_map(|of_loop| of_loop.renumbered(&place)).collect(),
            a_priori: BTreeMap::new(),
            ..self.clone()
        };
        let parameters = self.parameters_of(&robot, joints, &motors)?;
        Some(Branch { robot, joints: joints.to_vec(), coordinates, motors, parameters })
    }

    /// Index in the own table of each parameter of a part with these joints and motors.
    fn parameters_of(&self, part: &Robot, joints: &[usize], motors: &[usize]) -> Option<Vec<usize>> {
        let (table, of_coordinates) = (self.parameter_table(), [self.coordinate_joints(), part.coordinate_joints()]);
        let index = |quantity: Quantity, number: usize| {
            let place = match quantity {
                Quantity::Link(_) | Quantity::Joint(_) => joints[number - 1],
                // A motor has the number of the joint of the coordinate with its own number.
                Quantity::Motor(_) => {
                    let own = of_coordinates[1].iter().position(|&j| j == number - 1)?;
                    of_coordinates[0][*motors.get(own)?]
                }
                Quantity::Term(_) => return None,
            };
            table.index(quantity, place)
        };
        part.parameter_table().iter().map(|p| index(p.quantity, p.number)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use thetahat_testing::TWO_LEGS;

    fn legs() -> Robot {
        Robot::parse(TWO_LEGS, Path::new("legs.toml")).unwrap()
    }

    /// The robot with its second joint on the base.
    fn on_base(mut robot: Robot) -> Robot {
        robot.joints[1].parent = None;
        robot
    }

    #[test]
    fn two_legs_are_two_branches_with_their_own_motors_and_parameters() {
        let robot = legs();
        let branches = robot.branches();
        let coordinates: Vec<_> = branches.iter().map(|b| (&b.coordinates[..], &b.motors[..])).collect();
        assert_eq!(coordinates, [(&[0, 1][..], &[0, 1][..]), (&[2, 3], &[2, 3])]);
        let table = robot.parameter_table();
        let names = |b: &Branch| b.parameters.iter().map(|&i| table.get(i).name()).collect::<Vec<_>>().join(" ");
        assert!(names(&branches[0]).ends_with("ia2 fv2 fc2 off2"), "{}", names(&branches[0]));
        assert!(names(&branches[1]).ends_with("off4 iam4 fvm4 fcm4"), "{}", names(&branches[1]));
        let of_parts: usize = branches.iter().map(|b| b.parameters.len()).sum();
        assert_eq!(of_parts, table.len());
    }

    #[test]
    fn what_shares_a_chain_a_follower_or_a_motor_is_one_part() {
        let chain = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n";
        let robot = |more: &str| Robot::parse(&format!("{chain}{more}"), Path::new("r.toml")).unwrap();
        assert_eq!((robot("").branches().len(), on_base(robot("")).branches().len()), (1, 2));
        for joining in [
            "mimic = { joint = 'a', ratio = 2 }",
            "[transmission]\nmatrix = [[1, 0], [1, 1]]",
            "[[term]]\nkind = 'joint-spring'\njoints = ['a']",
        ] {
            assert_eq!(on_base(robot(joining)).branches().len(), 1, "{joining}");
        }
    }
}
