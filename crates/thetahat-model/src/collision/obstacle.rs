use super::{capsule::Capsule, nearest::least_of_convex};
use thetahat_ground::vector::{Vec3, add, dot, norm, scale, times, transpose_times};

/// An obstacle near the robot, in the frame of its base.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: ObstacleShape,
}

/// Shapes of obstacles: convex, so that the distance of a point is a convex function of the point.
#[derive(Debug, Clone, PartialEq)]
pub enum ObstacleShape {
    /// All points below a plane: `n . x <= offset`.
    HalfSpace {
        /// The direction out of it, of length one.
        normal: [f64; 3],
        /// Distance of the plane from the origin along it, m.
        offset: f64,
    },
    /// A box.
    Box {
        /// Its axes as columns.
        rotation: [[f64; 3]; 3],
        /// Its centre, m.
        centre: [f64; 3],
        /// Half of its edges, m.
        half: [f64; 3],
    },
    /// A cylinder along the third of its axes.
    Cylinder {
        /// Its axes as columns.
        rotation: [[f64; 3]; 3],
        /// Its centre, m.
        centre: [f64; 3],
        /// Its radius, m.
        radius: f64,
        /// Half of its length, m.
        half: f64,
    },
}

impl ObstacleShape {
    /// The distance of a point, below zero inside, and its gradient.
    pub(super) fn distance(&self, point: Vec3) -> (f64, Vec3) {
        match self {
            Self::HalfSpace { normal, offset } => (dot(*normal, point) - offset, *normal),
            Self::Box { rotation, centre, half } => {
                let x = transpose_times(rotation, add(point, scale(-1.0, *centre)));
                let (distance, direction) = of_box(x, half);
                (distance, times(rotation, direction))
            }
            Self::Cylinder { rotation, centre, radius, half } => {
                let x = transpose_times(rotation, add(point, scale(-1.0, *centre)));
                let across = x[0].hypot(x[1]);
                // A rectangle in the plane of the axis and the point.
                let (distance, [out, along, _]) = of_box([across, x[2], 0.0], &[*radius, *half, f64::INFINITY]);
                let outward = if across > 0.0 { [x[0] / across, x[1] / across] } else { [1.0, 0.0] };
                (distance, times(rotation, [out * outward[0], out * outward[1], along]))
            }
        }
    }

    /// The clearance of a capsule, the nearest point of its segment, and the direction of separation.
    pub(super) fn clearance(&self, capsule: &Capsule) -> (f64, Vec3, Vec3) {
        let part = match self {
            Self::HalfSpace { normal, .. } => {
                let [a, b] = capsule.ends.map(|end| dot(*normal, end));
                if a <= b { 0.0 } else { 1.0 }
            }
            Self::Box { .. } | Self::Cylinder { .. } => least_of_convex(|part| self.distance(capsule.at(part)).0),
        };
        let point = capsule.at(part);
        let (distance, direction) = self.distance(point);
        (distance - capsule.radius, point, direction)
    }
}

/// Distance of a point to a box about the origin, below zero inside, and its gradient.
fn of_box(x: Vec3, half: &Vec3) -> (f64, Vec3) {
    let beyond = [0, 1, 2].map(|k| x[k].abs() - half[k]);
    let outside = beyond.map(|b| b.max(0.0));
    let distance = norm(outside);
    if distance > 0.0 {
        return (distance, [0, 1, 2].map(|k| outside[k] / distance * x[k].signum()));
    }
    let face = (0..3).max_by(|&a, &b| beyond[a].total_cmp(&beyond[b])).unwrap_or(0);
    let mut direction = [0.0; 3];
    direction[face] = x[face].signum();
    (beyond[face], direction)
}
