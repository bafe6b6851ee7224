use super::{bias::SimulatorBias, coupling::Coupling, reference::Reference};
use thetahat_model::robot::Transmission;

/// The reference in the motors' coordinates, `p_ref = n (q_ref - offset)`, with the true transmission and the biases of a
/// simulator: `q_0 + scale (q - q_0) + offset`, later by a delay.
pub(super) struct MotorReference {
    reference: Reference,
    delay_s: f64,
    /// The time last evaluated: the last stages of a step, and the first of the next, share it.
    time_s: f64,
    /// Position of each motor in joint units at the time last evaluated.
    pub(super) p: Vec<f64>,
    /// Its velocity.
    pub(super) dp: Vec<f64>,
    /// Its acceleration.
    pub(super) ddp: Vec<f64>,
}

impl MotorReference {
    /// The reference with the biases applied; `delay_s` shifts it in time.
    pub(super) fn new(reference: &Reference, transmission: &Transmission, bias: &SimulatorBias, delay_s: f64) -> Self {
        let coupling = Coupling::new(&transmission.motor_in_joint_units(), 1.0);
        let to_motors = |joints: &[f64]| {
            let mut motors = vec![0.0; joints.len()];
            coupling.to_motors(joints, &mut motors);
            motors
        };
        let zeros = || vec![0.0; transmission.joints()];
        let [mut start, mut dq, mut ddq] = [zeros(), zeros(), zeros()];
        reference.evaluate(0.0, &mut start, &mut dq, &mut ddq);
        let (scale, offset) = (bias.reference_scale, bias.reference_offset);
        let biased = |q: f64, start: f64| if scale == 1.0 { q + offset } else { start + scale * (q - start) + offset };
        let position = |q: &[f64]| {
            let each = q.iter().zip(start.iter().zip(transmission.offset()));
            to_motors(&each.map(|(q, (start, zero))| biased(*q, *start) - zero).collect::<Vec<_>>())
        };
        let rate = |dq: &[f64]| to_motors(&dq.iter().map(|v| scale * v).collect::<Vec<_>>());
        let reference = reference.mapped(&position, &rate);
        Self { reference, delay_s, time_s: f64::NAN, p: zeros(), dp: zeros(), ddp: zeros() }
    }

    #[inline]
    pub(super) fn evaluate(&mut self, t: f64) {
        if t != self.time_s {
            self.time_s = t;
            self.reference.evaluate(t - self.delay_s, &mut self.p, &mut self.dp, &mut self.ddp);
        }
    }

    /// The derivatives in time of position, velocity and acceleration, at the time last evaluated.
    pub(super) fn rates(&self, [velocity, acceleration, jerk]: &mut [Vec<f64>; 3]) {
        self.reference.rates(self.time_s - self.delay_s, velocity, acceleration, jerk);
    }

    /// The largest motor velocity in joint units up to `end` s, at a thousand times.
    pub(super) fn fastest(&mut self, end: f64) -> f64 {
        let mut fastest: f64 = 0.0;
        for k in 0..=1000 {
            self.evaluate(end * f64::from(k) / 1000.0);
            fastest = self.dp.iter().fold(fastest, |a, v| a.max(v.abs()));
        }
        fastest
    }
}
