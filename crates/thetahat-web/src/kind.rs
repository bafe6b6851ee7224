//! The kind of a file, by its content.

use std::path::Path;

use thetahat::recording::Format;

use crate::{session::Outcome, store};

/// The kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Robot,
    Experiment,
    Results,
    Recording,
    Unknown,
}

impl Kind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Experiment => "experiment",
            Self::Results => "results",
            Self::Recording => "recording",
            Self::Unknown => "unknown",
        }
    }

    /// The kind of an existing file.
    pub(crate) fn of(path: &Path) -> Outcome<Self> {
        let beginning = store::beginning(path, BEGINNING)?;
        if BINARY.iter().any(|magic| beginning.starts_with(magic)) {
            return Ok(Self::Recording);
        }
        let text = String::from_utf8_lossy(&beginning);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        Ok(of_text(text).unwrap_or_else(|| of_name(path)))
    }
}

/// Bytes that are examined: enough to recognise a description.
const BEGINNING: usize = 1 << 18;
/// The first bytes of binary recordings: NumPy, zip, MAT of both versions and HDF5, Parquet, SQLite, MCAP, ROS 1 bags, Zstandard.
const BINARY: [&[u8]; 9] = [
    b"\x93NUMPY",
    b"PK\x03\x04",
    b"MATLAB ",
    b"\x89HDF",
    b"PAR1",
    b"SQLite format 3\0",
    b"\x89MCAP",
    b"#ROSBAG V2.0",
    b"\x28\xb5\x2f\xfd",
];

/// The kind of a text, if its content shows it.
fn of_text(text: &str) -> Option<Kind> {
    if text.starts_with('<') {
        let is_robot = ["<robot", "<mujoco"].iter().any(|root| text.contains(root));
        return Some(if is_robot { Kind::Robot } else { Kind::Unknown });
    }
    if text.starts_with('{') {
        return Some(if text.contains("\"thetahat\"") { Kind::Results } else { Kind::Unknown });
    }
    let has = |key: &str| keys(text).any(|found| found == key);
    if has("[signal]") {
        return Some(Kind::Experiment);
    }
    (has("[[joint]]") || has("urdf") || has("urdf_text")).then_some(Kind::Robot)
}

/// The keys and the heads of tables of a TOML.
fn keys(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(|line| {
        let line = line.trim();
        if line.starts_with('[') {
            line.split('#').next().unwrap_or_default().trim()
        } else {
            line.split('=').next().unwrap_or_default().trim()
        }
    })
}

/// The kind of a file by its extension.
fn of_name(path: &Path) -> Kind {
    if Format::of(path).is_ok() { Kind::Recording } else { Kind::Unknown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_recognised() {
        for (text, expected) in [
            ("<?xml version=\"1.0\"?>\n<robot name=\"arm\"/>", Some(Kind::Robot)),
            ("<mujoco model=\"arm\"></mujoco>", Some(Kind::Robot)),
            ("<html></html>", Some(Kind::Unknown)),
            ("# arm\nname = \"arm\"\n[[joint]]  # the first\nname = \"a\"", Some(Kind::Robot)),
            ("urdf = \"arm.urdf\"", Some(Kind::Robot)),
            ("title = \"t\"\nrobot = \"arm.urdf\"\n[signal]\ncutoff_hz = 5", Some(Kind::Experiment)),
            ("{ \"schema\": 2, \"thetahat\": \"0.1.0\" }", Some(Kind::Results)),
            ("{}", Some(Kind::Unknown)),
            ("t,q_1\n0,1\n", None),
        ] {
            assert_eq!(of_text(text), expected, "{text}");
        }
    }

    #[test]
    fn other_files_are_recognised_by_their_names() {
        assert_eq!(of_name(Path::new("run.CSV")), Kind::Recording);
        assert_eq!(of_name(Path::new("notes.md")), Kind::Unknown);
    }
}
