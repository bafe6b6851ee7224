//! Several publishers on one topic, stamps that do not rise, and values that are not finite.

use super::super::super::Format;
use super::super::{BagError, tables};
use super::written::*;

/// An arm with efforts, of which each second message is of a publisher without them.
fn two_publishers() -> Vec<(&'static str, Vec<u8>)> {
    let arm = |k: u32| message(false, 8_000_000 * k, &["a", "b"], [&[1.0 + f64::from(k), 2.0], &[], &[3.0, 4.0]]);
    let other = |k: u32| message(false, 8_000_000 * k, &["b", "a"], [&[0.0, 0.0], &[], &[]]);
    on_topic((0..4).flat_map(|k| [arm(k), other(k)]).collect())
}

#[test]
fn messages_with_fewer_signals_are_left_out_of_all_signals() {
    let messages = two_publishers();
    for columns in [["a.effort"], ["a.position"], ["stamp"], ["a.stamp"]] {
        assert_eq!(loaded(&messages, None, &columns).unwrap().len(), 4, "{columns:?}");
    }
    assert_eq!(loaded(&messages, None, &["position"]).unwrap().sample(1), [2.0, 2.0]);
    let (_folder, path) = db3(&messages);
    let (tables, others) = tables(&path, Format::Db3).unwrap();
    assert_eq!(tables.len(), 1);
    let remark = "sensor_msgs/msg/JointState, 4 messages of another publisher with fewer signals";
    assert!(others.iter().any(|other| other.kind == remark), "{others:?}");
}

#[test]
fn second_publisher_of_the_same_signals_is_named_as_the_cause() {
    let mut messages = on_topic((0..4).map(|k| states(8_000_000 * k, &["a"], &[1.0])).collect());
    messages.insert(2, (TOPIC, states(8_000_000, &["a"], &[0.0])));
    let problem = problem(&messages, None, &["stamp"]);
    assert!(matches!(problem, BagError::StampsRepeat { sample: 2, count: 1, .. }), "{problem}");
    assert!(problem.to_string().contains("several publishers") && problem.to_string().contains("log_time"));
}

/// Joint states of joint a with these stamps in seconds.
fn stamped(stamps: &[u32]) -> Vec<(&'static str, Vec<u8>)> {
    let with_stamp = |seconds: &u32| {
        let mut bytes = states(0, &["a"], &[1.0]);
        bytes[4..8].copy_from_slice(&seconds.to_le_bytes());
        bytes
    };
    on_topic(stamps.iter().map(with_stamp).collect())
}

#[test]
fn messages_before_the_simulated_clock_are_left_out() {
    let messages = stamped(&[0, 0, 0, 7, 8, 9]);
    for columns in [["stamp"], ["log_time"], ["a.position"]] {
        assert_eq!(loaded(&messages, None, &columns).unwrap().len(), 3, "{columns:?}");
    }
    assert_eq!(loaded(&messages, None, &["stamp"]).unwrap().values(), [0.0, 1.0, 2.0]);
    let (_folder, path) = db3(&messages);
    let (_, others) = tables(&path, Format::Db3).unwrap();
    assert!(others.iter().any(|other| other.kind.contains("3 messages with stamp 0 at the start")), "{others:?}");
    assert_eq!(loaded(&stamped(&[0, 7, 8]), None, &["stamp"]).unwrap().len(), 2);
}

#[test]
fn stamps_that_are_all_zero_name_the_other_time() {
    let problem = problem(&stamped(&[0, 0, 0]), None, &["stamp"]);
    assert!(matches!(problem, BagError::NoStamp { .. }) && problem.to_string().contains("log_time"));
    assert_eq!(loaded(&stamped(&[0, 0, 0]), None, &["log_time"]).unwrap().len(), 3);
}

#[test]
fn effort_that_is_nan_names_joint_and_remedy() {
    let effort = |value| message(false, 0, &["a", "b"], [&[1.0, 2.0], &[], &[3.0, value]]);
    let messages = on_topic(vec![effort(1.0), effort(f64::NAN), effort(2.0)]);
    let text = problem(&messages, None, &["a.effort", "b.effort"]).to_string();
    let expected = "column \"b.effort\": 1 of 3 samples are not finite numbers below 1e30, the first is sample 1 counted from 0, \
        NaN; cut the recording to the part without gaps, lock joint \"b\" (`[locked]`), leave it out, or name another column";
    assert!(text.ends_with(expected), "{text}");
}

#[test]
fn joint_states_without_names_have_numbers() {
    let messages = on_topic(vec![message(false, 0, &[], [&[1.0, 2.0], &[], &[]])]);
    assert_eq!(loaded(&messages, None, &["position[1]"]).unwrap().values(), [2.0]);
    assert_eq!(loaded(&messages, None, &["position"]).unwrap().values(), [1.0, 2.0]);
}

#[test]
fn list_of_another_length_than_the_names() {
    let messages = on_topic(vec![message(false, 0, &["a", "b"], [&[1.0], &[], &[]])]);
    assert!(matches!(problem(&messages, None, &["a.position"]), BagError::BadMessage { message: 1, .. }));
}

/// An empty message, as some drivers send at first, is no message of the arm.
#[test]
fn empty_messages_are_left_out() {
    let mut messages = on_topic(arm());
    messages.insert(0, (TOPIC, states(0, &[], &[])));
    assert_eq!(loaded(&messages, None, &["stamp"]).unwrap().len(), 3);
    assert_eq!(loaded(&messages, None, &["elbow.position"]).unwrap().len(), 3);
}
