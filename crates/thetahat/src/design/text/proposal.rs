//! The design file that is proposed for a robot alone: what its description does not state is a guess, and said to be one.

use std::path::Path;

use crate::design::{Design, DesignError};
use thetahat_model::{
    consistency::completed_a_priori,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{Joint, JointKind, Limits, Locks, Robot, RobotSource},
};

/// Range of a joint without a stated one, degrees or mm to both sides of zero: small, as the robot will travel it.
const RANGE: [f64; 2] = [45.0, 50.0];
/// Velocity of a joint without a stated one, degrees/s or mm/s: slow.
const VELOCITY: [f64; 2] = [60.0, 100.0];
/// Time in which an industrial robot reaches its velocity, s.
const RISE_S: f64 = 0.4;
/// Noise of a torque over its largest value.
const NOISE: f64 = 0.01;
/// Noise of a position, degrees or mm: an encoder of 2^18 counts a turn at the joint.
const POSITION_NOISE: f64 = 0.0005;
/// States in which torques are computed.
const STATES: usize = 200;

impl Design {
    /// The text of a design file for a robot alone, which the file at `path` calls `robot_file`. Ranges, velocities and torques are limited as the
    /// description states; what it does not state is written as a guess.
    ///
    /// # Errors
    /// [`DesignError`] for a robot that cannot be designed for.
    pub fn proposed(source: &RobotSource, robot_file: &Path, path: &Path) -> Result<String, DesignError> {
        let robot = source.robot_with_locks(&Locks { locked: Default::default(), until: Vec::new() }, path)?;
        let limits: Vec<Proposed> = robot.coordinates().map(Proposed::of).collect();
        let text = text(&robot, &robot_file.display().to_string(), &limits);
        Self::parse(&text, path).map(|_| text)
    }
}

/// The limits of a joint in the units of a design file.
struct Proposed {
    joint: String,
    range: [f64; 2],
    is_range_stated: bool,
    velocity: f64,
    is_velocity_stated: bool,
    is_torque_stated: bool,
    /// From these units to SI.
    to_si: f64,
}

impl Proposed {
    fn of(joint: &Joint) -> Self {
        let (unit, to_si) = match joint.kind {
            JointKind::Revolute => (0, 1_f64.to_radians()),
            JointKind::Prismatic => (1, 1e-3),
        };
        let range = joint.limits.lower.zip(joint.limits.upper).filter(|(lower, upper)| lower < upper);
        let velocity = Limits::usable(joint.limits.velocity);
        Self {
            joint: joint.name.clone(),
            range: range.map_or([-RANGE[unit], RANGE[unit]], |(lower, upper)| [lower, upper].map(|v| v / to_si)),
            is_range_stated: range.is_some(),
            velocity: velocity.map_or(VELOCITY[unit], |velocity| velocity / to_si),
            is_velocity_stated: velocity.is_some(),
            is_torque_stated: Limits::usable(joint.limits.effort).is_some(),
            to_si,
        }
    }

    fn acceleration(&self) -> f64 {
        self.velocity / RISE_S
    }
}

fn text(robot: &Robot, robot_file: &str, limits: &[Proposed]) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut text = format!(
        "# Proposed by thetahat for the robot alone. Read every line: a guess is what its description does not state.\n\
         title = {}\nrobot = {}\nduration_s = 20 # a guess: longer motions have narrower intervals\n\
         sample_rate_hz = 500 # a guess: the rate at which the robot is recorded\n\n{}",
        quoted(&format!("{}: the motion to record", robot.name)),
        quoted(robot_file),
        of_limits(limits),
    );
    let noise: Vec<f64> = largest_torques(robot, limits).into_iter().map(|torque| NOISE * torque).collect();
    text += &format!(
        "\n# A guess, standard deviations per sample: torques, N m or N, of 1 % of the largest; positions, degrees or mm.\n\
         [noise]\ntorque = {}\nposition = {POSITION_NOISE}\n\n\
         # How the recording will be filtered.\n[signal]\ncutoff_hz = 20\ndecimation = 10\n\n\
         # A guess, to simulate the tracking errors: the usual loop of an industrial robot.\n\
         [controller]\nlaw = \"pd\"\nbandwidth_hz = [10]\ndamping = 1.0\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0\n",
        list(&noise),
    );
    text
}

/// The table of limits: all joints of a quantity that some of them lack.
fn of_limits(limits: &[Proposed]) -> String {
    let mut text =
        "# Degrees or mm. What is not here is limited as the robot's description states.\n[limits]\n".to_owned();
    let without = |is_stated: fn(&Proposed) -> bool| {
        limits.iter().filter(|l| !is_stated(l)).map(|l| l.joint.as_str()).collect::<Vec<_>>().join(" ")
    };
    let [ranges, velocities, torques] =
        [|l: &Proposed| l.is_range_stated, |l: &Proposed| l.is_velocity_stated, |l: &Proposed| l.is_torque_stated]
            .map(without);
    if !ranges.is_empty() {
        let all: Vec<String> = limits.iter().map(|l| list(&l.range)).collect();
        text += &format!("position = [{}] # a guess of {ranges}\n", all.join(", "));
    }
    if !velocities.is_empty() {
        let all: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
        text += &format!("velocity = {} # a guess of {velocities}\n", list(&all));
    }
    let accelerations: Vec<f64> = limits.iter().map(Proposed::acceleration).collect();
    text += &format!("acceleration = {} # a guess: the velocity is reached in {RISE_S} s\n", list(&accelerations));
    if !torques.is_empty() {
        text += &format!(
            "# torque = [...] # N m or N: without it torques are not limited where the description states none: {torques}\n"
        );
    }
    text
}

/// The largest torque of each joint in states within the limits, of the a-priori parameters; where these give none that of the description.
fn largest_torques(robot: &Robot, limits: &[Proposed]) -> Vec<f64> {
    let (model, n) = (Model::new(robot), limits.len());
    let theta = DynamicParameters::sorted(&model, &completed_a_priori(robot, None));
    let (mut workspace, mut torque, mut largest) = (Workspace::new(&model), vec![0.0; n], vec![0.0_f64; n]);
    for k in 0..STATES {
        // Low-discrepancy sequences with a step for each number of the state.
        let part = |place: usize| (0.5 + k as f64 * ((place + 1) as f64 * 0.618_034).fract()).fract();
        let symmetric = |place: usize, limit: f64| (2.0 * part(place) - 1.0) * limit;
        let each = |value: &dyn Fn(usize, &Proposed) -> f64| -> Vec<f64> {
            limits.iter().enumerate().map(|(j, l)| l.to_si * value(j, l)).collect()
        };
        let q = each(&|j, l| l.range[0] + part(j) * (l.range[1] - l.range[0]));
        let dq = each(&|j, l| symmetric(n + j, l.velocity));
        let ddq = each(&|j, l| symmetric(2 * n + j, l.acceleration()));
        model.inverse_dynamics(&theta, State::new(&q, &dq), &ddq, Sign::Exact, &mut workspace, &mut torque);
        largest.iter_mut().zip(&torque).for_each(|(most, torque)| *most = most.max(torque.abs()));
    }
    let stated = |joint: &Joint| Limits::usable(joint.limits.effort).unwrap_or(1.0);
    let of_joint = |(largest, joint): (f64, &Joint)| if largest > 0.0 { largest } else { stated(joint) };
    largest.into_iter().zip(robot.coordinates()).map(of_joint).collect()
}

/// Numbers of three significant digits after which zeros are left out.
fn list(values: &[f64]) -> String {
    let short = |value: &f64| {
        let scale = 10_f64.powf(2.0 - value.abs().max(f64::MIN_POSITIVE).log10().floor());
        if *value == 0.0 { "0".to_owned() } else { format!("{}", (value * scale).round() / scale) }
    };
    format!("[{}]", values.iter().map(short).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_testing::{Folder, project};

    fn proposed(robot: &str, change: impl Fn(String) -> String) -> Result<String, DesignError> {
        let folder = Folder::new();
        let text = change(std::fs::read_to_string(project(robot)).unwrap());
        let name = Path::new(robot).file_name().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        let source = RobotSource::read(&folder.path().join(name)).unwrap();
        Design::proposed(&source, Path::new(name), &folder.path().join("design.toml"))
    }

    #[test]
    fn limits_of_the_description_are_left_to_it() {
        let text = proposed("examples/arm/arm.urdf", |text| text).unwrap();
        assert!(text.contains("acceleration = [") && text.contains("robot = \"arm.urdf\""), "{text}");
        for absent in ["position = [[", "velocity = [", "torque = [...]"] {
            assert!(!text.contains(absent), "{absent}: {text}");
        }
    }

    #[test]
    fn what_the_description_lacks_is_a_guess_of_the_joints_that_lack_it() {
        let unlimited = |text: String| {
            let start = text.find("<limit").unwrap();
            let end = start + text[start..].find("/>").unwrap() + 2;
            format!("{}{}", &text[..start], &text[end..]).replacen("\"revolute\"", "\"continuous\"", 1)
        };
        let text = proposed("examples/arm/arm.urdf", unlimited).unwrap();
        let first = proposed("examples/arm/arm.urdf", |text| text).unwrap();
        for part in ["position = [[-45, 45], ", "velocity = [60, ", "# torque = [...]"] {
            assert!(text.contains(part) && !first.contains(part), "{part}: {text}");
        }
    }
}
