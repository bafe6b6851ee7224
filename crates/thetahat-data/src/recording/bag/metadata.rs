//! Bags of several files: the folder that `ros2 bag record` writes, with `metadata.yaml` and the files in their order.

use std::path::{Path, PathBuf};

use super::super::error::RecordingError;
use super::super::format::Format;
use super::super::place::{file_length, inside, unreadable};
use super::error::BagError;
use super::file::add;
use super::topics::Topics;
use thetahat_ground::files;

/// The list of files in the metadata.
const FILES: &str = "relative_file_paths";
/// Longest metadata that are read, in bytes.
const LONGEST: u64 = 1 << 24;
/// Largest number of files.
const MOST_FILES: usize = 1 << 12;

/// The messages of all files of a bag; `path` is its folder or its metadata.
pub(super) fn read(path: &Path, topic: Option<&str>) -> Result<Topics, RecordingError> {
    let metadata = Format::metadata_of(path).unwrap_or_else(|| path.to_owned());
    let paths = paths(&metadata)?;
    let lengths: Vec<u64> = paths.iter().map(|(path, _)| file_length(path)).collect::<Result<_, _>>()?;
    let mut topics = Topics::new(&metadata, lengths.iter().fold(0, |sum, length| sum.saturating_add(*length)));
    for (path, format) in &paths {
        topics.path.clone_from(path);
        add(path, *format, topic, &mut topics)?;
    }
    topics.path = metadata;
    Ok(topics)
}

/// The files of a bag, each in the folder of its metadata: only their names count.
fn paths(metadata: &Path) -> Result<Vec<(PathBuf, Format)>, RecordingError> {
    if file_length(metadata)? > LONGEST {
        return Err(RecordingError::damaged(metadata, "it is longer than the metadata of any bag".to_owned()));
    }
    let text = files::read_to_string(metadata).map_err(|e| unreadable(metadata, e))?;
    let folder = metadata.parent().unwrap_or(Path::new(""));
    let found = listed(&text);
    let named = |name: &String| {
        let name = Path::new(name.rsplit(['/', '\\']).next().unwrap_or_default());
        let format = Format::of(name).ok().filter(|format| matches!(format, Format::Db3 | Format::Mcap))?;
        Some((name.to_owned(), format))
    };
    match found.iter().map(named).collect::<Option<Vec<_>>>() {
        Some(names) if !names.is_empty() && names.len() <= MOST_FILES => {
            names.into_iter().map(|(name, format)| Ok((inside(folder, &as_it_is(folder, name))?, format))).collect()
        }
        _ => {
            let problem = Box::new(BagError::BadMetadata { found });
            Err(RecordingError::Bag { file: metadata.to_owned(), problem })
        }
    }
}

/// The name of a file, or of what it was compressed to after the metadata were written.
fn as_it_is(folder: &Path, name: PathBuf) -> PathBuf {
    let mut compressed = name.clone().into_os_string();
    compressed.push(".zstd");
    let is_compressed = !files::is_file(&folder.join(&name)) && files::is_file(&folder.join(&compressed));
    if is_compressed { compressed.into() } else { name }
}

/// The files of a YAML text: the elements of their list, in lines of their own or in brackets.
fn listed(text: &str) -> Vec<String> {
    let mut lines = text.lines().map(str::trim).skip_while(|line| !line.starts_with(FILES));
    let after = lines.next().and_then(|line| line.split_once(':')).map_or("", |(_, after)| after.trim());
    let in_brackets = after.strip_prefix('[').and_then(|list| list.strip_suffix(']'));
    match in_brackets {
        Some(list) => list.split(',').map(unquoted).filter(|name| !name.is_empty()).collect(),
        None => lines.map_while(|line| line.strip_prefix("- ")).take(MOST_FILES + 1).map(unquoted).collect(),
    }
}

fn unquoted(text: &str) -> String {
    text.trim().trim_matches(['"', '\'']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_listed_in_lines_or_in_brackets() {
        let lines = "a:\n  relative_file_paths:\n    - b_0.db3\n    - \"b_1.db3\"\n  duration:\n    - 1\n";
        assert_eq!(listed(lines), ["b_0.db3", "b_1.db3"]);
        assert_eq!(listed("relative_file_paths: [b_0.mcap, 'b_1.mcap']"), ["b_0.mcap", "b_1.mcap"]);
        assert_eq!(listed("relative_file_paths: []"), [""; 0]);
        assert_eq!(listed("version: 4"), [""; 0]);
    }
}
