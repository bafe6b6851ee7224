use super::{
    columns,
    error::ProposalError,
    joints::JointsOfLog,
    request::ProposalRequest,
    source::{SelectedColumn, Source, channels},
};
use thetahat_model::robot::Robot;

/// The columns that the user named for a signal.
pub(super) struct Named<'s, 'a> {
    signal: &'static str,
    sources: &'s [Source<'a>],
    entries: Vec<Entry<'s>>,
}

/// A file by its number, a column, or a column of a file.
#[derive(Clone, Copy)]
pub(super) struct Entry<'s> {
    pub(super) file: Option<usize>,
    pub(super) column: Option<&'s str>,
}

impl<'s, 'a> Named<'s, 'a> {
    /// `arguments` are `NAME`, `FILE` or `FILE:NAME`; names after a `FILE:NAME` are of that file too, if it has them.
    pub(super) fn new(signal: &'static str, arguments: &'s [String], sources: &'s [Source<'a>]) -> Self {
        let mut entries: Vec<Entry<'s>> = Vec::new();
        for argument in arguments {
            let entry = entry(argument, sources);
            let before = entries.last().and_then(|e| e.column.and(e.file));
            let of_before = before.filter(|&file| sources[file].column(argument).is_some());
            entries.push(Entry { file: entry.file.or(of_before), ..entry });
        }
        Self { signal, sources, entries }
    }

    /// Of each file the columns named, if it has all of them; none if nothing was named.
    pub(super) fn columns(
        &self,
        joints: &JointsOfLog,
    ) -> Result<Option<Vec<Option<Vec<SelectedColumn<'a>>>>>, ProposalError> {
        if self.entries.is_empty() {
            return Ok(None);
        }
        let found: Vec<Result<Vec<SelectedColumn<'a>>, &str>> =
            (0..self.sources.len()).map(|file| self.of_file(file)).collect();
        let likeliest = self.entries.iter().find_map(|e| e.file).unwrap_or(0);
        if let (true, Err(name)) = (found.iter().all(Result::is_err), &found[likeliest]) {
            let source = &self.sources[likeliest];
            let (file, name) = (source.file.to_owned(), (*name).to_owned());
            return Err(ProposalError::NoSuchColumn { file, name, columns: source.listed() });
        }
        let left = |columns| joints.left(columns);
        let found: Vec<Result<Vec<SelectedColumn<'a>>, &str>> =
            found.into_iter().map(|found| found.map(left)).collect();
        let count = joints.robot.coordinate_count();
        match found.iter().flatten().map(|columns| channels(columns)).find(|&found| found != count) {
            None => Ok(Some(found.into_iter().map(Result::ok).collect())),
            Some(found) => {
                let (signal, robot) = (self.signal, joints.robot.name.clone());
                Err(ProposalError::ColumnCount { signal, found, robot, joints: count })
            }
        }
    }

    /// The columns of a file that are named, or the first that it has not.
    fn of_file(&self, file: usize) -> Result<Vec<SelectedColumn<'a>>, &'s str> {
        let source = &self.sources[file];
        let mut columns = Vec::new();
        for entry in self.entries.iter().filter(|e| e.file.is_none_or(|of| of == file)) {
            match entry.column {
                Some(name) => columns.push(source.column(name).ok_or(name)?),
                None => columns.extend(source.columns().filter(|c| !source.is_time(&c.name)).map(SelectedColumn::of)),
            }
        }
        if columns.is_empty() { Err(self.entries[0].column.unwrap_or_default()) } else { Ok(columns) }
    }
}

/// The request with the columns of each group that was named for a signal in the place of the group: a name that columns begin with.
pub(super) fn with_groups(request: &ProposalRequest, sources: &[Source<'_>], robot: &Robot) -> ProposalRequest {
    let columns = |arguments: &[String]| arguments.iter().flat_map(|a| of_group(a, sources, robot)).collect();
    ProposalRequest { position: columns(&request.position), torque: columns(&request.torque), ..request.clone() }
}

/// The columns of the group that an argument names, or the argument.
fn of_group(argument: &str, sources: &[Source<'_>], robot: &Robot) -> Vec<String> {
    let Entry { file, column } = entry(argument, sources);
    let asked: Vec<&Source<'_>> =
        sources.iter().enumerate().filter(|(n, _)| file.is_none_or(|of| of == *n)).map(|(_, s)| s).collect();
    let named = || vec![argument.to_owned()];
    let Some(column) = column.filter(|name| asked.iter().all(|source| source.column(name).is_none())) else {
        return named();
    };
    let groups = asked.iter().map(|source| columns::of_group(source, robot, column));
    let found = groups.into_iter().find(|columns| !columns.is_empty()).unwrap_or_default();
    let file = &argument[..argument.len() - column.len()];
    let names: Vec<String> = found.iter().map(|column| format!("{file}{}", column.name)).collect();
    if names.is_empty() { named() } else { names }
}

/// What an argument means: `NAME`, `FILE` or `FILE:NAME`.
pub(super) fn entry<'s>(argument: &'s str, sources: &[Source<'_>]) -> Entry<'s> {
    let file = |name: &str| sources.iter().position(|s| s.is_called(name));
    if let Some(number) = file(argument) {
        return Entry { file: Some(number), column: None };
    }
    let split = argument.match_indices(':').find_map(|(at, _)| Some((file(&argument[..at])?, &argument[at + 1..])));
    match split {
        Some((number, column)) => Entry { file: Some(number), column: Some(column) },
        None => Entry { file: None, column: Some(argument) },
    }
}
