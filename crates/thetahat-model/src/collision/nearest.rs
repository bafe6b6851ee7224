//! The nearest points of shapes.

use super::capsule::Capsule;
use thetahat_ground::vector::{Vec3, add, dot, norm, scale};

/// Steps of the golden section: the fraction is then known to 1e-8.
const STEPS: usize = 38;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The fraction from 0 to 1 at which a convex function is least.
pub(super) fn least_of_convex(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = inner.map(&f);
    for _ in 0..STEPS {
        if values[0] <= values[1] {
            (high, inner[1], values[1]) = (inner[1], inner[0], values[0]);
            inner[0] = high - GOLDEN * (high - low);
            values[0] = f(inner[0]);
        } else {
            (low, inner[0], values[0]) = (inner[0], inner[1], values[1]);
            inner[1] = low + GOLDEN * (high - low);
            values[1] = f(inner[1]);
        }
    }
    let middle = 0.5 * (low + high);
    [0.0, 1.0].into_iter().fold(middle, |best, end| if f(end) < f(best) { end } else { best })
}

/// The nearest points of two segments (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
pub(super) fn of_segments(first: &Capsule, second: &Capsule) -> [Vec3; 2] {
    let minus = |a: Vec3, b: Vec3| add(a, scale(-1.0, b));
    let ([p1, q1], [p2, q2]) = (first.ends, second.ends);
    let (d1, d2, r) = (minus(q1, p1), minus(q2, p2), minus(p1, p2));
    let (a, e, f) = (dot(d1, d1), dot(d2, d2), dot(d2, r));
    let (b, c) = (dot(d1, d2), dot(d1, r));
    let part = |value: f64, length: f64| if length > 0.0 { (value / length).clamp(0.0, 1.0) } else { 0.0 };
    let determinant = a * e - b * b;
    let parallel = determinant <= 1e-14 * a * e;
    let mut s = if parallel { 0.0 } else { ((b * f - c * e) / determinant).clamp(0.0, 1.0) };
    let mut t = part(b * s + f, e);
    s = part(b * t - c, a);
    t = part(b * s + f, e);
    [first.at(s), second.at(t)]
}

/// The clearance of two capsules, the nearest point of each segment, and the direction in which the first leaves the second.
pub(super) fn of_capsules(first: &Capsule, second: &Capsule) -> (f64, [Vec3; 2], Vec3) {
    let points = of_segments(first, second);
    let apart = add(points[0], scale(-1.0, points[1]));
    let distance = norm(apart);
    let direction = if distance > 0.0 { scale(1.0 / distance, apart) } else { [0.0, 0.0, 1.0] };
    (distance - first.radius - second.radius, points, direction)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::collision::ObstacleShape;

    fn capsule(rng: &mut ChaCha8Rng) -> Capsule {
        let mut point = || [0, 1, 2].map(|_| rng.random_range(-1.0..1.0));
        Capsule { ends: [point(), point()], radius: 0.1 }
    }

    /// Number of sampled points of a segment.
    const TRIED: usize = 400;

    fn tried(capsule: &Capsule) -> Vec<Vec3> {
        (0..=TRIED).map(|k| capsule.at(k as f64 / TRIED as f64)).collect()
    }

    /// No sampled points of the segments are nearer; the sampled distance is too long by at most a step.
    #[test]
    fn segments_are_as_near_as_their_nearest_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for round in 0..60 {
            let (mut first, second) = (capsule(&mut rng), capsule(&mut rng));
            if round % 6 == 0 {
                first.ends[1] = first.ends[0];
            }
            if round % 6 == 1 {
                // Parallel ones.
                first.ends[1] = add(first.ends[0], add(second.ends[1], scale(-1.0, second.ends[0])));
            }
            let (clearance, ..) = of_capsules(&first, &second);
            let others = tried(&second);
            let all = tried(&first).into_iter().flat_map(|a| others.iter().map(move |b| norm(add(a, scale(-1.0, *b)))));
            let least = all.fold(f64::INFINITY, f64::min) - 0.2;
            assert!(clearance <= least + 1e-12 && least < clearance + 0.01, "{round}: {clearance} {least}");
        }
    }

    /// The distance to boxes and cylinders: compared with sampled points on their surface, and slopes with differences.
    #[test]
    fn obstacles_are_as_near_as_their_nearest_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let (sin, cos) = 0.7_f64.sin_cos();
        let rotation = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
        let centre = [0.2, -0.1, 0.3];
        let shapes = [
            ObstacleShape::Box { rotation, centre, half: [0.3, 0.2, 0.1] },
            ObstacleShape::Cylinder { rotation, centre, radius: 0.2, half: 0.4 },
            ObstacleShape::HalfSpace { normal: [0.0, sin, cos], offset: -0.3 },
        ];
        for shape in &shapes {
            for _ in 0..30 {
                let own = capsule(&mut rng);
                let (clearance, point, direction) = shape.clearance(&own);
                let least =
                    tried(&own).into_iter().map(|p| shape.distance(p).0).fold(f64::INFINITY, f64::min) - own.radius;
                assert!(clearance <= least + 1e-9 && least < clearance + 0.01, "{shape:?}: {clearance} {least}");
                // Inside, the nearest face changes, and the slope with it.
                for k in (0..3).filter(|_| shape.distance(point).0 > 1e-3) {
                    let h = 1e-6;
                    let moved = |h: f64| {
                        let mut point = point;
                        point[k] += h;
                        shape.distance(point).0
                    };
                    assert!(((moved(h) - moved(-h)) / (2.0 * h) - direction[k]).abs() < 1e-3, "{shape:?} {point:?}");
                }
            }
        }
        // A point above the lid of the cylinder, and one inside the box.
        let above = add(centre, thetahat_ground::vector::times(&rotation, [0.1, 0.0, 0.6]));
        assert!((shapes[1].distance(above).0 - 0.2).abs() < 1e-12);
        assert!((shapes[0].distance(centre).0 + 0.1).abs() < 1e-12);
    }
}
