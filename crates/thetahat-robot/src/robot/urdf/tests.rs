//! One valid file, and one difference from it in each test.

use std::path::Path;

use super::UrdfError;
use crate::robot::{DoubtGrade, JointKind, Limits, Locks, Robot, RobotError, RobotSource};
use thetahat_ground::series::Series;

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

/// Several `<mimic>` are a sum, which a joint that follows it follows too; a note says that other programs read it otherwise.
#[test]
fn several_mimics_of_a_joint_are_a_sum() {
    let joint = |name: &str, of: &str, mimics: &str| {
        format!(
            "<link name='{name}'/><joint name='{name}_joint' type='revolute'><parent link='{of}'/><child link='{name}'/>\
             <axis xyz='0 1 0'/>{mimics}</joint>"
        )
    };
    let arms = joint("a", "base", "") + &joint("b", "a", "");
    let sum =
        "<mimic joint='a_joint' multiplier='-1' offset='0.2'/><mimic joint='b_joint' multiplier='-2' offset='0.1'/>";
    let tip = joint("c", "b", sum) + &joint("d", "c", "<mimic joint='c_joint' multiplier='0.5'/>");
    let robot = read(&format!("<robot name='r'><link name='base'/>{arms}{tip}</robot>")).unwrap();
    assert_eq!((robot.coordinate_count(), robot.link_count()), (2, 4));
    let [c, d] = [2, 3].map(|j: usize| (robot.joints[j].mimic.unwrap(), robot.joints[j].also_follows[0]));
    assert_eq!((c.0.of, c.0.ratio, c.1.of, c.1.ratio), (0, -1.0, 1, -2.0));
    assert!((c.0.offset - 0.3).abs() < 1e-15 && (d.0.offset - 0.15).abs() < 1e-15);
    assert_eq!((d.0.ratio, d.1.ratio), (-0.5, -1.0));
    assert!(robot.doubts.iter().any(|doubt| doubt.what.contains("sum of several others")), "{:?}", robot.doubts);
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
    says(&refused("type=\"revolute\"", "type=\"floating\""), &["line 18", "shoulder", "floating_base = true"]);
    says(&refused("type=\"prismatic\"", "type=\"planar\""), &["elbow", "two prismatic joints"]);
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

/// The arm without its link `base`.
fn without_base() -> String {
    ARM.replace("  <link name=\"base\"/>\n", "")
}

#[test]
fn a_missing_base_is_added_with_a_note() {
    let robot = read(&without_base()).unwrap();
    let whole = read(ARM).unwrap();
    assert_eq!((&robot.joints, &robot.a_priori), (&whole.joints, &whole.a_priori));
    let [note] = &robot.doubts[..] else { panic!("{:?}", robot.doubts) };
    assert_eq!(note.grade, DoubtGrade::Note);
    assert_eq!(note.place, "arm.urdf, line 18: <parent> of <joint name=\"shoulder\">");
    assert!(note.what.contains("no link `base`; it was added"), "{}", note.what);
}

#[test]
fn several_missing_bases_are_named() {
    let text = without_base().replace("<parent link=\"upper\"/>", "<parent link=\"world\"/>");
    let RobotError::Urdf(error) = read(&text).unwrap_err() else { panic!() };
    assert!(matches!(error, UrdfError::MissingBases { .. }), "{error}");
    says(&error, &["arm.urdf, line 18", "base (line 18), world (line 26)", "only one can be the base"]);
}

#[test]
fn a_missing_link_that_has_a_parent_is_refused() {
    let text = without_base().replace("<child link=\"tool\"/>", "<child link=\"tol\"/>");
    let RobotError::Urdf(error) = read(&text).unwrap_err() else { panic!() };
    says(&error, &["names the link"]);
}

#[test]
fn transmissions_of_ros2_control_are_read() {
    let of = |text: &str| {
        let block = "<joint name=\"shoulder\"><mechanicalReduction>9</mechanicalReduction></joint></ros2_control>";
        let (_, ros1) = ARM.split_once("  <transmission").unwrap();
        let (ros1, _) = ros1.split_once("  <gazebo").unwrap();
        let alone = ARM.replace(&format!("  <transmission{ros1}"), "");
        assert!(alone.contains(block));
        read(&alone.replace(block, &format!("{text}</ros2_control>")))
    };
    let joint = "<joint name=\"shoulder\" role=\"joint1\"><mechanical_reduction>101.0</mechanical_reduction>\
                 <offset>0.15</offset></joint>";
    let robot = of(&format!("<transmission name=\"t\"><actuator name=\"a\"/>{joint}</transmission>")).unwrap();
    assert_eq!((robot.transmission.matrix().at(0, 0), robot.transmission.offset()), (101.0, &[0.15, 0.0][..]));
    // The reduction of the joint counts, as ROS 2 reads it.
    let actuator = "<actuator name=\"a\"><mechanical_reduction>2</mechanical_reduction></actuator>";
    let robot = of(&format!("<transmission name=\"t\">{actuator}{joint}</transmission>")).unwrap();
    assert_eq!(robot.transmission.matrix().at(0, 0), 101.0);
    let missing = of("<transmission name=\"t\"><joint name=\"sholder\"/></transmission>").unwrap_err().to_string();
    assert!(missing.contains("`sholder`") && missing.contains("is `shoulder` meant"), "{missing}");
    let own =
        "<transmission name=\"t\"><joint name=\"shoulder\"><mechanical_reduction>3</mechanical_reduction></joint>";
    let error = refused("</ros2_control>", &format!("{own}</transmission></ros2_control>"));
    says(&error, &["a second, different reduction"]);
}

#[test]
fn motor_inertias_are_a_priori_at_the_joint() {
    let reduction = "<mechanicalReduction>-50</mechanicalReduction>";
    for inertia in ["<motorInertia>5e-5</motorInertia>", "<rotor_inertia value=\"5e-5\"/>"] {
        let robot = changed(reduction, &format!("<mechanicalReduction>113.90625</mechanicalReduction>{inertia}"));
        close(value(&robot, "ia1"), 113.90625 * 113.90625 * 5e-5);
        assert_eq!(robot.doubts, []);
    }
    let drake = changed(reduction, "<rotor_inertia value=\"2e-4\"/><gear_ratio value=\"20\"/>");
    close(value(&drake, "ia1"), 20.0 * 20.0 * 2e-4);
    assert_eq!(drake.transmission.matrix().at(0, 0), 1.0);
    let error = refused(reduction, "<motorInertia>-1</motorInertia>");
    says(&error, &["<motorInertia> of <actuator name=\"motor\">", "zero or more"]);
}

#[test]
fn a_motor_inertia_that_cannot_be_used_is_noted() {
    let inertia = "<motorInertia>5e-5</motorInertia><mechanicalReduction>-50</mechanicalReduction>";
    let text = ARM.replace("<mechanicalReduction>-50</mechanicalReduction>", inertia);
    let notes = |robot: &Robot| robot.doubts.iter().map(|d| d.what.clone()).collect::<Vec<_>>();
    let fixed = read(&text.replacen("<joint name=\"shoulder\"><hard", "<joint name=\"flange\"><hard", 1)).unwrap();
    assert_eq!(notes(&fixed), ["the motor inertia is not used, since joint `flange` is fixed"]);
    let source = RobotSource::from_text(text, Path::new("arm.urdf")).unwrap();
    let replaced = source.robot_without_transmission().unwrap();
    assert!(notes(&replaced)[0].contains("replaced by another"));
    assert_eq!(replaced.a_priori.get("ia1"), None);
}

#[test]
fn limits_of_zero_are_stated_and_noted() {
    let robot = changed("velocity=\"3\" effort=\"40\"", "velocity=\"0\" effort=\"0.0\"");
    let limits = robot.joints[0].limits;
    assert_eq!((limits.velocity, limits.effort, Limits::usable(limits.effort)), (Some(0.0), Some(0.0), None));
    assert_eq!(robot.joints[1].limits.velocity, None);
    let [velocity, effort] = &robot.doubts[..] else { panic!("{:?}", robot.doubts) };
    assert_eq!((velocity.grade, effort.grade), (DoubtGrade::Note, DoubtGrade::Note));
    assert!(velocity.place.contains("line 23: <limit> of <joint name=\"shoulder\">"), "{}", velocity.place);
    assert!(velocity.what.starts_with("the limit of velocity is 0"));
    assert!(effort.what.starts_with("the limit of effort is 0"));
    let fixed = changed("lower=\"-1\" upper=\"2\"", "lower=\"0\" upper=\"0\"");
    assert!(fixed.doubts[0].what.starts_with("the limits of position are both 0"), "{:?}", fixed.doubts);
}

#[test]
fn a_lower_limit_above_the_upper_is_refused() {
    let error = refused("lower=\"-1\" upper=\"2\"", "lower=\"2\" upper=\"-1\"");
    assert!(matches!(error, UrdfError::LimitOrder { .. }));
    says(&error, &["line 23: <limit> of <joint name=\"shoulder\">", "lower is 2, above upper, -1"]);
    let continuous =
        ARM.replace("lower=\"-1\" upper=\"2\"", "lower=\"2\" upper=\"-1\"").replace("revolute", "continuous");
    assert!(read(&continuous).is_ok());
}

#[test]
fn masses_in_a_point_and_links_without_mass_are_noted() {
    let inertia = "ixx=\"0.3\" ixy=\"0\" ixz=\"0\" iyy=\"0.2\" iyz=\"0\" izz=\"0.1\"";
    let doubt = |robot: Robot| {
        let [doubt] = &robot.doubts[..] else { panic!("{:?}", robot.doubts) };
        (doubt.grade, format!("{}: {}", doubt.place, doubt.what))
    };
    let with = |xx: &str, yy: &str| format!("ixx=\"{xx}\" ixy=\"0\" ixz=\"0\" iyy=\"{yy}\" iyz=\"0\" izz=\"{yy}\"");
    let place = "arm.urdf, line 8: <inertial> of <link name=\"upper\">: ";
    for (xx, yy) in [("0", "0"), ("1e-18", "1e-18")] {
        let (grade, message) = doubt(changed(inertia, &with(xx, yy)));
        assert_eq!(grade, DoubtGrade::Note);
        assert!(message.starts_with(&format!("{place}a mass of 2 kg with an inertia of {xx}")), "{message}");
        assert!(message.ends_with("all of it in one point"), "{message}");
    }
    let (grade, message) = doubt(changed(inertia, &with("4.1e-18", "0")));
    assert_eq!(grade, DoubtGrade::Impossible);
    assert!(message.contains("which no body has"), "{message}");
    let massless = ARM.replace(inertia, &with("0", "0")).replace("<mass value=\"2\"/>", "<mass value=\"0\"/>");
    let (grade, message) = doubt(read(&massless).unwrap());
    assert_eq!(
        (grade, message),
        (
            DoubtGrade::Note,
            format!("{place}a mass of 0 kg for a link that a joint moves, with all that is fixed to it")
        )
    );
    // Something that is fixed to the link can give it its mass.
    let carried = massless.replace("<parent link=\"lower\"/>", "<parent link=\"upper\"/>");
    assert_eq!(read(&carried).unwrap().doubts, []);
}

#[test]
fn a_file_in_another_encoding_is_read() {
    let folder = thetahat_testing::Folder::new();
    let text = ARM.replace("<?xml version=\"1.0\"?>", "<?xml version=\"1.0\" encoding=\"utf-16\"?>");
    let bytes: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    folder.write("arm.urdf", bytes);
    assert_eq!(Robot::read(&folder.at("arm.urdf")).unwrap().link_count(), 2);
    folder.write("bad.urdf", b"<robot name=\"arm\">\n<link name=\"\xe4\"/></robot>");
    let error = Robot::read(&folder.at("bad.urdf")).unwrap_err();
    assert!(matches!(error, RobotError::Encoding { line: 2, .. }), "{error}");
}

#[test]
fn transmissions_of_hardware_interfaces_are_skipped() {
    let interface = |kind: &str, joints: &str| {
        let state =
            format!("<transmission name=\"s\"><type>{kind}</type>{joints}<actuator name=\"m\"/></transmission>");
        read(&ARM.replace("<gazebo", &format!("{state}<gazebo")))
    };
    let both = "<joint name=\"shoulder\"/><joint name=\"elbow\"/>";
    assert_eq!(interface("maker/StateInterface", both).unwrap(), read(ARM).unwrap());
    let coupled = interface("transmission_interface/DifferentialTransmission", both).unwrap_err().to_string();
    assert!(coupled.contains("couples two joints by two motors, and states 1 <actuator>"), "{coupled}");
}

/// Joint positions from those of motors as ROS' `transmission_interface` states them: differential
/// `(m1 / a1 +- m2 / a2) / (2 j)`, four-bar linkage `m1 / (j1 a1)` and `(m2 / a2 - m1 / (j1 a1)) / j2`, plus offsets.
#[test]
fn coupled_transmissions_of_ros_are_read() {
    let coupled = |kind: &str, roles: [&str; 2]| {
        let joint = |role: &str, name: &str, ratio: f64, offset: f64| {
            format!(
                "<joint name='{name}'>{role}<mechanicalReduction>{ratio}</mechanicalReduction><offset>{offset}</offset></joint>"
            )
        };
        let motors = "<actuator name='x'><mechanicalReduction>50</mechanicalReduction></actuator>\
                      <actuator name='y'><mechanicalReduction>-40</mechanicalReduction></actuator>";
        let of = format!(
            "<transmission name='pair'><type>transmission_interface/{kind}</type>{}{}{motors}</transmission>",
            joint(roles[0], "elbow", 3.0, 0.1),
            joint(roles[1], "shoulder", 2.0, -0.2)
        );
        let alone = ARM.find("<transmission").unwrap()..ARM.find("<gazebo").unwrap();
        let mut text = ARM.to_owned();
        text.replace_range(alone, &of);
        text
    };
    let pair = |kind: &str, roles: [&str; 2]| read(&coupled(kind, roles)).unwrap();
    let motors = Series::shaped(2, vec![7.0, -11.0]);
    let joints = |robot: Robot| robot.transmission.joint_positions(&motors).sample(0).to_vec();
    // The order of the file is elbow, shoulder; the coordinates are shoulder, elbow. Motors stand at the coordinates of their roles.
    let roles = ["<role>joint2</role>", "<role>joint1</role>"];
    let found = joints(pair("DifferentialTransmission", roles));
    close(found[0], (7.0 / 50.0 + 11.0 / 40.0) / (2.0 * 2.0) - 0.2);
    close(found[1], (7.0 / 50.0 - 11.0 / 40.0) / (2.0 * 3.0) + 0.1);
    let found = joints(pair("FourBarLinkageTransmission", roles));
    close(found[0], 7.0 / (2.0 * 50.0) - 0.2);
    close(found[1], (11.0 / 40.0 - 7.0 / (2.0 * 50.0)) / 3.0 + 0.1);
    // The inertia of a motor that drives both is not used, and a note says so.
    let text = "<actuator name='x'><motorInertia>1e-4</motorInertia>";
    let doubts = pair("DifferentialTransmission", roles).doubts;
    assert_eq!(doubts, []);
    let with = read(&coupled("DifferentialTransmission", roles).replace("<actuator name='x'>", text)).unwrap();
    assert!(matches!(&with.doubts[..], [note] if note.what.contains("drives two joints")), "{:?}", with.doubts);
    // Without roles the first of the file is the first: the elbow, with its motor.
    let robot = pair("FourBarLinkageTransmission", ["", ""]);
    assert_eq!(robot.transmission.coupled_motors(), [0]);
    assert_eq!((robot.transmission.matrix().at(1, 1), robot.transmission.matrix().at(0, 0)), (150.0, -80.0));
}

/// A tool with an impossible inertia on a link whose body is possible with it.
#[test]
fn an_impossible_part_of_a_possible_body_is_a_note() {
    let tool = |link: &str| {
        let text = ARM.replace(
            "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"",
            "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"1e-6\"",
        );
        let robot = read(&text.replace("<link name=\"lower\"/>", link)).unwrap();
        robot.doubts.iter().map(|doubt| doubt.grade).collect::<Vec<_>>()
    };
    let heavy = "<link name=\"lower\"><inertial><mass value=\"2\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" \
                 izz=\"0.01\"/></inertial></link>";
    assert_eq!(tool(heavy), [DoubtGrade::Note]);
    // A mass below zero is none of a part.
    let negative = ARM.replace("<link name=\"lower\"/>", heavy).replace("mass value=\"0.5\"", "mass value=\"-0.5\"");
    let grades: Vec<_> = read(&negative).unwrap().doubts.iter().map(|doubt| doubt.grade).collect();
    assert_eq!(grades, [DoubtGrade::Impossible]);
}

/// What nothing moves is in no equation: its impossible inertia is a note, and so it is once its joint is locked.
#[test]
fn impossible_values_of_what_does_not_move_are_notes() {
    let inertial =
        "<inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.9'/></inertial>";
    let base = ARM.replace("<link name=\"base\"/>", &format!("<link name=\"base\">{inertial}</link>"));
    let grades = |robot: &Robot| robot.doubts.iter().map(|doubt| doubt.grade).collect::<Vec<_>>();
    assert_eq!(grades(&read(&base).unwrap()), [DoubtGrade::Note]);
    let upper = changed("ixx=\"0.3\"", "ixx=\"0.5\"");
    assert_eq!(grades(&upper), [DoubtGrade::Impossible]);
    let locked = |joint: &str| {
        let locks = Locks { locked: [(joint.to_owned(), 0.0)].into(), until: Vec::new() };
        grades(&upper.with_locks(&locks).unwrap())
    };
    assert_eq!((locked("shoulder"), locked("elbow")), (vec![DoubtGrade::Note], vec![DoubtGrade::Impossible]));
}

#[test]
fn xml_that_other_readers_accept_is_refused_with_a_remedy() {
    let message = |text: &str| read(text).unwrap_err().to_string();
    let prefix = message(&ARM.replace("<link name=\"base\"/>", "<drake:rigid/><link name=\"base\"/>"));
    assert!(prefix.contains("line 5") && prefix.contains("add xmlns:drake=\"...\" to the root element"), "{prefix}");
    let blank = message(&format!("\n{ARM}"));
    assert!(blank.contains("remove what stands before `<?xml`"), "{blank}");
    let comment = message(&ARM.replace("looks are", "looks -- are"));
    assert!(comment.contains("line 3"), "{comment}");
}

/// A thigh in mm among links in m, and bodies in g and g mm^2.
#[test]
fn lengths_in_mm_and_masses_in_g_are_noted() {
    let notes = |text: &str| {
        let doubts = read(text).unwrap().doubts;
        assert!(doubts.iter().all(|doubt| doubt.grade == DoubtGrade::Note), "{doubts:?}");
        doubts.into_iter().map(|doubt| doubt.what).collect::<Vec<_>>()
    };
    let joint = |n: usize, z: f64| {
        format!(
            "<link name='l{n}'/><joint name='j{n}' type='revolute'><origin xyz='0 0 {z}'/><parent link='{}'/><child link='l{n}'/>\
             <axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>",
            if n == 1 { "base".to_owned() } else { format!("l{}", n - 1) }
        )
    };
    let leg = |lengths: [f64; 3]| {
        let joints: String = lengths.iter().zip(1..).map(|(z, n)| joint(n, *z)).collect();
        format!("<robot name='leg'><link name='base'/>{joints}</robot>")
    };
    assert_eq!(notes(&leg([0.1, 0.22, 0.2])), Vec::<String>::new());
    // A crane on a long track is none in mm.
    assert_eq!(notes(&leg([0.4, 12.0, 8.0])), Vec::<String>::new());
    let [note] = &notes(&leg([0.1, 220.0, 0.2]))[..] else { panic!("one note") };
    assert!(note.starts_with("joint `j2` lies 220 m from the one before it"), "{note}");
    let body =
        "<inertial><mass value='2000'/><inertia ixx='8e6' ixy='0' ixz='0' iyy='8e6' iyz='0' izz='8e6'/></inertial>";
    let text = leg([0.1, 0.2, 0.2]).replace("<link name='l2'/>", &format!("<link name='l2'>{body}</link>"));
    let [note] = &notes(&text)[..] else { panic!("one note") };
    assert!(note.contains("as of a body with a radius of 63 m"), "{note}");
}
