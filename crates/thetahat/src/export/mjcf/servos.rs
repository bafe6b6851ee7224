//! The controller of a loop whose positions were fitted, as actuators of a new MJCF: the commands of the log move the exported robot.

use crate::export::{
    pd_loop::{Gains, PdLoop},
    xml::{escaped, number},
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Workspace},
    robot::{JointQuantity, Quantity, Robot},
};

/// The step that is written, s.
const STEP_S: f64 = 0.001;
/// Time constant with which friction stops a joint, s: MuJoCo takes no less than two steps. Its default, 0.02 s, makes friction near rest
/// ten times as soft.
const FRICTION_TIME_S: f64 = 2.0 * STEP_S;

/// Largest rate of the damping times the step at which RK4 is taken: it diverges at 2.8, and the posture changes the rate.
const FASTEST: f64 = 1.0;

/// Powers of a matrix that are taken for its largest eigenvalue.
const POWERS: usize = 30;

/// Actuators of a robot, and the settings of a simulation in which they move it as the identified loop moves.
pub(in crate::export) struct Servos {
    lines: Vec<String>,
    integrator: Integrator,
    /// What they are, and what they lack of the controller, a sentence each.
    pub(in crate::export) about: Vec<String>,
}

/// The integrator that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Integrator {
    /// Follows the loop closely.
    Rk4,
    /// Stable where damping is fast against the step.
    ImplicitFast,
}

impl Integrator {
    fn of(pd: &PdLoop, robot: &Robot, parameters: &[f64]) -> Self {
        match damping_rate(pd, robot, parameters) {
            Some(rate) if rate * STEP_S <= FASTEST => Self::Rk4,
            Some(_) | None => Self::ImplicitFast,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Rk4 => "RK4",
            Self::ImplicitFast => "implicitfast",
        }
    }
}

/// The largest rate with which damping and velocity gains stop the robot at its zero position, 1/s: the largest eigenvalue of `M^-1 D`,
/// by powers; none if the mass matrix has no inverse.
fn damping_rate(pd: &PdLoop, robot: &Robot, parameters: &[f64]) -> Option<f64> {
    let (model, table, n) = (Model::new(robot), robot.parameter_table(), robot.coordinate_count());
    let (mut mass, mut workspace) = (vec![0.0; n * n], Workspace::new(&model));
    let sorted = DynamicParameters::sorted(&model, parameters);
    let mut position = vec![0.0; n];
    model.reach(&mut position);
    model.mass_matrix(&sorted, &position, &mut workspace, &mut mass);
    let inverse = Matrix::from_fn(n, n, |i, j| mass[i * n + j]).inverse()?;
    let damping = |joint| table.value(parameters, Quantity::Joint(JointQuantity::Fv), joint);
    let damping: Vec<f64> = pd.gains.iter().map(|gains| damping(gains.joint) + gains.velocity).collect();
    let (mut rate, mut velocity) = (0.0, vec![1.0; n]);
    for _ in 0..POWERS {
        let torque: Vec<f64> = velocity.iter().zip(&damping).map(|(v, d)| v * d).collect();
        velocity = inverse.times(&torque);
        rate = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        velocity.iter_mut().for_each(|v| *v /= rate);
    }
    Some(rate)
}

impl Servos {
    /// Those of a loop of a robot with these standard parameters.
    pub(in crate::export) fn of(pd: &PdLoop, robot: &Robot, parameters: &[f64]) -> Self {
        let table = robot.parameter_table();
        let constant = |joint| table.value(parameters, Quantity::Joint(JointQuantity::Off), joint);
        let line = |gains: &Gains| actuator(gains, pd.delay_s, &robot.joints[gains.joint].name, constant(gains.joint));
        let integrator = Integrator::of(pd, robot, parameters);
        Self { lines: pd.gains.iter().map(line).collect(), integrator, about: about(pd, integrator) }
    }

    /// The attributes of `<option>` other than gravity.
    pub(super) fn options(&self) -> String {
        format!(" timestep=\"{}\" integrator=\"{}\"", number(STEP_S), self.integrator.name())
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

fn about(pd: &PdLoop, integrator: Integrator) -> Vec<String> {
    let mut lines = vec![
        "actuators: the PD controller of the identification with the constant torques of the joints; their commands are \
         positions, in each step those of its middle"
            .to_owned(),
        "integrator, step and solreffriction: those with which MuJoCo moves as the identified loop; with a step above 1 ms \
         take solreffriction of two steps or more"
            .to_owned(),
    ];
    if integrator == Integrator::ImplicitFast {
        lines.push(
            "integrator implicitfast: the damping is too fast for RK4; rollouts are half a step from the identified loop"
                .to_owned(),
        );
    }
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
