use std::fs;
use std::path::Path;

use ::mcap::Compression;
use rusqlite::Connection;

use super::super::super::{Format, RecordingError};
use super::super::decode::decode;
use super::super::topics::Topics;
use super::super::{BagError, OtherTopic, built_in, channels, fuzz_db3, fuzz_mcap, tables};
use super::written::*;
use thetahat_testing::Folder;

#[test]
fn joints_are_found_by_name_in_every_message() {
    let series = loaded(&on_topic(arm()), None, &["elbow.position", "shoulder.velocity"]).unwrap();
    assert_eq!(series.values(), [2.0, 1.0, 4.0, 3.0, 6.0, 5.0]);
}

#[test]
fn times_are_seconds_from_the_first_message_to_the_nanosecond() {
    let series = loaded(&on_topic(arm()), None, &["stamp", "log_time"]).unwrap();
    assert_eq!(
        series.values(),
        [0.0, 0.0, 8_000_000.0 * 1e-9, 8_000_000.0 * 1e-9, 16_000_001.0 * 1e-9, 16_000_000.0 * 1e-9]
    );
}

#[test]
fn bag_in_mcap_says_the_same_as_in_sqlite() {
    let messages = on_topic(arm());
    let columns = ["stamp".to_owned(), "elbow.position".to_owned(), "log_time".to_owned()];
    let expected = loaded(&messages, None, &["stamp", "elbow.position", "log_time"]).unwrap();
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let folder = Folder::with("bag.mcap", mcap(&messages, compression));
        let series = channels(&folder.path().join("bag.mcap"), Format::Mcap, None, &columns).unwrap();
        assert_eq!(series, expected);
    }
}

#[test]
fn both_orders_of_bytes() {
    let fields: [&[f64]; 3] = [&[1.0, 2.0], &[], &[3.0, 4.0]];
    let (little, big) = (message(false, 5, &["a", "bc"], fields), message(true, 5, &["a", "bc"], fields));
    let schema = built_in::schemas("sensor_msgs/msg/JointState").remove(0);
    let state = decode(&schema, &little).unwrap();
    assert_eq!(state, decode(&schema, &big).unwrap());
    assert_eq!(state.stamp_ns, Some(i64::from(START_S) * 1_000_000_000 + 5));
    assert_eq!(
        (state.texts.as_slice(), state.values.as_slice()),
        (["a", "bc"].as_slice(), [1.0, 2.0, 3.0, 4.0].as_slice())
    );
}

#[test]
fn message_cut_short_or_damaged_never_panics() {
    let whole = message(false, 5, &["a", "bc"], [&[1.0, 2.0], &[], &[3.0, 4.0]]);
    let schema = built_in::schemas("sensor_msgs/msg/JointState").remove(0);
    for length in 0..whole.len() {
        assert!(decode(&schema, &whole[..length]).is_err(), "{length}");
    }
    for place in 0..whole.len() {
        for damage in 0..=255 {
            let mut bytes = whole.clone();
            bytes[place] = damage;
            let _ = decode(&schema, &bytes);
        }
    }
}

#[test]
fn messages_of_other_publishers_are_passed_over() {
    let mut messages = on_topic(arm());
    messages.insert(1, (TOPIC, states(9, &["gripper"], &[0.1])));
    assert_eq!(loaded(&messages, None, &["elbow.position"]).unwrap().values(), [2.0, 4.0, 6.0]);
    assert_eq!(loaded(&messages, None, &["elbow.stamp"]).unwrap().len(), 3);
    assert!(
        matches!(problem(&messages, None, &["stamp"]), BagError::UnclearTime { example, .. } if example == "shoulder.stamp")
    );
}

#[test]
fn message_that_lacks_a_joint_is_left_out_of_all_signals() {
    let mut messages = on_topic(arm());
    messages.push((TOPIC, states(9, &["shoulder"], &[0.1])));
    for columns in [["shoulder.position"], ["elbow.position"], ["stamp"], ["log_time"], ["shoulder.log_time"]] {
        assert_eq!(loaded(&messages, None, &columns).unwrap().len(), 3, "{columns:?}");
    }
}

#[test]
fn joints_of_different_messages() {
    let mut messages = on_topic(arm());
    messages.insert(1, (TOPIC, states(9, &["gripper"], &[0.1])));
    let problem = problem(&messages, None, &["shoulder.position", "gripper.position"]);
    assert!(
        matches!(&problem, BagError::InDifferentMessages { column, present, .. }
            if column == "gripper.position" && present == "shoulder.position"),
        "{problem}"
    );
}

#[test]
fn field_that_no_message_has() {
    let error = loaded(&on_topic(arm()), None, &["elbow.effort"]).unwrap_err();
    assert!(matches!(error, RecordingError::MissingColumn { column, .. } if column == "elbow.effort"));
}

#[test]
fn joint_that_is_nowhere() {
    let error = loaded(&on_topic(arm()), None, &["wrist.position"]).unwrap_err();
    assert!(
        matches!(error, RecordingError::MissingColumn { found, .. } if found.contains(&"elbow.position".to_owned()))
    );
}

#[test]
fn all_joints_at_once_only_if_their_order_stays() {
    let problem = problem(&on_topic(arm()), None, &["position"]);
    assert!(matches!(problem, BagError::JointsChange { message: 2, .. }));
    let steady = on_topic(arm().into_iter().step_by(2).collect());
    assert_eq!(loaded(&steady, None, &["position"]).unwrap().values(), [1.0, 2.0, 5.0, 6.0]);
}

#[test]
fn topic_is_named_where_there_are_several() {
    let mut messages = on_topic(arm());
    messages.push(("/other/joint_states", states(9, &["elbow"], &[0.1])));
    assert!(
        matches!(problem(&messages, None, &["elbow.position"]), BagError::UnclearTopic { found } if found.len() == 2)
    );
    let other = Some("/other/joint_states");
    assert_eq!(loaded(&messages, other, &["elbow.position"]).unwrap().values(), [0.1]);
    assert!(matches!(problem(&messages, Some("/absent"), &["elbow.position"]), BagError::MissingTopic { .. }));
}

#[test]
fn bag_without_joint_states() {
    let problem = problem(&[], None, &["elbow.position"]);
    assert!(matches!(problem, BagError::NoTopic { found } if found == ["/rosout (rcl_interfaces/msg/Log)"]));
}

#[test]
fn message_that_is_damaged() {
    let mut messages = on_topic(arm());
    messages[1].1.truncate(40);
    assert!(matches!(problem(&messages, None, &["elbow.position"]), BagError::BadMessage { message: 2, .. }));
}

#[test]
fn joint_named_twice() {
    let messages = on_topic(vec![states(0, &["elbow", "elbow"], &[1.0, 2.0])]);
    assert!(matches!(problem(&messages, None, &["elbow.position"]), BagError::BadMessage { message: 1, .. }));
}

#[test]
fn position_that_is_nan() {
    let messages = on_topic(vec![states(0, &["elbow"], &[f64::NAN])]);
    let problem = problem(&messages, None, &["elbow.position"]);
    assert!(matches!(&problem, BagError::NotFinite { sample: 0, joint: Some(joint), .. } if joint == "elbow"));
    let expected = "topic \"/joint_states\", column \"elbow.position\": none of its 1 samples is a finite number below 1e30, \
        the first is NaN; lock joint \"elbow\" (`[locked]`), leave it out, or name another column";
    assert_eq!(problem.to_string(), expected);
}

/// The error for a bag whose schema was changed.
fn changed(sql: &str) -> RecordingError {
    let (_folder, path) = db3(&on_topic(arm()));
    Connection::open(&path).unwrap().execute_batch(sql).unwrap();
    channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap_err()
}

#[test]
fn view_that_stands_in_for_a_table() {
    let error = changed("ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m;");
    assert!(matches!(error, RecordingError::Damaged { reason, .. } if reason.contains("messages")));
}

#[test]
fn view_that_never_ends_is_not_a_table_either() {
    let endless =
        "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)
        SELECT x AS id, 1 AS topic_id, x AS timestamp, x'00' AS data FROM c;";
    assert!(matches!(changed(endless), RecordingError::Damaged { .. }));
}

#[test]
fn message_that_is_not_a_blob() {
    let error = changed("UPDATE messages SET data = 'text'");
    assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
}

#[test]
fn bag_that_was_not_closed() {
    let (_folder, path) = db3(&on_topic(arm()));
    let refused = |ending: &str| {
        let error = channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap_err();
        matches!(error, RecordingError::Bag { problem, .. } if matches!(*problem, BagError::NotClosed { ending: e } if e == ending))
    };
    let second = |ending: &str| path.with_file_name(format!("bag #1.db3{ending}"));
    fs::write(second("-wal"), b"log").unwrap();
    assert!(refused("-wal"));
    fs::remove_file(second("-wal")).unwrap();
    fs::write(second("-journal"), b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7 pages").unwrap();
    assert!(refused("-journal"));
    // As SQLite leaves the journal of a finished transaction where it keeps the file.
    fs::write(second("-journal"), [0; 512]).unwrap();
    channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap();
}

#[test]
fn reading_leaves_no_file_next_to_the_bag() {
    let (folder, path) = db3(&on_topic(arm()));
    channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn other_files() {
    for (name, format) in [("bag.db3", Format::Db3), ("bag.mcap", Format::Mcap)] {
        let folder = Folder::with(name, b"t,q\n0,1\n".repeat(100));
        let error = channels(&folder.path().join(name), format, None, &["elbow.position".to_owned()]).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
    }
}

#[test]
fn mcap_cut_short() {
    let whole = mcap(&on_topic(arm()), Some(Compression::Zstd));
    for length in 1..whole.len() {
        let mut topics = Topics::new(Path::new("bag.mcap"), length as u64);
        let error = super::super::mcap::read_from(&whole[..length], None, &mut topics).err();
        assert!(matches!(error, Some(RecordingError::Damaged { .. })), "{length}");
    }
}

#[test]
fn damaged_bags_never_panic() {
    let (_folder, path) = db3(&on_topic(arm()));
    let (sqlite, mcap) = (fs::read(path).unwrap(), mcap(&on_topic(arm()), Some(Compression::Zstd)));
    let damage = |whole: &[u8], read: fn(&[u8])| {
        for place in (0..whole.len()).filter(|&place| place < 4096 || whole[place] != 0) {
            for damage in [0x00, 0x01, 0x7f, 0xff] {
                let mut bytes = whole.to_vec();
                bytes[place] = damage;
                read(&bytes);
            }
        }
    };
    damage(&sqlite, fuzz_db3);
    damage(&mcap, fuzz_mcap);
}

#[test]
fn summary_has_a_table_for_each_publisher() {
    let mut messages = on_topic(arm());
    messages.insert(1, (TOPIC, states(9, &["gripper"], &[0.1])));
    let (_folder, path) = db3(&messages);
    let (tables, others) = tables(&path, Format::Db3).unwrap();
    let names: Vec<Vec<&str>> = tables.iter().map(|t| t.columns.iter().map(|c| c.name.as_str()).collect()).collect();
    let arm = [
        "shoulder.stamp",
        "shoulder.log_time",
        "shoulder.position",
        "shoulder.velocity",
        "elbow.position",
        "elbow.velocity",
    ];
    assert_eq!(names[0], arm);
    assert_eq!(names[1], ["gripper.stamp", "gripper.log_time", "gripper.position", "gripper.velocity"]);
    assert_eq!(others, [OtherTopic { name: "/rosout".to_owned(), kind: "rcl_interfaces/msg/Log".to_owned() }]);
}
