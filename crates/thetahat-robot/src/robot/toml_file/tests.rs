use std::path::Path;

use crate::robot::{JointKind, Robot, RobotError, RobotSource};
use thetahat_ground::vector::{IDENTITY, Mat3, Vec3, add, product, times};

const TWO_JOINTS: &str = r#"
name = "arm"
[[joint]]
name = "shoulder"
kind = "revolute"
[[joint]]
name = "slide"
parent = "shoulder"
kind = "prismatic"
alpha_deg = 90
[transmission]
matrix = [[10, 0], [5, 5]]
offset_deg = [90, 0]
[parameters]
zz1 = 0.5
"#;

fn parse(text: &str) -> Result<Robot, RobotError> {
    Robot::parse(text, Path::new("arm.toml"))
}

#[test]
fn a_valid_description_is_read() {
    let robot = parse(TWO_JOINTS).unwrap();
    assert_eq!(robot.coordinate_count(), 2);
    assert_eq!(robot.joints[1].kind, JointKind::Prismatic);
    assert_eq!(robot.gravity, [0.0, 0.0, -9.81]);
    assert_eq!(robot.transmission.coupled_motors(), vec![1]);
    assert_eq!(robot.a_priori_parameters()[robot.parameter_table().index_of("zz1").unwrap()], 0.5);
}

#[test]
fn joints_are_ordered_by_their_parents() {
    let text = r#"
name = "arm"
[[joint]]
name = "b"
parent = "a"
kind = "revolute"
[[joint]]
name = "a"
kind = "revolute"
"#;
    let names: Vec<String> = parse(text).unwrap().joints.into_iter().map(|j| j.name).collect();
    assert_eq!(names, ["a", "b"]);
}

#[test]
fn a_cycle_is_refused_with_its_joints() {
    let text = TWO_JOINTS.replacen("kind = \"revolute\"", "kind = \"revolute\"\nparent = \"slide\"", 1);
    let error = parse(&text).unwrap_err();
    let RobotError::Cycle { line, joints, .. } = error else { panic!("{error}") };
    assert_eq!(line, 3);
    assert_eq!(joints, ["shoulder", "slide", "shoulder"]);
}

#[test]
fn a_branch_is_a_tree() {
    let third = "[[joint]]\nname = \"third\"\nparent = \"shoulder\"\nkind = \"revolute\"\ngamma_deg = 30\nb_m = 0.2\n";
    let text = TWO_JOINTS.replace("[transmission]", &format!("{third}[transmission]"));
    let text = text.replace("[[10, 0], [5, 5]]", "[[10, 0, 0], [5, 5, 0], [0, 0, 1]]").replace("[90, 0]", "[90, 0, 0]");
    let robot = parse(&text).unwrap();
    let parents: Vec<Option<usize>> = robot.joints.iter().map(|j| j.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(0)]);
    assert_eq!(robot.joints[2].placement.origin, [0.0, 0.0, 0.2]);
}

#[test]
fn an_unknown_parent_is_refused() {
    let text = TWO_JOINTS.replace("parent = \"shoulder\"", "parent = \"elbow\"");
    assert!(matches!(parse(&text).unwrap_err(), RobotError::Joint { line: 6, .. }));
}

#[test]
fn a_singular_matrix_is_refused_with_its_line() {
    let text = TWO_JOINTS.replace("[[10, 0], [5, 5]]", "[[10, 10], [5, 5]]");
    let error = parse(&text).unwrap_err();
    let RobotError::SingularTransmission { line, .. } = error else { panic!("{error}") };
    assert_eq!(line, 12);
}

#[test]
fn a_short_row_is_refused() {
    let text = TWO_JOINTS.replace("[5, 5]]", "[5]]");
    assert!(matches!(parse(&text).unwrap_err(), RobotError::WrongCount { expected: 2, found: 1, .. }));
}

#[test]
fn an_unknown_key_is_refused_with_line_and_the_known_ones() {
    let message = parse(&TWO_JOINTS.replace("alpha_deg", "alpha")).unwrap_err().to_string();
    assert!(message.contains("line 10") && message.contains("alpha_deg"), "{message}");
}

#[test]
fn an_unknown_parameter_is_refused() {
    let text = TWO_JOINTS.replace("zz1 = 0.5", "zz7 = 0.5");
    assert!(matches!(parse(&text).unwrap_err(), RobotError::UnknownParameter { .. }));
}

#[test]
fn a_follower_in_degrees_or_metres_has_no_coordinate() {
    let mimic = |what: &str| {
        let text =
            TWO_JOINTS.replace("alpha_deg = 90", &format!("mimic = {{ joint = \"shoulder\", ratio = 2, {what} }}"));
        parse(&text.replace("[[10, 0], [5, 5]]", "[[10]]").replace("[90, 0]", "[90]"))
    };
    let robot = mimic("offset_m = 0.5").unwrap();
    assert_eq!((robot.coordinate_count(), robot.link_count()), (1, 2));
    assert_eq!(robot.joints[1].mimic.unwrap().offset, 0.5);
    assert!(matches!(mimic("offset_deg = 1").unwrap_err(), RobotError::Joint { line: 6, .. }));
}

#[test]
fn a_follower_of_no_joint_or_of_itself_by_a_sum_is_refused() {
    let joint = |name: &str, mimic: &str| format!("[[joint]]\nname = '{name}'\nkind = 'revolute'\n{mimic}\n");
    let text = |mimic: &str| format!("name = 'r'\n{}{}{}", joint("a", ""), joint("b", ""), joint("c", mimic));
    let message = |mimic: &str| parse(&text(mimic)).unwrap_err().to_string();
    assert!(message("mimic = []").contains("names no joint; leave it out"), "{}", message("mimic = []"));
    let itself = "mimic = [{ joint = 'a', ratio = 1 }, { joint = 'c', ratio = 1 }]";
    assert!(message(itself).contains("joint `c` follows itself"), "{}", message(itself));
    let term = "mimic = [{ joint = 'a', ratio = 1 }, { joint = 'b', ratio = 1 }]\n[[term]]\nkind = 'joint-spring'\njoints = ['c']";
    assert!(message(term).contains("joint `c` follows several others, and takes no terms"), "{}", message(term));
}

/// `Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha)` multiplied out.
fn standard_frame([a, alpha, d, theta]: [f64; 4]) -> (Mat3, Vec3) {
    let ((sa, ca), (st, ct)) = (alpha.sin_cos(), theta.sin_cos());
    let rotation = [[ct, -st * ca, st * sa], [st, ct * ca, -ct * sa], [0.0, sa, ca]];
    (rotation, [a * ct, a * st, d])
}

fn then((r, p): (Mat3, Vec3), (s, o): (Mat3, Vec3)) -> (Mat3, Vec3) {
    (product(&r, &s), add(p, times(&r, o)))
}

/// The converted frames give the tool the same frame as the standard table, whose last a and alpha come after the last joint.
#[test]
fn a_standard_table_has_its_own_forward_kinematics() {
    let table = [[0.3, 40.0, 0.2, 10.0], [-0.5, -90.0, 0.1, 0.0], [0.2, 25.0, -0.4, -70.0]];
    let mut text = "name = \"s\"\nconvention = \"standard\"\n".to_owned();
    for (j, [a, alpha, d, theta]) in table.iter().enumerate() {
        text += &format!("[[joint]]\nname = \"j{j}\"\nkind = \"revolute\"\n");
        text += &format!("a_m = {a}\nalpha_deg = {alpha}\nd_m = {d}\ntheta_deg = {theta}\n");
    }
    let robot = parse(&text).unwrap();
    let q = [0.4, -1.1, 0.7];
    let mut expected = (IDENTITY, [0.0; 3]);
    let mut found = expected;
    for (k, [a, alpha, d, theta]) in table.iter().enumerate() {
        expected = then(expected, standard_frame([*a, alpha.to_radians(), *d, theta.to_radians() + q[k]]));
        let placement = robot.joints[k].placement;
        let turned = standard_frame([0.0, 0.0, 0.0, q[k]]);
        found = then(then(found, (placement.rotation(), placement.origin)), turned);
    }
    let [a, alpha, ..] = table[2];
    found = then(found, standard_frame([a, f64::to_radians(alpha), 0.0, 0.0]));
    let pairs = found.0.as_flattened().iter().chain(&found.1).zip(expected.0.as_flattened().iter().chain(&expected.1));
    pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{a} against {b}"));
}

/// A standard table, moved by one joint, has the same numbers as the modified one.
#[test]
fn a_standard_table_is_the_modified_one_moved_by_a_joint() {
    let joint = |name: &str, rest: &str| format!("[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\n{rest}\n");
    let head = "name = \"s\"\n";
    let standard =
        joint("a", "d_m = 0.1\na_m = 0.5\nalpha_deg = 30") + &joint("b", "d_m = 0.2\na_m = 0.7\nalpha_deg = 40");
    let modified = joint("a", "d_m = 0.1") + &joint("b", "d_m = 0.2\na_m = 0.5\nalpha_deg = 30");
    let standard = parse(&format!("{head}convention = \"standard\"\n{standard}")).unwrap();
    assert_eq!(standard, parse(&format!("{head}convention = \"modified\"\n{modified}")).unwrap());
}

#[test]
fn a_standard_table_of_a_tree_is_refused() {
    let third = "[[joint]]\nname = \"third\"\nparent = \"shoulder\"\nkind = \"revolute\"\n[transmission]";
    let text = format!("convention = \"standard\"{}", TWO_JOINTS.replace("[transmission]", third));
    assert!(matches!(parse(&text).unwrap_err(), RobotError::Joint { line: 11, .. }));
    let text = format!("convention = \"standard\"{}", TWO_JOINTS.replace("alpha_deg", "gamma_deg"));
    assert!(matches!(parse(&text).unwrap_err(), RobotError::Joint { line: 6, .. }));
}

/// The first three joints of `robots/ur10.toml`, which lies outside the package.
const UR10_ARM: &str = r#"
name = "UR10"
friction = "symmetric"
convention = "standard"
[[joint]]
name = "shoulder_pan_joint"
kind = "revolute"
d_m = 0.1273
alpha_deg = 90
[[joint]]
name = "shoulder_lift_joint"
kind = "revolute"
a_m = -0.612
[[joint]]
name = "elbow_joint"
kind = "revolute"
a_m = -0.5723
"#;

#[test]
fn the_ur10_has_its_parallel_axes() {
    let robot = parse(UR10_ARM).unwrap();
    let (shoulder, elbow) = (&robot.joints[1].placement, &robot.joints[2].placement);
    assert_eq!((elbow.alpha, elbow.origin, shoulder.origin[2]), (0.0, [-0.612, 0.0, 0.0], 0.0));
}

const URDF: &str = r#"<robot name="arm"><link name="base"/><link name="rod">
<inertial><mass value="2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.4"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/>
<dynamics damping="0.7"/></joint>
<transmission name="t"><joint name="hinge"/><actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator>
</transmission></robot>"#;

/// A description on the URDF above, in one text.
fn on_urdf(toml: &str) -> Result<Robot, RobotError> {
    parse(&super::with_embedded_urdf(toml, URDF))
}

#[test]
fn a_description_adds_to_its_urdf() {
    let robot = on_urdf("name = \"mine\"\nurdf = \"arm.urdf\"\n[parameters]\nia1 = 0.1\nzz1 = 0.5").unwrap();
    assert_eq!((robot.name.as_str(), robot.transmission.matrix().at(0, 0)), ("mine", 50.0));
    let given: Vec<(&str, f64)> = robot.a_priori.iter().map(|(name, v)| (name.as_str(), *v)).collect();
    assert_eq!(given, [("fv1", 0.7), ("ia1", 0.1), ("m1", 2.0), ("zz1", 0.5)]);
}

#[test]
fn a_description_takes_the_place_of_what_its_urdf_says() {
    let robot = on_urdf("friction = \"asymmetric\"\ngravity = [0, 9.81, 0]\n[transmission]\nmatrix = [[80]]").unwrap();
    assert_eq!((robot.gravity, robot.transmission.matrix().at(0, 0)), ([0.0, 9.81, 0.0], 80.0));
    assert_eq!(
        (robot.a_priori.get("fvp1"), robot.a_priori.get("fvn1"), robot.a_priori.get("fv1")),
        (Some(&0.7), Some(&0.7), None)
    );
    let gains = on_urdf("[transmission]\ndrive_gain = [0.5]").unwrap().transmission;
    assert_eq!((gains.matrix().at(0, 0), gains.drive_to_joint_units()), (50.0, vec![25.0]));
}

#[test]
fn joints_are_given_once() {
    let joints = on_urdf("[[joint]]\nname = \"j\"\nkind = \"revolute\"").unwrap_err();
    assert!(matches!(joints, RobotError::Value { .. }), "{joints}");
    assert!(matches!(on_urdf("convention = \"standard\"").unwrap_err(), RobotError::Value { .. }));
    assert!(matches!(parse("name = \"n\"").unwrap_err(), RobotError::Value { .. }));
    assert!(matches!(parse("[[joint]]\nname = \"j\"\nkind = \"revolute\"").unwrap_err(), RobotError::Value { .. }));
}

#[test]
fn a_urdf_next_to_its_description_is_read_and_kept_in_one_text() {
    let folder = thetahat_testing::Folder::new();
    folder.write("arm.urdf", URDF.replace('\n', "\r\n"));
    folder.write("arm.toml", "urdf = \"arm.urdf\" # the maker's\n[parameters]\nia1 = 0.1\n");
    let source = RobotSource::read(&folder.at("arm.toml")).unwrap();
    let robot = source.robot().unwrap();
    assert_eq!((source.format(), robot.name.as_str()), ("TOML on URDF", "arm"));
    let kept = RobotSource::from_text(source.to_text(), Path::new("results.json")).unwrap();
    // The rod is given only its inertia about the axis; the doubt about it names another place.
    let without_doubts = |robot: Robot| Robot { doubts: Vec::new(), ..robot };
    assert_eq!((robot.doubts.len(), kept.robot().unwrap().doubts.len()), (1, 1));
    assert_eq!(without_doubts(kept.robot().unwrap()), without_doubts(robot));
    assert_eq!(kept.to_text(), source.to_text());
}

#[test]
fn a_missing_urdf_is_named() {
    let error = parse("urdf = \"absent.urdf\"").unwrap_err();
    assert!(matches!(&error, RobotError::Unreadable { path, .. } if path.ends_with("absent.urdf")), "{error}");
}

/// The message for `TWO_JOINTS` with a line replaced, or with one more in front.
fn message_of(line: &str, other: &str) -> String {
    let text = if line.is_empty() { format!("{other}{TWO_JOINTS}") } else { TWO_JOINTS.replace(line, other) };
    parse(&text).unwrap_err().to_string()
}

#[test]
fn gravity_in_g_or_beyond_any_place_is_refused() {
    for (given, found) in [
        (
            "[0, 0, -1]",
            "gravity is [0.0, 0.0, -1.0], of length 1.0000, expected m/s^2 in the base frame, of length 1.5 to 30",
        ),
        ("[0, 0, -1e6]", "of length 1000000.0000"),
        ("[0, nan, 0]", "gravity is NaN, expected finite numbers"),
    ] {
        let message = message_of("", &format!("gravity = {given}\n"));
        assert!(message.starts_with("arm.toml: ") && message.contains(found), "{message}");
    }
    assert!(parse(&format!("gravity = [0, 0, 0]\n{TWO_JOINTS}")).is_ok());
}

#[test]
fn parameters_that_no_robot_has_are_refused() {
    for (given, found) in [
        ("m2 = -1", "[parameters] m2 (joint `slide`) is -1, expected zero or more"),
        ("ia1 = -0.1", "[parameters] ia1 (joint `shoulder`) is -0.1, expected zero or more"),
        ("fc1 = -0.1", "fc1 (joint `shoulder`) is -0.1"),
        ("yy1 = -0.1", "yy1 (joint `shoulder`) is -0.1"),
        ("mx1 = 1e300", "mx1 (joint `shoulder`) is 1"),
        ("m1 = inf", "[parameters] m1 is inf, expected finite numbers"),
        (
            "m1 = 2\nxx1 = 0.1\nyy1 = 0.1\nzz1 = 0.5",
            "[parameters] inertia of link 1 (joint `shoulder`) is 1.000e-1 1.000e-1 5.000e-1 about the centre of mass, expected",
        ),
        ("m1 = 2\nmx1 = 1\nxx1 = 0.1\nyy1 = 0.1\nzz1 = 0.1", "inertia of link 1 (joint `shoulder`) is -4.000e-1"),
    ] {
        let message = message_of("zz1 = 0.5", given);
        assert!(message.starts_with("arm.toml: ") && message.contains(found), "{given}: {message}");
    }
    // Inertias without a mass are regrouped ones and imply no body.
    assert!(parse(&TWO_JOINTS.replace("zz1 = 0.5", "zz1 = 0.5\nxx1 = 0.01\noff1 = -2\nmy1 = -1")).is_ok());
}

#[test]
fn transmissions_that_cannot_be_are_refused() {
    for (matrix, found) in [
        ("[[0, 0], [5, 5]]", "row 1 is zero"),
        ("[[10, 10], [5, 5.000000001]]", "its rows depend on one another"),
        ("[[10, nan], [5, 5]]", "[transmission] matrix is NaN, expected finite numbers"),
        ("[[1e12, 0], [5, 5]]", "[transmission] matrix is 1000000000000, expected motor per joint positions up to 1e9"),
    ] {
        let message = message_of("matrix = [[10, 0], [5, 5]]", &format!("matrix = {matrix}"));
        assert!(message.contains(found), "{matrix}: {message}");
    }
    assert!(
        message_of("offset_deg = [90, 0]", "drive_gain = 0").contains("drive_gain is 0, expected numbers other than")
    );
    assert!(
        message_of("alpha_deg = 90", "alpha_deg = inf")
            .contains("joint `slide` has alpha_deg = inf, expected a finite")
    );
}

#[test]
fn one_number_is_for_all_joints() {
    let list = parse(&TWO_JOINTS.replace("offset_deg = [90, 0]", "drive_gain = [3, 3]\noffset_m = [0, 0]")).unwrap();
    let scalar = parse(&TWO_JOINTS.replace("offset_deg = [90, 0]", "drive_gain = 3\noffset_m = 0")).unwrap();
    assert_eq!(list, scalar);
    let message = message_of("offset_deg = [90, 0]", "offset_deg = 90");
    assert!(message.contains("offset_deg is not zero, expected zero for prismatic joints (use offset_m)"), "{message}");
}

/// The complete example of docs/reference/robots.md.
#[test]
fn the_documented_example_is_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/robots.md");
    let Ok(docs) = std::fs::read_to_string(path) else { return };
    let blocks = docs.split("```toml\n").skip(1).filter_map(|part| part.split("```").next());
    let examples: Vec<&str> = blocks.filter(|text| text.contains("\n[[joint]]")).collect();
    assert_eq!(examples.len(), 1);
    let robot = parse(examples[0]).unwrap();
    assert_eq!((robot.coordinate_count(), robot.link_count(), robot.locked.len()), (3, 4, 1));
}
