//! What an expansion knows and has used so far.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    ExpressionError, XacroError, XacroOptions, XacroProblem,
    folders::Folders,
    scope::Scopes,
    tree::{DEEPEST, shortened},
};
use crate::robot::text_file::{RobotFile, TextFile, read};

/// Most steps of an evaluation: far above those of any robot, and seconds at most.
const MOST_STEPS: usize = 4_000_000;
/// Most elements and texts of an expansion.
const MOST_NODES: usize = 500_000;
/// Most bytes of the values of attributes and of texts.
const MOST_BYTES: usize = 64 << 20;
/// Bytes of text, or entries of values, that count as one step.
const BYTES_PER_STEP: usize = 64;
/// Most files of an expansion, each as often as it is read.
const MOST_FILES: usize = 1000;

/// An expansion under way.
pub(super) struct Expander {
    /// The values of arguments.
    pub(super) arguments: BTreeMap<String, String>,
    pub(super) scopes: Scopes,
    pub(super) folders: Folders,
    /// The files that were read, each once.
    pub(super) files: Vec<(PathBuf, RobotFile)>,
    /// The file being expanded, after those that include it.
    pub(super) current: Vec<PathBuf>,
    /// Prefixes of other namespaces than xacro's.
    pub(super) namespaces: Vec<(String, String)>,
    depth: usize,
    steps: usize,
    nodes: usize,
    bytes: usize,
    reads: usize,
}

impl Expander {
    pub(super) fn new(path: &Path, options: &XacroOptions) -> Self {
        Self {
            arguments: options.arguments.iter().cloned().collect(),
            scopes: Scopes::new(),
            folders: Folders::new(path, options),
            files: Vec::new(),
            current: Vec::new(),
            namespaces: Vec::new(),
            depth: 0,
            steps: 0,
            nodes: 0,
            bytes: 0,
            reads: 0,
        }
    }

    /// The file being expanded.
    pub(super) fn file(&self) -> &Path {
        self.current.last().map_or(Path::new(""), PathBuf::as_path)
    }

    /// Goes one level deeper: into an element, a macro, a text or an expression.
    pub(super) fn enter(&mut self) -> Result<(), XacroProblem> {
        if self.depth >= DEEPEST {
            return Err(XacroProblem::TooDeep { limit: DEEPEST });
        }
        self.depth += 1;
        Ok(())
    }

    pub(super) fn enter_expression(&mut self) -> Result<(), ExpressionError> {
        self.enter()
            .map_err(|_| ExpressionError::TooLarge { what: "levels of nested properties and macros", limit: DEEPEST })
    }

    pub(super) fn leave(&mut self) {
        self.depth -= 1;
    }

    /// Counts the work for a text or value of this size.
    pub(super) fn spend(&mut self, size: usize) -> Result<(), ExpressionError> {
        self.steps += 1 + size / BYTES_PER_STEP;
        if self.steps <= MOST_STEPS {
            return Ok(());
        }
        Err(ExpressionError::TooLarge { what: "steps of evaluation", limit: MOST_STEPS })
    }

    /// Counts an element or text of the expansion.
    pub(super) fn add_node(&mut self) -> Result<(), XacroProblem> {
        self.nodes += 1;
        if self.nodes <= MOST_NODES {
            return Ok(());
        }
        Err(XacroProblem::TooLarge { what: "elements and texts", limit: MOST_NODES })
    }

    /// Counts the bytes of an attribute or text of the expansion.
    pub(super) fn add_bytes(&mut self, bytes: usize) -> Result<(), XacroProblem> {
        self.bytes += bytes;
        if self.bytes <= MOST_BYTES {
            return Ok(());
        }
        Err(XacroProblem::TooLarge { what: "bytes of values", limit: MOST_BYTES })
    }

    /// The text of a file that a file may name.
    pub(super) fn read(&mut self, path: &Path) -> Result<String, XacroError> {
        self.reads += 1;
        if self.reads > MOST_FILES {
            let problem = Box::new(XacroProblem::TooLarge { what: "files that are read", limit: MOST_FILES });
            return Err(XacroError::Reading { path: path.to_owned(), problem });
        }
        if !self.folders.may_read(path) {
            let problem = Box::new(XacroProblem::Outside { path: path.to_owned() });
            return Err(XacroError::Reading { path: self.file().to_owned(), problem });
        }
        let TextFile { text, file } = read(path).map_err(|error| {
            let reason = error.to_string();
            XacroError::File { path: path.to_owned(), reason }
        })?;
        if self.files.iter().all(|(known, _)| known != path) {
            self.files.push((path.to_owned(), file));
        }
        Ok(text)
    }
}

/// The problem of a text that has no value.
pub(super) fn text_problem(text: &str, error: ExpressionError) -> XacroProblem {
    XacroProblem::Text { text: shortened(text), error }
}
