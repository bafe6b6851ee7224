//! Damaged and truncated bags: errors, never panics.

use std::path::Path;

use super::super::super::RecordingError;
use super::super::topics::Topics;
use super::super::{fuzz_db3, fuzz_mcap, fuzz_ros1, ros1, zstd};
use super::bags::{ALL_MCAP, FILE_DB3, MESSAGE_DB3, ROS1, ROS1_BZ2, ROS1_LZ4, bytes};

/// Distance of damaged bytes, so that the tests take seconds.
const EVERY: usize = 7;

fn damaged(whole: &[u8], read: fn(&[u8])) {
    for place in (0..whole.len()).step_by(EVERY).filter(|&place| place < 4096 || whole[place] != 0) {
        for damage in [0x00, 0x7f, 0xff] {
            let mut bytes = whole.to_vec();
            bytes[place] = damage;
            read(&bytes);
        }
    }
}

#[test]
fn bags_of_ros_1_never_panic() {
    [ROS1, ROS1_BZ2, ROS1_LZ4].into_iter().for_each(|text| damaged(&bytes(text), fuzz_ros1));
}

#[test]
fn bags_of_ros_1_cut_short_are_damaged() {
    for whole in [ROS1, ROS1_BZ2, ROS1_LZ4].map(bytes) {
        for length in (0..whole.len()).step_by(EVERY) {
            let mut topics = Topics::new(Path::new("a.bag"), length as u64);
            let error = ros1::read_from(&whole[..length], length as u64, None, &mut topics).err();
            // A bag that ends between two entries of its index is whole but for the index.
            assert!(matches!(error, None | Some(RecordingError::Damaged { .. })), "{length}: {error:?}");
            assert!(error.is_some() || length > 4096, "{length}");
        }
    }
}

#[test]
fn messages_of_any_type_in_mcap_never_panic() {
    damaged(&bytes(ALL_MCAP), fuzz_mcap);
}

#[test]
fn compressed_messages_never_panic() {
    damaged(&bytes(MESSAGE_DB3), fuzz_db3);
}

#[test]
fn compressed_files_cut_short_or_damaged_are_errors() {
    let whole = bytes(FILE_DB3);
    let read = |bytes: &[u8]| zstd::decompress(bytes, 1 << 20, Path::new("a.db3.zstd"), "the file").map(|_| ());
    for length in 0..whole.len() {
        assert!(matches!(read(&whole[..length]), Err(RecordingError::Damaged { .. })), "{length}");
        let mut bytes = whole.clone();
        bytes[length] ^= 0x55;
        let _ = read(&bytes);
    }
}

#[test]
fn other_files_are_no_bags_of_ros_1() {
    let text = b"t,q\n0,1\n".repeat(100);
    let error = ros1::read_from(text.as_slice(), 800, None, &mut Topics::new(Path::new("a.bag"), 800)).unwrap_err();
    assert!(matches!(&error, RecordingError::Damaged { reason, .. } if reason.contains("#ROSBAG V2.0")), "{error}");
}

/// A chunk of a few bytes that states gigabytes, or decompresses to more than it states.
#[test]
fn chunks_of_ros_1_cannot_ask_for_memory() {
    let whole = bytes(ROS1_BZ2);
    let place = whole.windows(5).position(|bytes| bytes == b"size=").unwrap() + 5;
    for size in [u32::MAX, 1 << 27, 10, 0] {
        let mut bytes = whole.clone();
        bytes[place..place + 4].copy_from_slice(&size.to_le_bytes());
        let mut topics = Topics::new(Path::new("a.bag"), bytes.len() as u64);
        let error = ros1::read_from(bytes.as_slice(), bytes.len() as u64, None, &mut topics).unwrap_err();
        assert!(
            matches!(&error, RecordingError::Damaged { reason, .. } if reason.contains("chunk")),
            "{size}: {error}"
        );
    }
}
