//! Datasets of LeRobot: names of channels in another file, and several episodes in one file.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::super::error::RecordingError;
use super::super::place;
use thetahat_ground::files;

/// The column that numbers the episodes.
pub(super) const EPISODE: &str = "episode_index";
/// Columns that a dataset of LeRobot has.
const SIGNALS: [&str; 2] = ["observation.state", "action"];
/// Largest description of a dataset that is read.
const LARGEST_INFO_BYTES: u64 = 1 << 20;

/// What a dataset says of its columns, in `meta/info.json`.
#[derive(Default)]
pub(in super::super) struct DatasetInfo(Option<Value>);

impl DatasetInfo {
    /// The description of the dataset of a file `data/chunk-000/NAME.parquet`; empty for other files, and outside of `root`.
    pub(in super::super) fn of(file: &Path, root: Option<&Path>) -> Self {
        let read = || {
            let path = info_path(file)?;
            let path = match root {
                Some(root) => place::inside(root, path.strip_prefix(root).ok()?).ok()?,
                None => path,
            };
            let is_small = files::length(&path).ok()? <= LARGEST_INFO_BYTES;
            serde_json::from_slice(&files::read(&path).ok().filter(|_| is_small)?).ok()
        };
        Self(read())
    }

    /// The names of a column's channels, `COLUMN.NAME`; none if it has another number of channels or equal names.
    pub(super) fn channel_names(&self, column: &str, channels: usize) -> Vec<String> {
        let names = self.0.as_ref().and_then(|info| info.get("features")?.get(column)?.get("names"));
        let names: Vec<&str> = names.map(listed).unwrap_or_default();
        let mut sorted = names.clone();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() != channels {
            return Vec::new();
        }
        names.iter().map(|name| format!("{column}.{name}")).collect()
    }
}

fn info_path(file: &Path) -> Option<PathBuf> {
    let mut folders = file.ancestors().skip(1);
    let (chunk, data, dataset) = (folders.next()?, folders.next()?, folders.next()?);
    let is_chunk = chunk.file_name()?.to_string_lossy().starts_with("chunk-");
    (is_chunk && data.file_name()? == "data").then(|| dataset.join("meta").join("info.json"))
}

/// A list of names, or the only list of an object such as `{"motors": [...]}`.
fn listed(names: &Value) -> Vec<&str> {
    match names {
        Value::Array(list) => list.iter().filter_map(Value::as_str).collect(),
        Value::Object(groups) => groups.values().next().filter(|_| groups.len() == 1).map(listed).unwrap_or_default(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Vec::new(),
    }
}

/// The rows of an episode, and what is to be said of them.
pub(super) struct Episode {
    pub(super) rows: Range<usize>,
    pub(super) note: Option<String>,
}

impl Episode {
    /// All rows, of a file without numbers of episodes.
    pub(super) fn whole(samples: usize, asked: Option<u64>, file: &Path) -> Result<Self, RecordingError> {
        match asked {
            None => Ok(Self { rows: 0..samples, note: None }),
            Some(episode) => {
                let found = format!("the file has no column {EPISODE:?}");
                Err(RecordingError::MissingEpisode { file: file.to_owned(), episode, found })
            }
        }
    }

    /// The rows of the asked episode, or otherwise of the first.
    pub(super) fn among(numbers: &[f64], asked: Option<u64>, file: &Path) -> Result<Self, RecordingError> {
        let Some(&first) = numbers.first() else { return Self::whole(0, None, file) };
        let chosen = asked.map_or(first, |episode| episode as f64);
        let (least, most) = numbers.iter().fold((first, first), |(a, b), &n| (a.min(n), b.max(n)));
        let Some(start) = numbers.iter().position(|number| *number == chosen) else {
            let (episode, found) = (asked.unwrap_or_default(), format!("the episodes are {least} to {most}"));
            return Err(RecordingError::MissingEpisode { file: file.to_owned(), episode, found });
        };
        let length = numbers[start..].iter().take_while(|number| **number == chosen).count();
        if numbers[start + length..].contains(&chosen) {
            let reason = format!("the rows of episode {chosen} are not together");
            return Err(RecordingError::damaged(file, reason));
        }
        let note = (least < most).then(|| {
            format!("Episode {chosen} of the episodes {least} to {most} is read; set episode = NUMBER for another one.")
        });
        Ok(Self { rows: start..start + length, note })
    }
}

/// The units of a dataset's positions are not in it.
pub(super) fn note_on_units<'a>(mut columns: impl Iterator<Item = &'a str>) -> Option<String> {
    columns.any(|name| SIGNALS.contains(&name)).then(|| {
        "LeRobot records positions from -100 to 100, in degrees or in rad, and the file does not say which: state the unit.".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(names: &str) -> DatasetInfo {
        let text = format!(r#"{{"features": {{"action": {{"dtype": "float32", "names": {names}}}}}}}"#);
        DatasetInfo(serde_json::from_str(&text).ok())
    }

    #[test]
    fn names_are_a_list_or_the_list_of_an_object() {
        for names in [r#"["pan", "lift"]"#, r#"{"motors": ["pan", "lift"]}"#] {
            assert_eq!(info(names).channel_names("action", 2), ["action.pan", "action.lift"]);
        }
        for names in ["null", r#"["pan"]"#, r#"["pan", "pan"]"#, r#"{"a": ["x", "y"], "b": []}"#, "[1, 2]", "{"] {
            assert!(info(names).channel_names("action", 2).is_empty(), "{names}");
        }
        assert!(info(r#"["pan", "lift"]"#).channel_names("observation.state", 2).is_empty());
    }

    #[test]
    fn the_description_is_above_the_chunks() {
        let path = |file: &str| info_path(Path::new(file));
        assert_eq!(path("set/data/chunk-000/file-000.parquet").unwrap(), Path::new("set/meta/info.json"));
        assert_eq!(path("data/chunk-000/file-000.parquet").unwrap(), Path::new("meta/info.json"));
        assert_eq!((path("q.parquet"), path("a/b/q.parquet"), path("data/b/q.parquet")), (None, None, None));
    }

    #[test]
    fn a_description_outside_the_folder_of_the_data_is_not_read() {
        let text = r#"{"features": {"action": {"names": ["pan"]}}}"#;
        let folder = thetahat_testing::Folder::with("meta/info.json", text);
        let file = folder.write("data/chunk-000/q.parquet", "").at("data/chunk-000/q.parquet");
        let count = |root: Option<&Path>| DatasetInfo::of(&file, root).channel_names("action", 1).len();
        assert_eq!((count(None), count(Some(folder.path())), count(file.parent())), (1, 1, 0));
    }

    #[test]
    fn rows_of_an_episode() {
        let among = |numbers: &[f64], asked| Episode::among(numbers, asked, Path::new("q.parquet"));
        let numbers = [3.0, 3.0, 4.0, 4.0, 4.0];
        let first = among(&numbers, None).unwrap();
        assert_eq!((first.rows, first.note.is_some()), (0..2, true));
        assert_eq!(among(&numbers, Some(4)).unwrap().rows, 2..5);
        assert!(among(&numbers[..2], None).unwrap().note.is_none());
        assert!(matches!(among(&numbers, Some(5)), Err(RecordingError::MissingEpisode { episode: 5, .. })));
        assert!(matches!(among(&[1.0, 2.0, 1.0], None), Err(RecordingError::Damaged { .. })));
    }
}
