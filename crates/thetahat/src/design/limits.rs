use crate::robot::Joint;

/// What a joint may do, SI: rad or m, N m or N, W.
#[derive(Debug, Clone, PartialEq)]
pub struct JointLimits {
    /// Name of the joint.
    pub joint: String,
    /// Smallest coordinate.
    pub lower: f64,
    /// Largest coordinate.
    pub upper: f64,
    /// Largest velocity.
    pub velocity: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk.
    pub jerk: Option<f64>,
    /// Largest torque, friction included.
    pub torque: Option<f64>,
    /// Largest product of torque and velocity.
    pub power: Option<f64>,
}

/// A quantity that is limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Limited {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Jerk.
    Jerk,
    /// Torque.
    Torque,
    /// Product of torque and velocity.
    Power,
}

impl Limited {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Position, Self::Velocity, Self::Acceleration, Self::Jerk, Self::Torque, Self::Power];

    /// Its name, as in a design file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Torque => "torque",
            Self::Power => "power",
        }
    }

    /// Which derivative of the position it is; none where dynamics come in.
    #[must_use]
    pub fn order(self) -> Option<usize> {
        match self {
            Self::Position => Some(0),
            Self::Velocity => Some(1),
            Self::Acceleration => Some(2),
            Self::Jerk => Some(3),
            Self::Torque | Self::Power => None,
        }
    }
}

impl JointLimits {
    /// Takes a smaller range of positions and a lower velocity where a joint that follows the coordinate of joint `leader` has
    /// them.
    pub(super) fn hold_follower(&mut self, follower: &Joint, leader: usize) {
        let Some(mimic) = follower.mimic.filter(|mimic| mimic.of == leader && mimic.ratio != 0.0) else { return };
        let ends = [follower.limits.lower, follower.limits.upper].map(|end| Some((end? - mimic.offset) / mimic.ratio));
        let [lower, upper] = if mimic.ratio > 0.0 { ends } else { [ends[1], ends[0]] };
        self.lower = lower.map_or(self.lower, |lower| self.lower.max(lower));
        self.upper = upper.map_or(self.upper, |upper| self.upper.min(upper));
        if let Some(velocity) = follower.limits.velocity.filter(|velocity| *velocity > 0.0) {
            self.velocity = self.velocity.min(velocity / mimic.ratio.abs());
        }
    }

    /// Lower and upper limit of a quantity, where there is one.
    #[must_use]
    pub fn range(&self, limited: Limited) -> Option<[f64; 2]> {
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
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    /// Whether torque or power is limited.
    #[must_use]
    pub fn has_dynamic(&self) -> bool {
        self.torque.is_some() || self.power.is_some()
    }

    /// The limits less a part of each range.
    #[must_use]
    pub fn less(&self, part: f64) -> Self {
        let keep = 1.0 - part;
        let half = 0.5 * keep * (self.upper - self.lower);
        let kept = |limit: Option<f64>| limit.map(|l| keep * l);
        Self {
            joint: self.joint.clone(),
            lower: self.middle() - half,
            upper: self.middle() + half,
            velocity: keep * self.velocity,
            acceleration: keep * self.acceleration,
            jerk: kept(self.jerk),
            torque: kept(self.torque),
            power: kept(self.power),
        }
    }
}
