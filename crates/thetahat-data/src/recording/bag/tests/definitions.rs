//! Definitions of types, and messages decoded by them.

use std::collections::BTreeMap;
use std::io::Cursor;

use ::mcap::WriteOptions;
use ::mcap::records::MessageHeader;

use super::super::super::Format;
use super::super::asked::Asked;
use super::super::decode::decode;
use super::super::definition::{Language, schema};
use super::super::naming::columns;
use super::super::schema::{Encoding, Schema};
use super::super::shape;
use super::super::topic::Topic;
use super::super::{built_in, channels};
use thetahat_testing::Folder;

const MSG: &str = "# State of an arm
std_msgs/Header header
uint8 IDLE=0
string WORD = \"a # b\"
float64[3] q 0
float64[<=4] some
string<=8 label \"x y\"
Motor[] motors
geometry_msgs/Point[2] points
uint16 flags
int64 big
bool on
================================================================================
MSG: robot/Motor
float32 q
int8[2] temperature
================================================================================
MSG: geometry_msgs/msg/Point
float64 x
float64 y
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

const IDL: &str = r#"================================================================================
IDL: robot/msg/Arm
// generated from robot/msg/Arm.msg
#include "std_msgs/msg/Header.idl"
module robot {
  module msg {
    module Arm_Constants {
      const uint8 IDLE = 0;
      @verbatim (language="comment", text="a ) and \" inside")
      const string WORD = "a ; b";
    };
    typedef double double__3[3];
    typedef geometry_msgs::msg::Point geometry_msgs__msg__Point__2[2];
    @verbatim (language="comment", text=
      "State of an arm")
    struct Arm {
      std_msgs::msg::Header header;
      @default (value=(0.0, 0.0, 0.0))
      double__3 q;
      sequence<double, 4> some;
      /* bounded */ string<8> label;
      sequence<robot::msg::Motor> motors;
      geometry_msgs__msg__Point__2 points;
      unsigned short flags;
      long long big;
      boolean on;
    };
  };
};
================================================================================
IDL: robot/msg/Motor
module robot { module msg { struct Motor { float q; int8 temperature[2]; }; }; };
================================================================================
MSG: geometry_msgs/msg/Point
float64 x
float64 y
================================================================================
IDL: std_msgs/msg/Header
module std_msgs { module msg { struct Header { builtin_interfaces::msg::Time stamp; string frame_id; }; }; };
"#;

fn of(text: &str, language: Language) -> Schema {
    schema("robot/msg/Arm", text, language, Encoding::Cdr).unwrap()
}

/// A message by the schema, in either order of bytes.
fn message(big: bool) -> Vec<u8> {
    let mut body: Vec<u8> = Vec::new();
    let mut put = |bytes: &[u8]| {
        body.resize(body.len().next_multiple_of(bytes.len()), 0);
        let bytes = bytes.iter().copied();
        if big { body.extend(bytes.rev()) } else { body.extend(bytes) }
    };
    put(&7_i32.to_le_bytes());
    put(&5_u32.to_le_bytes());
    put(&1_u32.to_le_bytes());
    put(&[0]);
    [1.0_f64, 2.0, 3.0].iter().for_each(|q| put(&q.to_le_bytes()));
    put(&1_u32.to_le_bytes());
    put(&4.0_f64.to_le_bytes());
    put(&2_u32.to_le_bytes());
    put(b"a");
    put(&[0]);
    put(&2_u32.to_le_bytes());
    for q in [5.0_f32, 6.0] {
        put(&q.to_le_bytes());
        put(&[30]);
        put(&[31]);
    }
    [8.0_f64, 9.0, 10.0, 11.0].iter().for_each(|x| put(&x.to_le_bytes()));
    put(&513_u16.to_le_bytes());
    put(&(-3_i64).to_le_bytes());
    put(&[1]);
    [vec![0, u8::from(!big), 0, 0], body].concat()
}

#[test]
fn both_languages_describe_the_same_message() {
    for (language, text) in [(Language::Msg, MSG), (Language::Idl, IDL)] {
        let schema = of(text, language);
        for big in [false, true] {
            let message = message(big);
            let decoded = decode(&schema, &message).unwrap();
            assert_eq!((decoded.stamp_ns, decoded.left), (Some(7_000_000_005), 0), "{language:?}");
            let expected =
                [1.0, 2.0, 3.0, 4.0, 5.0, 30.0, 31.0, 6.0, 30.0, 31.0, 8.0, 9.0, 10.0, 11.0, 513.0, -3.0, 1.0];
            assert_eq!(decoded.values, expected, "{language:?}");
            let names: Vec<String> = columns(&shape::of(&schema, &decoded)).into_iter().map(|c| c.name).collect();
            let expected = ["q[0]", "q[1]", "q[2]", "some[0]", "motors[0].q", "motors[0].temperature[0]"];
            assert_eq!(names[..6], expected, "{language:?}");
            assert_eq!(names[10..], ["points[0].x", "points[0].y", "points[1].x", "points[1].y", "flags", "big", "on"]);
        }
    }
}

/// The definition of a file decides, in either language.
#[test]
fn mcap_with_either_language() {
    for (encoding, text) in [("ros2msg", MSG), ("ros2idl", IDL)] {
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = WriteOptions::new().compression(None).create(&mut bytes).unwrap();
        let schema_id = writer.add_schema("robot/msg/Arm", encoding, text.as_bytes()).unwrap();
        let channel_id = writer.add_channel(schema_id, "/arm", "cdr", &BTreeMap::new()).unwrap();
        let header = MessageHeader { channel_id, sequence: 0, log_time: 9, publish_time: 9 };
        writer.write_to_known_channel(&header, &message(true)).unwrap();
        writer.finish().unwrap();
        drop(writer);
        let folder = Folder::with("a.mcap", bytes.into_inner());
        let columns = ["header.stamp", "points[1].y", "motors[1].temperature[0]", "q[2]"].map(str::to_owned);
        let series = channels(&folder.path().join("a.mcap"), Format::Mcap, None, &columns).unwrap();
        assert_eq!(series.values(), [0.0, 11.0, 30.0, 3.0], "{encoding}");
    }
}

/// A number that is called like a time is a signal.
#[test]
fn number_called_stamp() {
    let schema = schema("robot/Arm", "uint8 stamp", Language::Msg, Encoding::Ros1).unwrap();
    let mut topic = Topic::new("/arm".to_owned(), "robot/Arm".to_owned(), vec![schema]);
    topic.add(5, &[7]).unwrap();
    assert!(!topic.has_stamp() && Asked::of("stamp", &topic) == Asked::Signal("stamp".to_owned()));
}

#[test]
fn definitions_cut_short_or_damaged_never_panic() {
    for (language, text) in [(Language::Msg, MSG), (Language::Idl, IDL)] {
        for end in 0..text.len() {
            let _ = schema("robot/msg/Arm", &text[..end], language, Encoding::Cdr);
            for damage in ["{", ">", "[9999999999]", "@(", "\"", "é", "="] {
                let _ = schema(
                    "robot/msg/Arm",
                    &format!("{}{damage}{}", &text[..end], &text[end..]),
                    language,
                    Encoding::Cdr,
                );
            }
        }
    }
}

/// A type that holds itself, arrays of empty types, and more elements than bytes end with an error at once.
#[test]
fn types_without_end_are_refused() {
    let messages = [&[0, 1, 0, 0][..], &[0, 1, 0, 0, 255, 255, 255, 127, 0, 0, 0, 0], &[0; 64]];
    for text in
        ["Arm arm", "Arm[] arms", "E[4000000000] e\n==========\nMSG: robot/E\n", "float64[4000000000] x", "float64[] x"]
    {
        for encoding in [Encoding::Cdr, Encoding::Ros1] {
            let schema = schema("robot/msg/Arm", text, Language::Msg, encoding).unwrap();
            for message in messages {
                if let Ok(decoded) = decode(&schema, message) {
                    assert!(decoded.values.len() <= message.len());
                }
            }
        }
    }
}

#[test]
fn type_that_is_not_defined_is_named() {
    let error = schema("robot/msg/Arm", "Motor[3] motors", Language::Msg, Encoding::Cdr).unwrap_err();
    assert!(error.contains("Motor") && error.contains("motors"), "{error}");
}

/// The state of a trajectory controller in its old and new form, distinguished by the length of the message.
#[test]
fn states_of_trajectory_controllers_name_joints() {
    let forms = built_in::schemas("control_msgs/msg/JointTrajectoryControllerState");
    assert_eq!(forms.len(), 5);
    let names: Vec<Vec<String>> = [(0, 4), (4, 3)].map(|(form, points)| names_of_state(&forms[form], points)).into();
    assert_eq!(
        names[0][..4],
        ["a.reference.position", "b.reference.position", "a.reference.velocity", "b.reference.velocity"]
    );
    assert!(names[0].contains(&"b.feedback.position".to_owned()) && names[0].contains(&"a.output.effort".to_owned()));
    assert!(names[1].contains(&"b.actual.position".to_owned()) && names[1].contains(&"a.error.effort".to_owned()));
}

/// The columns of a state of joints a and b with this number of points.
fn names_of_state(schema: &Schema, points: usize) -> Vec<String> {
    let mut words: Vec<u32> = vec![7, 5, 1, 0, 2, 2, u32::from(b'a'), 2, u32::from(b'b')];
    for _ in 0..points {
        for count in [2, 2, 0, 2] {
            words.push(count);
            // CDR aligns eight bytes from the first one after the head.
            if count > 0 && words.len() % 2 == 1 {
                words.push(0);
            }
            words.extend((0..2 * count).map(|_| 0));
        }
        words.extend([0, 0]);
    }
    words.extend(if points == 4 { vec![0; 1 + 4 * 5] } else { Vec::new() });
    let message = [vec![0, 1, 0, 0], words.iter().flat_map(|word| word.to_le_bytes()).collect()].concat();
    let decoded = decode(schema, &message).unwrap();
    assert_eq!(decoded.left, 0);
    columns(&shape::of(schema, &decoded)).into_iter().map(|column| column.name).collect()
}

/// Points of a trajectory have numbers, even if there are as many points as joints.
#[test]
fn points_of_a_trajectory_are_numbered() {
    let text = "string[] joint_names\nPoint[] points\n==========\nMSG: robot/Point\nuint8[] positions\n";
    let schema = schema("robot/Trajectory", text, Language::Msg, Encoding::Ros1).unwrap();
    let names = [2, 0, 0, 0, 1, 0, 0, 0, b'a', 1, 0, 0, 0, b'b'];
    let message = [&names[..], &[2, 0, 0, 0], &[2, 0, 0, 0, 7, 8], &[2, 0, 0, 0, 9, 10]].concat();
    let decoded = decode(&schema, &message).unwrap();
    let names: Vec<String> = columns(&shape::of(&schema, &decoded)).into_iter().map(|column| column.name).collect();
    assert_eq!(names, ["a.points[0].position", "b.points[0].position", "a.points[1].position", "b.points[1].position"]);
}
