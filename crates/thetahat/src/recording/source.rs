//! The description of a signal in a file, and its reading into a series.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{Quantity, RecordingError, Unit, csv, mat};
use crate::series::Series;

/// Where the channels of one signal are, and what they are.
///
/// ```
/// use thetahat::recording::{ChannelSource, Side, Unit};
/// let text = r#"
///     file = "torque.csv"
///     columns = ["motor_1", "motor_2"]
///     unit = "mN m"
///     side = "motor"
/// "#;
/// let source: ChannelSource = toml::from_str(text).unwrap();
/// assert_eq!((source.unit, source.side), (Unit::MillinewtonMetre, Side::Motor));
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSource {
    /// The file, relative to the folder of the data.
    pub file: PathBuf,
    /// Names of CSV columns or of MAT variables, in the order of the channels; none means all columns of a CSV file. A
    /// MAT variable with several columns gives several channels.
    #[serde(default)]
    pub columns: Vec<String>,
    /// The unit of the values in the file.
    pub unit: Unit,
    /// The side of the transmission on which the values were measured.
    #[serde(default)]
    pub side: Side,
    /// A factor per channel, applied after the unit; none means 1 for all.
    #[serde(default)]
    pub gain: Vec<f64>,
}

/// A side of the transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The motor's: before the gears.
    Motor,
    /// The joint's: behind the gears.
    #[default]
    Joint,
}

impl ChannelSource {
    /// The path of the file below the folder of the data.
    #[must_use]
    pub fn path(&self, root: &Path) -> PathBuf {
        root.join(&self.file)
    }

    /// Checks that the unit measures what the `signal` (a word for the error's text) is.
    ///
    /// # Errors
    /// [`RecordingError::WrongQuantity`] if the unit's quantity is not among the `expected` ones.
    pub fn require_quantity(&self, signal: &str, expected: &[Quantity]) -> Result<(), RecordingError> {
        if expected.contains(&self.unit.quantity()) {
            return Ok(());
        }
        Err(RecordingError::WrongQuantity {
            file: self.file.clone(),
            signal: signal.to_owned(),
            expected: expected.to_vec(),
            found: self.unit,
        })
    }

    /// The factor of each channel: unit times gain.
    fn factors(&self, channels: usize) -> Result<Vec<f64>, RecordingError> {
        if self.gain.is_empty() {
            return Ok(vec![self.unit.to_si(); channels]);
        }
        if self.gain.len() != channels {
            let file = self.file.clone();
            return Err(RecordingError::GainCount { file, expected: channels, found: self.gain.len() });
        }
        if let Some(channel) = self.gain.iter().position(|&g| g == 0.0 || !g.is_finite()) {
            let file = self.file.clone();
            return Err(RecordingError::BadGain { file, channel, found: self.gain[channel] });
        }
        Ok(self.gain.iter().map(|g| g * self.unit.to_si()).collect())
    }

    fn refuse_repetition(&self) -> Result<(), RecordingError> {
        let repeated = (1..self.columns.len()).find(|&i| self.columns[..i].contains(&self.columns[i]));
        repeated.map_or(Ok(()), |i| {
            Err(RecordingError::RepeatedColumn { file: self.file.clone(), column: self.columns[i].clone() })
        })
    }
}

/// The channels of `source` in SI units: the file's values times the unit's factor times the gain.
///
/// The file is looked for in `root`; its format follows from its extension, `.csv` or `.mat`. The side is not applied:
/// motor values stay on the motor side.
///
/// # Errors
/// A [`RecordingError`] that names the place, what was expected and what was found, if the file cannot be read, a column
/// is missing, a value is not a finite number, or the gains do not fit the channels.
pub fn read_channels(source: &ChannelSource, root: &Path) -> Result<Series, RecordingError> {
    source.refuse_repetition()?;
    let path = source.path(root);
    let mut series = match Format::of(&path)? {
        Format::Csv => csv::read(&path, &source.columns)?,
        Format::Mat => mat::read(&path, &source.columns)?,
    };
    let factors = source.factors(series.channels())?;
    for sample in series.values_mut().chunks_exact_mut(factors.len()) {
        sample.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
    }
    Ok(series)
}

enum Format {
    Csv,
    Mat,
}

impl Format {
    fn of(path: &Path) -> Result<Self, RecordingError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match extension.as_str() {
            "csv" => Ok(Self::Csv),
            "mat" => Ok(Self::Mat),
            _ => {
                Err(RecordingError::UnknownFormat { file: path.to_owned(), expected: ".csv or .mat", found: extension })
            }
        }
    }
}

/// All bytes of a file that must hold some.
pub(super) fn file_bytes(path: &Path) -> Result<Vec<u8>, RecordingError> {
    let file = path.to_owned();
    match fs::read(path) {
        Ok(bytes) if bytes.is_empty() => Err(RecordingError::EmptyFile { file }),
        Ok(bytes) => Ok(bytes),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Err(RecordingError::FileNotFound { file }),
        Err(source) => Err(RecordingError::Unreadable { file, source }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_files::Folder;
    use super::*;

    const TWO_JOINTS: &str = "a,b\n1,2\n3,4\n";

    fn source(file: &str, gain: &[f64]) -> ChannelSource {
        ChannelSource {
            file: file.into(),
            columns: Vec::new(),
            unit: Unit::Millimetre,
            side: Side::Joint,
            gain: gain.to_vec(),
        }
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
        assert_eq!((source.side, source.columns.len(), source.gain.len()), (Side::Joint, 0, 0));
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
        source.require_quantity("position", &[Quantity::Angle, Quantity::Length]).unwrap();
        source.unit = Unit::NewtonMetre;
        let error = source.require_quantity("position", &[Quantity::Angle, Quantity::Length]).unwrap_err();
        assert!(matches!(error, RecordingError::WrongQuantity { found: Unit::NewtonMetre, .. }));
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
}
