//! The text of a model with those of its `<include>` elements in their places.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use roxmltree::{Document, Node};

use super::error::MjcfError;
use crate::robot::{Place, RobotError, parse_xml};
use thetahat_ground::{files, visible::visible};

/// Most files that a model includes, and how deep.
const MOST_FILES: usize = 200;
const DEEPEST: usize = 20;
/// Most bytes of all files together.
const MOST_BYTES: usize = 16 << 20;

/// Reads the text of a file.
pub(in crate::robot) type ReadText<'r> = &'r dyn Fn(&Path) -> Result<String, RobotError>;

/// The files that a joined text is from; empty for a text without `<include>`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(in crate::robot) struct Origins {
    pieces: Vec<Piece>,
    files: Vec<(PathBuf, String)>,
}

/// A stretch of a joined text.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Piece {
    /// Where it begins in the joined text, bytes.
    start: usize,
    path: PathBuf,
    /// Its first line in its own file, from one.
    line: usize,
}

impl Origins {
    /// The files with their texts, that of the model first.
    pub(in crate::robot) fn files(&self) -> &[(PathBuf, String)] {
        &self.files
    }

    /// The file and the line of a position in the joined `text`, which is the file at `path` if nothing was joined.
    pub(super) fn line_at(&self, text: &str, path: &Path, position: usize) -> (PathBuf, usize) {
        let before = self.pieces.partition_point(|piece| piece.start <= position);
        let lines = |start: usize| text.as_bytes()[start..position].iter().filter(|byte| **byte == b'\n').count();
        match before.checked_sub(1).map(|last| &self.pieces[last]) {
            Some(piece) => (piece.path.clone(), piece.line + lines(piece.start)),
            None => (path.to_owned(), 1 + lines(0)),
        }
    }
}

/// The text of the model at `path` with what it includes, from its folder and the folders in it.
pub(in crate::robot) fn join(text: String, path: &Path, read: ReadText<'_>) -> Result<(String, Origins), RobotError> {
    if !text.contains("<include") {
        return Ok((text, Origins::default()));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (joined, origins) = (String::with_capacity(text.len()), Origins::default());
    let mut joiner = Joiner { folder, read, text: joined, origins, open: Vec::new(), bytes: 0 };
    joiner.open.extend(files::real(path).ok());
    joiner.origins.files.push((path.to_owned(), text.clone()));
    joiner.append(text.trim_start_matches('\u{feff}'), path, Extent::Whole)?;
    Ok((joiner.text, joiner.origins))
}

/// How much of a file is used.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extent {
    Whole,
    /// What its root element holds.
    Content,
}

struct Joiner<'r> {
    folder: &'r Path,
    read: ReadText<'r>,
    text: String,
    origins: Origins,
    /// The file being joined and those that include it.
    open: Vec<PathBuf>,
    /// Length of all texts that were read.
    bytes: usize,
}

impl Joiner<'_> {
    fn append(&mut self, text: &str, path: &Path, extent: Extent) -> Result<(), RobotError> {
        self.spend(text.len(), path)?;
        let document = parse_xml(text, path).map_err(MjcfError::from)?;
        let range = if extent == Extent::Whole { 0..text.len() } else { content(&document) };
        let lines = |range: Range<usize>| text[range].matches('\n').count();
        let (mut at, mut line) = (range.start, 1 + lines(0..range.start));
        for include in document.descendants().filter(|node| node.has_tag_name("include")) {
            let Range { start, end } = include.range();
            if start < at {
                continue;
            }
            self.push(&text[at..start], path, line);
            self.include(include, &Place { line: line + lines(at..start), ..place(include, path) }, path)?;
            (line, at) = (line + lines(at..end), end);
        }
        self.push(&text[at..range.end], path, line);
        Ok(())
    }

    fn push(&mut self, text: &str, path: &Path, line: usize) {
        self.origins.pieces.push(Piece { start: self.text.len(), path: path.to_owned(), line });
        self.text.push_str(text);
    }

    /// Joined text is never longer than what was read.
    fn spend(&mut self, bytes: usize, path: &Path) -> Result<(), MjcfError> {
        self.bytes += bytes;
        let too_large = |what, limit| Err(MjcfError::TooLarge { path: path.to_owned(), what, limit });
        if self.bytes > MOST_BYTES {
            return too_large("MiB of text, included files counted", MOST_BYTES >> 20);
        }
        if self.origins.files.len() > MOST_FILES {
            return too_large("included files", MOST_FILES);
        }
        Ok(())
    }

    fn include(&mut self, include: Node<'_, '_>, place: &Place, path: &Path) -> Result<(), RobotError> {
        let Some(file) = include.attribute("file") else {
            let remedy = "name the file: <include file=\"...\"/>";
            return Err(MjcfError::Missing { place: place.clone(), missing: "attribute file", remedy }.into());
        };
        let refuse = |problem| MjcfError::Include { place: place.clone(), file: visible(file).into_owned(), problem };
        let target = self.target(path, file).map_err(refuse)?;
        let real = files::real(&target).ok();
        if self.open.len() > DEEPEST || real.as_ref().is_some_and(|real| self.open.contains(real)) {
            return Err(refuse("it includes itself in the end; remove one of the two").into());
        }
        let text = (self.read)(&target)?;
        self.origins.files.push((target.clone(), text.clone()));
        self.open.extend(real.clone());
        self.append(text.trim_start_matches('\u{feff}'), &target, Extent::Content)?;
        self.open.truncate(self.open.len() - usize::from(real.is_some()));
        Ok(())
    }

    /// The file of an `<include>`: relative to the folder of the model, otherwise to that of the file with the element. It must be in
    /// the folder of the model, links followed, so that a foreign model cannot read any other file.
    fn target(&self, path: &Path, file: &str) -> Result<PathBuf, &'static str> {
        let in_own_folder = path.parent().map(|folder| folder.join(file));
        let candidates = [Some(self.folder.join(file)), in_own_folder];
        let mut existing = candidates.into_iter().flatten().filter(|candidate| files::is_file(candidate));
        let target = existing.next().ok_or("there is no such file; copy it into the folder of the model")?;
        match files::real(&target).ok().zip(files::real(self.folder).ok()) {
            Some((target, folder)) if !target.starts_with(&folder) => {
                Err("it is not in the folder of the model or a folder in it; copy it there")
            }
            Some(_) | None => Ok(target),
        }
    }
}

/// The range of what the root element holds.
fn content(document: &Document<'_>) -> Range<usize> {
    let root = document.root_element();
    let start = root.first_child().map_or(root.range().end, |child| child.range().start);
    start..root.last_child().map_or(start, |child| child.range().end)
}

fn place(node: Node<'_, '_>, path: &Path) -> Place {
    Place { path: path.to_owned(), line: 0, element: format!("<{}>", node.tag_name().name()) }
}
