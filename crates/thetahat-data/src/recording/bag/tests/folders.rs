//! Folders of bags, and compressed files and messages.

use std::fs;
use std::path::Path;

use super::super::super::{ChannelSource, Format, RecordingError, inspect, read_channels};
use super::super::zstd::decompress;
use super::super::{BagError, channels};
use super::bags::{ALL_MCAP, FILE_DB3, MESSAGE_DB3, bytes};
use super::written::*;
use thetahat_testing::Folder;

const COLUMN: &str = "file = 'run'\ncolumns = ['elbow.position']\nunit = 'rad'";

/// A folder `run` with metadata that list these files, and the files.
fn folder(files: &[(&str, Vec<u8>)]) -> Folder {
    let folder = Folder::with("notes.txt", b"");
    fs::create_dir(folder.path().join("run")).unwrap();
    let names: Vec<String> = files.iter().map(|(name, _)| format!("    - {name}\n")).collect();
    let text = format!("rosbag2_bagfile_information:\n  relative_file_paths:\n{}  duration:\n", names.concat());
    fs::write(folder.path().join("run/metadata.yaml"), text).unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join("run").join(name), bytes).unwrap();
    }
    folder
}

fn halves() -> Folder {
    let messages = on_topic(arm());
    let (first, last) = messages.split_at(2);
    let (_folder, path) = db3(last);
    folder(&[("run_0.mcap", mcap(first, None)), ("run_1.db3", fs::read(path).unwrap())])
}

#[test]
fn files_of_a_folder_are_one_recording() {
    let folder = halves();
    for file in ["run", "run/metadata.yaml", "./run/"] {
        let source: ChannelSource = toml::from_str(&COLUMN.replace("run", file)).unwrap();
        let series = read_channels(&source, folder.path()).unwrap();
        assert_eq!(series.len(), 3, "{file}");
        let path = folder.path().join(file);
        assert_eq!(Format::of(&path).unwrap(), Format::Metadata);
        assert_eq!(inspect(&path).unwrap().tables[0].samples, 3);
    }
}

#[test]
fn folder_that_leaves_that_of_the_data() {
    let folder = halves();
    let source: ChannelSource = toml::from_str(&COLUMN.replace("run", "../run")).unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    let error = read_channels(&source, &folder.path().join("data")).unwrap_err();
    assert!(matches!(error, RecordingError::OutsideData { .. }), "{error}");
}

#[test]
fn folder_whose_metadata_name_no_bag() {
    for files in [vec![], vec![("notes.csv", b"q\n1\n".to_vec())]] {
        let folder = folder(&files);
        let error = read_channels(&toml::from_str(COLUMN).unwrap(), folder.path()).unwrap_err();
        let RecordingError::Bag { problem, .. } = error else { panic!("{error}") };
        assert!(matches!(*problem, BagError::BadMetadata { .. }), "{problem}");
    }
}

/// Only the names of files count, so that metadata lead nowhere else.
#[test]
fn file_of_a_folder_that_is_not_there() {
    let folder = folder(&[("run_0.mcap", mcap(&on_topic(arm()), None))]);
    fs::write(folder.path().join("run/metadata.yaml"), "relative_file_paths: [../../run_9.mcap]").unwrap();
    let error = read_channels(&toml::from_str(COLUMN).unwrap(), folder.path()).unwrap_err();
    assert!(matches!(&error, RecordingError::FileNotFound { file } if file.ends_with("run/run_9.mcap")), "{error}");
}

#[test]
fn folder_without_metadata() {
    let folder = Folder::with("notes.txt", b"");
    fs::create_dir(folder.path().join("run")).unwrap();
    let error = read_channels(&toml::from_str(COLUMN).unwrap(), folder.path()).unwrap_err();
    assert!(matches!(error, RecordingError::UnknownFormat { .. }), "{error}");
}

#[test]
fn compressed_files_and_messages() {
    let whole = ::zstd::encode_all(bytes(ALL_MCAP).as_slice(), 3).unwrap();
    for (name, bytes) in [("a.db3", bytes(MESSAGE_DB3)), ("a.db3.zstd", bytes(FILE_DB3)), ("a.mcap.zstd", whole)] {
        let folder = Folder::with(name, bytes);
        let path = folder.path().join(name);
        let format = Format::of(&path).unwrap();
        let columns = ["stamp", "elbow.position"].map(str::to_owned);
        let series = channels(&path, format, None, &columns).unwrap();
        assert_eq!(series.values(), [0.0, 2.0, 8_000_000.0 * 1e-9, 3.0], "{name}");
    }
}

/// A few bytes that would become many.
#[test]
fn compressed_bytes_that_expand_beyond_the_limit() {
    let expanding = ::zstd::encode_all([0; 1 << 20].as_slice(), 1).unwrap();
    let decompressed = |limit| decompress(expanding.as_slice(), limit, Path::new("a.db3"), "a message").unwrap();
    assert!(decompressed((1 << 20) - 1).is_none() && decompressed(1 << 20).is_some());
}

#[test]
fn compressed_file_cut_short() {
    let whole = ::zstd::encode_all(bytes(ALL_MCAP).as_slice(), 3).unwrap();
    for (name, whole, format) in [("a.mcap.zstd", whole, Format::Mcap), ("a.db3.zstd", bytes(FILE_DB3), Format::Db3)] {
        for length in (1..whole.len()).step_by(40) {
            let folder = Folder::with(name, &whole[..length]);
            let error = channels(&folder.path().join(name), format, None, &["elbow.position".to_owned()]).unwrap_err();
            assert!(matches!(error, RecordingError::Damaged { .. }), "{name}, {length}: {error}");
        }
    }
}
