//! Messages of any type, from bags of ROS 1 and 2 that another program wrote.

use std::path::Path;

use super::super::super::{Format, RecordingError};
use super::super::read::tables_of;
use super::super::topics::Topics;
use super::super::{BagError, channels, mcap, tables};
use super::bags::{ALL_DB3, ALL_MCAP, ROS1, ROS1_BZ2, ROS1_LZ4, bytes};
use thetahat_testing::Folder;

/// All bags with the topics of joint states and of motors.
fn bags() -> Vec<(Folder, &'static str, Format)> {
    let bags = [
        (ALL_MCAP, "a.mcap", Format::Mcap),
        (ALL_DB3, "a.db3", Format::Db3),
        (ROS1, "a.bag", Format::Ros1),
        (ROS1_BZ2, "bz2.bag", Format::Ros1),
        (ROS1_LZ4, "lz4.bag", Format::Ros1),
    ];
    bags.into_iter().map(|(text, name, format)| (Folder::with(name, bytes(text)), name, format)).collect()
}

fn read(path: &Path, format: Format, topic: &str, columns: &[&str]) -> Result<Vec<f64>, RecordingError> {
    let columns: Vec<String> = columns.iter().map(|&column| column.to_owned()).collect();
    let topic = (!topic.is_empty()).then_some(topic);
    channels(path, format, topic, &columns).map(|series| series.values().to_vec())
}

#[test]
fn joint_states_are_the_same_in_all_bags() {
    for (folder, name, format) in bags() {
        let columns = ["stamp", "elbow.position", "shoulder.effort", "log_time"];
        let values = read(&folder.path().join(name), format, "", &columns).unwrap();
        let step = 8_000_000.0 * 1e-9;
        assert_eq!(values, [0.0, 2.0, 10.0, 0.0, step, 3.0, 11.0, step], "{name}");
    }
}

/// Constants and defaults are no fields, a bounded sequence has its own length, and arrays have numbers from 0.
#[test]
fn fields_of_any_kind_are_columns() {
    for (folder, name, format) in bags() {
        let columns = [
            "tick",
            "level",
            "big",
            "on",
            "some[2]",
            "motor_state[2].q",
            "motor_state[1].temperature",
            "points[0].z",
            "last",
        ];
        let values = read(&folder.path().join(name), format, "/lowstate", &columns).unwrap();
        let expected = [100.0, 3.0, -5.0, 1.0, 3.5, 1.0, -31.0, 3.0, 9.75];
        assert_eq!(values[..columns.len()], expected, "{name}");
        let all = read(&folder.path().join(name), format, "/lowstate", &["motor_state.dq"]).unwrap();
        assert_eq!(all, [0.0, -0.25, -0.5, 0.0, -0.25, -0.5], "{name}");
        let reserve = read(&folder.path().join(name), format, "/lowstate", &["motor_state[0].reserve[1]"]).unwrap();
        assert_eq!(reserve, [8.0, 8.0], "{name}");
    }
}

#[test]
fn message_without_a_header_has_the_time_of_the_recorder() {
    for (folder, name, format) in bags() {
        let path = folder.path().join(name);
        assert_eq!(read(&path, format, "/lowstate", &["log_time"]).unwrap(), [0.0, 8_000_000.0 * 1e-9]);
        let error = read(&path, format, "/lowstate", &["stamp"]).unwrap_err();
        assert!(matches!(error, RecordingError::MissingColumn { found, .. } if found[0] == "log_time"), "{name}");
    }
}

/// Interfaces of a joint differ, and each is called by its name.
#[test]
fn interfaces_are_addressed_by_joint_and_name() {
    for (folder, name, format) in bags().into_iter().take(2) {
        let path = folder.path().join(name);
        let columns = ["shoulder.position", "shoulder.effort", "elbow.velocity"];
        assert_eq!(read(&path, format, "/dynamic", &columns).unwrap(), [1.0, 10.0, -1.0, 2.0, 10.0, -1.0]);
        assert!(read(&path, format, "/dynamic", &["elbow.effort"]).is_err());
    }
}

#[test]
fn joint_states_with_efforts_are_the_summary() {
    for (folder, name, format) in bags() {
        let (tables, others) = tables(&folder.path().join(name), format).unwrap();
        assert_eq!(tables.len(), 1, "{name}");
        let columns: Vec<&str> = tables[0].columns.iter().map(|column| column.name.as_str()).collect();
        let expected =
            ["stamp", "log_time", "shoulder.position", "shoulder.velocity", "shoulder.effort", "elbow.position"];
        assert_eq!(columns[..6], expected, "{name}");
        let low = others.iter().find(|other| other.name == "/lowstate").unwrap();
        assert!(low.kind.ends_with(", 33 signals: read where topic = \"/lowstate\" names it"), "{name}: {}", low.kind);
    }
}

#[test]
fn other_topics_are_summarised_where_there_are_no_joint_states() {
    let mut topics = Topics::new(Path::new("a.mcap"), 1);
    mcap::read_from(bytes(ALL_MCAP).as_slice(), None, &mut topics).unwrap();
    topics.list.retain(|topic| !topic.is_joint_state());
    let (tables, others) = tables_of(topics.in_order_of_time()).unwrap();
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!((names.as_slice(), others.len()), (["/dynamic", "/lowstate"].as_slice(), 0));
    let columns: Vec<&str> = tables[1].columns.iter().map(|column| column.name.as_str()).collect();
    assert!(columns.contains(&"motor_state[2].dq") && !columns.contains(&"image[0]"), "{columns:?}");
}

#[test]
fn column_of_another_topic() {
    for (folder, name, format) in bags() {
        let error = read(&folder.path().join(name), format, "", &["motor_state[0].q"]).unwrap_err();
        let RecordingError::Bag { problem, .. } = error else { panic!("{error}") };
        assert!(matches!(*problem, BagError::ColumnOfOtherTopic { other, .. } if other == "/lowstate"), "{name}");
    }
}
