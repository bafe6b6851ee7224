use std::path::{Path, PathBuf};

use super::{
    super::{
        column_names::{self, Reading, Signal},
        driver::{Driver, DriverColumns},
    },
    joint_names,
};
use thetahat_data::recording::{ChannelSummary, ColumnSummary, Contents, TableSummary, TimeSummary};
use thetahat_model::robot::Robot;

/// A column, or one channel of it, as the experiment is to name it.
#[derive(Debug, Clone)]
pub(super) struct SelectedColumn<'a> {
    pub(super) name: String,
    pub(super) channels: &'a [ChannelSummary],
    /// Whether they are rows of a matrix.
    pub(super) in_rows: bool,
}

impl<'a> SelectedColumn<'a> {
    /// A whole column.
    pub(super) fn of(column: &'a ColumnSummary) -> Self {
        Self { name: column.name.clone(), channels: &column.statistics, in_rows: column.in_rows }
    }

    /// Whether a channel has no sample that is a finite number, as efforts that a driver does not know.
    pub(super) fn is_void(&self) -> bool {
        self.channels.iter().any(|channel| channel.min.is_none())
    }

    /// Its channels, each by itself: `name[3]` of a matrix.
    pub(super) fn each(&self) -> impl Iterator<Item = Self> + use<'a> {
        let (name, is_one, in_rows) = (self.name.clone(), self.channels.len() == 1, self.in_rows);
        self.channels.chunks(1).zip(1..).map(move |(channels, number)| Self {
            name: if is_one { name.clone() } else { format!("{name}[{number}]") },
            channels,
            in_rows,
        })
    }
}

/// Number of channels of some columns.
pub(super) fn channels(columns: &[SelectedColumn<'_>]) -> usize {
    columns.iter().map(|c| c.channels.len()).sum()
}

/// A file with the table of it that is used.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// The file, as the experiment is to name it.
    pub(super) file: &'a Path,
    pub(super) contents: &'a Contents,
    pub(super) table: Option<&'a TableSummary>,
    /// Whether the table is one topic of those that hold one signal each.
    pub(super) is_one_topic: bool,
    /// Whether the files are in several folders, whose names may say what they hold.
    pub(super) in_several_folders: bool,
    /// The driver that wrote it, and its columns.
    pub(super) driver: Option<(&'a Driver, &'a DriverColumns)>,
}

impl<'a> Source<'a> {
    /// The columns of numbers of the chosen table.
    pub(super) fn columns(&self) -> impl Iterator<Item = &'a ColumnSummary> + Clone + use<'a> {
        self.table.into_iter().flat_map(|t| &t.columns).filter(|c| c.not_numeric.is_none())
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.columns().map(|c| c.name.clone()).collect()
    }

    /// The names of all its columns for an error, those that are not numbers with what they are.
    pub(super) fn listed(&self) -> Vec<String> {
        let all = self.contents.tables.iter().flat_map(|table| &table.columns);
        let unread = all.filter_map(|c| Some(format!("`{}` ({})", c.name, c.not_numeric.as_ref()?)));
        self.names().into_iter().chain(unread).collect()
    }

    /// What one of its columns holds: as the driver has it, or as its name says among the others. Of a signal whose columns the driver
    /// has, no other is taken.
    pub(super) fn reading(&self, column: &str) -> Option<Reading> {
        self.by_driver(column).cloned().or_else(|| {
            let reading = column_names::read_among(column, self.columns().map(|other| other.name.as_str()));
            reading.filter(|reading| !self.driver_has(reading.signal))
        })
    }

    /// What a column holds, or one channel of it, where it is the driver's.
    pub(super) fn by_driver(&self, column: &str) -> Option<&'a Reading> {
        let (_, columns) = self.driver?;
        let matrix = || column.strip_suffix(']')?.rsplit_once('[').map(|(matrix, _)| matrix);
        columns.reading(column).or_else(|| columns.reading(matrix()?))
    }

    /// Whether it has the driver's columns of a signal.
    pub(super) fn driver_has(&self, signal: Signal) -> bool {
        self.driver.is_some_and(|(_, columns)| columns.has(signal))
    }

    /// The column of each joint, of one channel: by the name of the joint, or else by its number, where the driver has the names of
    /// numbered joints.
    pub(super) fn columns_of(&self, joints: &[&str], columns: &[&'a ColumnSummary]) -> Vec<Option<&'a ColumnSummary>> {
        let by_name = joint_names::columns_of(joints, columns);
        if by_name.iter().any(Option::is_some) {
            return by_name;
        }
        let places: Vec<Option<usize>> = joints.iter().map(|joint| self.place_in_driver(joint)).collect();
        let is_one = |place: usize| places.iter().filter(|other| **other == Some(place)).count() == 1;
        let column = |place: usize| columns.iter().find(|c| self.place(c) == Some(place)).copied();
        places.iter().map(|place| place.filter(|place| is_one(*place)).and_then(column)).collect()
    }

    /// The first joint that the driver does not have, where its columns are numbered by its joints and it has others of the robot.
    pub(super) fn joint_unknown_to_driver<'r>(
        &self,
        robot: &'r Robot,
        mut columns: impl Iterator<Item = &'a ColumnSummary>,
    ) -> Option<&'r str> {
        let joints = || robot.coordinates().map(|joint| joint.name.as_str());
        let is_numbered = columns.any(|column| self.place(column).is_some());
        let knows_some = joints().any(|joint| self.place_in_driver(joint).is_some());
        joints().find(|joint| is_numbered && knows_some && self.place_in_driver(joint).is_none())
    }

    fn place_in_driver(&self, joint: &str) -> Option<usize> {
        self.driver.and_then(|(driver, _)| driver.place_of(joint))
    }

    /// The place of a numbered column among the joints of the driver.
    pub(super) fn place(&self, column: &ColumnSummary) -> Option<usize> {
        let ((driver, columns), reading) = (self.driver?, self.by_driver(&column.name)?);
        let least = columns.least_number(reading.signal)?;
        let first = driver.first_number.or_else(|| (least <= 1).then_some(least))?;
        reading.number?.checked_sub(first).filter(|_| column.channels == 1)
    }

    /// The likeliest time: the driver's, or else the first that looks like one.
    pub(super) fn time(&self) -> Option<&'a TimeSummary> {
        let times = &self.table?.times;
        let of_driver = |time: &&TimeSummary| self.by_driver(&time.column).is_some_and(|r| r.signal == Signal::Time);
        times.iter().find(of_driver).or_else(|| times.first())
    }

    pub(super) fn samples(&self) -> usize {
        self.table.map_or(0, |t| t.samples)
    }

    /// The name of the topic where each holds one signal, else of the file without its ending.
    pub(super) fn stem(&self) -> String {
        if let (true, Some(table)) = (self.is_one_topic, self.table) {
            return table.name.clone();
        }
        self.contents.file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The name of the folder of the file; empty where all files are in one.
    pub(super) fn folder(&self) -> String {
        let folder = self.contents.file.parent().and_then(Path::file_name).filter(|_| self.in_several_folders);
        folder.unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Whether it holds messages of ROS, whose units are those of SI (REP 103).
    pub(super) fn is_bag(&self) -> bool {
        self.contents.format.is_bag()
    }

    /// Whether its last line is cut.
    pub(super) fn is_cut(&self) -> bool {
        self.contents.dialect.is_some_and(|d| d.drop_cut_line)
    }

    /// Whether a column is its time, the likeliest of several.
    pub(super) fn is_time(&self, column: &str) -> bool {
        self.time().is_some_and(|time| time.column == column)
    }

    /// The topic, where a bag holds several.
    pub(super) fn topic(&self) -> Option<&'a str> {
        let table = self.table.filter(|t| self.contents.tables.len() > 1 && !t.name.is_empty())?;
        Some(&table.name)
    }

    /// The file, with the topic of those that hold one signal each.
    pub(super) fn place_name(&self) -> PathBuf {
        match self.topic().filter(|_| self.is_one_topic) {
            Some(topic) => PathBuf::from(format!("{}, topic {topic}", self.file.display())),
            None => self.file.to_owned(),
        }
    }

    /// Whether the user means this file, or this topic, by a name.
    pub(super) fn is_called(&self, name: &str) -> bool {
        if self.is_one_topic {
            return self.topic() == Some(name);
        }
        let path = Path::new(name);
        path == self.file || path == self.contents.file || Some(path.as_os_str()) == self.file.file_name()
    }

    /// A column, or `name[3]` of a matrix.
    pub(super) fn column(&self, name: &str) -> Option<SelectedColumn<'a>> {
        let whole = self.columns().find(|c| c.name == name);
        if let Some(column) = whole {
            return Some(SelectedColumn::of(column));
        }
        let (matrix, index) = name.strip_suffix(']')?.rsplit_once('[')?;
        let index: usize = index.parse().ok()?;
        let column = self.columns().find(|c| c.name == matrix && !c.in_rows)?;
        let channel = column.statistics.get(index.checked_sub(1)?..index)?;
        Some(SelectedColumn { name: name.to_owned(), channels: channel, in_rows: false })
    }
}
