//! The description of a signal in a file, and its reading into a series.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::csv::{self, Decimal, Dialect};
use super::error::RecordingError;
use super::format::Format;
use super::layout::{self, Layout};
use super::reader::{TableOptions, table};
use super::select::SelectedColumns;
use super::table::{Column, MissingValues, RequestedColumns};
use super::unit::{Dimension, Unit};
use super::{bag, place, select, split_time};
use thetahat_ground::{one_or_each::OneOrEach, series::Series};

/// Where the channels of one signal are, and what they are.
///
/// ```
/// use thetahat_data::recording::{ChannelSource, Side, Unit};
/// let text = r#"
///     file = "torque.csv"
///     columns = ["motor_1", "motor_2"]
///     unit = "mN m"
///     side = "motor"
/// "#;
/// let source: ChannelSource = toml::from_str(text).unwrap();
/// assert_eq!((source.unit.of(0), source.side), (&Unit::MillinewtonMetre, Side::Motor));
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSource {
    /// The file, relative to the folder of the data.
    pub file: PathBuf,
    /// Names of columns or variables, in the order of the channels. A variable with several columns gives several
    /// channels, and `name[3]` only its third. None means all columns of a table (CSV, Parquet), or the only numeric variable of another
    /// file. Joints of a bag are `elbow.position`, `elbow.velocity`, `elbow.effort`; other signals of its messages `motor_state[3].q`, counted from 0.
    ///
    /// A column of a text may also be named by its number, the second of one name by `name#2`, and one with a unit by its name alone. A data
    /// set of an HDF5 file is `group/name`. A time in two columns is `sec+nanosec`, or both columns with `unit = ["s", "ns"]`.
    #[serde(default)]
    pub columns: Vec<String>,
    /// The unit of the values in the file: one for all channels, or one for each.
    pub unit: OneOrEach<Unit>,
    /// The side of the transmission on which the values were measured.
    #[serde(default)]
    pub side: Side,
    /// A factor for all channels, or one for each, applied after the unit; none means 1 for all.
    #[serde(default)]
    pub gain: Option<OneOrEach<f64>>,
    /// The topic of a bag; required if several topics of the bag have joint states, or if the signals are not in the one that has.
    #[serde(default)]
    pub topic: Option<String>,
    /// The delimiter of a CSV file, one character; none means that it is detected. A space means any number of spaces.
    #[serde(default)]
    pub delimiter: Option<char>,
    /// The decimal sign of a CSV file; none means that it is detected.
    #[serde(default)]
    pub decimal: Option<Decimal>,
    /// Whether a CSV file has a line of column names; none means that it is detected. Without one, columns are named
    /// `1`, `2` and so on.
    #[serde(default)]
    pub header: Option<bool>,
    /// Whether an incomplete last line of a text is left out.
    #[serde(default)]
    pub drop_cut_line: bool,
    /// Number of lines of a text above its table, such as titles; none means that they are detected.
    #[serde(default)]
    pub skip_lines: Option<u64>,
    /// Whether the day stands before the month in dates of a text such as `03.05.2024`; none means that the file has to show it.
    #[serde(default)]
    pub day_first: Option<bool>,
    /// Number of the episode that is read of a Parquet file of several episodes; none means the first.
    #[serde(default)]
    pub episode: Option<u64>,
    /// Whether a matrix or a text has one row, not one column, for each channel; of a text with far more cells than lines it is evident.
    #[serde(default)]
    pub channels_in_rows: bool,
    /// Number of channels whose values are interleaved in one column, sample by sample.
    #[serde(default)]
    pub interleaved: Option<usize>,
    /// A numeric column with the channel of each row, for rows that contain one channel each. Channels are ordered by their numbers.
    #[serde(default)]
    pub channel_column: Option<String>,
    /// Delay of the values, s, or a list with one for each channel: the value at a time is the one recorded that much later. Negative if
    /// they are early.
    #[serde(default = "no_delay")]
    pub delay_s: OneOrEach<f64>,
    /// Time constant of the low-pass filter of first order through which a torque was recorded, s: what a drive or a logger smooths
    /// (`y += (x - y) dt / T`). The torque before the filter is what is used.
    #[serde(default)]
    pub low_pass_s: Option<f64>,
    /// Whether a torque holds until the next sample, as from a sampled controller: it then acts half a step later than it was recorded.
    #[serde(default)]
    pub held: bool,
    /// Whether the unit of a torque is a guess from the masses of the description, or that of some positions one from their range, which the
    /// verdict then says. Leave it out once the unit is known.
    #[serde(default)]
    pub unit_guessed: bool,
    /// Whether the file may be anywhere, because the user named it and not a description file. Not read from files.
    #[serde(skip)]
    pub anywhere: bool,
}

/// A side of the transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The motor side: before the gears.
    Motor,
    /// The joint side: after the gears.
    #[default]
    Joint,
}

fn no_delay() -> OneOrEach<f64> {
    OneOrEach::One(0.0)
}

impl ChannelSource {
    /// Columns of a text file by name, or all of them where none is named, in a unit and on the joint side.
    ///
    /// ```
    /// use thetahat_data::recording::{ChannelSource, Unit, read_channels};
    /// # let folder = thetahat_testing::Folder::new();
    /// # let file = folder.path().join("log.csv");
    /// std::fs::write(&file, "t,q1,q2\n0.0,0,90\n0.1,0,180\n").unwrap();
    /// let position = ChannelSource::csv(&file, ["q1", "q2"], Unit::Degree);
    /// let series = read_channels(&position, "".as_ref()).unwrap();
    /// assert!((series.sample(1)[1] - std::f64::consts::PI).abs() < 1e-12);
    /// ```
    pub fn csv<S: Into<String>>(file: impl Into<PathBuf>, columns: impl IntoIterator<Item = S>, unit: Unit) -> Self {
        Self {
            file: file.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            unit: OneOrEach::One(unit),
            side: Side::Joint,
            gain: None,
            topic: None,
            delimiter: None,
            decimal: None,
            header: None,
            drop_cut_line: false,
            skip_lines: None,
            day_first: None,
            episode: None,
            channels_in_rows: false,
            interleaved: None,
            channel_column: None,
            delay_s: no_delay(),
            low_pass_s: None,
            held: false,
            unit_guessed: false,
            anywhere: true,
        }
    }

    /// The path of the file below the folder of the data.
    #[must_use]
    pub fn path(&self, root: &Path) -> PathBuf {
        root.join(&self.file)
    }

    /// Checks that the units match the quantity of the `signal` (a word for the error's text).
    ///
    /// # Errors
    /// [`RecordingError::WrongDimension`] if the dimension of a unit is not among the `expected` ones.
    pub fn require_dimension(&self, signal: &str, expected: &[Dimension]) -> Result<(), RecordingError> {
        match self.unit.given().iter().find(|unit| !expected.contains(&unit.dimension())) {
            None => Ok(()),
            Some(&found) => Err(self.wrong_dimension(signal.to_owned(), expected, found)),
        }
    }

    /// Checks that the unit of each channel matches the dimension in `joints`, a name and a dimension for each. One unit for both revolute
    /// and prismatic joints means SI, as `"rad"` for rad and m.
    ///
    /// # Errors
    /// [`RecordingError::UnitCount`], [`RecordingError::WrongDimension`], or [`RecordingError::MixedUnit`].
    pub fn require_dimensions(&self, signal: &str, joints: &[(&str, Dimension)]) -> Result<(), RecordingError> {
        let OneOrEach::Each(units) = &self.unit else {
            let dimensions: Vec<Dimension> = joints.iter().map(|(_, dimension)| *dimension).collect();
            return self.require_one_unit(signal, joints, &dimensions);
        };
        self.require_unit_count(joints.len())?;
        match units.iter().zip(joints).find(|(unit, (_, dimension))| unit.dimension() != *dimension) {
            None => Ok(()),
            Some((&unit, (joint, dimension))) => {
                Err(self.wrong_dimension(format!("{signal} of joint `{joint}`"), &[*dimension], unit))
            }
        }
    }

    fn require_one_unit(
        &self,
        signal: &str,
        joints: &[(&str, Dimension)],
        dimensions: &[Dimension],
    ) -> Result<(), RecordingError> {
        let unit = *self.unit.of(0);
        let mut expected = dimensions.to_vec();
        expected.dedup();
        self.require_dimension(signal, &expected)?;
        match joints.iter().find(|(_, dimension)| *dimension != unit.dimension()) {
            Some((joint, dimension)) if unit.to_si() != 1.0 => Err(RecordingError::MixedUnit {
                file: self.file.clone(),
                signal: signal.to_owned(),
                unit,
                joint: (*joint).to_owned(),
                dimension: *dimension,
            }),
            _ => Ok(()),
        }
    }

    fn wrong_dimension(&self, signal: String, expected: &[Dimension], found: Unit) -> RecordingError {
        RecordingError::WrongDimension { file: self.file.clone(), signal, expected: expected.to_vec(), found }
    }

    fn require_unit_count(&self, channels: usize) -> Result<(), RecordingError> {
        if self.unit.fits(channels) {
            return Ok(());
        }
        let (file, found) = (self.file.clone(), self.unit.given().len());
        Err(RecordingError::UnitCount { file, expected: channels, found })
    }

    /// The factor of each channel: unit times gain.
    pub(super) fn factors(&self, channels: usize) -> Result<Vec<f64>, RecordingError> {
        self.require_unit_count(channels)?;
        let gain = self.gain.as_ref().unwrap_or(&OneOrEach::One(1.0));
        if gain.given().is_empty() {
            let (file, columns, what) = (self.file.clone(), self.columns.clone(), self.what_gains_are());
            return Err(RecordingError::GainToFillIn { file, columns, channels, what });
        }
        if !gain.fits(channels) {
            let file = self.file.clone();
            return Err(RecordingError::GainCount { file, expected: channels, found: gain.given().len() });
        }
        if let Some(channel) = gain.given().iter().position(|&g| g == 0.0 || !g.is_finite()) {
            let file = self.file.clone();
            return Err(RecordingError::BadGain { file, channel, found: *gain.of(channel) });
        }
        Ok((0..channels).map(|c| gain.of(c) * self.unit.of(c).to_si()).collect())
    }

    /// What a gain converts to the signal, by the unit.
    fn what_gains_are(&self) -> String {
        let place = match self.side {
            Side::Joint => "at the joint",
            Side::Motor => "of the motor",
        };
        match self.unit.of(0).dimension() {
            Dimension::Current => format!("the torque {place} per A"),
            Dimension::Voltage => format!("the torque {place} per V"),
            Dimension::Dimensionless if *self.unit.of(0) == Unit::Percent => format!("the torque {place} at 100 %"),
            Dimension::Dimensionless => format!("the torque {place} per count"),
            Dimension::Angle
            | Dimension::Length
            | Dimension::AngularVelocity
            | Dimension::LinearVelocity
            | Dimension::AngularAcceleration
            | Dimension::LinearAcceleration
            | Dimension::Torque
            | Dimension::Force
            | Dimension::Time => format!("a factor to values in {}", self.unit.of(0)),
        }
    }

    pub(super) fn refuse_repetition(&self) -> Result<(), RecordingError> {
        let repeated = (1..self.columns.len()).find(|&i| self.columns[..i].contains(&self.columns[i]));
        repeated.map_or(Ok(()), |i| {
            Err(RecordingError::RepeatedColumn { file: self.file.clone(), column: self.columns[i].clone() })
        })
    }

    /// Refuses settings of another format, which would have no effect.
    pub(super) fn refuse_useless_settings(&self, format: Format) -> Result<(), RecordingError> {
        let text = !matches!(format, Format::Csv);
        let settings = [
            ("topic", self.topic.is_some() && !format.is_bag()),
            ("delimiter", self.delimiter.is_some() && text),
            ("decimal", self.decimal.is_some() && text),
            ("header", self.header.is_some() && text),
            ("drop_cut_line", self.drop_cut_line && text),
            ("skip_lines", self.skip_lines.is_some() && text),
            ("day_first", self.day_first.is_some() && text),
            ("episode", self.episode.is_some() && format != Format::Parquet),
            ("channels_in_rows", self.channels_in_rows && format == Format::Parquet),
            ("channels_in_rows", self.channels_in_rows && format.is_bag()),
            ("interleaved", self.interleaved.is_some() && (format.is_bag() || self.channels_in_rows)),
            ("channel_column", self.channel_column.is_some() && (format.is_bag() || self.channels_in_rows)),
            ("channel_column", self.channel_column.is_some() && self.interleaved.is_some()),
        ];
        match settings.into_iter().find(|(_, useless)| *useless) {
            None => Ok(()),
            Some((setting, _)) => Err(RecordingError::UselessSetting { file: self.file.clone(), setting, format }),
        }
    }

    /// How its channels are arranged in their columns.
    fn layout(&self) -> Layout {
        match (self.channel_column.is_some(), self.interleaved) {
            (true, _) => Layout::Long,
            (false, Some(channels)) => Layout::Interleaved { channels },
            (false, None) => Layout::Columns,
        }
    }

    /// The least delay of a channel, s.
    #[must_use]
    pub fn least_delay_s(&self) -> f64 {
        self.delay_s.given().iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether the value at a time is one of other times than its own sample's.
    #[must_use]
    pub fn takes_other_samples(&self) -> bool {
        self.is_delayed() || self.low_pass_s.is_some()
    }

    /// Whether any samples of the signal can be read without the others.
    pub(super) fn can_be_read_in_pieces(&self) -> bool {
        let is_split = self.is_split_time() || self.columns.iter().any(|name| name.contains('+'));
        let is_whole = self.channels_in_rows || self.drop_cut_line || self.episode.is_some() || is_split;
        self.layout() == Layout::Columns && !is_whole && !self.takes_other_samples()
    }

    /// Whether a channel has a delay.
    #[must_use]
    pub fn is_delayed(&self) -> bool {
        self.delay_s.given().iter().any(|delay| *delay != 0.0)
    }

    /// Whether two columns are one time: seconds and the nanoseconds beyond them, by their units.
    fn is_split_time(&self) -> bool {
        let units = self.unit.given();
        matches!(units, [long, short] if long.to_si() > short.to_si())
            && units.iter().all(|unit| unit.dimension() == Dimension::Time)
            && self.columns.len() == 2
    }

    pub(super) fn dialect(&self) -> Dialect {
        Dialect {
            delimiter: self.delimiter,
            decimal: self.decimal,
            header: self.header,
            drop_cut_line: self.drop_cut_line,
            skip_lines: self.skip_lines,
            channels_in_rows: self.channels_in_rows,
            day_first: self.day_first,
        }
    }

    /// The format of the file, which may be a folder below `root`.
    pub(super) fn format(&self, root: &Path) -> Result<Format, RecordingError> {
        let of_path = Format::of(&self.path(root)).ok();
        of_path.map_or_else(|| Format::of(&self.file), Ok)
    }

    /// The folder that nothing is read outside of; none if the file may be anywhere.
    pub(super) fn root<'a>(&self, root: &'a Path) -> Option<&'a Path> {
        (!self.anywhere).then_some(root)
    }

    /// The path to read from: inside the folder of the data, unless the file may be anywhere.
    pub(super) fn place(&self, root: &Path) -> Result<PathBuf, RecordingError> {
        if self.anywhere {
            return Ok(self.path(root));
        }
        // Of a folder, its metadata are to be inside.
        match Format::metadata_of(&self.path(root)) {
            Some(metadata) if metadata != self.path(root) => place::inside(root, &Format::metadata_below(&self.file)),
            Some(_) | None => place::inside(root, &self.file),
        }
    }
}

/// The channels of `source` in SI units: the file's values times the unit's factor times the gain.
///
/// The file must be inside `root`; its [`Format`] follows from its extension. The side is not applied: motor values stay on the motor side.
/// Time stamps of a bag are seconds from the first message of their topic.
///
/// # Errors
/// A [`RecordingError`] that states the place, what was expected and what was found, if the file cannot be read, a column
/// is missing, a value is not a finite number, or the gains do not fit the channels.
pub fn read_channels(source: &ChannelSource, root: &Path) -> Result<Series, RecordingError> {
    channels(source, root, MissingValues::Refused)
}

/// The same with NaN where a table has an empty cell or a NaN. A bag is refused as by [`read_channels`].
///
/// # Errors
/// As [`read_channels`] for anything else.
pub fn read_channels_with_missing_values(source: &ChannelSource, root: &Path) -> Result<Series, RecordingError> {
    channels(source, root, MissingValues::Kept)
}

fn channels(source: &ChannelSource, root: &Path, missing: MissingValues) -> Result<Series, RecordingError> {
    source.refuse_repetition()?;
    let format = source.format(root)?;
    source.refuse_useless_settings(format)?;
    let mut series = read(source, format, (source.root(root), &source.place(root)?), missing)?;
    let factors = source.factors(series.channels())?;
    if source.is_split_time() {
        subtract_first(&mut series);
    }
    for sample in series.values_mut().chunks_exact_mut(factors.len()) {
        sample.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
    }
    Ok(if source.is_split_time() { sums(&series) } else { series })
}

/// Subtracts the first sample of each channel, before large times would be rounded.
fn subtract_first(series: &mut Series) {
    let first = if !series.is_empty() { series.sample(0).to_vec() } else { Vec::new() };
    for sample in series.values_mut().chunks_exact_mut(first.len().max(1)) {
        sample.iter_mut().zip(&first).for_each(|(value, first)| *value -= first);
    }
}

/// The sum of the channels of each sample.
fn sums(series: &Series) -> Series {
    Series::shaped(1, (0..series.len()).map(|k| series.sample(k).iter().sum()).collect())
}

/// The channels in the units of the file.
fn read(
    source: &ChannelSource,
    format: Format,
    (root, path): (Option<&Path>, &Path),
    missing: MissingValues,
) -> Result<Series, RecordingError> {
    if format.is_bag() {
        return bag::channels(path, format, source.topic.as_deref(), &source.columns);
    }
    let mut columns = source.columns.clone();
    columns.extend(source.channel_column.clone());
    let wanted = if columns.is_empty() { RequestedColumns::All } else { RequestedColumns::Named(&columns) };
    let options = TableOptions { dialect: source.dialect(), episode: source.episode, root };
    let mut table = table(path, format, &options, wanted)?;
    if source.channels_in_rows {
        table.columns.iter_mut().for_each(Column::transpose);
    }
    split_time::add_requested(&mut table, &columns);
    let columns = select::columns(&table, format, &columns, path)?;
    require_units_of_file(source, &columns, path)?;
    layout::laid_out(source.layout(), columns.series(path, missing)?, path)
}

/// Dates and times of day are in seconds. A unit that the file gives to a column, and that was left out of its name, is the one that is
/// stated, unless a gain converts the values.
pub(super) fn require_units_of_file(
    source: &ChannelSource,
    columns: &SelectedColumns<'_>,
    path: &Path,
) -> Result<(), RecordingError> {
    let stated = |channel: usize| match &source.unit {
        OneOrEach::One(unit) => Some(*unit),
        OneOrEach::Each(units) => units.get(channel).copied(),
    };
    for (place, (channel, column)) in columns.with_channels().enumerate() {
        let Some(found) = stated(channel) else { continue };
        let (file, name) = (path.to_owned(), column.name.clone());
        if column.in_seconds && found != Unit::Second {
            return Err(RecordingError::UnitOfStamps { file, column: name, found });
        }
        let left_out = source.columns.get(place).and_then(|asked| csv::unit_left_out(asked, &column.name));
        if let Some(expected) = left_out.filter(|unit| *unit != found && source.gain.is_none()) {
            return Err(RecordingError::OtherUnit { file, column: name, expected, found });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use thetahat_testing::Folder;

    use super::*;

    const TWO_JOINTS: &str = "a,b\n1,2\n3,4\n";

    fn source(file: &str, gain: &[f64]) -> ChannelSource {
        let gain = (!gain.is_empty()).then(|| OneOrEach::Each(gain.to_vec()));
        ChannelSource {
            file: file.into(),
            columns: Vec::new(),
            unit: Unit::Millimetre.into(),
            side: Side::Joint,
            gain,
            topic: None,
            delimiter: None,
            decimal: None,
            header: None,
            drop_cut_line: false,
            skip_lines: None,
            day_first: None,
            episode: None,
            channels_in_rows: false,
            interleaved: None,
            channel_column: None,
            delay_s: no_delay(),
            low_pass_s: None,
            held: false,
            unit_guessed: false,
            anywhere: false,
        }
    }

    /// One value a line, joint by joint.
    #[test]
    fn interleaved_values_are_samples() {
        let folder = Folder::with("q.csv", b"q\n1\n2\n3\n4\n5\n6\n");
        let of = |channels: usize| {
            let text = format!("file = 'q.csv'\nunit = 'rad'\ninterleaved = {channels}");
            read_channels(&toml::from_str(&text).unwrap(), folder.path())
        };
        assert_eq!(of(3).unwrap(), Series::shaped(3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        let error = of(4).unwrap_err().to_string();
        assert!(error.contains("6 values in 1 columns are no samples of 4 interleaved channels"), "{error}");
    }

    /// One row for each joint at each instant, in any order of the joints.
    #[test]
    fn long_tables() {
        let folder = Folder::with("q.csv", b"t,joint,q\n0,2,20\n0,1,10\n1,1,11\n1,2,21\n");
        let of = |extra: &str| {
            read_channels(&toml::from_str(&format!("file = 'q.csv'\nunit = 'rad'\n{extra}")).unwrap(), folder.path())
        };
        let series = of("columns = ['q']\nchannel_column = 'joint'").unwrap();
        assert_eq!(series, Series::shaped(2, vec![10.0, 20.0, 11.0, 21.0]));
        let error = of("columns = ['q']\nchannel_column = 't'\ninterleaved = 2").unwrap_err();
        assert!(matches!(error, RecordingError::UselessSetting { setting: "channel_column", .. }));
        folder.write("q.csv", "t,joint,q\n0,2,20\n0,1,10\n1,1,11\n");
        let error = of("columns = ['q']\nchannel_column = 'joint'").unwrap_err().to_string();
        assert!(error.contains("channel 1 has 2 rows, channel 2 has 1"), "{error}");
    }

    /// A matrix with a row for each joint.
    #[test]
    fn channels_in_rows() {
        let values: Vec<u8> = (0..8).flat_map(|k| f64::from(k).to_le_bytes()).collect();
        let folder = Folder::with("q.npy", super::super::test_files::npy("<f8", false, "(2, 4)", &values));
        let source: ChannelSource = toml::from_str("file = 'q.npy'\nunit = 'rad'\nchannels_in_rows = true").unwrap();
        let series = read_channels(&source, folder.path()).unwrap();
        assert_eq!(series, Series::side_by_side(&[vec![0.0, 1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0, 7.0]]));
    }

    #[test]
    fn a_cut_last_line_is_left_out_where_that_is_asked_for() {
        let folder = Folder::with("q.csv", b"a,b\n1,2\n3,4\n5");
        let mut source = source("q.csv", &[]);
        let error = read_channels(&source, folder.path()).unwrap_err().to_string();
        assert!(
            error.ends_with(
                "line 4, the last one, is cut: it has 1 of 2 columns and no end; leave it out with drop_cut_line = true"
            ),
            "{error}"
        );
        source.drop_cut_line = true;
        assert_eq!(read_channels(&source, folder.path()).unwrap().len(), 2);
    }

    #[test]
    fn garbage_is_named_with_its_place() {
        let folder = Folder::with("q.csv", b"a,b\n1,2\n3,1e305\n");
        let error = read_channels(&source("q.csv", &[]), folder.path()).unwrap_err().to_string();
        assert!(error.contains("line 3, column \"b\": expected a finite number below 1e30, found 1e305"), "{error}");
    }

    fn failure(source: &ChannelSource) -> RecordingError {
        let folder = Folder::with("q.csv", TWO_JOINTS.as_bytes());
        read_channels(source, folder.path()).unwrap_err()
    }

    #[test]
    fn values_are_multiplied_by_unit_and_gain() {
        let folder = Folder::with("q.csv", TWO_JOINTS.as_bytes());
        let series = read_channels(&source("q.csv", &[1000.0, -2000.0]), folder.path()).unwrap();
        assert_eq!(series.values(), [1.0, -4.0, 3.0, -8.0]);
    }

    #[test]
    fn side_is_the_joint_s_unless_said() {
        let source: ChannelSource = toml::from_str("file = 'q.csv'\nunit = 'rad'").unwrap();
        assert_eq!((source.side, source.columns.len(), source.gain), (Side::Joint, 0, None));
    }

    #[test]
    fn units_and_gains_are_of_all_channels_or_of_each() {
        let folder = Folder::with("q.csv", TWO_JOINTS.as_bytes());
        let read = |units: &str| {
            let source: ChannelSource = toml::from_str(&format!("file = 'q.csv'\n{units}")).unwrap();
            read_channels(&source, folder.path())
        };
        assert_eq!(read("unit = ['m', 'mm']").unwrap().values(), [1.0, 2e-3, 3.0, 4e-3]);
        assert_eq!(read("unit = 'mm'\ngain = 1e3").unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(
            read("unit = ['m', 'mm', 'm']").unwrap_err().to_string(),
            "q.csv: unit lists 3 units for 2 channels; give one for all, or one for each channel"
        );
    }

    #[test]
    fn units_measure_what_their_joints_do() {
        let joints = [("lift", Dimension::Length), ("shoulder", Dimension::Angle)];
        let message = |unit: &str| {
            let source: ChannelSource = toml::from_str(&format!("file = 'q.csv'\nunit = {unit}")).unwrap();
            source.require_dimensions("position", &joints).err().map(|e| e.to_string())
        };
        assert_eq!((message("['m', 'rad']"), message("['mm', 'deg']"), message("'rad'")), (None, None, None));
        assert_eq!(
            message("'deg'").unwrap(),
            "q.csv: unit \"deg\" of position is for all joints, but joint `lift` has a length; give a list with one unit for \
             each joint, such as unit = [\"m\", \"rad\"]"
        );
        assert!(message("['rad', 'm']").unwrap().contains("position of joint `lift`"), "{:?}", message("['rad', 'm']"));
        assert!(message("['rad']").unwrap().contains("unit lists 1 units for 2 channels"));
    }

    #[test]
    fn unit_must_be_given() {
        assert!(toml::from_str::<ChannelSource>("file = 'q.csv'").is_err());
    }

    #[test]
    fn unknown_field_is_refused() {
        assert!(toml::from_str::<ChannelSource>("file = 'q.csv'\nunit = 'rad'\ngains = [1.0]").is_err());
    }

    #[test]
    fn position_in_a_unit_of_torque_is_refused() {
        let mut source = source("q.csv", &[]);
        source.require_dimension("position", &[Dimension::Angle, Dimension::Length]).unwrap();
        source.unit = Unit::NewtonMetre.into();
        let error = source.require_dimension("position", &[Dimension::Angle, Dimension::Length]).unwrap_err();
        assert!(matches!(error, RecordingError::WrongDimension { found: Unit::NewtonMetre, .. }));
    }

    #[test]
    fn missing_file() {
        assert!(matches!(failure(&source("p.csv", &[])), RecordingError::FileNotFound { .. }));
    }

    #[test]
    fn unknown_extension() {
        assert!(matches!(failure(&source("q.xlsx", &[])), RecordingError::UnknownFormat { .. }));
    }

    #[test]
    fn one_gain_for_two_channels() {
        let error = failure(&source("q.csv", &[2.0]));
        assert!(matches!(error, RecordingError::GainCount { expected: 2, found: 1, .. }));
    }

    #[test]
    fn zero_gain() {
        let error = failure(&source("q.csv", &[2.0, 0.0]));
        assert!(matches!(error, RecordingError::BadGain { channel: 1, .. }));
    }

    #[test]
    fn column_listed_twice() {
        let mut source = source("q.csv", &[]);
        source.columns = vec!["a".into(), "b".into(), "a".into()];
        assert!(matches!(failure(&source), RecordingError::RepeatedColumn { column, .. } if column == "a"));
    }

    #[test]
    fn delimiter_of_a_file_that_is_not_text() {
        let mut source = source("q.npz", &[]);
        source.delimiter = Some(';');
        assert!(matches!(failure(&source), RecordingError::UselessSetting { setting: "delimiter", .. }));
    }

    #[test]
    fn topic_of_a_file_that_is_not_a_bag() {
        let mut source = source("q.csv", &[]);
        source.topic = Some("/joint_states".into());
        assert!(matches!(failure(&source), RecordingError::UselessSetting { setting: "topic", .. }));
    }

    #[test]
    fn absolute_path_is_read_only_where_the_user_named_it() {
        let folder = Folder::with("q.csv", TWO_JOINTS.as_bytes());
        let mut source = source("q.csv", &[]);
        source.file = folder.path().join("q.csv");
        let error = read_channels(&source, folder.path()).unwrap_err();
        assert!(matches!(error, RecordingError::OutsideData { .. }));
        source.anywhere = true;
        assert_eq!(read_channels(&source, folder.path()).unwrap().len(), 2);
    }
}
