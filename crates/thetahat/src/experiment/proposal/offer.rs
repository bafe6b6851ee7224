use std::path::PathBuf;

use super::{
    super::{
        column_names::{self, Signal},
        driver::DriverColumns,
    },
    columns,
    error::ProposalError,
    joints::JointsOfLog,
    named::Named,
    request::{ProposalRequest, is_named},
    source::{SelectedColumn, Source},
};
use thetahat_data::recording::{ColumnSummary, Contents, TableSummary};

/// What a file offers: the columns of each signal, one channel for each joint.
pub(super) struct Offer<'a> {
    pub(super) source: Source<'a>,
    pub(super) position: Result<Vec<SelectedColumn<'a>>, String>,
    pub(super) torque: Result<Vec<SelectedColumn<'a>>, String>,
    pub(super) velocity: Option<Vec<SelectedColumn<'a>>>,
    pub(super) reference: Option<Vec<SelectedColumn<'a>>>,
}

impl Offer<'_> {
    /// Whether columns look like torques, at least one for each joint, and it is not clear which are meant.
    pub(super) fn has_unclear_torques(&self, joints: usize) -> bool {
        let is_torque = |c: &ColumnSummary| {
            let is_void = c.statistics.iter().all(|channel| channel.min.is_none());
            !is_void && self.source.reading(&c.name).is_some_and(|reading| reading.signal == Signal::Torque)
        };
        let found: usize = self.source.columns().filter(|c| is_torque(c)).map(|c| c.channels).sum();
        self.torque.is_err() && found >= joints
    }

    /// Whether nothing in the file is of use but times.
    pub(super) fn is_empty(&self) -> bool {
        self.position.is_err() && self.torque.is_err() && self.velocity.is_none() && self.reference.is_none()
    }
}

/// A table that is used of a file, and its columns as the driver has them.
pub(super) struct ChosenTable<'a> {
    /// The number of the file.
    file: usize,
    table: Option<&'a TableSummary>,
    columns: DriverColumns,
    /// Whether it is one topic of those that hold one signal each.
    is_one_topic: bool,
}

/// The table that is used of each file, or the topics of a bag that hold one signal each. `joints` are the names of the robot's joints.
pub(super) fn tables<'a>(
    request: &ProposalRequest,
    contents: &'a [Contents],
    joints: &[String],
) -> Vec<ChosenTable<'a>> {
    let of_driver = |table: &TableSummary| {
        let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        request.driver.as_ref().map(|driver| DriverColumns::of(driver, &names, joints)).unwrap_or_default()
    };
    let chosen = |(file, contents): (usize, &'a Contents)| {
        let best = contents.tables.iter().rev().max_by_key(|table| of_driver(table).len());
        let of_one = |table: Option<&'a TableSummary>, is_one_topic| ChosenTable {
            file,
            table,
            columns: table.map(of_driver).unwrap_or_default(),
            is_one_topic,
        };
        match (best.filter(|best| of_driver(best).len() > 0), topics_of_one_signal(request, contents)) {
            (None, several) if !several.is_empty() => several.into_iter().map(|t| of_one(Some(t), true)).collect(),
            (best, _) => vec![of_one(best.or_else(|| chosen_table(request, contents)), false)],
        }
    };
    contents.iter().enumerate().flat_map(chosen).collect()
}

/// The topics of a bag that are named for the positions and the torques, or whose names say which of them they hold where their columns
/// say nothing; empty if one topic holds both.
fn topics_of_one_signal<'a>(request: &ProposalRequest, contents: &'a Contents) -> Vec<&'a TableSummary> {
    // Torques that a controller computed are no measured ones.
    let is_measured = |table: &TableSummary| !column_names::says_desired_torque(&table.name);
    let says = |table: &TableSummary| column_names::read_file_name(&table.name).filter(|_| is_measured(table));
    let has = |table: &TableSummary, named: &[String], signal: Signal| {
        let columns = || table.columns.iter().filter(|column| column.not_numeric.is_none());
        let is_of = |column: &ColumnSummary| column_names::read(&column.name).is_some_and(|r| r.signal == signal);
        let is_silent = || columns().any(|column| column_names::is_silent(&column.name));
        match named {
            [] => columns().any(is_of) || (says(table) == Some(signal) && is_silent()),
            [..] => named.iter().any(|name| is_topic(name, table)),
        }
    };
    let signals = [(&request.position, Signal::Position), (&request.torque, Signal::Torque)];
    let of = |table: &TableSummary| signals.map(|(named, signal)| has(table, named, signal));
    let tables = || contents.tables.iter().filter(|_| contents.format.is_bag());
    let some = |k: usize| tables().any(|table| of(table)[k]);
    if tables().any(|table| of(table) == [true; 2]) || !some(0) || !some(1) {
        return Vec::new();
    }
    tables().filter(|table| of(table) != [false; 2]).collect()
}

/// Whether a name is that of a topic, or of columns of it.
fn is_topic(name: &str, table: &TableSummary) -> bool {
    name.strip_prefix(&table.name).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
}

/// The files, each with a table of it that is used.
pub(super) fn sources<'a>(
    request: &'a ProposalRequest,
    contents: &'a [Contents],
    tables: &'a [ChosenTable<'a>],
) -> Vec<Source<'a>> {
    let folders = contents.windows(2).any(|pair| pair[0].file.parent() != pair[1].file.parent());
    let files: Vec<(&'a Contents, &'a PathBuf)> = contents.iter().zip(&request.recording_files).collect();
    let source = |chosen: &'a ChosenTable<'a>| {
        let (contents, file) = files.get(chosen.file)?;
        Some(Source {
            contents,
            file: file.as_path(),
            table: chosen.table,
            is_one_topic: chosen.is_one_topic,
            in_several_folders: folders,
            driver: request.driver.as_ref().map(|driver| (driver, &chosen.columns)),
        })
    };
    tables.iter().filter_map(source).collect()
}

/// What each of the files offers.
pub(super) fn offers<'a>(
    request: &'a ProposalRequest,
    joints: &JointsOfLog,
    sources: &[Source<'a>],
) -> Result<Vec<Offer<'a>>, ProposalError> {
    let position = Named::new("position", &request.position, sources).columns(joints)?;
    let torque = Named::new("torque", &request.torque, sources).columns(joints)?;
    let offer = |(number, source): (usize, &Source<'a>)| {
        let found = |signal| of_joints(source, joints, signal);
        let or_found = |named: &Option<Vec<Option<Vec<SelectedColumn<'a>>>>>, signal| match named {
            Some(named) => named[number].clone().ok_or_else(|| "others were named".to_owned()),
            None => found(signal),
        };
        Offer {
            source: *source,
            position: or_found(&position, Signal::Position),
            torque: or_found(&torque, Signal::Torque).and_then(without_void),
            velocity: found(Signal::Velocity).ok(),
            reference: found(Signal::Reference).ok(),
        }
    };
    let offers: Vec<Offer<'a>> = sources.iter().enumerate().map(offer).collect();
    offers.iter().try_for_each(refuse_same_columns)?;
    Ok(offers)
}

/// The columns of the joints that are left, by their names or by those of all joints.
fn of_joints<'a>(source: &Source<'a>, joints: &JointsOfLog, signal: Signal) -> Result<Vec<SelectedColumn<'a>>, String> {
    columns::by_name(source, &joints.robot, signal).or_else(|problem| match &joints.free {
        Some(_) => columns::by_name(source, &joints.whole, signal).map(|columns| joints.left(columns)),
        None => Err(problem),
    })
}

/// The columns, if each has a finite number.
fn without_void(columns: Vec<SelectedColumn<'_>>) -> Result<Vec<SelectedColumn<'_>>, String> {
    let void = columns.iter().find(|column| column.is_void());
    match void {
        Some(void) => Err(format!("no sample of column `{}` is a finite number", void.name)),
        None => Ok(columns),
    }
}

/// The table with the most columns of the signals needed, that of the most samples of equals, or else the first.
fn chosen_table<'a>(request: &ProposalRequest, contents: &'a Contents) -> Option<&'a TableSummary> {
    let wanted = |c: &&ColumnSummary| {
        let named = request.position.iter().chain(&request.torque).any(|name| is_named(name, &c.name));
        let read = column_names::read(&c.name);
        named || matches!(read, Some(r) if matches!(r.signal, Signal::Position | Signal::Torque))
    };
    let is_numeric = |c: &&ColumnSummary| c.not_numeric.is_none();
    let score = |t: &&TableSummary| (t.columns.iter().filter(is_numeric).filter(wanted).count(), t.samples);
    contents.tables.iter().rev().max_by_key(score)
}

fn refuse_same_columns(offer: &Offer<'_>) -> Result<(), ProposalError> {
    let (Ok(position), Ok(torque)) = (&offer.position, &offer.torque) else { return Ok(()) };
    let same = position.iter().find(|p| torque.iter().any(|t| t.name == p.name));
    same.map_or(Ok(()), |same| {
        Err(ProposalError::SameColumn { file: offer.source.file.to_owned(), column: same.name.clone() })
    })
}
