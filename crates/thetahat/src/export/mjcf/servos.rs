//! The controller of a loop whose positions were fitted, as actuators of a new MJCF: the commands of the log move the exported robot.

use crate::export::{
    pd_loop::{Gains, PdLoop},
    xml::{escaped, number},
};
use thetahat_model::robot::{JointQuantity, Quantity, Robot};

/// The step that is written, s.
const STEP_S: f64 = 0.001;
/// Time constant with which friction stops a joint, s: MuJoCo takes no less than two steps. Its default, 0.02 s, makes friction near rest
/// ten times as soft.
const FRICTION_TIME_S: f64 = 2.0 * STEP_S;

/// Actuators of a robot, and the settings of a simulation in which they move it as the identified loop moves.
pub(in crate::export) struct Servos {
    lines: Vec<String>,
    /// What they are, and what they lack of the controller, a sentence each.
    pub(in crate::export) about: Vec<String>,
}

impl Servos {
    /// Those of a loop of a robot with these standard parameters.
    pub(in crate::export) fn of(pd: &PdLoop, robot: &Robot, parameters: &[f64]) -> Self {
        let table = robot.parameter_table();
        let constant = |joint| table.value(parameters, Quantity::Joint(JointQuantity::Off), joint);
        let line = |gains: &Gains| actuator(gains, pd.delay_s, &robot.joints[gains.joint].name, constant(gains.joint));
        Self { lines: pd.gains.iter().map(line).collect(), about: about(pd) }
    }

    /// The attributes of `<option>` other than gravity.
    pub(super) fn options(&self) -> String {
        format!(" timestep=\"{}\" integrator=\"RK4\"", number(STEP_S))
    }

    /// How joints have their friction.
    pub(super) fn defaults(&self) -> String {
        let friction = number(FRICTION_TIME_S);
        format!("  <default>\n    <joint solreffriction=\"{friction} 1\"/>\n  </default>")
    }

    /// The actuators.
    pub(super) fn actuators(&self) -> String {
        format!("  <actuator>\n{}\n  </actuator>", self.lines.join("\n"))
    }
}

/// The actuator of a joint; `constant` is the joint's constant torque, which the motor overcomes.
fn actuator(gains: &Gains, delay_s: f64, joint: &str, constant: f64) -> String {
    let limited = gains.limit.map_or_else(String::new, |limit| {
        format!(" forcelimited=\"true\" forcerange=\"-{limit} {limit}\"", limit = number(limit))
    });
    // The command of now and those of the delay, and one more for rounding.
    let samples = (delay_s / STEP_S).ceil() + 2.0;
    let delayed =
        if delay_s > 0.0 { format!(" delay=\"{}\" nsample=\"{samples}\"", number(delay_s)) } else { String::new() };
    let [kp, kv, constant] = [gains.position, gains.velocity, -constant].map(number);
    let name = escaped(joint);
    format!(
        "    <general name=\"{name}\" joint=\"{name}\" biastype=\"affine\" gainprm=\"{kp}\" biasprm=\"{constant} -{kp} -{kv}\"{limited}{delayed}/>"
    )
}

fn about(pd: &PdLoop) -> Vec<String> {
    let mut lines = vec![
        "actuators: the PD controller of the identification with the constant torques of the joints; their commands are \
         positions, in each step those of its middle"
            .to_owned(),
        "integrator RK4, step and solreffriction: those with which MuJoCo moves as the identified loop; with a step above 1 ms \
         take solreffriction of two steps or more"
            .to_owned(),
    ];
    if pd.delay_s > 0.0 {
        lines.push(format!(
            "the delay of the actuators, {} s, needs MuJoCo 3.5 or later; nsample is for the step of the file",
            number(pd.delay_s)
        ));
    }
    if pd.delay_s < 0.0 {
        lines.push(format!("the delay that was found is below zero, {} s: the file has none", number(pd.delay_s)));
    }
    if pd.feeds_forward {
        lines.push("the actuators follow positions alone: the controller's feed-forward is not in the file".to_owned());
    }
    lines
}
