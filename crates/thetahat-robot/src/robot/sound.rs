//! Checks whether a robot that was not read from a file is usable.

use super::{Joint, Robot, floating::BASE_JOINTS};
use thetahat_ground::vector::{IDENTITY, Mat3, cross, dot, norm, product, transpose};

/// Largest difference of the entries of `R R^T` from those of the identity.
const ORTHONORMAL: f64 = 1e-9;

/// What is wrong with a robot that was built by a program.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("robot {robot}: {place} {problem}")]
pub struct NotARobot {
    /// Its name.
    pub robot: String,
    /// The joint or field.
    pub place: String,
    /// What is wrong with it.
    pub problem: &'static str,
}

impl Robot {
    /// Refuses what no description produces: parents after their children, invalid rotations, numbers that are not finite, and
    /// a transmission for another number of joints.
    ///
    /// # Errors
    /// [`NotARobot`] with the joint.
    pub fn check_sound(&self) -> Result<(), NotARobot> {
        let fail = |place: String, problem| Err(NotARobot { robot: self.name.clone(), place, problem });
        for (j, joint) in self.joints.iter().enumerate() {
            if let Some(problem) = self.problem_of(j, joint) {
                return fail(format!("joint `{}`", joint.name), problem);
            }
        }
        if self.transmission.joints() != self.coordinate_count() {
            return fail("transmission".to_owned(), "has another number of joints than follow no other");
        }
        if self.loops.iter().any(|of_loop| of_loop.joints().any(|joint| joint >= self.joints.len())) {
            return fail("loops".to_owned(), "name a joint that the robot does not have");
        }
        if self.joints.iter().any(|joint| joint.passive) == self.loops.is_empty() {
            return fail("loops".to_owned(), "are needed with passive joints, and passive joints with loops");
        }
        if ![0, BASE_JOINTS].contains(&self.base_coordinates())
            || !self.joints.iter().rev().is_sorted_by_key(|j| j.of_base)
        {
            return fail("base".to_owned(), "that floats has six joints, before all others, none of them locked");
        }
        if !self.gravity.iter().all(|g| g.is_finite()) {
            return fail("gravity".to_owned(), "is not finite");
        }
        match self.a_priori.iter().find(|(_, value)| !value.is_finite()) {
            None => Ok(()),
            Some((name, _)) => fail(format!("a-priori {name}"), "is not finite"),
        }
    }

    fn problem_of(&self, j: usize, joint: &Joint) -> Option<&'static str> {
        let leads = |of: usize| self.joints.get(of).is_some_and(|leader| leader.mimic.is_none());
        let placement = joint.placement;
        let numbers = [placement.gamma, placement.alpha, placement.theta].into_iter().chain(placement.origin);
        if joint.parent.is_some_and(|parent| parent >= j) {
            Some("stands before its parent; parents come first")
        } else if joint.mimic.is_none() && !joint.also_follows.is_empty() {
            Some("has also_follows without mimic, the first joint that it follows")
        } else if joint.follows().any(|share| !leads(share.of) || !share.ratio.is_finite())
            || joint.mimic.is_some_and(|m| !m.offset.is_finite())
        {
            Some("follows no joint that follows none, or by a number that is not finite")
        } else if !numbers.into_iter().all(f64::is_finite) {
            Some("has a placement that is not finite")
        } else if !joint.link_axes.is_none_or(|axes| is_rotation(&axes)) {
            Some("has link_axes that are no rotation: rows of length one, orthogonal, right-handed")
        } else {
            None
        }
    }
}

fn is_rotation(r: &Mat3) -> bool {
    let product = product(r, &transpose(r));
    let near = product.as_flattened().iter().zip(IDENTITY.as_flattened()).all(|(a, b)| (a - b).abs() < ORTHONORMAL);
    near && dot(cross(r[0], r[1]), r[2]) > 0.0 && norm(r[0]).is_finite()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn each_defect_is_named() {
        let text = "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n";
        let good = Robot::parse(text, Path::new("arm.toml")).unwrap();
        assert_eq!(good.check_sound(), Ok(()));
        let message = |change: fn(&mut Robot)| {
            let mut robot = good.clone();
            change(&mut robot);
            robot.check_sound().unwrap_err().to_string()
        };
        let turned = |r: &mut Robot| r.joints[1].link_axes = Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.1], [0.0, 0.0, 1.0]]);
        let mirrored =
            |r: &mut Robot| r.joints[1].link_axes = Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        let no_rotation =
            "robot arm: joint `b` has link_axes that are no rotation: rows of length one, orthogonal, right-handed";
        assert_eq!((message(turned), message(mirrored)), (no_rotation.to_owned(), no_rotation.to_owned()));
        assert!(message(|r| r.joints[0].parent = Some(1)).contains("joint `a` stands before its parent"));
        assert!(message(|r| r.joints[0].placement.theta = f64::NAN).contains("joint `a` has a placement"));
        assert!(message(|r| r.gravity[0] = f64::INFINITY).contains("gravity is not finite"));
        assert!(message(|r| _ = r.a_priori.insert("m1".to_owned(), f64::NAN)).contains("a-priori m1"));
        assert!(message(|r| _ = r.joints.pop()).contains("transmission has another number"));
    }
}
