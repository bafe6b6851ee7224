use serde::{Deserialize, Serialize};

use thetahat_ground::vector::{Mat3, Vec3};

/// Most moving joints of a robot that is read.
pub(super) const MOST_JOINTS: usize = 100;

/// Largest length in m, angle in rad, mass or ratio of a description: far above any robot's, and far from overflow.
pub(super) const LARGEST: f64 = 1e9;

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// Turns about its z axis; its coordinate is an angle in rad.
    Revolute,
    /// Slides along its z axis; its coordinate is a length in m.
    Prismatic,
}

impl JointKind {
    /// Converts degrees to rad, mm to m.
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_radians(),
            Self::Prismatic => 1e-3 * value,
        }
    }

    /// Converts rad to degrees, m to mm.
    #[must_use]
    pub fn to_file(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_degrees(),
            Self::Prismatic => 1e3 * value,
        }
    }

    /// The unit of a torque or force.
    #[must_use]
    pub fn torque_unit(self) -> &'static str {
        match self {
            Self::Revolute => "N m",
            Self::Prismatic => "N",
        }
    }

    /// The unit of a position in files that people write.
    #[must_use]
    pub fn file_unit(self) -> &'static str {
        match self {
            Self::Revolute => "degrees",
            Self::Prismatic => "mm",
        }
    }
}

/// A moving joint and its link.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Index of the joint whose link carries it; none if it is on the base. Always smaller than its own index.
    pub parent: Option<usize>,
    /// Its frame at coordinate zero. The joint moves about or along the z axis of that frame.
    pub placement: Placement,
    /// The link's own axes, to which its inertial parameters refer, if they differ from the axes of the joint's
    /// frame: the rotation `A` with `x_joint = A x_link`. Both have the same origin.
    pub link_axes: Option<[[f64; 3]; 3]>,
    /// The joint that it follows, if it has no coordinate of its own.
    pub mimic: Option<Mimic>,
    /// Further joints that it follows at the same time, each another one: its coordinate is the sum of the shares of all, and its torque
    /// acts on each. Empty without `mimic`.
    pub also_follows: Vec<Share>,
    /// Whether loops of links move it: it has no motor, and no coordinate of its own.
    pub passive: bool,
    /// Whether it is one of the six of a base that floats: its position is measured, it has no motor, and its link is massless but
    /// for the root body.
    pub of_base: bool,
    /// Its known limits.
    pub limits: Limits,
}

/// A joint frame relative to the frame of the joint before it: `Rot(z, gamma) Rot(x, alpha) Rot(z, theta)`, which represents
/// any rotation, and the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// First angle, about z of the frame before, rad; zero in serial Denavit-Hartenberg robots.
    pub gamma: f64,
    /// Second angle, about x, rad.
    pub alpha: f64,
    /// Third angle, about the joint's own z axis, rad.
    pub theta: f64,
    /// The origin in the frame before, m.
    pub origin: [f64; 3],
}

/// A joint that follows another: its coordinate is `ratio q + offset`, its torque acts on q times `ratio`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// Index of the joint that it follows, which follows none.
    pub of: usize,
    /// Its velocity per velocity of the other.
    pub ratio: f64,
    /// Its coordinate when the other's is zero, rad or m.
    pub offset: f64,
}

/// The share of another joint in the coordinate of one that follows several, as the tool of a palletiser follows shoulder and elbow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Index of the joint that it follows, which follows none.
    pub of: usize,
    /// Its velocity per velocity of the other.
    pub ratio: f64,
}

impl Joint {
    /// Whether it has a coordinate of its own: it follows no other joint, and no loop moves it.
    #[must_use]
    pub fn has_coordinate(&self) -> bool {
        self.mimic.is_none() && !self.passive
    }

    /// The joints that it follows, with their shares; none if it has a coordinate of its own.
    pub fn follows(&self) -> impl Iterator<Item = Share> + '_ {
        let first = self.mimic.map(|mimic| Share { of: mimic.of, ratio: mimic.ratio });
        first.into_iter().chain(self.also_follows.iter().copied())
    }

    /// That it follows a sum of joints: its coordinate is `offset` where theirs are zero.
    pub(super) fn follow(&mut self, sum: Option<FollowedSum>) {
        let Some(FollowedSum { shares, offset }) = sum else { return };
        let mut shares = shares.into_iter();
        self.mimic = shares.next().map(|first| Mimic { of: first.of, ratio: first.ratio, offset });
        self.also_follows = shares.collect();
    }
}

/// A sum of joints that a joint follows, each once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FollowedSum {
    /// At least one.
    pub(super) shares: Vec<Share>,
    /// The coordinate where those of the joints are zero, rad or m.
    pub(super) offset: f64,
}

/// The limits of a joint that its description states: none if it states nothing, and a velocity or an effort of zero if it
/// states 0, which is no limit that a joint can move under ([`Limits::usable`]).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Smallest coordinate, rad or m.
    pub lower: Option<f64>,
    /// Largest coordinate, rad or m.
    pub upper: Option<f64>,
    /// Largest velocity, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Largest torque or force, N m or N.
    pub effort: Option<f64>,
}

impl Limits {
    /// A limit of velocity or effort under which the joint can move: none if the description states none, or 0.
    #[must_use]
    pub fn usable(limit: Option<f64>) -> Option<f64> {
        limit.filter(|value| *value > 0.0)
    }
}

/// The six numbers of a joint's frame in modified Denavit-Hartenberg form, with Khalil's gamma and b for trees.
///
/// The joint's frame in the parent joint's frame is `Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, a) Rot(z, theta)
/// Trans(z, d)` (W. Khalil, J.-F. Kleinfinger, "A new geometric notation for open and closed-loop robots", 1986).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DenavitHartenberg {
    /// About z of the frame before, rad.
    pub gamma: f64,
    /// Along z of the frame before, m.
    pub b: f64,
    /// About x, rad.
    pub alpha: f64,
    /// Along x, m.
    pub a: f64,
    /// About the joint's z axis, rad.
    pub theta: f64,
    /// Along the joint's z axis, m.
    pub d: f64,
}

/// Sine of alpha below which gamma and theta turn about the same axis, and only theta is used.
const PARALLEL: f64 = 1e-15;

impl From<DenavitHartenberg> for Placement {
    fn from(dh: DenavitHartenberg) -> Self {
        let DenavitHartenberg { gamma, b, alpha, a, theta, d } = dh;
        let (sin_gamma, cos_gamma) = gamma.sin_cos();
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let [x, y, z] = [a, -d * sin_alpha, b + d * cos_alpha];
        let origin = [cos_gamma * x - sin_gamma * y, sin_gamma * x + cos_gamma * y, z];
        let origin = if gamma == 0.0 { [x, y, z] } else { origin };
        Self { gamma, alpha, theta, origin }
    }
}

impl Placement {
    /// The placement with a given rotation, from the joint's frame to the one before, and an origin.
    #[must_use]
    pub fn new(rotation: &[[f64; 3]; 3], origin: [f64; 3]) -> Self {
        let [_, _, z_axis] = thetahat_ground::vector::transpose(rotation);
        let gamma = if z_axis[0].hypot(z_axis[1]) < PARALLEL { 0.0 } else { z_axis[0].atan2(-z_axis[1]) };
        let (s, c) = gamma.sin_cos();
        // Rot(z, -gamma) R = Rot(x, alpha) Rot(z, theta)
        let first = [0, 1].map(|j| c * rotation[0][j] + s * rotation[1][j]);
        let alpha = (s * z_axis[0] - c * z_axis[1]).atan2(z_axis[2]);
        Self { gamma, alpha, theta: (-first[1]).atan2(first[0]), origin }
    }

    /// The rotation from the joint's frame, at coordinate zero, to the frame before.
    #[must_use]
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let about_z = |angle: f64| -> Mat3 {
            let (s, c) = angle.sin_cos();
            [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
        };
        let (s, c) = self.alpha.sin_cos();
        let about_x: Mat3 = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]];
        thetahat_ground::vector::product(
            &thetahat_ground::vector::product(&about_z(self.gamma), &about_x),
            &about_z(self.theta),
        )
    }

    /// The joint's axis in the frame before.
    #[must_use]
    pub fn axis(&self) -> Vec3 {
        let (sin_alpha, cos_alpha) = self.alpha.sin_cos();
        if self.gamma == 0.0 {
            return [0.0, -sin_alpha, cos_alpha];
        }
        let (sin_gamma, cos_gamma) = self.gamma.sin_cos();
        [sin_gamma * sin_alpha, -cos_gamma * sin_alpha, cos_alpha]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_rotation_comes_back_from_its_three_angles() {
        let angles = [0.0, 1.0, -2.5, std::f64::consts::FRAC_PI_2, std::f64::consts::PI, 1e-9, -1e-17];
        for gamma in angles {
            for alpha in angles {
                let given = Placement { gamma, alpha, theta: 0.7, origin: [0.0; 3] }.rotation();
                let back = Placement::new(&given, [0.0; 3]).rotation();
                let pairs = given.as_flattened().iter().zip(back.as_flattened());
                let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst < 4e-15, "gamma {gamma} alpha {alpha}: {worst:e}");
            }
        }
    }

    #[test]
    fn the_origin_follows_khalil_and_kleinfinger() {
        let dh = DenavitHartenberg { gamma: 0.5, b: 0.3, alpha: -0.4, a: 0.2, theta: 1.0, d: 0.7 };
        let placement = Placement::from(dh);
        let axis = placement.axis();
        let expected = [0.2 * 0.5f64.cos() + 0.7 * axis[0], 0.2 * 0.5f64.sin() + 0.7 * axis[1], 0.3 + 0.7 * axis[2]];
        for (a, b) in placement.origin.iter().zip(expected) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}
