use crate::robot::Solid;
use thetahat_ground::vector::{Mat3, Vec3, add, scale, times};

/// All points within a given distance of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// The ends of the segment, m.
    pub ends: [[f64; 3]; 2],
    /// The radius, m.
    pub radius: f64,
}

/// Number of segment lengths tried for the smallest capsule, up to the solid's length.
const LENGTHS: usize = 200;

impl Capsule {
    /// The capsule of least volume, along the longest edge, that contains a solid.
    #[must_use]
    pub fn around(solid: &Solid) -> Self {
        match *solid {
            Solid::Sphere { radius } => Self { ends: [[0.0; 3]; 2], radius },
            Solid::Cylinder { radius, length } => Self::least(2, 0.5 * length, radius),
            Solid::Box { edges } => {
                let axis = (0..3).max_by(|&a, &b| edges[a].total_cmp(&edges[b])).unwrap_or(2);
                let others: f64 = (0..3).filter(|&k| k != axis).map(|k| (0.5 * edges[k]).powi(2)).sum();
                Self::least(axis, 0.5 * edges[axis], others.sqrt())
            }
        }
    }

    /// Around all points within `radius` of an axis over `half` of a length to both sides.
    fn least(axis: usize, half: f64, radius: f64) -> Self {
        let of = |k: usize| {
            let segment = half * k as f64 / LENGTHS as f64;
            (segment, radius.hypot(half - segment))
        };
        let volume = |(segment, radius): &(f64, f64)| radius * radius * (segment + 2.0 / 3.0 * radius);
        let least = (0..=LENGTHS).map(of).min_by(|a, b| volume(a).total_cmp(&volume(b)));
        let (segment, radius) = least.unwrap_or((half, radius));
        let mut end = [0.0; 3];
        end[axis] = segment;
        Self { ends: [end, scale(-1.0, end)], radius }
    }

    /// The capsule moved by a rotation and an origin.
    #[must_use]
    pub fn placed(&self, rotation: &[[f64; 3]; 3], origin: [f64; 3]) -> Self {
        Self { ends: self.ends.map(|end| placed(rotation, origin, end)), radius: self.radius }
    }

    /// The point of the segment at a fraction from 0 to 1.
    pub(super) fn at(&self, part: f64) -> Vec3 {
        let [a, b] = self.ends;
        add(scale(1.0 - part, a), scale(part, b))
    }
}

pub(super) fn placed(rotation: &Mat3, origin: Vec3, point: Vec3) -> Vec3 {
    add(times(rotation, point), origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::vector::norm;

    /// Distance of a point to the segment, by sampling the segment.
    fn from_segment(capsule: &Capsule, point: Vec3) -> f64 {
        (0..=1000)
            .map(|k| norm(add(point, scale(-1.0, capsule.at(f64::from(k) / 1000.0)))))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn capsules_contain_their_solids() {
        let edges = [0.2, 0.7, 0.3];
        let around = Capsule::around(&Solid::Box { edges });
        for corner in 0..8 {
            let side = |k: usize| if corner >> k & 1 == 0 { 0.5 } else { -0.5 };
            let point = [0, 1, 2].map(|k| side(k) * edges[k]);
            assert!(from_segment(&around, point) <= around.radius + 1e-9);
        }
        assert!(around.radius < 0.36 && around.ends[0][1] > 0.1, "{around:?}");
        let (radius, length) = (0.06, 0.6);
        let around = Capsule::around(&Solid::Cylinder { radius, length });
        for k in 0..36 {
            let (sin, cos) = (f64::from(k) / 36.0 * std::f64::consts::TAU).sin_cos();
            assert!(from_segment(&around, [radius * cos, radius * sin, 0.5 * length]) <= around.radius + 1e-9);
        }
        assert_eq!(Capsule::around(&Solid::Sphere { radius }), Capsule { ends: [[0.0; 3]; 2], radius });
    }
}
