//! The PD controller of a loop whose positions were fitted, as simulators describe it: gains and limits at the joints, and one delay.

use crate::experiment::IdentifiedRobot;
use thetahat_estimation::{
    control::{ControllerDescription, Law},
    identification::Response,
};

/// A PD controller with what was found of its loop.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PdLoop {
    /// One for each coordinate of the robot.
    pub(super) gains: Vec<Gains>,
    /// From a command to its torque, s.
    pub(super) delay_s: f64,
    /// Its sample time, s; none for a continuous one.
    pub(super) sample_time_s: Option<f64>,
    /// Whether it follows velocities or accelerations of the reference as well.
    pub(super) feeds_forward: bool,
}

/// The gains of a joint, in N m/rad and N m s/rad or their linear counterparts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gains {
    /// The joint of the coordinate.
    pub(super) joint: usize,
    pub(super) position: f64,
    pub(super) velocity: f64,
    /// The largest torque.
    pub(super) limit: Option<f64>,
    /// The position gain over that of the experiment.
    pub(super) ratio: f64,
}

impl PdLoop {
    /// That of a robot that was identified from positions under a PD controller of known gains.
    pub(super) fn of(identified: &IdentifiedRobot) -> Option<Self> {
        let controller = identified.settings.controller.as_ref()?;
        let is_pd = controller.own.is_none() && controller.law == Law::Pd;
        if identified.run.method.response() != Response::Position || !is_pd {
            return None;
        }
        let (robot, found) = (&identified.robot, FittedController { identified, controller });
        let ratios = robot.transmission.ratios()?;
        let joints = robot.coordinate_joints();
        let gains: Option<Vec<Gains>> = joints.iter().enumerate().map(|(c, &j)| found.gains(c, j, ratios[c])).collect();
        let added = identified.run.loop_parameters.iter().find(|p| p.name == "delay").map_or(0.0, |p| p.estimate);
        Some(Self {
            gains: gains?,
            delay_s: controller.delay_s + added,
            sample_time_s: Some(controller.sample_time_s).filter(|time| *time > 0.0),
            feeds_forward: controller.velocity_feed_forward != 0.0 || controller.acceleration_feed_forward != 0.0,
        })
    }
}

/// A controller, and what was estimated of it.
#[derive(Clone, Copy)]
struct FittedController<'a> {
    identified: &'a IdentifiedRobot,
    controller: &'a ControllerDescription,
}

impl FittedController<'_> {
    /// The gains of a motor, at its joint; none if they are not known.
    fn gains(self, motor: usize, joint: usize, stated_ratio: f64) -> Option<Gains> {
        let ratio = stated_ratio * self.factor("gear ratio", motor);
        let gain = self.identified.robot.transmission.drive_gain()[motor];
        let torque = ratio * gain * self.factor("drive gain", motor);
        let of_motor = |list: &[f64]| list.get(motor).or(list.first()).copied();
        let at_joint = |list: &[f64], name: &str| Some(of_motor(list)? * self.factor(name, motor) * torque * ratio);
        let position = at_joint(&self.controller.position_gain, "position gain")?;
        let stated = of_motor(&self.controller.position_gain)? * gain * stated_ratio * stated_ratio;
        Some(Gains {
            joint,
            position,
            velocity: at_joint(&self.controller.velocity_gain, "velocity gain")?,
            limit: of_motor(&self.controller.saturation).map(|limit| (limit * torque).abs()),
            ratio: position / stated,
        })
    }

    /// The estimated factor on a number of all motors, or of one.
    fn factor(self, name: &str, motor: usize) -> f64 {
        let found = &self.identified.run.loop_parameters;
        let of_one = format!("{name} {}", motor + 1);
        found.iter().find(|p| p.name == name || p.name == of_one).map_or(1.0, |p| p.estimate)
    }
}
