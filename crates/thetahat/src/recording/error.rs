//! What can be wrong with a recording.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::{Quantity, Unit};

/// Why a recording is not accepted: where the defect is, what was expected, what was found.
///
/// Lines are counted from 1, as editors do, samples from 0.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no file of this name.
    #[error("{file}: there is no such file; check its name and the folder in which the data are looked for")]
    FileNotFound {
        /// The file, with the folder against which it was resolved.
        file: PathBuf,
    },

    /// The file is there and cannot be read.
    #[error("{file}: the file cannot be read ({source}); check its permissions")]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },

    /// The extension names no format that is read.
    #[error("{file}: expected a file name that ends in {expected}, found {found:?}; export the recording to CSV")]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// The extensions that are read.
        expected: &'static str,
        /// The extension of this file, empty if it has none.
        found: String,
    },

    /// The file holds nothing.
    #[error("{file}: the file is empty; record or export it again")]
    EmptyFile {
        /// The file.
        file: PathBuf,
    },

    /// The columns are there and hold no value.
    #[error("{file}: expected at least one sample below the column names, found none; record or export it again")]
    NoSamples {
        /// The file.
        file: PathBuf,
    },

    /// The first line of a CSV file holds numbers, and no column was asked for by name.
    #[error("{file}: line 1: expected the names of the columns, found numbers; write a first line of names")]
    MissingHeader {
        /// The file.
        file: PathBuf,
    },

    /// A CSV file has no column of this name.
    #[error("{file}: there is no column {column:?}; the columns are {}; correct the list of columns", quoted(.found))]
    MissingColumn {
        /// The file.
        file: PathBuf,
        /// The name asked for.
        column: String,
        /// The names that are there.
        found: Vec<String>,
    },

    /// A CSV file has several columns of the name asked for.
    #[error("{file}: column {column:?} occurs {found} times in line 1; give each column its own name")]
    AmbiguousColumn {
        /// The file.
        file: PathBuf,
        /// The name asked for.
        column: String,
        /// How many columns have it.
        found: usize,
    },

    /// The same name was asked for twice.
    #[error("{file}: column {column:?} is listed twice; list the column of each joint once")]
    RepeatedColumn {
        /// The file.
        file: PathBuf,
        /// The name listed twice.
        column: String,
    },

    /// A row of a CSV file is longer or shorter than the header.
    #[error(
        "{file}: line {line}: expected {expected} values as in line 1, found {found}; \
         values are separated by commas, and the decimal sign is a point"
    )]
    RowLength {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// Number of names in the header.
        expected: usize,
        /// Number of values in the row.
        found: usize,
    },

    /// A cell of a CSV file is not a number.
    #[error("{file}: line {line}, column {column:?}: expected a number, found {found:?}; correct or remove the line")]
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

    /// A cell of a CSV file is NaN or infinite.
    #[error(
        "{file}: line {line}, column {column:?}: expected a finite number, found {found}; \
         cut the record to the part without gaps, or fill the gap"
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

    /// A sample of a MAT variable or of a time axis is NaN or infinite.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: expected a finite number, found {found}; \
         cut the record to the part without gaps, or fill the gap"
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

    /// The file is not a MAT file of version 5.
    #[error("{file}: expected a MAT file of version 5, found another kind of file; save it in MATLAB with save -v7")]
    NotMatV5 {
        /// The file.
        file: PathBuf,
    },

    /// The file is a MAT file of version 7.3, which is HDF5 inside.
    #[error(
        "{file}: expected a MAT file of version 5, found one of version 7.3, which is an HDF5 file; \
         save it in MATLAB with save -v7"
    )]
    MatV73 {
        /// The file.
        file: PathBuf,
    },

    /// The parts of a MAT file do not fit into it: it was cut short or damaged.
    #[error("{file}: the file is cut short or damaged from byte {offset} on; copy or save it again")]
    DamagedMat {
        /// The file.
        file: PathBuf,
        /// Where the part begins that does not fit.
        offset: usize,
    },

    /// No variable of a MAT file was asked for by name.
    #[error("{file}: no variable is listed; the numeric variables are {}; list those to read", quoted(.found))]
    NoVariableListed {
        /// The file.
        file: PathBuf,
        /// The variables that can be read.
        found: Vec<String>,
    },

    /// A MAT file has no variable of this name that can be read.
    #[error(
        "{file}: there is no numeric variable {variable:?}; those that can be read are {}{}; \
         correct the name, or save the variable as a matrix of doubles", quoted(.found), beside(*.skipped)
    )]
    MissingVariable {
        /// The file.
        file: PathBuf,
        /// The name asked for.
        variable: String,
        /// The variables that can be read.
        found: Vec<String>,
        /// How many more variables there are, of kinds that are not read: text, cells, structures, sparse and some
        /// integer matrices, or damaged ones.
        skipped: usize,
    },

    /// A MAT variable is complex.
    #[error("{file}: variable {variable:?} is complex; save its real part")]
    ComplexVariable {
        /// The file.
        file: PathBuf,
        /// The variable.
        variable: String,
    },

    /// A MAT variable has not the shape asked for.
    #[error("{file}: variable {variable:?}: expected {expected}, found {}; save it in that shape", by_sides(.found))]
    VariableShape {
        /// The file.
        file: PathBuf,
        /// The variable.
        variable: String,
        /// The shape asked for.
        expected: &'static str,
        /// The shape of the variable.
        found: Vec<usize>,
    },

    /// The text names no known unit.
    #[error("unknown unit {found:?}; the known units are {}", .expected.join(", "))]
    UnknownUnit {
        /// The text.
        found: String,
        /// The known units, in quotation marks.
        expected: Vec<String>,
    },

    /// The unit does not measure what the signal is.
    #[error("{file}: the {signal} is {}, but its unit {:?} measures {}; correct the unit, the side (motor or joint) or the columns",
        alternatives(.expected), .found.symbol(), .found.quantity())]
    WrongQuantity {
        /// The file.
        file: PathBuf,
        /// The signal, such as `position`.
        signal: String,
        /// The quantities that the signal may be.
        expected: Vec<Quantity>,
        /// The unit given.
        found: Unit,
    },

    /// The number of gains is not the number of channels.
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

    /// The time steps jitter too much to be made equal.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: the step is {found:.6} s where it is {expected:.6} s on \
         average, which deviates by more than {largest} of a step (`largest_jitter`); samples were dropped or the clock \
         is not that of the samples: cut the record there, or state sample_rate_hz instead of time"
    )]
    TooMuchJitter {
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
        /// Largest deviation allowed, in steps.
        largest: f64,
    },

    /// The samples are not equally spaced in time.
    #[error(
        "{file}: {column:?}, sample {sample} counted from 0: expected a step of {expected} s as on average, \
         found {found} s; resample the record to equal steps before"
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

fn quoted(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}

fn alternatives(quantities: &[Quantity]) -> String {
    quantities.iter().map(Quantity::to_string).collect::<Vec<_>>().join(" or ")
}

fn by_sides(shape: &[usize]) -> String {
    shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

fn beside(skipped: usize) -> String {
    match skipped {
        0 => String::new(),
        n => format!(" (beside {n} of a kind that is not read, such as text, cells, structures, sparse or int32)"),
    }
}
