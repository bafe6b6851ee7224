//! The controller of a loop whose positions were fitted, as actuators of a new MJCF: the commands of the log move the exported robot.

use super::xml::{escaped, number};
use crate::experiment::IdentifiedRobot;
use thetahat_estimation::{
    control::{ControllerDescription, Law},
    identification::Response,
};

/// Actuators of a robot.
pub(super) struct Servos {
    lines: Vec<String>,
    /// What they are, and what they lack of the controller, a sentence each.
    pub(super) about: Vec<String>,
}

impl Servos {
    /// Those of a robot that was identified from positions under a PD controller of known gains.
    pub(super) fn of(identified: &IdentifiedRobot) -> Option<Self> {
        let controller = identified.settings.controller.as_ref()?;
        let is_pd = controller.own.is_none() && controller.law == Law::Pd;
        let has_gains = !controller.position_gain.is_empty() && !controller.velocity_gain.is_empty();
        if identified.run.method.response() != Response::Position || !is_pd || !has_gains {
            return None;
        }
        let robot = &identified.robot;
        let ratios = robot.transmission.ratios()?;
        let line = |(c, joint): (usize, usize)| {
            let [kp, kv, limit] = Loop { identified, controller }.at_joint(c, ratios[c]);
            let limited = limit.map_or_else(String::new, |limit| {
                format!(" forcelimited=\"true\" forcerange=\"-{limit} {limit}\"", limit = number(limit))
            });
            let [kp, kv] = [kp, kv].map(|gain| number(gain.unwrap_or_default()));
            let name = escaped(&robot.joints[joint].name);
            format!(
                "    <general name=\"{name}\" joint=\"{name}\" biastype=\"affine\" gainprm=\"{kp}\" biasprm=\"0 -{kp} -{kv}\"{limited}/>"
            )
        };
        let lines = robot.coordinate_joints().into_iter().enumerate().map(line).collect();
        Some(Self { lines, about: about(identified, controller) })
    }

    /// A new MJCF with the actuators.
    pub(super) fn put_into(&self, mjcf: &str) -> String {
        let actuators = format!("  <actuator>\n{}\n  </actuator>\n</mujoco>", self.lines.join("\n"));
        mjcf.replacen("</mujoco>", &actuators, 1)
    }
}

/// A controller with what was found of its loop.
#[derive(Clone, Copy)]
struct Loop<'a> {
    identified: &'a IdentifiedRobot,
    controller: &'a ControllerDescription,
}

impl Loop<'_> {
    /// Position gain, velocity gain and largest torque of a motor, at its joint.
    fn at_joint(self, motor: usize, ratio: f64) -> [Option<f64>; 3] {
        let ratio = ratio * self.factor("gear ratio", motor);
        let torque = ratio * self.identified.robot.transmission.drive_gain()[motor] * self.factor("drive gain", motor);
        let of_motor = |list: &[f64]| list.get(motor).or(list.first()).copied();
        let gain = |list: &[f64], name: &str| Some(of_motor(list)? * self.factor(name, motor) * torque * ratio);
        [
            gain(&self.controller.position_gain, "position gain"),
            gain(&self.controller.velocity_gain, "velocity gain"),
            of_motor(&self.controller.saturation).map(|limit| (limit * torque).abs()),
        ]
    }

    /// The estimated factor on a number of all motors, or of one.
    fn factor(self, name: &str, motor: usize) -> f64 {
        let found = &self.identified.run.loop_parameters;
        let of_one = format!("{name} {}", motor + 1);
        found.iter().find(|p| p.name == name || p.name == of_one).map_or(1.0, |p| p.estimate)
    }
}

fn about(identified: &IdentifiedRobot, controller: &ControllerDescription) -> Vec<String> {
    let added = identified.run.loop_parameters.iter().find(|p| p.name == "delay").map_or(0.0, |p| p.estimate);
    let delay_s = controller.delay_s + added;
    let mut lines = vec!["actuators: the PD controller of the identification; their commands are positions".to_owned()];
    if delay_s != 0.0 {
        lines.push(format!("the actuators have no delay: apply commands {} s later", number(delay_s)));
    }
    if controller.velocity_feed_forward != 0.0 || controller.acceleration_feed_forward != 0.0 {
        lines.push("the actuators follow positions alone: the controller's feed-forward is not in the file".to_owned());
    }
    lines
}
