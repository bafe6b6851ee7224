use std::path::Path;

use crate::robot::{JointKind, Robot, RobotError};

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
    assert_eq!(robot.joint_count(), 2);
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
    match parse(&text).unwrap_err() {
        RobotError::Cycle { line, joints, .. } => {
            assert_eq!(line, 3);
            assert_eq!(joints, ["shoulder", "slide", "shoulder"]);
        }
        other => panic!("{other}"),
    }
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
    match parse(&text).unwrap_err() {
        RobotError::SingularTransmission { line, .. } => assert_eq!(line, 12),
        other => panic!("{other}"),
    }
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
