//! A link's inertial parameters as mass, centre of mass and inertia about it, as most formats have them.

use thetahat_ground::vector::{Mat3, Vec3, dot, scale};

/// A body in the axes of its link's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    /// kg.
    pub(super) mass: f64,
    /// The centre of mass from the frame's origin, m.
    pub(super) centre: Vec3,
    /// The inertia about the centre of mass, kg m^2.
    pub(super) inertia: Mat3,
}

impl Body {
    /// From the ten inertial parameters about the frame's origin, in the order of [`INERTIAL`].
    pub(super) fn new([xx, xy, xz, yy, yz, zz, mx, my, mz, mass]: [f64; 10]) -> Self {
        let centre = if mass > 0.0 { scale(1.0 / mass, [mx, my, mz]) } else { [0.0; 3] };
        let square = dot(centre, centre);
        let mut inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= mass * (if i == j { square } else { 0.0 } - centre[i] * centre[j]);
            }
        }
        Self { mass, centre, inertia }
    }

    /// `ixx ixy ixz iyy iyz izz`.
    pub(super) fn six(&self) -> [f64; 6] {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.inertia;
        [xx, xy, xz, yy, yz, zz]
    }
}
