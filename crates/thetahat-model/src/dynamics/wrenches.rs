//! Generalised forces of wrenches that act on links from outside.

use super::model::Model;
use thetahat_ground::vector::{IDENTITY, Mat3, Vec3, add, product, times};

/// A force and a moment that act on a link from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct Wrench {
    /// The joint of the link.
    #[doc(hidden)]
    pub joint: usize,
    /// Where it acts, in the link's own axes from its origin, m.
    #[doc(hidden)]
    pub point: Vec3,
    /// Whether force and moment are along the link's own axes, or else the world's.
    #[doc(hidden)]
    pub in_link: bool,
    /// N.
    #[doc(hidden)]
    pub force: Vec3,
    /// About the point, N m.
    #[doc(hidden)]
    pub moment: Vec3,
}

impl Model {
    /// Adds `J(q)^T w` of each wrench to the torques and forces of the coordinates.
    #[doc(hidden)]
    pub fn add_wrenches(&self, q: &[f64], wrenches: &[Wrench], tau: &mut [f64]) {
        let frames = self.frames(q);
        for wrench in wrenches {
            let frame = &frames[wrench.joint];
            let own: Mat3 = self.link_axes(wrench.joint).map_or(IDENTITY, |axes| *axes);
            let axes = product(&frame.rotation, &own);
            let turned = |x: Vec3| if wrench.in_link { times(&axes, x) } else { x };
            let (force, moment) = (turned(wrench.force), turned(wrench.moment));
            let point = add(frame.origin, times(&axes, wrench.point));
            self.add_point_slopes(&frames, wrench.joint, point, force, tau);
            self.add_turn_slopes(&frames, wrench.joint, moment, tau);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::Robot;

    const PENDULUM: &str = "name = 'p'\nfloating_base = true\n[[joint]]\nname = 'a'\nkind = 'revolute'\na_m = 0.5\n";

    /// At zero the joint turns about the world's z axis at x = 0.5 m; a force along y at x = 0.8 m turns it by 0.3 m.
    #[test]
    fn a_force_acts_on_the_base_and_on_the_joints_between() {
        let model = Model::new(&Robot::parse(PENDULUM, Path::new("p.toml")).unwrap());
        let mut tau = vec![0.0; 7];
        let wrench = Wrench {
            joint: 6,
            point: [0.3, 0.0, 0.0],
            in_link: false,
            force: [0.0, 2.0, 0.0],
            moment: [5.0, 0.0, 1.0],
        };
        model.add_wrenches(&[0.0; 7], &[wrench], &mut tau);
        let expected = [0.0, 2.0, 0.0, 0.8 * 2.0 + 1.0, 0.0, 5.0, 0.3 * 2.0 + 1.0];
        assert!(tau.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{tau:?}");
        // Turned by a right angle, the link's x axis is the world's y axis.
        let mut turned = vec![0.0; 7];
        let own = Wrench { in_link: true, ..wrench };
        model.add_wrenches(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2], &[own], &mut turned);
        assert!((turned[0] + 2.0).abs() < 1e-14 && (turned[6] - 1.6).abs() < 1e-14, "{turned:?}");
    }
}
