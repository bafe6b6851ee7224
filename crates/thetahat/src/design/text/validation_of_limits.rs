//! The limits of a design file, and what is refused of them.

use crate::design::{
    error::DesignError,
    limits::joint_limits::JointLimits,
    text::{
        description::Design,
        options::{LimitOptions, MotionKind},
    },
};
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_model::robot::Joint;
use thetahat_report::results::Limited;

/// Least part of every range that the search leaves unused, for what lies between the watched instants.
const LEAST_MARGIN: f64 = 0.002;

impl Design {
    /// The limits of every coordinate, SI: those of the design, or else of the robot's description.
    pub(in crate::design) fn limits(&self) -> Result<Vec<JointLimits>, DesignError> {
        let joints: Vec<&Joint> = self.robot.coordinates().collect();
        let options = &self.file.limits;
        self.require((0.0..0.5).contains(&options.margin), "[limits] margin", "from 0 to 0.5", options.margin)?;
        self.require_lengths(options, joints.len())?;
        let mut limits =
            joints.iter().enumerate().map(|(j, joint)| self.limits_of(joint, j)).collect::<Result<Vec<_>, _>>()?;
        for (limits, leader) in limits.iter_mut().zip(self.robot.coordinate_joints()) {
            self.robot.joints.iter().for_each(|joint| limits.hold_follower(joint, leader));
        }
        if let Some(start) = self.start_posture() {
            for (limits, start) in limits.iter_mut().zip(start) {
                self.require_start(limits, start)?;
                limits.start = Some(start);
            }
        }
        Ok(limits)
    }

    /// A start within what the margin leaves of the range.
    fn require_start(&self, limits: &JointLimits, start: f64) -> Result<(), DesignError> {
        let (kept, kind) = (limits.less(self.margin()), limits.kind);
        let [lower, upper, found] = [kept.lower, kept.upper, start].map(|value| kind.to_file(value));
        let expected = format!(
            "from {lower:.4} to {upper:.4} {} for joint {}: its limits less [limits] margin",
            kind.file_unit(),
            limits.joint
        );
        self.require((kept.lower..=kept.upper).contains(&start), "[motion] start", &expected, found)
    }

    /// The limits that the search keeps: less the margin, and less the overshoot of moves under a controller that is not known.
    pub(in crate::design) fn kept(&self, limits: &[JointLimits]) -> Vec<JointLimits> {
        let overshoot = self.assumed_overshoot().unwrap_or_default();
        let kept = |limits: &JointLimits| {
            let less = limits.less(self.margin());
            JointLimits { velocity: less.velocity / (1.0 + 0.01 * overshoot), ..less }
        };
        limits.iter().map(kept).collect()
    }

    /// By how many percent velocities of moves are assumed to overshoot, where no controller says by how much.
    pub(in crate::design) fn assumed_overshoot(&self) -> Option<f64> {
        let is_assumed = self.file.motion.kind == MotionKind::Moves && self.settings.controller.is_none();
        is_assumed.then_some(self.file.uncertainty.overshoot_percent).filter(|percent| *percent > 0.0)
    }

    /// Part of every range that the search leaves unused.
    pub(in crate::design) fn margin(&self) -> f64 {
        self.file.limits.margin.max(LEAST_MARGIN)
    }

    fn require_lengths(&self, options: &LimitOptions, joints: usize) -> Result<(), DesignError> {
        if let Some(position) = &options.position {
            self.require(position.len() == joints, "[limits] position", &format!("{joints} ranges"), position.len())?;
        }
        let lists = [
            ("[limits] velocity", &options.velocity),
            ("[limits] acceleration", &options.acceleration),
            ("[limits] jerk", &options.jerk),
            ("[limits] torque", &options.torque),
            ("[limits] power", &options.power),
            ("[rated] velocity", &self.file.rated.velocity),
            ("[rated] acceleration", &self.file.rated.acceleration),
        ];
        for (key, list) in lists {
            let Some(list) = list else { continue };
            self.require(list.fits(joints), key, &format!("one value, or {joints}"), list.given().len())?;
            for &value in list.given() {
                self.require(value > 0.0 && value.is_finite(), key, "a finite number above zero", value)?;
            }
        }
        Ok(())
    }

    /// Rated velocities and accelerations, SI, where they are known.
    pub(in crate::design) fn rated(&self) -> [Vec<Option<f64>>; 2] {
        let joints: Vec<&Joint> = self.robot.coordinates().collect();
        let given = |list: &Option<OneOrEach<f64>>, number: usize| {
            list.as_ref().map(|list| joints[number].kind.to_si(*list.of(number)))
        };
        let of_urdf = |number: usize| joints[number].limits.velocity.filter(|velocity| *velocity > 0.0);
        let rated = &self.file.rated;
        let velocity = (0..joints.len()).map(|j| given(&rated.velocity, j).or_else(|| of_urdf(j)));
        [velocity.collect(), (0..joints.len()).map(|j| given(&rated.acceleration, j)).collect()]
    }

    fn limits_of(&self, joint: &Joint, number: usize) -> Result<JointLimits, DesignError> {
        let options = &self.file.limits;
        let si = |value: f64| joint.kind.to_si(value);
        let given = |list: &Option<OneOrEach<f64>>| list.as_ref().map(|list| *list.of(number));
        let is_zero = |quantity| quantity == Limited::Velocity.name() && joint.limits.velocity == Some(0.0);
        let missing = |quantity| DesignError::NoLimit {
            states: if is_zero(quantity) { "0" } else { "none" },
            path: self.path.clone(),
            robot: self.robot_path.clone(),
            joint: joint.name.clone(),
            quantity,
        };
        let stated = joint.limits.lower.zip(joint.limits.upper);
        let [lower, upper] = match (&options.position, stated) {
            (Some(ranges), _) => ranges[number].map(si),
            (None, Some((lower, upper))) => [lower, upper],
            (None, None) => return Err(missing(Limited::Position.name())),
        };
        self.require_range(joint, [lower, upper])?;
        let velocity = given(&options.velocity).map(si).or(joint.limits.velocity);
        let velocity = velocity.filter(|v| *v > 0.0).ok_or_else(|| missing(Limited::Velocity.name()))?;
        let acceleration = given(&options.acceleration).map(si).ok_or_else(|| missing(Limited::Acceleration.name()))?;
        Ok(JointLimits {
            joint: joint.name.clone(),
            kind: joint.kind,
            start: None,
            lower,
            upper,
            velocity,
            acceleration,
            jerk: given(&options.jerk).map(si),
            torque: given(&options.torque).or(joint.limits.effort.filter(|effort| *effort > 0.0)),
            power: given(&options.power),
        })
    }

    /// A range of positions in which a joint can move.
    fn require_range(&self, joint: &Joint, [lower, upper]: [f64; 2]) -> Result<(), DesignError> {
        let remedy = match lower.partial_cmp(&upper) {
            Some(std::cmp::Ordering::Less) if lower.is_finite() && upper.is_finite() => return Ok(()),
            Some(std::cmp::Ordering::Equal) => "the joint cannot move; name it in [locked]",
            Some(std::cmp::Ordering::Less | std::cmp::Ordering::Greater) | None => {
                "give the smaller number first, both finite"
            }
        };
        let (limited, kind) = (Limited::Position, joint.kind);
        let [lower, upper] = [lower, upper].map(|value| limited.to_file(kind, value));
        let (path, unit) = (self.path.clone(), limited.file_unit(kind));
        Err(DesignError::Contradiction {
            path,
            joint: joint.name.clone(),
            quantity: limited.name(),
            lower,
            upper,
            unit,
            remedy,
        })
    }

    /// The posture in which the motion starts, rad or m.
    pub(in crate::design) fn start_posture(&self) -> Option<Vec<f64>> {
        self.file.motion.start.as_ref().map(|start| self.posture(start))
    }

    /// Degrees or mm as rad or m.
    pub(in crate::design) fn posture(&self, values: &[f64]) -> Vec<f64> {
        self.robot.coordinates().zip(values).map(|(joint, value)| joint.kind.to_si(*value)).collect()
    }
}
