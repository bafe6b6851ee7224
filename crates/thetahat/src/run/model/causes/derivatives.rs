//! The derivatives of the predicted torque by errors of the base, of the torque sensors and drives, and by springs.

use super::torques::{STEP, Torques};
use thetahat_ground::vector::{IDENTITY, axis_angle, norm, times};
use thetahat_model::{dynamics::Model, robot::Robot};

impl Torques<'_> {
    /// Whether the base may be tilted about an axis of its frame: about the two that are furthest from gravity.
    pub(super) fn can_tilt_about(&self, axis: usize) -> bool {
        let along = self.robot.gravity.map(f64::abs);
        let nearest = (0..3).fold(0, |nearest, k| if along[k] > along[nearest] { k } else { nearest });
        norm(self.robot.gravity) > 0.0 && axis != nearest
    }

    /// A base that is turned about an axis of its frame: in it gravity is turned back.
    pub(super) fn tilt(&self, axis: usize) -> Option<Vec<f64>> {
        let gravity = times(&axis_angle(IDENTITY[axis], -STEP), self.robot.gravity);
        let model = Model::new(&Robot { gravity, ..self.robot.clone() });
        self.difference(STEP, |r| self.of(&model, self.standard, &r.motion, r))
    }

    /// The torque of one joint in that of another.
    pub(super) fn crosstalk(&self, from: usize, into: usize) -> Option<Vec<f64>> {
        self.of_predicted(into, |torques| torques[from])
    }

    /// A recorded torque that is too large by a part that grows with its square, which is one at the largest torque.
    pub(super) fn falling_constant(&self, joint: usize) -> Option<Vec<f64>> {
        let torques = self.predicted.iter().flat_map(|p| (0..p.len()).map(|k| p.sample(k)[joint].abs()));
        let largest = torques.fold(f64::MIN_POSITIVE, f64::max);
        self.of_predicted(joint, |torques| torques[joint] * (torques[joint] / largest).powi(2))
    }

    /// Viscous friction that is larger in one direction.
    pub(super) fn asymmetric(&self, joint: usize) -> Option<Vec<f64>> {
        self.each(|r, k, j| if j == joint { r.motion.dq.sample(k)[joint].abs() } else { 0.0 })
    }

    /// A spring whose rest is anywhere, which the torque's offset takes.
    pub(super) fn spring(&self, joint: usize) -> Option<Vec<f64>> {
        self.each(|r, k, j| if j == joint { r.motion.q.sample(k)[joint] } else { 0.0 })
    }
}
