//! The links' own frames, as files have them: inertial parameters refer to their axes.

use thetahat_ground::vector::{IDENTITY, Mat3, Vec3, product, transpose, transpose_times};
use thetahat_model::robot::Robot;

/// The name of link `k` in a file that is written anew.
pub(super) fn link_name(k: usize) -> String {
    format!("link_{}", k + 1)
}

/// A link's frame at coordinate zero, in the frame of the link that carries it, or of the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinkFrame {
    /// From the link's axes to those of its carrier.
    pub(super) rotation: Mat3,
    /// Its origin in the carrier's frame, m.
    pub(super) origin: Vec3,
    /// The joint's axis in the link's own axes.
    pub(super) axis: Vec3,
}

impl LinkFrame {
    /// The frame of link `k`.
    pub(super) fn of(robot: &Robot, k: usize) -> Self {
        let joint = &robot.joints[k];
        let axes = |k: usize| robot.joints[k].link_axes.unwrap_or(IDENTITY);
        let of_carrier = joint.parent.map_or(IDENTITY, axes);
        let own = axes(k);
        let from_joint = product(&transpose(&of_carrier), &joint.placement.rotation());
        Self {
            rotation: product(&from_joint, &own),
            origin: transpose_times(&of_carrier, joint.placement.origin),
            axis: own[2],
        }
    }

    /// The frame of the root body of a base that floats, in the pose zero.
    pub(super) fn of_root(robot: &Robot, root: usize) -> Self {
        Self { rotation: IDENTITY, origin: [0.0; 3], ..Self::of(robot, root) }
    }

    /// The angles of `Rot(z, yaw) Rot(y, pitch) Rot(x, roll)`: roll, pitch, yaw, rad.
    pub(super) fn roll_pitch_yaw(&self) -> Vec3 {
        let r = &self.rotation;
        let level = r[0][0].hypot(r[1][0]);
        let pitch = (-r[2][0]).atan2(level);
        let yaw = if level < UPRIGHT { 0.0 } else { r[1][0].atan2(r[0][0]) };
        // Roll from Rot(z, -yaw) R, so that both angles together are exact where each alone is not.
        let (s, c) = yaw.sin_cos();
        let [y, z] = [1, 2].map(|j| c * r[1][j] - s * r[0][j]);
        [(-z).atan2(y), pitch, yaw]
    }

    /// The rotation as a unit quaternion: w, x, y, z.
    pub(super) fn quaternion(&self) -> [f64; 4] {
        quaternion_of(&self.rotation)
    }
}

/// A rotation as a unit quaternion: w, x, y, z.
pub(super) fn quaternion_of(r: &Mat3) -> [f64; 4] {
    let [xx, yy, zz] = [r[0][0], r[1][1], r[2][2]];
    let squares = [1.0 + xx + yy + zz, 1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz];
    let largest = (0..4).fold(0, |best, k| if squares[k] > squares[best] { k } else { best });
    let [wx, wy, wz] = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    let [xy, xz, yz] = [r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]];
    let own = squares[largest];
    let unscaled = match largest {
        0 => [own, wx, wy, wz],
        1 => [wx, own, xy, xz],
        2 => [wy, xy, own, yz],
        _ => [wz, xz, yz, own],
    };
    let length = unscaled.iter().map(|v| v * v).sum::<f64>().sqrt();
    unscaled.map(|v| v / length)
}

/// Cosine of the pitch below which yaw and roll turn about the same axis.
const UPRIGHT: f64 = 1e-15;

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::vector::quaternion_rotation;

    fn turn(roll: f64, pitch: f64, yaw: f64) -> Mat3 {
        let about = |axis: usize, angle: f64| -> Mat3 {
            let (s, c) = angle.sin_cos();
            let mut out = IDENTITY;
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            (out[a][a], out[a][b], out[b][a], out[b][b]) = (c, -s, s, c);
            out
        };
        product(&product(&about(2, yaw), &about(1, pitch)), &about(0, roll))
    }

    #[test]
    fn any_rotation_comes_back_from_angles_and_from_a_quaternion() {
        use std::f64::consts::{FRAC_PI_2, PI};
        let angles = [0.0, 0.3, -2.5, FRAC_PI_2, PI, FRAC_PI_2 - 1e-9, -FRAC_PI_2 + 1e-12, 1e-17];
        for roll in angles {
            for pitch in angles {
                for yaw in angles {
                    let rotation = turn(roll, pitch, yaw);
                    let frame = LinkFrame { rotation, origin: [0.0; 3], axis: [0.0, 0.0, 1.0] };
                    let [r, p, y] = frame.roll_pitch_yaw();
                    for back in [turn(r, p, y), quaternion_rotation(frame.quaternion())] {
                        let pairs = rotation.as_flattened().iter().zip(back.as_flattened());
                        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                        assert!(worst < 4e-15, "{roll} {pitch} {yaw}: {worst:e}");
                    }
                }
            }
        }
    }
}
