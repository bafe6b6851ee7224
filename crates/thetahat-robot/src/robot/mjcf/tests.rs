//! One valid model, and one difference from it in each test.

use std::path::Path;

use super::MjcfError;
use crate::robot::{JointKind, Loop, LoopKind, Robot, RobotError, RobotSource, TermDescription};
use thetahat_testing::Folder;

const ARM: &str = r#"<?xml version="1.0"?>
<!-- an arm -->
<mujoco model="arm">
  <compiler angle="radian"/>
  <default>
    <joint damping="0.5"/>
    <default class="strong"><motor gear="50" ctrlrange="-2 2"/></default>
  </default>
  <asset><mesh file="absent.stl"/></asset>
  <worldbody>
    <light pos="0 0 3"/>
    <geom type="plane" size="1 1 1"/>
    <body name="upper" pos="0 0 0.3">
      <inertial mass="2" pos="0 0 0.1" diaginertia="0.2 0.3 0.1"/>
      <joint name="shoulder" axis="0 0 2" range="-1 2" frictionloss="0.4" armature="0.1"/>
      <geom type="mesh" mesh="absent" class="main"/>
      <site name="tip"/>
      <body name="lower" pos="0.1 0.2 0.3">
        <joint name="elbow" type="slide" axis="0 1 0"/>
        <geom name="rod" type="capsule" size="0.05" fromto="0 0 0 0 0 1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="m1" joint="shoulder" class="strong"/>
    <motor name="m2" joint="elbow" gear="-3"/>
  </actuator>
  <equality/>
  <keyframe><key qpos="0 0"/></keyframe>
</mujoco>
"#;

fn read(text: &str) -> Result<Robot, RobotError> {
    Robot::parse(text, Path::new("arm.xml"))
}

fn changed(from: &str, to: &str) -> Robot {
    assert!(ARM.contains(from), "{from}");
    read(&ARM.replacen(from, to, 1)).unwrap()
}

fn refused(from: &str, to: &str) -> MjcfError {
    assert!(ARM.contains(from), "{from}");
    mjcf_error(read(&ARM.replacen(from, to, 1)))
}

fn mjcf_error(result: Result<Robot, RobotError>) -> MjcfError {
    let error = result.unwrap_err();
    let RobotError::Mjcf(error) = error else { panic!("{error}") };
    error
}

/// Checks that a message contains these words.
fn says(message: &str, words: &[&str]) {
    words.iter().for_each(|word| assert!(message.contains(word), "`{word}` is not in: {message}"));
}

fn value(robot: &Robot, name: &str) -> f64 {
    robot.a_priori.get(name).copied().unwrap_or(0.0)
}

#[test]
fn the_valid_model_is_read() {
    let robot = read(ARM).unwrap();
    assert_eq!((robot.name.as_str(), robot.coordinate_count(), robot.doubts.len()), ("arm", 2, 0));
    let [shoulder, elbow] = &robot.joints[..] else { panic!() };
    assert_eq!((shoulder.kind, shoulder.parent), (JointKind::Revolute, None));
    assert_eq!((elbow.kind, elbow.parent), (JointKind::Prismatic, Some(0)));
    assert_eq!((shoulder.limits.lower, shoulder.limits.upper, elbow.limits.lower), (Some(-1.0), Some(2.0), None));
    assert_eq!((robot.gravity, shoulder.placement.origin), ([0.0, 0.0, -9.81], [0.0, 0.0, 0.3]));
    assert_eq!((value(&robot, "m1"), value(&robot, "mz1")), (2.0, 0.2));
    assert!((value(&robot, "xx1") - (0.2 + 2.0 * 0.01)).abs() < 1e-15);
}

#[test]
fn drives_are_a_priori_parameters_and_gears_the_transmission() {
    let robot = read(ARM).unwrap();
    assert_eq!((value(&robot, "ia1"), value(&robot, "fv1"), value(&robot, "fc1")), (0.1, 0.5, 0.4));
    let matrix = robot.transmission.matrix();
    assert_eq!((matrix.at(0, 0), matrix.at(1, 1), matrix.at(0, 1)), (50.0, -3.0, 0.0));
    assert_eq!((robot.joints[0].limits.effort, robot.joints[1].limits.effort), (Some(100.0), None));
    let armature = changed("class=\"strong\"/>\n    <motor", "class=\"strong\" armature=\"0.0002\"/>\n    <motor");
    assert!((value(&armature, "ia1") - (0.1 + 2500.0 * 0.0002)).abs() < 1e-15);
    let gain = changed("<motor name=\"m2\" joint=\"elbow\"", "<general joint=\"elbow\" gainprm=\"7\"");
    assert_eq!(gain.transmission.drive_gain(), [1.0, 7.0]);
    let source = RobotSource::from_text(ARM.to_owned(), Path::new("arm.xml")).unwrap();
    assert_eq!(source.robot_without_transmission().unwrap().transmission.ratios(), Some(vec![1.0, 1.0]));
}

#[test]
fn limits_follow_limited_and_autolimits() {
    assert_eq!(changed("angle=\"radian\"", "angle=\"radian\" autolimits=\"false\"").joints[0].limits.lower, None);
    assert_eq!(changed("range=\"-1 2\"", "range=\"-1 2\" limited=\"false\"").joints[0].limits.lower, None);
    let degrees = changed("angle=\"radian\"", "angle=\"degree\"").joints[0].limits;
    assert_eq!((degrees.lower, degrees.upper), (Some(-1f64.to_radians()), Some(2f64.to_radians())));
    assert_eq!(changed("range=\"-1 2\"", "actuatorfrcrange=\"-30 20\"").joints[0].limits.effort, Some(30.0));
}

#[test]
fn springs_and_damping_by_powers_are_terms() {
    let robot = changed("type=\"slide\"", "type=\"slide\" stiffness=\"20\" springref=\"0.1\" damping=\"1 2 3\"");
    let names: Vec<&str> = robot.terms.iter().map(|term| term.parameter.as_str()).collect();
    assert_eq!(names, ["k2", "fvq2", "fvc2"]);
    assert_eq!(["k2", "fvq2", "fvc2", "fv2"].map(|name| value(&robot, name)), [20.0, 2.0, 3.0, 1.0]);
    let TermDescription::JointSpring { rest_m, .. } = &robot.term_descriptions[0] else { panic!() };
    assert_eq!(*rest_m, Some(0.1));
}

#[test]
fn what_a_robot_cannot_hold_is_noted() {
    let noted = |from: &str, to: &str, words: &[&str]| {
        let robot = changed(from, to);
        assert_eq!(robot.doubts.len(), 1, "{:?}", robot.doubts);
        let doubt = &robot.doubts[0];
        says(&format!("{}: {}; {}", doubt.place, doubt.what, doubt.remedy), words);
    };
    let trunk = "<body name=\"trunk\" pos=\"0 0 1\"><freejoint/><geom size=\"0.1\"/></body>\n    <body name=\"upper\"";
    noted("<body name=\"upper\"", trunk, &["line 13", "a free joint", "trunk", "floating_base"]);
    noted("type=\"slide\"", "type=\"slide\" springdamper=\"1 1\"", &["line 19", "springdamper", "elbow"]);
    noted("type=\"slide\"", "type=\"slide\" stiffness=\"1 2\"", &["powers of the deflection"]);
    noted("<motor name=\"m2\" joint=\"elbow\"", "<motor name=\"m2\" site=\"tip\"", &["m2", "one joint"]);
    noted("<motor name=\"m2\"", "<position name=\"m2\" kp=\"5\"", &["m2", "gains"]);
    noted("<motor name=\"m2\" joint=\"elbow\"", "<motor joint=\"shoulder\"", &["shoulder", "different gears"]);
    noted("pos=\"0.1 0.2 0.3\"", "pos=\"0.1 0.2 0.3\" gravcomp=\"1\"", &["gravcomp", "lower"]);
    noted("<equality/>", "<option density=\"1.2\"/>", &["fluid"]);
    let tendon = "<tendon><fixed name=\"t\" damping=\"1\"><joint joint=\"elbow\" coef=\"1\"/></fixed></tendon>";
    noted("<equality/>", tendon, &["tendons", "(t)"]);
    noted("mass=\"2\"", "mass=\"-2\"", &["line 13", "a mass of -2 kg"]);
    noted("diaginertia=\"0.2 0.3 0.1\"", "diaginertia=\"0.2 0.7 0.1\"", &["principal inertias"]);
    noted("frictionloss=\"0.4\"", "frictionloss=\"-0.4\"", &["frictionloss of -0.4 N m", "below zero"]);
    noted("type=\"slide\"", "type=\"slide\" stiffness=\"-3\"", &["stiffness of -3 N/m", "below zero"]);
}

#[test]
fn a_joint_without_a_name_has_that_of_its_body() {
    let undriven = ARM.replacen("<motor name=\"m2\" joint=\"elbow\" gear=\"-3\"/>", "", 1);
    let unnamed = undriven.replacen("name=\"elbow\" type", "type", 1);
    assert_eq!(read(&unnamed).unwrap().joints[1].name, "lower_joint");
    let taken = unnamed.replacen("name=\"shoulder\"", "name=\"lower_joint\"", 1);
    let taken = taken.replacen("joint=\"shoulder\"", "joint=\"lower_joint\"", 1);
    assert_eq!(read(&taken).unwrap().joints[1].name, "lower_joint_2");
}

#[test]
fn what_is_more_than_a_tree_of_hinges_and_slides_is_refused() {
    let unsupported = |from: &str, to: &str, words: &[&str]| {
        let error = refused(from, to);
        assert!(matches!(error, MjcfError::Unsupported { .. }), "{error}");
        says(&error.to_string(), words);
    };
    unsupported("type=\"slide\"", "type=\"ball\"", &["arm.xml, line 19: <joint name=\"elbow\">", "three hinges"]);
    let equality = |inner: &str| format!("<equality>{inner}</equality>");
    let connect = equality("<connect body1=\"lower\" body2=\"world\" anchor=\"0 0 0\"/>");
    unsupported("<equality/>", &connect, &["line 28: <connect>", "every joint has an actuator", "active=\"false\""]);
    unsupported("<equality/>", &equality("<weld name=\"w\"/>"), &["<weld name=\"w\">", "body1"]);
    unsupported("<equality/>", &equality("<tendon tendon1=\"t\"/>"), &["a fixed tendon", "active=\"false\""]);
    let replicate = "<replicate count=\"3\"><body><joint/></body></replicate>\n    <body name=\"upper\"";
    unsupported("<body name=\"upper\"", replicate, &["mj_saveLastXML"]);
    unsupported("<site name=\"tip\"/>", "<composite type=\"cable\"/>", &["<composite>", "<body name=\"upper\">"]);
    unsupported("<light pos=\"0 0 3\"/>", "<joint/>", &["the world does not move"]);
}

#[test]
fn loops_that_are_not_active_or_within_one_link_are_no_loops() {
    for inner in [
        "<connect site1=\"tip\" site2=\"tip\"/>",
        "<connect body1=\"lower\" active=\"false\"/>",
        "<weld body1=\"lower\" body2=\"lower\"/>",
    ] {
        let robot = changed("<equality/>", &format!("<equality>{inner}</equality>"));
        assert_eq!(robot, Robot { ..read(ARM).unwrap() }, "{inner}");
    }
}

#[test]
fn a_mesh_whose_mass_counts_is_refused() {
    let error = refused("type=\"capsule\" size=\"0.05\" fromto=\"0 0 0 0 0 1\"", "type=\"mesh\" mesh=\"absent\"");
    says(&error.to_string(), &["line 20: <geom name=\"rod\">", "`lower`", "a mesh", "<inertial>", "mass=\"0\""]);
    let light = "type=\"mesh\" mesh=\"absent\" density=\"0\"";
    assert_eq!(value(&changed("type=\"capsule\" size=\"0.05\" fromto=\"0 0 0 0 0 1\"", light), "m2"), 0.0);
}

#[test]
fn joints_follow_by_linear_equalities_only() {
    let equality = |inner: &str| format!("<equality><joint {inner}/></equality>");
    let robot = changed("<equality/>", &equality("joint1=\"elbow\" joint2=\"shoulder\" polycoef=\"0.1 -2\""));
    let mimic = robot.joints[1].mimic.unwrap();
    assert_eq!((mimic.of, mimic.ratio, mimic.offset, robot.coordinate_count()), (0, -2.0, 0.1, 1));
    let held = changed("<equality/>", &equality("joint1=\"elbow\" polycoef=\"0.1\""));
    assert_eq!((held.joints.len(), held.locked[0].value), (1, 0.1));
    let message = |inner: &str| refused("<equality/>", &equality(inner)).to_string();
    let square = message("joint1=\"elbow\" joint2=\"shoulder\" polycoef=\"0 1 2\"");
    says(&square, &["line 28: <joint>", "`elbow`", "powers above one"]);
    says(&message("joint1=\"elbow\" joint2=\"elbow\""), &["follows itself"]);
    says(&message("joint1=\"elbow\" joint2=\"wrist\""), &["the joint `wrist`"]);
    says(&message("joint2=\"elbow\""), &["joint1"]);
    let twice = "joint1=\"elbow\" joint2=\"shoulder\"/><joint joint1=\"elbow\" joint2=\"shoulder\"";
    says(&message(twice), &["another already"]);
}

#[test]
fn each_invalid_value_is_named() {
    for (from, to, words) in [
        ("axis=\"0 0 2\"", "axis=\"0 0 0\"", ["line 15: <joint name=\"shoulder\">: axis is `0 0 0`", "0 0 1"]),
        ("axis=\"0 0 2\"", "axis=\"0 0\"", ["axis is `0 0`", "three numbers"]),
        ("axis=\"0 0 2\"", "axis=\"0 0 x\"", ["axis is `0 0 x`", "numbers"]),
        ("mass=\"2\"", "mass=\"nan\"", ["mass is `nan`", "up to 1e9"]),
        ("mass=\"2\"", "mass=\"1e300\"", ["mass is `1e300`", "up to 1e9"]),
        ("mass=\"2\" ", "", ["<inertial> of <body name=\"upper\">", "no mass"]),
        ("diaginertia=\"0.2 0.3 0.1\"", "", ["no diaginertia or fullinertia", "line 14"]),
        ("0.3 0.1\"/>", "0.3 0.1\" fullinertia=\"1 1 1 0 0 0\"/>", ["either diaginertia or fullinertia", "remove"]),
        ("angle=\"radian\"", "angle=\"grad\"", ["angle is `grad`", "degree or radian"]),
        ("angle=\"radian\"", "coordinate=\"global\"", ["coordinate is `global`", "local"]),
        ("angle=\"radian\"", "eulerseq=\"xyw\"", ["eulerseq is `xyw`", "three letters"]),
        ("pos=\"0 0 0.3\"", "quat=\"0 0 0 0\"", ["quat is `0 0 0 0`", "other than zero"]),
        ("pos=\"0 0 0.3\"", "quat=\"1 0 0 0\" euler=\"0 0 0\"", ["one orientation", "remove"]),
        ("pos=\"0 0 0.3\"", "xyaxes=\"1 0 0 2 0 0\"", ["xyaxes", "not parallel"]),
        ("size=\"0.05\"", "size=\"0\"", ["line 20: <geom name=\"rod\">: size is `0`", "above zero"]),
        ("size=\"0.05\"", "", ["line 20: <geom name=\"rod\"> has no attribute size", "above zero"]),
        ("size=\"0.05\"", "size=\"1\" mass=\"-1\"", ["mass is `-1`", "zero or more"]),
        ("0 0 0 0 0 1", "1 0 0 1 0 0", ["fromto", "two different points"]),
        ("type=\"capsule\"", "type=\"cone\"", ["type is `cone`", "capsule"]),
        ("type=\"slide\"", "type=\"screw\"", ["type is `screw`", "hinge, slide"]),
        ("type=\"slide\"", "class=\"weak\"", ["the class `weak`", "line 19"]),
        ("joint=\"elbow\"", "joint=\"wrist\"", ["line 26: <motor name=\"m2\">", "the joint `wrist`"]),
        ("name=\"lower\"", "name=\"upper\"", ["line 18: <body name=\"upper\">", "line 13; rename"]),
        ("name=\"elbow\" ", "name=\"shoulder\" ", ["line 19", "line 15; rename"]),
        ("class=\"strong\"><motor", "><motor", ["<default> has no class", "line 7"]),
    ] {
        let changed = ARM.replacen(from, to, 1);
        assert!(ARM.contains(from), "{from}");
        says(&mjcf_error(read(&changed)).to_string(), &words);
    }
}

#[test]
fn a_model_without_moving_joints_and_a_part_of_a_model_are_refused() {
    let error = mjcf_error(read("<mujoco><worldbody><body><geom size=\"1\"/></body></worldbody></mujoco>"));
    assert!(matches!(error, MjcfError::NoMovingJoint { .. }), "{error}");
    let error = mjcf_error(read("<mujocoinclude/>"));
    assert!(matches!(error, MjcfError::Part { .. }), "{error}");
    assert!(matches!(read("<robot name=\"r\"/>").unwrap_err(), RobotError::Urdf(_)));
}

#[test]
fn includes_are_joined_and_lines_are_those_of_their_files() {
    let folder = Folder::new();
    folder.write(
        "scene.xml",
        "<mujoco model=\"scene\">\n  <include file=\"robot/arm.xml\"/>\n  <option gravity=\"0 0 -2\"/>\n</mujoco>",
    );
    folder.write("robot/arm.xml", ARM.replace("<site name=\"tip\"/>", "<include file=\"hand.xml\"/>"));
    folder.write(
        "robot/hand.xml",
        "<mujoco>\n\n<body name=\"hand\"><geom size=\"0.1\"/>\n<joint name=\"wrist\"/></body></mujoco>",
    );
    let source = RobotSource::read(&folder.at("scene.xml")).unwrap();
    let robot = source.robot().unwrap();
    assert_eq!((source.format(), robot.name.as_str(), robot.gravity[2]), ("MJCF", "scene", -2.0));
    assert_eq!(
        robot.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(),
        ["shoulder", "wrist", "elbow"]
    );
    let names: Vec<String> = source.files().into_iter().map(|file| file.name).collect();
    assert_eq!(names, ["scene.xml", "arm.xml", "hand.xml"]);
    // One text has everything.
    assert_eq!(read(&source.to_text()).unwrap(), robot);
    folder.write("robot/hand.xml", "<mujoco>\n\n<body>\n<joint type=\"ball\"/></body></mujoco>");
    let error = Robot::read(&folder.at("scene.xml")).unwrap_err().to_string();
    says(&error, &["hand.xml, line 4: <joint> of <body name=\"upper\">"]);
    folder.write("robot/hand.xml", "<mujoco><body/></mujoco>");
    let text = ARM.replace("<site name=\"tip\"/>", "<include file=\"hand.xml\"/>").replace("\"slide\"", "\"ball\"");
    folder.write("robot/arm.xml", text);
    says(&Robot::read(&folder.at("scene.xml")).unwrap_err().to_string(), &["arm.xml, line 19: <joint name=\"elbow\">"]);
}

#[test]
fn includes_stay_in_the_folder_of_the_model_and_end() {
    let folder = Folder::new();
    folder.write("outside.xml", "<mujoco/>");
    folder.write("in/itself.xml", "<mujoco><include file=\"itself.xml\"/></mujoco>");
    folder.write("in/a.xml", "<mujoco><include file=\"b.xml\"/></mujoco>");
    folder.write("in/b.xml", "<mujoco><include file=\"a.xml\"/></mujoco>");
    let refused = |file: &str| {
        let text = format!("<mujoco>\n<include file=\"{file}\"/>\n</mujoco>");
        folder.write("in/model.xml", text);
        mjcf_error(Robot::read(&folder.at("in/model.xml"))).to_string()
    };
    says(&refused("../outside.xml"), &["model.xml, line 2: <include> includes `../outside.xml`", "not in the folder"]);
    says(&refused("absent.xml"), &["no such file"]);
    for circular in ["model.xml", "itself.xml", "a.xml"] {
        says(&refused(circular), &["includes itself"]);
    }
    folder.write("in/many.xml", format!("<mujoco>{}</mujoco>", "<include file=\"leaf.xml\"/>".repeat(300)));
    folder.write("in/leaf.xml", "<mujoco/>");
    says(&refused("many.xml"), &["more than 200 included files"]);
    says(
        &mjcf_error(read(&ARM.replace("<equality/>", "<include/>"))).to_string(),
        &["<include> has no attribute file"],
    );
}

#[test]
fn a_toml_stands_on_an_mjcf() {
    let folder = Folder::new();
    folder.write("model.xml", ARM.replace("<site name=\"tip\"/>", "<include file=\"tip.xml\"/>"));
    folder.write("tip.xml", "<mujoco><geom size=\"0.1\"/></mujoco>");
    for key in ["urdf", "mjcf"] {
        folder.write("arm.toml", format!("{key} = \"model.xml\"\n[parameters]\nia1 = 0.7\n[locked]\nelbow = 0.1\n"));
        let source = RobotSource::read(&folder.at("arm.toml")).unwrap();
        let robot = source.robot().unwrap();
        assert_eq!((source.format(), robot.joints.len(), value(&robot, "ia1")), ("TOML on MJCF", 1, 0.7));
        assert!(source.urdf_text().is_none() && source.mjcf_text().is_some());
        assert_eq!(source.files().len(), 3);
        let kept = RobotSource::from_text(source.to_text(), Path::new("results.json")).unwrap();
        assert!(kept.to_text().contains("mjcf_text"));
        assert_eq!(kept.robot().unwrap(), robot);
    }
    let embedded = "mjcf_text = '<mujoco><include file=\"tip.xml\"/></mujoco>'";
    says(&mjcf_error(Robot::parse(embedded, &folder.at("arm.toml"))).to_string(), &["includes nothing"]);
}

#[test]
fn a_tendon_of_two_joints_makes_one_follow_the_other() {
    let tendon = "<tendon><fixed name=\"t\"><joint joint=\"elbow\" coef=\"2\"/><joint joint=\"shoulder\" coef=\"1\"/>\
                  </fixed></tendon><equality><tendon tendon1=\"t\" polycoef=\"0.4\"/></equality>";
    let mimic = changed("<equality/>", tendon).joints[1].mimic.unwrap();
    assert_eq!((mimic.of, mimic.ratio, mimic.offset), (0, -0.5, 0.2));
}

#[test]
fn the_outermost_class_may_have_a_name() {
    let text = ARM.replacen("<default>", "<default class=\"all\">", 1).replace("class=\"main\"", "class=\"all\"");
    assert_eq!(read(&text).unwrap(), read(ARM).unwrap());
}

#[test]
fn a_byte_order_mark_is_skipped() {
    assert_eq!(read(&format!("\u{feff}{ARM}")).unwrap(), read(ARM).unwrap());
}

#[test]
fn large_and_deep_models_are_refused() {
    let body = |inner: &str| format!("<mujoco><worldbody>{inner}</worldbody></mujoco>");
    let message = |text: &str| mjcf_error(read(text)).to_string();
    says(&message(&body(&"<body><joint/></body>".repeat(101))), &["more than 100 moving joints"]);
    says(
        &message(&body(&"<body>".repeat(5000)).replace("</world", &format!("{}</world", "</body>".repeat(5000)))),
        &["more than 4000 bodies"],
    );
    let nested: String = (0..60).map(|k| format!("<default class=\"c{k}\">")).collect();
    let defaults = format!("<mujoco><default>{nested}{}</default></mujoco>", "</default>".repeat(60));
    says(&message(&defaults), &["more than 50 nested classes"]);
}

/// Damaged models give errors, or robots that a program can use: never a panic.
#[test]
fn damaged_models_do_not_panic() {
    for end in (0..ARM.len()).step_by(7) {
        assert!(read(&ARM[..end]).is_err(), "{end}");
    }
    let quotes: Vec<usize> = ARM.match_indices('"').map(|(at, _)| at).collect();
    for pair in quotes.chunks_exact(2) {
        for value in ["", "0", "-1", "1e9", "1e-300", "x", "1 2 3 4 5 6 7 8 9 10 11", "true"] {
            let text = format!("{}{value}{}", &ARM[..=pair[0]], &ARM[pair[1]..]);
            if let Ok(robot) = read(&text) {
                assert_eq!(robot.check_sound(), Ok(()), "{text}");
            }
        }
    }
}

/// Bars whose free ends are joined to the world, by bodies in the pose of the model and by sites in that of the first key.
#[test]
fn connected_bodies_and_sites_close_loops() {
    let text = |equality: &str, more: &str| {
        format!(
            "<mujoco><worldbody><site name='base' pos='0.3 0 0.1'/><body name='upper' pos='0 0 0.5'><inertial pos='0 0 0' mass='1' \
             diaginertia='1 1 1'/><joint name='a' axis='0 1 0'/><body name='lower' pos='0.4 0 0'><inertial pos='0 0 0' mass='1' \
             diaginertia='1 1 1'/><joint name='b' axis='0 1 0'/><body name='foot' pos='0 0 -0.4'><inertial pos='0 0 0' mass='1' \
             diaginertia='1 1 1'/><joint name='c' axis='0 1 0'/><site name='end' pos='-0.1 0 0'/></body></body></body></worldbody>\
             <equality>{equality}</equality><actuator><motor joint='a'/></actuator>{more}</mujoco>"
        )
    };
    let connect = "<connect name='pin' body1='foot' body2='world' anchor='-0.1 0 0'/>";
    let robot = read(&text(connect, "")).unwrap();
    assert_eq!((robot.coordinate_count(), robot.transmission.joints(), robot.loops.len()), (1, 1, 1));
    let Loop { kind, from, to, near, .. } = &robot.loops[0];
    assert_eq!(
        (kind, from.joint, to.joint, near.iter().all(|(_, q)| *q == 0.0)),
        (&LoopKind::Point, Some(2), None, true)
    );
    let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(from.origin, [-0.1, 0.0, 0.0]) && close(to.origin, [0.3, 0.0, 0.1]), "{:?}", robot.loops);
    // A passive joint has bearings, but no motor.
    let names: Vec<String> = robot.parameter_table().iter().map(|p| p.name()).collect();
    assert!(["ia2", "off3"].iter().all(|name| !names.iter().any(|n| n == name)) && names.iter().any(|n| n == "fv2"));
    let sites =
        read(&text("<weld site1='end' site2='base'/>", "<keyframe><key qpos='0.1 0.2 -0.3'/></keyframe>")).unwrap();
    let Loop { kind, from, to, near, .. } = &sites.loops[0];
    assert_eq!((kind, &near[..]), (&LoopKind::Pose, &[(0, 0.1), (1, 0.2), (2, -0.3)][..]));
    assert!(close(from.origin, [-0.1, 0.0, 0.0]) && close(to.origin, [0.3, 0.0, 0.1]), "{:?}", sites.loops);
    let undriven = text(connect, "").replace("<motor joint='a'/>", "");
    says(&mjcf_error(read(&undriven)).to_string(), &["without actuators", "[[loop]]", "active=\"false\""]);
}

/// A tendon between two sites that keeps its length is a rod; one through a third site is refused.
#[test]
fn a_tendon_of_constant_length_is_a_rod() {
    let text = |through: &str, equality: &str| {
        format!(
            "<mujoco><worldbody><site name='base' pos='0.3 0 0.1'/><body name='bar' pos='0 0 0.5'><inertial pos='0 0 0' mass='1' \
             diaginertia='1 1 1'/><joint name='a' axis='0 1 0'/><site name='end' pos='0.3 0 0'/></body><body name='rocker'><inertial \
             pos='0 0 0' mass='1' diaginertia='1 1 1'/><joint name='b' axis='0 1 0'/><site name='tip' pos='0 0 0.2'/></body></worldbody>\
             <tendon><spatial name='rod'><site site='end'/>{through}<site site='tip'/></spatial></tendon>\
             <equality><tendon name='link' tendon1='rod' {equality}/></equality><actuator><motor joint='a'/></actuator></mujoco>"
        )
    };
    let length = |equality: &str| match read(&text("", equality)).unwrap().loops[0].kind {
        LoopKind::Distance { length } => length,
        LoopKind::Point | LoopKind::Axis | LoopKind::Pose => 0.0,
    };
    let own = 0.3f64.hypot(0.3);
    assert!((length("") - own).abs() < 1e-12);
    assert!((length("polycoef='0.05 0 0 0 0'") - own - 0.05).abs() < 1e-12);
    says(&mjcf_error(read(&text("<site site='base'/>", ""))).to_string(), &["between two sites", "active=\"false\""]);
    says(&mjcf_error(read(&text("", "polycoef='-1 0 0 0 0'"))).to_string(), &["no length"]);
}
