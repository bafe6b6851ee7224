//! Types of common messages, for bags that do not hold their definitions: those in SQLite of ROS 2 before Iron.
//!
//! Source: the packages common_interfaces of ros2 and control_msgs of ros-controls. The state of a trajectory controller has had several
//! forms; the first that takes all bytes of a message is the right one.

use super::definition::{Language, schema};
use super::schema::{Encoding, Schema, normal};

const JOINT_STATE: &str = "std_msgs/Header header
    string[] name
    float64[] position
    float64[] velocity
    float64[] effort";
const DYNAMIC_JOINT_STATE: &str = "std_msgs/Header header
    string[] joint_names
    InterfaceValue[] interface_values";
const ARRAY: &str = "MultiArrayLayout layout
    float64[] data";
const WRENCH: &str = "std_msgs/Header header
    Wrench wrench";
const IMU: &str = "std_msgs/Header header
    geometry_msgs/Quaternion orientation
    float64[9] orientation_covariance
    geometry_msgs/Vector3 angular_velocity
    float64[9] angular_velocity_covariance
    geometry_msgs/Vector3 linear_acceleration
    float64[9] linear_acceleration_covariance";
/// What the state of a trajectory controller holds for each joint, and for joints of several degrees of freedom, in each form.
const CONTROLLER_STATES: [(&[&str], &[&str], &str); 5] = [
    (&["reference", "feedback", "error", "output"], &["reference", "feedback", "error", "output"], ""),
    (
        &["reference", "feedback", "error", "output"],
        &["reference", "feedback", "error", "output"],
        "speed_scaling_factor",
    ),
    (
        &["reference", "feedback", "error", "output", "desired", "actual"],
        &["reference", "feedback", "error", "output", "desired", "actual"],
        "",
    ),
    (&["desired", "actual", "error"], &["desired", "actual", "error"], ""),
    (&["desired", "actual", "error"], &[], ""),
];
/// The types inside.
const PARTS: &str = "
================
MSG: std_msgs/Header
    builtin_interfaces/Time stamp
    string frame_id
================
MSG: control_msgs/InterfaceValue
    string[] interface_names
    float64[] values
================
MSG: trajectory_msgs/JointTrajectoryPoint
    float64[] positions
    float64[] velocities
    float64[] accelerations
    float64[] effort
    builtin_interfaces/Duration time_from_start
================
MSG: trajectory_msgs/MultiDOFJointTrajectoryPoint
    geometry_msgs/Transform[] transforms
    geometry_msgs/Twist[] velocities
    geometry_msgs/Twist[] accelerations
    builtin_interfaces/Duration time_from_start
================
MSG: geometry_msgs/Transform
    Vector3 translation
    Quaternion rotation
================
MSG: geometry_msgs/Twist
    Vector3 linear
    Vector3 angular
================
MSG: geometry_msgs/Wrench
    Vector3 force
    Vector3 torque
================
MSG: geometry_msgs/Vector3
    float64 x
    float64 y
    float64 z
================
MSG: geometry_msgs/Quaternion
    float64 x
    float64 y
    float64 z
    float64 w
================
MSG: std_msgs/MultiArrayLayout
    MultiArrayDimension[] dim
    uint32 data_offset
================
MSG: std_msgs/MultiArrayDimension
    string label
    uint32 size
    uint32 stride
";

/// The forms of a type, the likeliest first; none if it is not known here.
pub(super) fn schemas(kind: &str) -> Vec<Schema> {
    texts(kind)
        .iter()
        .filter_map(|text| schema(kind, &format!("{text}\n{PARTS}"), Language::Msg, Encoding::Cdr).ok())
        .collect()
}

fn texts(kind: &str) -> Vec<String> {
    let text = match normal(kind).as_str() {
        "sensor_msgs/JointState" => JOINT_STATE,
        "control_msgs/DynamicJointState" => DYNAMIC_JOINT_STATE,
        "control_msgs/JointTrajectoryControllerState" => return CONTROLLER_STATES.map(controller_state).into(),
        "std_msgs/Float64MultiArray" => ARRAY,
        "geometry_msgs/WrenchStamped" => WRENCH,
        "sensor_msgs/Imu" => IMU,
        _ => return Vec::new(),
    };
    vec![text.to_owned()]
}

fn controller_state((joints, others, last): (&[&str], &[&str], &str)) -> String {
    let mut text = "std_msgs/Header header\nstring[] joint_names\n".to_owned();
    joints.iter().for_each(|name| text += &format!("trajectory_msgs/JointTrajectoryPoint {name}\n"));
    if !others.is_empty() {
        text += "string[] multi_dof_joint_names\n";
    }
    others.iter().for_each(|name| text += &format!("trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_{name}\n"));
    if last.is_empty() { text } else { text + &format!("float64 {last}\n") }
}
