//! What can be wrong with a recording.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::bag::BagError;
use super::format::Format;
use super::unit::{Dimension, Unit};

/// Why a recording is rejected: where the defect is, what was expected, what was found.
///
/// Lines are counted from 1, as in editors, samples from 0.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no file of this name.
    #[error("{file}: there is no such file; check its name and the folder in which the data are looked for")]
    FileNotFound {
        /// The file, with the folder against which it was resolved.
        file: PathBuf,
    },

    /// The file exists and cannot be read.
    #[error("{file}: the file cannot be read ({source}); check its permissions")]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },

    /// The extension belongs to no known format.
    #[error(
        "{file}: expected a file name that ends in .csv or .mat, or in .tsv, .tab, .txt, .dat, .asc, .log, .lvm, .npy, .npz, .h5, .hdf5, \
         .parquet, .db3, .mcap or .bag, or a folder with metadata.yaml, found {found:?}; export the recording to CSV"
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// The extension of this file, empty if it has none.
        found: String,
    },

    /// The file has no content.
    #[error("{file}: the file is empty; record or export it again")]
    EmptyFile {
        /// The file.
        file: PathBuf,
    },

    /// The columns exist and have no values.
    #[error("{file}: expected at least one sample below the column names, found none; record or export it again")]
    NoSamples {
        /// The file.
        file: PathBuf,
    },

    /// The path leads out of the folder of the data.
    #[error(
        "{file}: the file lies outside the folder of the data ({root}), where a description may not lead; \
         copy it there, or name a folder above it as that of the data"
    )]
    OutsideData {
        /// The file as described.
        file: PathBuf,
        /// The folder of the data.
        root: PathBuf,
    },

    /// The program was built without the reader of this format.
    #[error("{file}: this build does not read {format}; build it with the feature `{feature}`, or export to CSV")]
    FeatureMissing {
        /// The file.
        file: PathBuf,
        /// The format in words.
        format: &'static str,
        /// The feature of the crate that reads it.
        feature: &'static str,
    },

    /// A setting belongs to another format.
    #[error("{file}: `{setting}` has no meaning for {format}; remove it")]
    UselessSetting {
        /// The file.
        file: PathBuf,
        /// The setting.
        setting: &'static str,
        /// The format of the file.
        format: Format,
    },

    /// The file does not follow its format, was truncated, or is damaged.
    #[error("{file}: the file is cut short or damaged: {reason}; copy or save it again")]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What is wrong, and where.
        reason: String,
    },

    /// A part of the file requests more memory than a file of its size may.
    #[error(
        "{file}: {what}: expected no more than {limit} values in a file of this size, found more; \
         save only the signals that are needed, or save without compression"
    )]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// The part.
        what: String,
        /// Largest number of values for a file of this size.
        limit: usize,
    },

    /// The signals of a bag are rejected.
    #[error("{file}: {problem}")]
    Bag {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        problem: Box<BagError>,
    },

    /// The delimiter set for a CSV file is invalid.
    #[error(
        "{file}: expected a delimiter such as \",\", \";\", \"|\", a tab or a space, found {found:?}; correct `delimiter`"
    )]
    BadDelimiter {
        /// The file.
        file: PathBuf,
        /// The delimiter given.
        found: char,
    },

    /// With either of two delimiters a CSV file is a table.
    #[error(
        "{file}: line {line}: cells may be separated by {:?} or by {:?}; say which by `delimiter`", .found[0], .found[1]
    )]
    UnclearDelimiter {
        /// The file.
        file: PathBuf,
        /// The first line of the table, counted from 1.
        line: u64,
        /// The two.
        found: [char; 2],
    },

    /// The first line of a CSV file may contain names or values.
    #[error(
        "{file}: line {line}: some columns of numbers begin with a number and some with text, so it may be a line of names \
         or of values; say which by `header = true` or `header = false`, or leave it out by `skip_lines`"
    )]
    UnclearHeader {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
    },

    /// The file has no column or variable of this name.
    #[error("{file}: there is no column {column:?}; the columns are {}; correct the list of columns", quoted(.found))]
    MissingColumn {
        /// The file.
        file: PathBuf,
        /// The requested name.
        column: String,
        /// The existing names.
        found: Vec<String>,
    },

    /// The file has several columns of the requested name.
    #[error(
        "{file}: column {column:?} occurs {found} times; name the one that is meant {column}#1, {column}#2 ..., or give each column its own name"
    )]
    AmbiguousColumn {
        /// The file.
        file: PathBuf,
        /// The requested name.
        column: String,
        /// How many columns have it.
        found: usize,
    },

    /// The same name was requested twice.
    #[error("{file}: column {column:?} is listed twice; list the column of each joint once")]
    RepeatedColumn {
        /// The file.
        file: PathBuf,
        /// The name listed twice.
        column: String,
    },

    /// A row of a CSV file is longer or shorter than the header.
    #[error(
        "{file}: line {line}: expected {expected} values as in line {first_line}, found {found}; the values were taken to be \
         separated by {delimiter:?}: correct the line, or set `delimiter`, `decimal` if the decimal sign is a comma, or \
         `skip_lines` if the table begins further down"
    )]
    RowLength {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The first line of the table.
        first_line: u64,
        /// Number of names in the header.
        expected: usize,
        /// Number of values in the row.
        found: usize,
        /// What separates the values.
        delimiter: char,
    },

    /// A cell of a CSV file is not a number.
    #[error(
        "{file}: line {line}, column {column:?}: expected a number, found {found:?}; correct or remove the line, \
             or set `decimal` if the decimal sign is not seen as one"
    )]
    NotANumber {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// The text in the cell.
        found: String,
    },

    /// Dates change, and the order of day and month is not evident.
    #[error(
        "{file}: line {line}, column {column:?}: {found:?} may begin with the day or with the month; say which by \
         `day_first = true` or `day_first = false`, or write dates as 2026-11-25"
    )]
    UnclearDate {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// The date.
        found: String,
    },

    /// The rows of joint states name their joints in different orders.
    #[error(
        "{file}: line {line}, column {column:?}: the rows name joints in different orders: {found:?} is where {expected:?} was \
         before; record with one publisher of joint states, or read the bag instead"
    )]
    JointOrder {
        /// The file.
        file: PathBuf,
        /// The first line with another order, counted from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// The joint that the first row names there.
        expected: String,
        /// The joint that this row names there.
        found: String,
    },

    /// Dates or times of day have a unit other than the second.
    #[error(
        "{file}: {column:?}: dates and times of day are read as seconds from the first one, but the unit is {:?}; set \
         unit = \"s\"",
        .found.symbol()
    )]
    UnitOfStamps {
        /// The file.
        file: PathBuf,
        /// The name of the column.
        column: String,
        /// The unit given.
        found: Unit,
    },

    /// The unit that the file gives to a column is not the stated one.
    #[error(
        "{file}: {column:?}: the file gives the unit {:?}, and the stated unit is {:?}; set unit = {:?}",
        .expected.symbol(), .found.symbol(), .expected.symbol()
    )]
    OtherUnit {
        /// The file.
        file: PathBuf,
        /// The name of the column, with its unit.
        column: String,
        /// The unit in the file.
        expected: Unit,
        /// The unit given.
        found: Unit,
    },

    /// The file is read after a conversion by another program.
    #[error("{file}: {what} is not read; convert it: {remedy}")]
    ToConvert {
        /// The file.
        file: PathBuf,
        /// What it is.
        what: &'static str,
        /// A command, or another way.
        remedy: String,
    },

    /// The file has no episode of this number.
    #[error("{file}: there is no episode {episode}; {found}; correct `episode`")]
    MissingEpisode {
        /// The file.
        file: PathBuf,
        /// The requested number.
        episode: u64,
        /// The episodes that are there.
        found: String,
    },

    /// The last line of a text is incomplete.
    #[error(
        "{file}: line {line}, the last one, is cut: it has {found} of {expected} columns and no end; leave it out with \
         drop_cut_line = true"
    )]
    CutLine {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// Number of columns of the lines before it.
        expected: usize,
        /// Number of columns in it.
        found: usize,
    },

    /// A line of a text has more values than the allowed number of columns.
    #[error(
        "{file}: line {line} has {found} or more values, and at most {limit} are read as columns; write one sample a line, one \
         channel a line with channels_in_rows = true, or one value a line with interleaved = CHANNELS"
    )]
    TooManyColumns {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// Least number of its values.
        found: usize,
        /// Most columns.
        limit: usize,
    },

    /// The number of interleaved values is not a multiple of the number of channels.
    #[error(
        "{file}: {values} values in {columns} columns are no samples of {channels} interleaved channels; interleaved takes one column of values"
    )]
    NotInterleaved {
        /// The file.
        file: PathBuf,
        /// Number of values.
        values: usize,
        /// Number of columns that contain them.
        columns: usize,
        /// The requested number of channels.
        channels: usize,
    },

    /// Rows of one channel each cannot be arranged into samples.
    #[error("{file}: {problem} (`channel_column`)")]
    NotLong {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        problem: String,
    },

    /// A cell of a CSV file is NaN, infinite or implausibly large.
    #[error(
        "{file}: line {line}, column {column:?}: expected a finite number below 1e30, found {found:e}; \
         cut the recording to the part without gaps, or fill the gap"
    )]
    NotFinite {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// The value: NaN or an infinity.
        found: f64,
    },

    /// A sample of a variable or of a time axis is NaN or infinite.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: expected a finite number below 1e30, found {found:e}; \
         cut the recording to the part without gaps, or fill the gap"
    )]
    NotFiniteSample {
        /// The file.
        file: PathBuf,
        /// The name of the variable or column.
        column: String,
        /// The sample, counted from 0.
        sample: usize,
        /// The value: NaN or an infinity.
        found: f64,
    },

    /// The file is not a MAT file of version 5 or 7.3.
    #[error(
        "{file}: expected a MAT file of version 5 or 7.3, found another kind of file; save it in MATLAB with save -v7"
    )]
    NotMat {
        /// The file.
        file: PathBuf,
    },

    /// No column was requested by name, and the file has several variables or topics.
    #[error("{file}: no column is listed; the columns and variables are {}; list those to read", quoted(.found))]
    NoColumnListed {
        /// The file.
        file: PathBuf,
        /// The columns and variables that are there.
        found: Vec<String>,
    },

    /// A variable has fewer columns than the requested index.
    #[error(
        "{file}: {column:?}: expected a column from 1 to {found}, which is what the variable has; correct the number"
    )]
    MissingChannel {
        /// The file.
        file: PathBuf,
        /// The requested name, with the number of the column.
        column: String,
        /// The number of columns of the variable.
        found: usize,
    },

    /// A column or variable does not contain real numbers.
    #[error("{file}: {column:?}: expected a vector or matrix of real numbers, found {found}; save it as such")]
    NotNumeric {
        /// The file.
        file: PathBuf,
        /// The column or variable.
        column: String,
        /// What it is.
        found: String,
    },

    /// The unit does not match the quantity of the signal.
    #[error("{file}: the {signal} is {}, but its unit {:?} measures {}; {}correct the unit, the side (motor or joint) or the columns",
        alternatives(.expected), .found.symbol(), .found.dimension(), with_a_gain(.expected, *.found))]
    WrongDimension {
        /// The file.
        file: PathBuf,
        /// The signal, such as `position`.
        signal: String,
        /// The dimensions that the signal may have.
        expected: Vec<Dimension>,
        /// The unit given.
        found: Unit,
    },

    /// The number of units is neither one nor the number of channels.
    #[error("{file}: unit lists {found} units for {expected} channels; give one for all, or one for each channel")]
    UnitCount {
        /// The file.
        file: PathBuf,
        /// Number of channels.
        expected: usize,
        /// Number of units.
        found: usize,
    },

    /// One unit is given for both revolute and prismatic joints.
    #[error(
        "{file}: unit \"{unit}\" of {signal} is for all joints, but joint `{joint}` has {dimension}; give a list with one unit \
         for each joint, such as unit = [\"m\", \"rad\"]"
    )]
    MixedUnit {
        /// The file.
        file: PathBuf,
        /// The signal.
        signal: String,
        /// The unit.
        unit: Unit,
        /// A joint with values of another dimension.
        joint: String,
        /// That dimension.
        dimension: Dimension,
    },

    /// The number of gains differs from the number of channels.
    #[error(
        "{file}: expected one gain for each of its {expected} channels, found {found}; list one number per channel"
    )]
    GainCount {
        /// The file.
        file: PathBuf,
        /// Number of channels.
        expected: usize,
        /// Number of gains.
        found: usize,
    },

    /// The list of gains is empty: a proposal leaves it for the user to fill in.
    #[error(
        "{file}: gain = [] of the columns {} is to be filled in, a number for each channel, {channels} in all: {what}",
        columns.join(" ")
    )]
    GainToFillIn {
        /// The file.
        file: PathBuf,
        /// Its columns.
        columns: Vec<String>,
        /// Number of channels.
        channels: usize,
        /// The meaning of a gain, for example torque per ampere.
        what: String,
    },

    /// A gain is zero, NaN or infinite.
    #[error(
        "{file}: gain of channel {channel} counted from 0: expected a finite number other than zero, found {found}"
    )]
    BadGain {
        /// The file.
        file: PathBuf,
        /// The channel, counted from 0.
        channel: usize,
        /// The gain.
        found: f64,
    },

    /// Two signals differ in length.
    #[error(
        "the {first} has {first_samples} samples ({first_file}), the {second} has {second_samples} ({second_file}); \
         cut both to the same samples"
    )]
    DifferentLengths {
        /// The first signal.
        first: String,
        /// Its file.
        first_file: PathBuf,
        /// Its number of samples.
        first_samples: usize,
        /// The second signal.
        second: String,
        /// Its file.
        second_file: PathBuf,
        /// Its number of samples.
        second_samples: usize,
    },

    /// A signal of one channel has several.
    #[error("{file}: expected one channel of {signal}, found {found}; name its column in the list of columns")]
    NotOneChannel {
        /// The file.
        file: PathBuf,
        /// The signal, such as `time`.
        signal: String,
        /// Number of channels.
        found: usize,
    },

    /// A signal is zero at every sample.
    #[error("{file}: the {signal} is zero at every sample; point to the columns that hold what was recorded")]
    AllZero {
        /// The file.
        file: PathBuf,
        /// The signal, such as `torque`.
        signal: String,
    },

    /// A time axis is too short to give a sample rate.
    #[error("{file}: {column:?}: expected at least two times, found {found}; record or export it again")]
    TooFewTimes {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// Number of times.
        found: usize,
    },

    /// A time is not later than the one before it.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: expected a time later than {previous} s, found {found} s; \
         remove doubled or misplaced samples"
    )]
    TimeNotIncreasing {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// The sample, counted from 0.
        sample: usize,
        /// The time of the sample before it, in seconds.
        previous: f64,
        /// The time of the sample, in seconds.
        found: f64,
    },

    /// The times start again: a file of two recordings.
    #[error(
        "{file}: {column:?} starts again at sample {sample} counted from 0: {found} s after {previous} s: these are two recordings; write \
         the samples from there on into a file of their own, and name both"
    )]
    TimeRestarts {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// The first sample of the second recording, counted from 0.
        sample: usize,
        /// The time of the sample before it, in seconds.
        previous: f64,
        /// The time of the sample, in seconds.
        found: f64,
    },

    /// Most samples lack a value of a signal.
    #[error(
        "{file}: only {complete} of {samples} samples have all values of {}: it was logged at a lower rate than the others; remove the \
         lines without them, so that all signals have that rate", quoted(.columns)
    )]
    Sparse {
        /// The file.
        file: PathBuf,
        /// The columns of the signal.
        columns: Vec<String>,
        /// Samples with all its values.
        complete: usize,
        /// All samples.
        samples: usize,
    },

    /// The time steps have no usual value.
    #[error(
        "{file}: {column:?}: {irregular} of {steps} time steps deviate by more than {largest} of the usual one, {expected:.6} s \
         (`largest_jitter`), most at sample {sample} counted from 0, {found:.6} s: the samples have no common clock; state \
         sample_rate_hz instead of time, or record again"
    )]
    TooMuchJitter {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// The sample at the end of the step that deviates most, counted from 0.
        sample: usize,
        /// Number of steps that deviate by more than allowed.
        irregular: usize,
        /// Number of all steps.
        steps: usize,
        /// The usual step, in seconds.
        expected: f64,
        /// The step found, in seconds.
        found: f64,
        /// Largest deviation allowed, in steps.
        largest: f64,
    },

    /// A gap is far longer than the recording.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: {found:.3} s after the one before it, far longer than the rest of \
         the recording: make two recordings of it"
    )]
    GapTooLong {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// The sample after the gap, counted from 0.
        sample: usize,
        /// The length of the gap, in seconds.
        found: f64,
    },

    /// The samples are not equally spaced in time.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: expected a step of {expected} s as on average, \
         found {found} s; resample the recording to equal steps before"
    )]
    TimeNotUniform {
        /// The file.
        file: PathBuf,
        /// The name of the time column.
        column: String,
        /// The sample at the end of the step that deviates most, counted from 0.
        sample: usize,
        /// The mean step, in seconds.
        expected: f64,
        /// The step found, in seconds.
        found: f64,
    },
}

impl RecordingError {
    pub(super) fn damaged(file: &Path, reason: String) -> Self {
        Self::Damaged { file: file.to_owned(), reason }
    }
}

fn quoted(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}

/// The remedy for torques in a drive's unit.
fn with_a_gain(expected: &[Dimension], found: Unit) -> &'static str {
    let of_drive = matches!(found.dimension(), Dimension::Current | Dimension::Voltage | Dimension::Dimensionless);
    let is_effort = expected.iter().all(|dimension| matches!(dimension, Dimension::Torque | Dimension::Force));
    if of_drive && is_effort { "add gain = [...], the torque at the joint for each unit, or " } else { "" }
}

fn alternatives(dimensions: &[Dimension]) -> String {
    dimensions.iter().map(Dimension::to_string).collect::<Vec<_>>().join(" or ")
}
