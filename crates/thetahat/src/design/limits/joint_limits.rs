use thetahat_model::robot::{Joint, JointKind, Share};
use thetahat_report::results::Limited;

/// The limits of a joint, SI: rad or m, N m or N, W.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::design) struct JointLimits {
    /// Name of the joint.
    pub(in crate::design) joint: String,
    /// How it moves.
    pub(in crate::design) kind: JointKind,
    /// The coordinate at which the motion starts, where it is given: within every range.
    pub(in crate::design) start: Option<f64>,
    /// Smallest coordinate.
    pub(in crate::design) lower: f64,
    /// Largest coordinate.
    pub(in crate::design) upper: f64,
    /// Largest velocity.
    pub(in crate::design) velocity: f64,
    /// Largest acceleration.
    pub(in crate::design) acceleration: f64,
    /// Largest jerk.
    pub(in crate::design) jerk: Option<f64>,
    /// Largest torque, friction included.
    pub(in crate::design) torque: Option<f64>,
    /// Largest product of torque and velocity.
    pub(in crate::design) power: Option<f64>,
}

impl JointLimits {
    /// Narrows the range of positions and the velocity to those of a joint that follows the coordinate of joint `leader`. Of a joint that
    /// follows several, each has an equal part of the range and of the velocity, so that the sum keeps within them.
    pub(in crate::design) fn hold_follower(&mut self, follower: &Joint, leader: usize) {
        let Some(mimic) = follower.mimic else { return };
        let share = follower.follows().find(|share| share.of == leader && share.ratio != 0.0);
        let Some(Share { ratio, .. }) = share else { return };
        let ratio = ratio * follower.follows().count() as f64;
        let ends = [follower.limits.lower, follower.limits.upper].map(|end| Some((end? - mimic.offset) / ratio));
        let [lower, upper] = if ratio > 0.0 { ends } else { [ends[1], ends[0]] };
        self.lower = lower.map_or(self.lower, |lower| self.lower.max(lower));
        self.upper = upper.map_or(self.upper, |upper| self.upper.min(upper));
        if let Some(velocity) = follower.limits.velocity.filter(|velocity| *velocity > 0.0) {
            self.velocity = self.velocity.min(velocity / ratio.abs());
        }
    }

    /// Lower and upper limit of a quantity, if it is limited.
    pub(in crate::design) fn range(&self, limited: Limited) -> Option<[f64; 2]> {
        let symmetric = |limit: f64| [-limit, limit];
        match limited {
            Limited::Position => Some([self.lower, self.upper]),
            Limited::Velocity => Some(symmetric(self.velocity)),
            Limited::Acceleration => Some(symmetric(self.acceleration)),
            Limited::Jerk => self.jerk.map(symmetric),
            Limited::Torque => self.torque.map(symmetric),
            Limited::Power => self.power.map(symmetric),
        }
    }

    /// The middle of the range of positions.
    pub(in crate::design) fn middle(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    /// Whether torque or power is limited.
    pub(in crate::design) fn has_dynamic(&self) -> bool {
        self.torque.is_some() || self.power.is_some()
    }

    /// The limits with a part of each range removed; the range of positions keeps the start.
    pub(in crate::design) fn less(&self, part: f64) -> Self {
        let keep = 1.0 - part;
        let half = 0.5 * keep * (self.upper - self.lower);
        let (lower, upper) = (self.middle() - half, self.middle() + half);
        let kept = |limit: Option<f64>| limit.map(|l| keep * l);
        Self {
            joint: self.joint.clone(),
            kind: self.kind,
            start: self.start,
            lower: self.start.map_or(lower, |start| lower.min(start)),
            upper: self.start.map_or(upper, |start| upper.max(start)),
            velocity: keep * self.velocity,
            acceleration: keep * self.acceleration,
            jerk: kept(self.jerk),
            torque: kept(self.torque),
            power: kept(self.power),
        }
    }
}
