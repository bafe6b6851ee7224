//! One valid file, and one difference from it in each test.

use std::path::Path;

use super::UrdfError;
use crate::robot::{JointKind, Robot, RobotError};

const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <!-- looks are passed over -->
  <material name="grey"><color rgba="1 1 1 1"/></material>
  <link name="base"/>
  <link name="upper">
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0 1.5708"/>
      <mass value="2"/>
      <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.1"/>
    </inertial>
  </link>
  <link name="lower"/>
  <link name="tool">
    <inertial><mass value="0.5"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 0.3"/>
    <axis xyz="0 0 2"/>
    <limit lower="-1" upper="2" velocity="3" effort="40"/>
    <dynamics damping="0.7" friction="0.4"/>
  </joint>
  <joint name="elbow" type="prismatic">
    <parent link="upper"/>
    <child link="lower"/>
    <origin rpy="0 1.5708 0" xyz="0.1 0.2 0.3"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="lower"/>
    <child link="tool"/>
    <origin xyz="0 0 0.2"/>
  </joint>
  <transmission name="shoulder_drive">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="shoulder"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
    <actuator name="motor"><mechanicalReduction>-50</mechanicalReduction></actuator>
  </transmission>
  <gazebo reference="upper"><gravity>true</gravity></gazebo>
  <ros2_control name="hw"><joint name="shoulder"><mechanicalReduction>9</mechanicalReduction></joint></ros2_control>
</robot>
"#;

fn read(text: &str) -> Result<Robot, RobotError> {
    Robot::parse(text, Path::new("arm.urdf"))
}

fn refused(from: &str, to: &str) -> UrdfError {
    assert!(ARM.contains(from), "{from}");
    let error = read(&ARM.replacen(from, to, 1)).unwrap_err();
    let RobotError::Urdf(error) = error else { panic!("{error}") };
    error
}

fn changed(from: &str, to: &str) -> Robot {
    assert!(ARM.contains(from), "{from}");
    read(&ARM.replacen(from, to, 1)).unwrap()
}

/// Checks that the message contains these words and the place that line.
fn says(error: &UrdfError, words: &[&str]) {
    let message = error.to_string();
    words.iter().for_each(|word| assert!(message.contains(word), "`{word}` is not in: {message}"));
}

fn value(robot: &Robot, name: &str) -> f64 {
    robot.a_priori_parameters()[robot.parameter_table().index_of(name).unwrap()]
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-14, "{a} against {b}");
}

#[test]
fn the_valid_file_is_read() {
    let robot = read(ARM).unwrap();
    assert_eq!((robot.name.as_str(), robot.coordinate_count(), robot.link_count()), ("arm", 2, 2));
    let [shoulder, elbow] = &robot.joints[..] else { panic!() };
    assert_eq!((shoulder.kind, shoulder.parent), (JointKind::Revolute, None));
    assert_eq!((elbow.kind, elbow.parent), (JointKind::Prismatic, Some(0)));
    let limits = shoulder.limits;
    assert_eq!([limits.lower, limits.upper, limits.velocity, limits.effort], [-1.0, 2.0, 3.0, 40.0].map(Some));
    assert_eq!(elbow.limits.lower, None);
    assert_eq!((robot.gravity, shoulder.placement.origin), ([0.0, 0.0, -9.81], [0.0, 0.0, 0.3]));
    assert_eq!((robot.transmission.matrix().at(0, 0), robot.transmission.matrix().at(1, 1)), (-50.0, 1.0));
}

#[test]
fn inertias_are_about_the_links_frame_and_friction_is_a_priori() {
    let robot = read(ARM).unwrap();
    // Turned by a right angle about z, which the file rounds to 1.5708, then moved by 0.1 m.
    close(value(&robot, "xx1"), 0.2 + 2.0 * 0.01);
    close(value(&robot, "yy1"), 0.3 + 2.0 * 0.01);
    close(value(&robot, "zz1"), 0.1);
    close(value(&robot, "mz1"), 0.2);
    assert_eq!((value(&robot, "fv1"), value(&robot, "fc1")), (0.7, 0.4));
}

#[test]
fn a_link_that_is_fixed_is_lumped_into_its_parent() {
    let robot = read(ARM).unwrap();
    assert_eq!((value(&robot, "m2"), value(&robot, "mz2"), value(&robot, "xx2")), (0.5, 0.1, 0.5 * 0.2 * 0.2));
    assert_eq!(value(&robot, "zz2"), 0.0);
}

#[test]
fn the_default_axis_is_x_and_parameters_stay_in_the_links_axes() {
    let robot = read(ARM).unwrap();
    let elbow = &robot.joints[1];
    // x of the elbow's frame, which is turned about y: down in the frame of the upper link.
    elbow.placement.axis().iter().zip([0.0, 0.0, -1.0]).for_each(|(a, b)| close(*a, b));
    assert_eq!(elbow.link_axes, Some([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]));
    assert_eq!(robot.joints[0].link_axes, None);
}

#[test]
fn a_continuous_joint_has_no_bounds() {
    let limits = changed("type=\"revolute\"", "type=\"continuous\"").joints[0].limits;
    assert_eq!((limits.lower, limits.velocity), (None, Some(3.0)));
}

#[test]
fn a_follower_has_no_coordinate() {
    let robot =
        changed("<origin rpy=\"0 1.5708 0\" xyz=\"0.1 0.2 0.3\"/>", "<mimic joint=\"shoulder\" multiplier=\"2\"/>");
    assert_eq!((robot.coordinate_count(), robot.link_count(), robot.transmission.joints()), (1, 2, 1));
    assert_eq!(robot.joints[1].mimic.unwrap().ratio, 2.0);
}

#[test]
fn old_transmissions_have_their_reduction_elsewhere() {
    let actuator = "<actuator name=\"motor\"><mechanicalReduction>-50</mechanicalReduction></actuator>";
    let reduction = |robot: Robot| robot.transmission.matrix().at(0, 0);
    assert_eq!(reduction(changed(actuator, "<mechanicalReduction> 7 </mechanicalReduction>")), 7.0);
    assert_eq!(reduction(changed(actuator, "<actuator name=\"motor\"/>")), 1.0);
}

#[test]
fn a_file_that_is_not_xml_is_refused_with_line_and_column() {
    let error = refused("<link name=\"lower\"/>", "<link name=\"lower\">");
    assert!(matches!(error, UrdfError::Syntax { line: 43, .. }), "{error}");
}

#[test]
fn a_document_type_is_refused() {
    let bomb = "<?xml version=\"1.0\"?><!DOCTYPE r [<!ENTITY a \"aaaa\">]>";
    assert!(matches!(refused("<?xml version=\"1.0\"?>", bomb), UrdfError::Syntax { .. }));
}

#[test]
fn xacro_that_is_not_expanded_is_refused() {
    let property = refused("<link name=\"base\"/>", "<xacro:property name=\"d\" value=\"1\"/><link name=\"base\"/>");
    says(&property, &["arm.urdf, line 5", "xacro arm.urdf > robot.urdf"]);
    says(
        &refused("xyz=\"0 0 0.3\"", "xyz=\"0 0 ${height}\""),
        &["line 21", "<joint name=\"shoulder\">", "not been expanded"],
    );
    let undeclared = ARM
        .replace(" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"", "")
        .replace("<link name=\"base\"/>", "<xacro:arm/>");
    assert!(matches!(read(&undeclared), Err(RobotError::Urdf(UrdfError::Xacro { .. }))));
}

#[test]
fn another_kind_of_file_is_refused() {
    let sdf = read("<sdf version=\"1.7\"><model name=\"arm\"/></sdf>").unwrap_err();
    assert!(matches!(sdf, RobotError::Urdf(UrdfError::NotARobot { .. })), "{sdf}");
}

#[test]
fn an_unknown_link_is_refused_with_one_that_is_meant() {
    says(
        &refused("<child link=\"upper\"/>", "<child link=\"uper\"/>"),
        &["line 20", "<child>", "`uper`", "is `upper` meant"],
    );
    says(
        &refused("<parent link=\"base\"/>", "<parent link=\"world\"/>"),
        &["line 19", "<parent> of <joint name=\"shoulder\">", "`world`"],
    );
}

#[test]
fn two_bases_are_refused() {
    let error = refused("<link name=\"lower\"/>", "<link name=\"lower\"/><link name=\"table\"/>");
    assert!(matches!(error, UrdfError::TwoRoots { first_line: 5, .. }), "{error}");
    says(&error, &["line 14", "<link name=\"table\">", "`base`"]);
}

#[test]
fn a_cycle_is_refused_with_its_joints() {
    let error = refused("<parent link=\"base\"/>", "<parent link=\"tool\"/>");
    says(&error, &["shoulder -> elbow -> flange -> shoulder"]);
    assert!(matches!(error, UrdfError::Cycle { .. }));
}

#[test]
fn a_link_with_two_parents_is_refused() {
    let error = refused("<child link=\"tool\"/>", "<child link=\"upper\"/>");
    says(&error, &["<joint name=\"flange\">", "`upper`", "joint `shoulder`"]);
    assert!(matches!(error, UrdfError::TwoParents { .. }));
}

#[test]
fn two_elements_of_one_name_are_refused() {
    assert!(matches!(
        refused("<link name=\"lower\"/>", "<link name=\"upper\"/>"),
        UrdfError::DuplicateName { first_line: 6, .. }
    ));
    assert!(matches!(refused("\"flange\"", "\"elbow\""), UrdfError::DuplicateName { first_line: 26, .. }));
}

#[test]
fn a_number_that_is_none_is_refused() {
    says(
        &refused("value=\"2\"", "value=\"2kg\""),
        &["line 10", "<mass> of <link name=\"upper\">", "`2kg`", "a number"],
    );
    says(
        &refused("xyz=\"0 0 0.3\"", "xyz=\"0 0\""),
        &["line 21", "<origin> of <joint name=\"shoulder\">", "three numbers"],
    );
    says(&refused("ixx=\"0.3\"", "ixx=\"inf\""), &["<inertia>", "ixx", "a finite number"]);
    says(&refused("value=\"2\"", "value=\"1e300\""), &["<mass>", "a number up to 1e9"]);
    says(&refused("damping=\"0.7\"", "damping=\"NaN\""), &["<dynamics>", "a finite number"]);
}

#[test]
fn a_missing_piece_is_refused() {
    let missing = |from, to| {
        let error = refused(from, to);
        let UrdfError::Missing { missing, .. } = error else { panic!("{error}") };
        missing
    };
    assert_eq!(missing("<child link=\"upper\"/>", ""), "<child>");
    assert_eq!(missing("<child link=\"upper\"/>", "<child/>"), "attribute link");
    assert_eq!(missing(" type=\"revolute\"", ""), "attribute type");
    assert_eq!(missing("<mass value=\"2\"/>", ""), "<mass>");
    assert_eq!(missing(" ixy=\"0\"", ""), "attribute ixy");
    assert_eq!(missing("<link name=\"base\"/>", "<link/>"), "attribute name");
    assert_eq!(missing("<robot name=\"arm\"", "<robot"), "attribute name");
    assert_eq!(missing("<axis xyz=\"0 0 2\"/>", "<axis/>"), "attribute xyz");
}

#[test]
fn an_axis_without_direction_is_refused() {
    says(
        &refused("xyz=\"0 0 2\"", "xyz=\"0 0 0\""),
        &["line 22", "<axis> of <joint name=\"shoulder\">", "other than zero"],
    );
}

#[test]
fn joints_of_several_coordinates_are_refused() {
    says(
        &refused("type=\"revolute\"", "type=\"floating\""),
        &["line 18", "shoulder", "a floating base is out of scope"],
    );
    says(&refused("type=\"prismatic\"", "type=\"planar\""), &["elbow", "out of scope"]);
    assert!(matches!(refused("type=\"revolute\"", "type=\"hinge\""), UrdfError::UnsupportedJoint { .. }));
}

#[test]
fn a_robot_that_does_not_move_is_refused() {
    let fixed = ARM.replace("type=\"revolute\"", "type=\"fixed\"").replace("type=\"prismatic\"", "type=\"fixed\"");
    assert!(matches!(read(&fixed), Err(RobotError::Urdf(UrdfError::NoMovingJoint { .. }))));
    assert!(matches!(read("<robot name=\"r\"/>"), Err(RobotError::Urdf(UrdfError::NoMovingJoint { .. }))));
}

#[test]
fn a_follower_of_itself_or_of_nothing_is_refused() {
    let axis = "<axis xyz=\"0 0 2\"/>";
    let error = refused(axis, "<mimic joint=\"shoulder\"/>");
    assert!(matches!(error, UrdfError::Mimic { .. }), "{error}");
    says(
        &refused(axis, "<mimic joint=\"flange\"/>"),
        &["<mimic> of <joint name=\"shoulder\">", "moving joint `flange`"],
    );
}

#[test]
fn a_transmission_beyond_a_ratio_is_refused() {
    let joint = "<joint name=\"shoulder\"><hardware";
    let error = refused(joint, &format!("<joint name=\"elbow\"/>{joint}"));
    says(&error, &["shoulder_drive", "couples several", "[transmission] matrix"]);
    says(&refused(">-50<", ">0<"), &["<mechanicalReduction> of", "other than zero"]);
    says(&refused(joint, "<joint name=\"sholder\"><hardware"), &["`sholder`", "is `shoulder` meant"]);
}

#[test]
fn files_beyond_any_robot_are_refused() {
    let too_large = |text: &str| matches!(read(text), Err(RobotError::Urdf(UrdfError::TooLarge { .. })));
    let attributes: String = (0..2000).map(|k| format!(" a{k}=\"1\"")).collect();
    assert!(too_large(&ARM.replace("<link name=\"base\"/>", &format!("<link name=\"base\"{attributes}/>"))));
    let nested = format!("{}{}", "<a xmlns:b=\"c\">".repeat(5000), "</a>".repeat(5000));
    assert!(too_large(&ARM.replace("<link name=\"base\"/>", &nested)));
    let chain: String = (1..=200)
        .map(|k| {
            let ends = format!("<parent link=\"l{}\"/><child link=\"l{k}\"/>", k - 1);
            format!("<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"revolute\">{ends}</joint>")
        })
        .collect();
    assert!(too_large(&format!("<robot name=\"r\"><link name=\"l0\"/>{chain}</robot>")));
}

#[test]
fn deep_nesting_does_not_overflow_the_stack() {
    let deep = format!("{}{}", "<a>".repeat(300_000), "</a>".repeat(300_000));
    assert!(read(&ARM.replace("<link name=\"base\"/>", &format!("{deep}<link name=\"base\"/>"))).is_ok());
}

/// Changed bytes, removed, doubled or moved pieces: the result is read or refused.
#[test]
fn mutilated_files_are_read_or_refused() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    for _ in 0..5000 {
        let mut bytes = ARM.as_bytes().to_vec();
        for _ in 0..rng.random_range(1..4) {
            let (from, to) = (rng.random_range(0..bytes.len()), rng.random_range(0..bytes.len()));
            let piece: Vec<u8> = bytes[from..(from + rng.random_range(1..60)).min(bytes.len())].to_vec();
            match rng.random_range(0..3) {
                0 => bytes[from] = rng.random_range(32..127),
                1 => drop(bytes.drain(from..from + piece.len())),
                _ => drop(bytes.splice(to..to, piece)),
            }
        }
        if let Ok(robot) = read(&String::from_utf8_lossy(&bytes)) {
            assert!(robot.a_priori_parameters().iter().all(|v| v.is_finite()));
        }
    }
}

#[test]
fn what_no_robot_has_is_used_and_doubted() {
    assert_eq!(Robot::parse(ARM, Path::new("arm.urdf")).unwrap().doubts, []);
    let doubts = |from: &str, to: &str| {
        assert!(ARM.contains(from));
        let robot = Robot::parse(&ARM.replacen(from, to, 1), Path::new("arm.urdf")).unwrap();
        robot.doubts.into_iter().map(|d| format!("{}: {}", d.place, d.what)).collect::<Vec<_>>()
    };
    assert_eq!(
        doubts("<mass value=\"2\"/>", "<mass value=\"-2\"/>"),
        ["arm.urdf, line 8: <inertial> of <link name=\"upper\">: a mass of -2 kg, below zero"]
    );
    assert_eq!(
        doubts("damping=\"0.7\"", "damping=\"-0.7\""),
        ["arm.urdf, line 18: <joint name=\"shoulder\">: a damping of -0.7 N m s/rad, below zero: friction that drives"]
    );
    assert!(doubts("friction=\"0.4\"", "friction=\"-0.4\"")[0].contains("a friction of -0.4 N m, below zero"));
    let inertia = doubts("ixx=\"0.3\"", "ixx=\"0.5\"");
    assert!(inertia[0].contains(
        "<link name=\"upper\">: principal inertias 1.000e-1, 2.000e-1 and 5.000e-1 kg m^2, which no body has"
    ));
    assert!(doubts("<mass value=\"2\"/>", "<mass value=\"0\"/>")[0].contains("inertia without a mass"));
    // Three printed digits of a thin plate.
    assert_eq!(doubts("ixx=\"0.3\"", "ixx=\"0.302\""), Vec::<String>::new());
}
