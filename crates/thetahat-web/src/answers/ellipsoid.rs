//! The bodies of a robot's links as ellipsoids.

use serde::Serialize;
use thetahat::{Matrix, Robot};
use thetahat_model::robot::{INERTIAL, Quantity, RigidBody};

/// Part of the largest principal inertia by which rounding may violate the inequality of the triangle.
const ROUNDING: f64 = 1e-9;

/// The homogeneous ellipsoid that has the mass and the inertia of a link.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Ellipsoid {
    /// kg.
    mass: f64,
    /// The centre of mass in the frame of the link, m.
    centre: [f64; 3],
    /// Half the lengths of its axes, m.
    radii: [f64; 3],
    /// Its axes in those of the link, in the order of the radii.
    axes: [[f64; 3]; 3],
}

/// The ellipsoid of a joint's link; none for parameters that no body has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct LinkBody {
    joint: String,
    body: Option<Ellipsoid>,
}

impl LinkBody {
    /// The bodies of all links, with standard parameters in the order of the robot's table.
    pub(crate) fn all_of(robot: &Robot, standard: &[f64]) -> Vec<Self> {
        let table = robot.parameter_table();
        let of = |link: usize| INERTIAL.map(|quantity| table.value(standard, Quantity::Link(quantity), link));
        let joints = robot.joints.iter().enumerate();
        joints.map(|(link, joint)| Self { joint: joint.name.clone(), body: Ellipsoid::of(of(link)) }).collect()
    }
}

impl Ellipsoid {
    /// From ten inertial parameters about the link's origin, in the order of [`INERTIAL`].
    fn of(inertial: [f64; 10]) -> Option<Self> {
        let RigidBody { m: mass, ms, inertia } = RigidBody::from_parameters(inertial);
        if mass <= 0.0 {
            return None;
        }
        let centre = ms.map(|moment| moment / mass);
        let square: f64 = centre.iter().map(|x| x * x).sum();
        let about_centre = Matrix::from_fn(3, 3, |i, j| {
            inertia[i][j] - mass * (if i == j { square } else { 0.0 } - centre[i] * centre[j])
        });
        let (principal, vectors) = about_centre.symmetric_eigen()?;
        let half: f64 = 0.5 * principal.iter().sum::<f64>();
        let squares: Vec<f64> = principal.iter().map(|moment| 5.0 * (half - moment) / mass).collect();
        let allowed = 5.0 * ROUNDING * principal[2] / mass;
        let is_body = principal[0] >= -ROUNDING * principal[2] && squares.iter().all(|square| *square >= -allowed);
        is_body.then(|| Self {
            mass,
            centre,
            radii: [0, 1, 2].map(|k| squares[k].max(0.0).sqrt()),
            axes: [0, 1, 2].map(|k| [0, 1, 2].map(|i| vectors.at(i, k))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the eigenvalues.
    const CLOSE: f64 = 1e-12;

    /// An ellipsoid of 2 kg with the radii 0.1, 0.2 and 0.3 m along z, x and y, whose centre is at (0.3, -0.2, 0.5).
    #[test]
    fn an_ellipsoid_comes_back_from_its_inertia() {
        let (mass, centre, radii) = (2.0, [0.3, -0.2, 0.5_f64], [0.2, 0.3, 0.1_f64]);
        let about_origin = |i: usize, j: usize| {
            let of_axis = |k: usize| mass / 5.0 * radii[k].powi(2) + mass * centre[k] * centre[k];
            let all: f64 = (0..3).map(of_axis).sum();
            if i == j { all - of_axis(i) } else { -mass * centre[i] * centre[j] }
        };
        let upper = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| about_origin(i, j));
        let [xx, xy, xz, yy, yz, zz] = upper;
        let [mx, my, mz] = centre.map(|x| mass * x);
        let found = Ellipsoid::of([xx, xy, xz, yy, yz, zz, mx, my, mz, mass]).unwrap();
        let of_axis = [(0.3, 1), (0.2, 0), (0.1, 2)];
        for (k, (radius, axis)) in of_axis.into_iter().enumerate() {
            assert!((found.radii[k] - radius).abs() < CLOSE, "{found:?}");
            assert!((found.axes[k][axis].abs() - 1.0).abs() < CLOSE, "{found:?}");
        }
        assert!(found.centre.iter().zip(centre).all(|(found, x)| (found - x).abs() < CLOSE));
    }

    #[test]
    fn what_no_body_has_is_no_ellipsoid() {
        assert_eq!(Ellipsoid::of([0.0; 10]), None);
        let [thin, long] = [0.1, 0.3];
        assert_eq!(Ellipsoid::of([thin, 0.0, 0.0, thin, 0.0, long, 0.0, 0.0, 0.0, 1.0]), None);
        assert_eq!(Ellipsoid::of([f64::NAN, 0.0, 0.0, thin, 0.0, thin, 0.0, 0.0, 0.0, 1.0]), None);
    }
}
